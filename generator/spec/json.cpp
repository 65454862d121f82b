#include "generator/spec/json.hpp"

#include <algorithm>
#include <iterator>
#include <set>

#include <nlohmann/json.hpp>

namespace ocm::spec {

const Node* Node::find(std::string_view key) const noexcept {
  for (const auto& [name, node] : members)
    if (name == key) return &node;
  return nullptr;
}

std::string_view describe(Node::Kind kind) noexcept {
  switch (kind) {
    case Node::Kind::null:
      return "null";
    case Node::Kind::boolean:
      return "true or false";
    case Node::Kind::number:
      return "a number";
    case Node::Kind::string:
      return "a text";
    case Node::Kind::array:
      return "a list";
    case Node::Kind::object:
      return "an object";
  }
  return "";
}

std::string pointer_step(std::string_view key) {
  std::string step;
  for (const char c : key) {
    if (c == '~')
      step += "~0";
    else if (c == '/')
      step += "~1";
    else
      step += c;
  }
  return step;
}

namespace {

/// Counts what the parser has taken, so that a node knows its line.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, const char** taken) : at_(at), taken_(taken) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    *taken_ = ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    auto before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char** taken_;
};

class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(std::string_view text, std::string_view file_name, std::vector<Problem>& problems,
          const Document& document)
      : taken(text.data()),
        text_(text),
        counted_(text.data()),
        file_name_(file_name),
        problems_(problems),
        document_(document) {}

  const char* taken;

  Node take_root() { return std::move(root_); }

  bool null() override { return add({}); }
  bool boolean(bool value) override {
    Node node;
    node.kind = Node::Kind::boolean;
    node.truth = value;
    return add(std::move(node));
  }
  bool number_integer(number_integer_t value) override { return number(std::to_string(value)); }
  bool number_unsigned(number_unsigned_t value) override { return number(std::to_string(value)); }
  bool number_float(number_float_t, const string_t& digits) override { return number(digits); }
  bool string(string_t& value) override {
    if (!short_enough(value)) return false;
    Node node;
    node.kind = Node::Kind::string;
    node.text = value;
    return add(std::move(node));
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Node::Kind::object); }
  bool start_array(std::size_t) override { return open(Node::Kind::array); }
  bool key(string_t& name) override {
    if (!short_enough(name)) return false;
    open_.back()->members.push_back({name, Node{}});
    return true;
  }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t position, const std::string& token,
                   const nlohmann::detail::exception& error) override {
    // The parser's message reads "[json.exception...] parse error at line 1, column 2: what". Only `what` is
    // ours to tell; line and column stand in the place.
    std::string what = error.what();
    if (const auto colon = what.find(": "); colon != std::string::npos) what.erase(0, colon + 2);
    std::string remedy = "strict JSON: double quotes, commas between members, no comments";
    const std::string_view mark = "\xEF\xBB\xBF";
    const std::size_t begin = text_.substr(0, mark.size()) == mark ? mark.size() : 0;
    if (text_.find_first_not_of(" \t\r\n", begin) == std::string_view::npos) {
      what = "the file is empty";
      remedy = std::string{document_.what} + " is a JSON object with " + std::string{document_.members};
    } else if (what.find("UTF-8") != std::string::npos) {
      remedy = "save the file as UTF-8";
    } else if (what.find("number overflow") != std::string::npos) {
      what = "number " + token.substr(0, 40) + " is too large";
      remedy = "at most 18 digits, and an exponent of at most 100";
    }
    const std::size_t offset = position == 0 ? 0 : std::min(position, text_.size() + 1) - 1;
    problems_.push_back({place_of(offset), std::move(what), std::move(remedy)});
    return false;
  }
  /// The parser takes a NUL for the end of the text; false: there is one.
  bool has_no_nul() {
    const std::size_t at = text_.find('\0');
    if (at == std::string_view::npos) return true;
    problems_.push_back({place_of(at), "a NUL character", "end the text in front of it"});
    return false;
  }

 private:
  bool number(std::string digits) {
    if (!short_enough(digits)) return false;
    Node node;
    node.kind = Node::Kind::number;
    node.text = std::move(digits);
    return add(std::move(node));
  }
  bool short_enough(const std::string& value) {
    if (value.size() <= document_.max_text) return true;
    problems_.push_back({place(), "a text of " + std::to_string(value.size()) + " bytes",
                         "at most " + std::to_string(document_.max_text)});
    return false;
  }
  Node* put(Node node) {
    node.line = line(node.kind == Node::Kind::number ? 1 : 0);
    if (open_.empty()) {
      root_ = std::move(node);
      return &root_;
    }
    Node& parent = *open_.back();
    if (parent.kind == Node::Kind::array) return &parent.items.emplace_back(std::move(node));
    return &(parent.members.back().node = std::move(node));
  }
  bool add(Node node) {
    put(std::move(node));
    return true;
  }
  // Only the innermost open node grows, so the addresses of those around it stay.
  bool open(Node::Kind kind) {
    if (open_.size() == max_depth) {
      problems_.push_back(
          {place(), "nested deeper than " + std::to_string(max_depth) + " levels",
           std::string{document_.what} + " needs " + std::to_string(document_.levels) + " levels at most"});
      return false;
    }
    Node node;
    node.kind = kind;
    open_.push_back(put(std::move(node)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }
  /// `ahead`: how many characters beyond the value the parser has taken; one after a number.
  std::size_t line(std::ptrdiff_t ahead = 0) {
    const char* end = std::max(counted_, taken - std::min(ahead, taken - text_.data()));
    line_ += static_cast<std::size_t>(std::count(counted_, end, '\n'));
    counted_ = end;
    return line_;
  }
  std::string place() { return std::string{file_name_} + ":" + std::to_string(line()); }
  /// Line and column.
  [[nodiscard]] std::string place_of(std::size_t offset) const {
    std::size_t line = 1;
    std::size_t column = 1;
    for (const char c : text_.substr(0, offset)) {
      column = c == '\n' ? 1 : column + 1;
      if (c == '\n') ++line;
    }
    return std::string{file_name_} + ":" + std::to_string(line) + ":" + std::to_string(column);
  }

  std::string_view text_;
  const char* counted_;
  std::size_t line_ = 1;
  std::string_view file_name_;
  std::vector<Problem>& problems_;
  const Document& document_;
  Node root_;
  std::vector<Node*> open_;
};

void find_twins(const Node& node, const std::string& path, std::string_view file_name,
                std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < node.items.size(); ++i)
    find_twins(node.items[i], path + "/" + std::to_string(i), file_name, problems);
  std::set<std::string_view> seen;
  for (const auto& [name, member] : node.members) {
    const std::string member_path = path + "/" + pointer_step(name);
    if (!seen.insert(name).second)
      problems.push_back({std::string{file_name} + ":" + std::to_string(member.line) + ": " + member_path,
                          "member \"" + name + "\" is there twice",
                          "keep one of the two: only one can be meant"});
    find_twins(member, member_path, file_name, problems);
  }
}

}  // namespace

std::string_view wide_encoding(std::string_view text) noexcept {
  using namespace std::string_view_literals;
  const auto begins = [text](std::string_view mark) { return text.substr(0, mark.size()) == mark; };
  const auto is_nul = [text](std::size_t at) { return at < text.size() && text[at] == '\0'; };
  const bool is_wider = is_nul(2) && is_nul(3);
  if (begins("\xFF\xFE"sv) || (text.size() > 1 && !is_nul(0) && is_nul(1)))
    return is_wider ? "UTF-32LE" : "UTF-16LE";
  if (begins("\xFE\xFF"sv) || (is_nul(0) && text.size() > 1 && !is_nul(1))) return "UTF-16BE";
  if (is_nul(0) && is_nul(1) && text.size() > 3) return "UTF-32BE";
  return {};
}

Node parse_json(std::string_view text, std::string_view file_name, std::vector<Problem>& problems,
                const Document& document) {
  if (text.data() == nullptr) text = "";
  if (const std::string encoding{wide_encoding(text)}; !encoding.empty()) {
    problems.push_back({std::string{file_name}, "the text is " + encoding,
                        "save it as UTF-8, such as iconv -f " + encoding + " -t UTF-8 writes it"});
    return {};
  }
  Builder builder{text, file_name, problems, document};
  const CountingIterator first{text.data(), &builder.taken};
  const CountingIterator last{text.data() + text.size(), &builder.taken};
  if (!nlohmann::json::sax_parse(first, last, &builder) || !builder.has_no_nul()) return {};
  Node root = builder.take_root();
  find_twins(root, "", file_name, problems);
  return root;
}

}  // namespace ocm::spec
