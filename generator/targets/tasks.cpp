#include "generator/targets/tasks.hpp"

#include <cctype>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <set>

#include "generator/spec/json.hpp"
#include "generator/spec/names.hpp"

namespace ocm::generate {
namespace {

using spec::Node;
using Kind = spec::Node::Kind;

/// Reads members, and says what is wrong with them.
class Reader {
 public:
  Reader(std::string_view file, std::vector<spec::Problem>& problems) : file_(file), problems_(problems) {}

  void complain(const Node& node, std::string what, std::string remedy) {
    problems_.push_back({file_ + ":" + std::to_string(node.line), std::move(what), std::move(remedy)});
  }
  /// Nothing else is in it.
  void only(const Node& node, std::initializer_list<std::string_view> names) {
    if (!node.is(Kind::object)) return complain(node, "not an object", "see spec/tasks.schema.json");
    for (const auto& member : node.members) {
      bool known = false;
      for (const auto name : names) known = known || member.name == name;
      if (!known) complain(member.node, "unknown member " + member.name, "see spec/tasks.schema.json");
    }
  }
  /// A C++ identifier in lower case, once within `taken`.
  std::string name(const Node& node, std::set<std::string>& taken) {
    const std::string text = string(node, "name");
    bool good = !text.empty() && std::islower(static_cast<unsigned char>(text[0])) != 0;
    for (const char c : text)
      good = good && (std::islower(static_cast<unsigned char>(c)) != 0 ||
                      std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '_');
    if (!good)
      complain(node, "'" + text + "' is not a valid name",
               "a letter, then letters, digits and _, all lower case");
    else if (!taken.insert(text).second)
      complain(node, "'" + text + "' is there twice", "another name");
    return text;
  }
  std::string string(const Node& node, std::string_view member) {
    const Node* found = node.find(member);
    if (found == nullptr) return {};
    if (!found->is(Kind::string))
      complain(*found, std::string{member} + " is not a text", "put it in quotes");
    std::string safe;  // it goes into a comment
    for (const char c : found->text) safe += static_cast<unsigned char>(c) < 0x20 || c == '\\' ? ' ' : c;
    return safe;
  }
  /// In nanoseconds; `otherwise` if it is missing.
  std::int64_t time(const Node& node, std::string_view member, std::int64_t least, std::int64_t otherwise) {
    const Node* found = node.find(member);
    if (found == nullptr) {
      if (otherwise < least) complain(node, "no " + std::string{member}, "a time such as 120us");
      return otherwise;
    }
    std::int64_t count = -1;
    const std::string& text = found->text;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    const std::string_view unit{end, static_cast<std::size_t>(text.data() + text.size() - end)};
    const std::int64_t scale = unit == "ns"   ? 1
                               : unit == "us" ? 1'000
                               : unit == "ms" ? 1'000'000
                               : unit == "s"  ? 1'000'000'000
                                              : 0;
    const bool good = found->is(Kind::string) && error == std::errc{} && scale != 0 &&
                      count <= INT64_MAX / 2 / (scale == 0 ? 1 : scale) && count * scale >= least;
    if (!good) complain(*found, "'" + text + "' is not a valid time", "a whole number of ns, us, ms or s");
    return good ? count * scale : least;
  }
  std::int64_t number(const Node& node, std::string_view member, std::int64_t most, std::int64_t otherwise) {
    const Node* found = node.find(member);
    if (found == nullptr) {
      if (otherwise < 0) complain(node, "no " + std::string{member}, "a whole number");
      return otherwise;
    }
    std::int64_t value = -1;
    const std::string& text = found->text;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (!found->is(Kind::number) || error != std::errc{} || end != text.data() + text.size() || value < 0 ||
        value > most)
      complain(*found, std::string{member} + " is out of range",
               "a whole number from 0 to " + std::to_string(most));
    return value;
  }
  const std::vector<Node>& list(const Node& node, std::string_view member) {
    static const std::vector<Node> none;
    const Node* found = node.find(member);
    if (found != nullptr && found->is(Kind::array) && !found->items.empty()) return found->items;
    complain(node, "no " + std::string{member}, "an array of at least one");
    return none;
  }

 private:
  std::string file_;
  std::vector<spec::Problem>& problems_;
};

/// With ' between thousands, as the house writes numbers.
std::string digits(std::int64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t at = text.size(); at > 3;) text.insert(at -= 3, "'");
  return text;
}

std::string task_struct(Reader& reader, const Node& node, const std::string& name) {
  reader.only(node, {"name", "cost", "waits", "period", "deadline", "jitter", "level", "own", "source"});
  const Node* own = node.find("own");
  if (own != nullptr && !own->is(Kind::boolean))
    reader.complain(*own, "own is not true or false", "one of them");
  const std::string source = reader.string(node, "source");
  std::string text;
  if (!source.empty()) text += "/// [" + source + "]\n";
  text += "struct " + spec::pascal_case(name) + " {\n";
  text += "  static constexpr std::string_view name = \"" + name + "\";\n";
  text += std::string{"  static constexpr bool own = "} + (own != nullptr && own->truth ? "true" : "false") +
          ";\n";
  text += "  static constexpr Task task{.cost = " + digits(reader.time(node, "cost", 1, -1));
  text += ", .period = " + digits(reader.time(node, "period", 1, -1));
  if (node.find("deadline") != nullptr)
    text += ", .deadline = " + digits(reader.time(node, "deadline", 1, 1));
  if (node.find("jitter") != nullptr) text += ", .jitter = " + digits(reader.time(node, "jitter", 0, 0));
  text += "@, .level = " + std::to_string(reader.number(node, "level", 1'000'000, -1));
  if (const Node* waits = node.find("waits"); waits != nullptr) {
    const std::int64_t ns = reader.time(node, "waits", 0, 0);
    if (ns >= reader.time(node, "cost", 1, 1))
      reader.complain(*waits, "waits is not less than the cost", "the part of the cost in which it waits");
    text += ", .waits = " + digits(ns);
  }
  return text + "};\n};\n";
}

std::string set_namespace(Reader& reader, const Node& node, const std::string& name) {
  reader.only(node, {"name", "description", "source", "blocking", "bus_percent", "tasks"});
  const std::int64_t blocking = reader.time(node, "blocking", 0, 0);
  const std::int64_t percent = reader.number(node, "bus_percent", 100, 100);
  std::set<std::string> taken;
  std::set<std::string> declared{"Facts", "Task", "TaskList"};
  std::string structs;
  std::string types;
  for (const Node& task : reader.list(node, "tasks")) {
    const std::size_t others = taken.size();
    const std::string task_name = reader.name(task, taken);
    const std::string type = spec::pascal_case(task_name);
    if (taken.size() > others && !declared.insert(type).second)
      reader.complain(task, "'" + task_name + "' has the type " + type + ", which is there already",
                      "another name");
    structs += task_struct(reader, task, task_name) + "\n";
    types += (types.empty() ? "" : ", ") + type;
  }
  const std::string held_up = blocking > 0 ? ", .blocking = " + digits(blocking) : "";
  for (std::size_t at; (at = structs.find('@')) != std::string::npos;) structs.replace(at, 1, held_up);
  return "/// " + reader.string(node, "description") + ". [" + reader.string(node, "source") +
         "]\nnamespace " + name + " {\n\n" + structs + "struct Facts {\n  using Tasks = TaskList<" + types +
         ">;\n  static constexpr std::int64_t blocking = " + digits(blocking) +
         ";\n  static constexpr std::uint32_t bus_percent = " + std::to_string(percent) +
         ";\n};\n\n}  // namespace " + name + "\n\n";
}

}  // namespace

std::string tasks_header(std::string_view json, std::string_view file_name,
                         std::vector<spec::Problem>& problems) {
  const Node root = spec::parse_json(json, file_name, problems);
  if (!problems.empty()) return {};
  Reader reader{file_name, problems};
  reader.only(root, {"$schema", "sets"});
  std::string text = "// Made by ocm-generate from " + std::string{file_name} +
                     ". Do not edit: change that, and generate again.\n\n"
                     "/// Task sets of processors: the boards', and those of the robots that theses "
                     "analysed. A task is a type,\n"
                     "/// so that a set that misses a deadline names it. Times are nanoseconds. No heap; "
                     "everything is constexpr.\n"
                     "#pragma once\n\n#include <cstdint>\n#include <string_view>\n\n"
                     "#include \"ocm/analysis/task_list.hpp\"\n#include \"ocm/analysis/task_set.hpp\"\n\n"
                     "// clang-format off\nnamespace ocm::analysis::task_sets {\n\n";
  std::set<std::string> taken;
  std::string calls;
  for (const Node& set : reader.list(root, "sets")) {
    const std::string name = reader.name(set, taken);
    if (spec::is_reserved(name) || name == "std" || name == "for_each_set")  // it is a namespace
      reader.complain(set, "'" + name + "' is a word of the header", "another name");
    text += set_namespace(reader, set, name);
    calls += "  f(std::string_view{\"" + name + "\"}, " + name + "::Facts::Tasks{});\n";
  }
  text +=
      "/// Calls f(name, its TaskList) for every set.\ntemplate <class F>\n"
      "constexpr void for_each_set(F&& f) {\n" +
      calls + "}\n\n";
  return problems.empty() ? text + "}  // namespace ocm::analysis::task_sets\n" : std::string{};
}

}  // namespace ocm::generate
