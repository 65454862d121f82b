/// Sets of messages and tasks as CSV.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "ocm/base/text.hpp"

#include "cli/analyse/set.hpp"
#include "cli/shared/messages.hpp"
#include "generator/spec/from_dbc.hpp"

namespace ocm::cli::analyse {
namespace {

/// Far more than 4096 messages need.
constexpr std::size_t most_text = 16U << 20U;

/// Digits with a sign, all of `text`.
base::Result<std::int64_t> parse_whole(std::string_view text) {
  const bool negative = text.starts_with('-');
  const auto number = base::parse_unsigned(negative ? text.substr(1) : text);
  if (!number) return number.error;
  if (*number > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()))
    return base::Error::out_of_range;
  const auto value = static_cast<std::int64_t>(*number);
  return negative ? -value : value;
}

struct Column {
  std::string_view name;
  bool needed;
};

/// A table whose header has the known columns, in any order.
class Table {
 public:
  Table(std::string text, const std::string& file, std::span<const Column> columns, std::string_view header)
      : file_(file), lines_(split_csv(text)) {
    if (lines_.empty()) {
      mistakes.push_back({file, "no header and no line", fmt::format("the first line is {}", header)});
      return;
    }
    const Line& head = lines_.front();
    for (const std::string& name : head.cells) {
      const auto known = std::find_if(columns.begin(), columns.end(),
                                      [&name](const Column& column) { return column.name == name; });
      const bool twice = std::find(names_.begin(), names_.end(), name) != names_.end();
      if (known == columns.end() || twice)
        mistake(
            head,
            twice ? fmt::format("column '{}' occurs twice", name) : fmt::format("unknown column '{}'", name),
            fmt::format("the header is {}", header));
      names_.push_back(name);
    }
    for (const Column& column : columns)
      if (column.needed && std::find(names_.begin(), names_.end(), column.name) == names_.end())
        mistake(head, fmt::format("no column '{}'", column.name), fmt::format("the header is {}", header));
    if (lines_.size() == 1 && mistakes.empty())
      mistake(head, "a header and nothing below it", "each message or task is a line");
    if (!mistakes.empty()) lines_.clear();
    for (std::size_t i = 1; i < lines_.size(); ++i)
      if (lines_[i].cells.size() > names_.size())
        mistake(lines_[i], fmt::format("{} cells, the header has {}", lines_[i].cells.size(), names_.size()),
                "write a name that contains a comma in double quotes");
  }

  [[nodiscard]] std::span<const Line> lines() const {
    return lines_.empty() ? std::span<const Line>{} : std::span<const Line>{lines_}.subspan(1);
  }
  [[nodiscard]] std::string_view cell(const Line& line, std::string_view column) const {
    for (std::size_t i = 0; i < names_.size() && i < line.cells.size(); ++i)
      if (names_[i] == column) return line.cells[i];
    return {};
  }
  void mistake(const Line& line, std::string what, std::string remedy) {
    mistakes.push_back({fmt::format("{}:{}", file_, line.number), std::move(what), std::move(remedy)});
  }
  /// A whole number from `least` on; `absent` for an empty cell, which is a mistake where there is none.
  std::int64_t number(const Line& line, std::string_view column, std::int64_t least,
                      std::optional<std::int64_t> absent = std::nullopt) {
    const std::string_view text = cell(line, column);
    if (text.empty() && absent) return *absent;
    const auto value = parse_whole(text);
    if (value && *value >= least) return *value;
    std::string what = fmt::format("{} '{}' ", column, text);
    if (text.empty())
      what = fmt::format("no {}", column);
    else if (value)
      what += fmt::format("is below {}", least);
    else if (value.error == base::Error::out_of_range)
      what += "has more than 63 bits";
    else
      what += "is not a whole number";
    mistake(line, std::move(what),
            column.ends_with("_ns") ? fmt::format("a whole number of nanoseconds, at least {}", least)
                                    : "a whole number");
    return absent.value_or(least);
  }

  std::vector<Mistake> mistakes;

 private:
  std::string file_;
  std::vector<Line> lines_;
  std::vector<std::string> names_;
};

constexpr std::string_view bus_header = "name,id,dlc,period_ns,deadline_ns,jitter_ns,node,offset_ns,fd";
constexpr std::array<Column, 9> bus_columns{{{"name", true},
                                             {"id", true},
                                             {"dlc", true},
                                             {"period_ns", true},
                                             {"deadline_ns", false},
                                             {"jitter_ns", false},
                                             {"node", false},
                                             {"offset_ns", false},
                                             {"fd", false}}};
constexpr std::string_view task_header = "name,priority,C_ns,T_ns,D_ns,J_ns,B_ns";
constexpr std::array<Column, 7> task_columns{{{"name", true},
                                              {"priority", true},
                                              {"C_ns", true},
                                              {"T_ns", true},
                                              {"D_ns", false},
                                              {"J_ns", false},
                                              {"B_ns", false}}};

constexpr std::string_view chain_header = "hop,set,activation,response_ns,best_ns,period_ns";
constexpr std::array<Column, 6> chain_columns{{{"hop", true},
                                               {"set", true},
                                               {"activation", true},
                                               {"response_ns", false},
                                               {"best_ns", false},
                                               {"period_ns", false}}};

/// "0x101", "257", "0x18FF0102", "257x" (29 bits, though it is small).
void read_identifier(Table& table, const Line& line, can::AnyFrame& head) {
  const std::string_view text = table.cell(line, "id");
  std::string_view digits = text;
  const bool hex = digits.starts_with("0x") || digits.starts_with("0X");
  if (hex) digits.remove_prefix(2);
  const bool marked = digits.ends_with('x') || digits.ends_with('X');
  if (marked) digits.remove_suffix(1);
  const auto id = base::parse_unsigned(digits, hex ? 16 : 10);
  if (!id || *id > can::max_extended_id) {
    const bool too_large = id || id.error == base::Error::out_of_range;
    table.mistake(line,
                  text.empty() ? std::string{"no id"}
                               : fmt::format("id '{}' {}", text,
                                             too_large ? "has more than 29 bits" : "is not an identifier"),
                  "such as 0x101 or 257; above 0x7FF, or with an x at the end, it has 29 bits");
    return;
  }
  head.id = static_cast<std::uint32_t>(*id);
  head.format = marked || *id > can::max_base_id ? can::Format::extended : can::Format::base;
}

/// Bytes, and whether it is CAN FD: "no", "brs" (its data at the rate of the data), "nobrs"; empty: by the
/// bytes.
void read_length(Table& table, const Line& line, can::AnyFrame& head) {
  const std::int64_t bytes = table.number(line, "dlc", 0);
  const std::string_view fd = table.cell(line, "fd");
  const bool classic = fd == "no" || (fd.empty() && bytes <= can::max_dlc);
  if (!fd.empty() && fd != "no" && fd != "brs" && fd != "nobrs")
    return table.mistake(line, fmt::format("fd '{}'", fd),
                         "no: classic; brs: CAN FD with the bit-rate switch; nobrs: CAN FD without");
  if (classic && bytes > can::max_dlc)
    return table.mistake(line, fmt::format("dlc '{}' is above 8", bytes), "0 to 8; of CAN FD up to 64");
  if (!classic && (bytes > can::max_fd_length || !can::is_fd_length(static_cast<std::size_t>(bytes))))
    return table.mistake(line, fmt::format("dlc '{}' is no length of CAN FD", bytes),
                         "0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes");
  head.length = static_cast<std::uint8_t>(bytes);
  if (classic) return;
  head.flags = can::frame_flag::fd;
  if (fd != "nobrs") head.flags |= can::frame_flag::bit_rate_switch;
}

BusSet bus_from(Table& table, const std::string& file) {
  BusSet set;
  for (const Line& line : table.lines()) {
    BusEntry entry;
    entry.name = table.cell(line, "name");
    entry.line = line.number;
    read_identifier(table, line, entry.head);
    read_length(table, line, entry.head);
    entry.period = table.number(line, "period_ns", 1);
    entry.deadline = table.number(line, "deadline_ns", 1, analysis::implicit_deadline);
    entry.jitter = table.number(line, "jitter_ns", 0, 0);
    entry.node = table.cell(line, "node");
    entry.offset = table.number(line, "offset_ns", 0, 0);
    if (entry.offset > 0 && entry.node.empty())
      table.mistake(line, "an offset_ns and no node",
                    "messages of one node have one clock, from which offsets count: say which");
    if (entry.name.empty()) entry.name = table.cell(line, "id");
    set.entries.push_back(std::move(entry));
  }
  if (table.mistakes.empty()) order_bus(set, file, table.mistakes);
  return set;
}

}  // namespace

void stop_at(const std::vector<Mistake>& mistakes, std::string_view file) {
  if (mistakes.empty()) return;
  constexpr std::size_t most_shown = 20;
  for (std::size_t i = 0; i < std::min(mistakes.size(), most_shown); ++i)
    remark(fmt::format("{}: {}\n    {}", mistakes[i].place, mistakes[i].what, mistakes[i].remedy));
  if (mistakes.size() > most_shown) remark(fmt::format("and {} more", mistakes.size() - most_shown));
  fail({fmt::format("{}: {}, nothing was analysed", file, counted(mistakes.size(), "error")), ""},
       exit_usage);
}

std::string read_text(const std::string& file) {
  std::error_code error;
  if (file != "-" && std::filesystem::is_directory(file, error))
    fail({fmt::format("{} is a folder", file), "give the name of a file, or - for standard input"});
  std::ifstream opened;
  if (file != "-") {
    opened.open(file, std::ios::binary);
    if (!opened.is_open())
      fail({fmt::format("cannot read {}: {}", file, std::strerror(errno)),
            "give the name of a file, or - for standard input"});
  }
  std::istream& in = file == "-" ? std::cin : opened;
  std::string text;
  char piece[65'536];
  while (text.size() <= most_text && (in.read(piece, sizeof piece) || in.gcount() > 0))
    text.append(piece, static_cast<std::size_t>(in.gcount()));
  if (text.size() > most_text)
    fail({fmt::format("{} is larger than {} MiB", file, most_text >> 20U), "a set has 4096 lines at most"});
  return text;
}

BusSet read_bus(const std::string& file, const std::vector<Rate>& rates) {
  std::string text = read_text(file);
  const auto first = text.find_first_not_of(" \t\r\n");
  const bool json = file.ends_with(".json") || (first != std::string::npos && text[first] == '{');
  if (json || spec::is_dbc(text, file)) return read_spec(text, file, rates);
  Table table{std::move(text), file, bus_columns, bus_header};
  BusSet set = bus_from(table, file);
  stop_at(table.mistakes, file);
  apply_rates(set, rates);
  return set;
}

TaskSet read_tasks(const std::string& file) {
  Table table{read_text(file), file, task_columns, task_header};
  TaskSet set;
  for (const Line& line : table.lines()) {
    TaskEntry entry;
    entry.name = table.cell(line, "name");
    if (entry.name.empty()) entry.name = fmt::format("line {}", line.number);
    entry.priority = table.number(line, "priority", std::numeric_limits<std::int64_t>::min());
    entry.task.cost = table.number(line, "C_ns", 1);
    entry.task.period = table.number(line, "T_ns", 1);
    entry.task.deadline = table.number(line, "D_ns", 1, analysis::implicit_deadline);
    entry.task.jitter = table.number(line, "J_ns", 0, 0);
    entry.task.blocking = table.number(line, "B_ns", 0, 0);
    set.entries.push_back(std::move(entry));
  }
  if (set.entries.size() > most_tasks)
    table.mistakes.push_back(
        {file, fmt::format("{} tasks", set.entries.size()), fmt::format("at most {}", most_tasks)});
  stop_at(table.mistakes, file);
  std::stable_sort(set.entries.begin(), set.entries.end(),
                   [](const TaskEntry& a, const TaskEntry& b) { return a.priority > b.priority; });
  for (std::size_t i = 1; i < set.entries.size(); ++i)
    set.entries[i].task.level =
        set.entries[i - 1].task.level + (set.entries[i].priority == set.entries[i - 1].priority ? 0U : 1U);
  return set;
}

bool is_task_set(const std::string& file) {
  const auto lines = split_csv(read_text(file));
  return !lines.empty() &&
         std::find(lines[0].cells.begin(), lines[0].cells.end(), "C_ns") != lines[0].cells.end();
}

std::vector<HopEntry> read_chain(const std::string& file) {
  Table table{read_text(file), file, chain_columns, chain_header};
  std::vector<HopEntry> hops;
  for (const Line& line : table.lines()) {
    HopEntry hop;
    hop.name = table.cell(line, "hop");
    hop.set = table.cell(line, "set");
    hop.line = line.number;
    const std::string_view activation = table.cell(line, "activation");
    hop.sampled = activation == "sampled";
    if (!hop.sampled && activation != "triggered")
      table.mistake(line, fmt::format("activation '{}'", activation),
                    "sampled: it looks with a period of its own; triggered: by the hop before");
    if (hops.empty() && activation == "triggered")
      table.mistake(line, "the first hop is triggered by nothing", "a sensor's task is sampled");
    if (hop.set.empty()) {
      hop.response = table.number(line, "response_ns", 1);
      hop.period =
          table.number(line, "period_ns", 1, hop.sampled ? std::nullopt : std::optional<std::int64_t>{0});
    } else {
      for (const char* column : {"response_ns", "period_ns"})
        if (!table.cell(line, column).empty())
          table.mistake(line, fmt::format("a {} beside a set", column), "leave it empty: the set gives it");
    }
    hop.best = table.number(line, "best_ns", 0, 0);
    hops.push_back(std::move(hop));
  }
  stop_at(table.mistakes, file);
  return hops;
}

}  // namespace ocm::cli::analyse
