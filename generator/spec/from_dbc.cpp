#include "generator/spec/from_dbc.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iterator>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "ocm/base/text.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::spec {
namespace {

char lower(char c) noexcept {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// 0: none, or longer than can be counted.
base::Duration duration_of(const std::optional<base::Decimal>& milliseconds) {
  if (!milliseconds) return {};
  const auto ns = base::divide_rounded(*milliseconds, base::Decimal{1, -6});
  return base::Duration{ns && *ns > 0 ? *ns : 0};
}

std::vector<AttributeModel> attributes_of(std::vector<dbc::Attribute>& attributes) {
  std::vector<AttributeModel> out;
  for (dbc::Attribute& attribute : attributes)
    out.push_back({std::move(attribute.name), std::move(attribute.text)});
  return out;
}

class Converter {
 public:
  Converter(std::string_view file_name, std::vector<Problem>& doubts)
      : file_name_(file_name), doubts_(doubts) {}

  Model convert(dbc::Document document) {
    Model model;
    model.robot = std::filesystem::path{file_name_}.stem().string();
    model.description = std::move(document.comment);
    model.attributes = attributes_of(document.attributes);
    definitions(document, model);
    note_what_is_not_kept(document, model);
    model.bit_rate = bit_rate(model, "Baudrate", 1'000'000);
    model.data_bit_rate = bit_rate(model, "BaudrateCANFD", max_data_bit_rate);
    if (model.data_bit_rate < model.bit_rate) model.data_bit_rate = 0;
    boards(document, model);
    model.messages.reserve(document.messages.size());
    for (dbc::Message& message : document.messages) add(message, model);
    return model;
  }

 private:
  void doubt(std::size_t line, std::string what, std::string remedy) {
    doubts_.push_back({file_name_ + ':' + std::to_string(line), std::move(what), std::move(remedy)});
  }

  /// Those that become members have none: their values say all.
  static bool becomes_member(const dbc::AttributeDefinition& definition) noexcept {
    static constexpr std::pair<dbc::Of, std::string_view> members[] = {
        {dbc::Of::message, "GenMsgCycleTime"},         {dbc::Of::message, "GenMsgDelayTime"},
        {dbc::Of::message, "GenMsgSendType"},          {dbc::Of::message, "VFrameFormat"},
        {dbc::Of::message, "SystemMessageLongSymbol"}, {dbc::Of::signal, "GenSigStartValue"},
        {dbc::Of::signal, "SystemSignalLongSymbol"},   {dbc::Of::node, "SystemNodeLongSymbol"}};
    return std::any_of(std::begin(members), std::end(members), [&](const auto& member) {
      return member.first == definition.of && member.second == definition.name;
    });
  }
  static void definitions(dbc::Document& document, Model& model) {
    using Out = AttributeDefinitionModel;
    std::size_t of_variables = 0;
    for (dbc::AttributeDefinition& each : document.definitions) {
      if (each.of == dbc::Of::variable) ++of_variables;
      if (each.of == dbc::Of::variable || becomes_member(each)) continue;
      model.definitions.push_back({static_cast<Out::Of>(each.of), std::move(each.name),
                                   static_cast<Out::Type>(each.type), std::move(each.min),
                                   std::move(each.max), std::move(each.names), std::move(each.default_text)});
    }
    if (of_variables != 0) model.not_kept.push_back({"BA_DEF_ EV_", of_variables});
  }
  static void note_what_is_not_kept(const dbc::Document& document, Model& model) {
    const auto note = [&](std::string_view what, std::size_t count) {
      if (count == 0) return;
      for (NotKept& known : model.not_kept)
        if (known.what == what) {
          known.count += count;
          return;
        }
      model.not_kept.push_back({std::string{what}, count});
    };
    note("VERSION", document.version.empty() ? 0 : 1);
    note("VAL_TABLE_, the values of which are with their signals", document.tables.size());
    note("signals of VECTOR__INDEPENDENT_SIG_MSG", document.independent.size());
    for (const dbc::Unused& statement : document.unused) note(statement.keyword, 1);
  }

  /// The attribute that many files give it in, or its default, in bit/s; 0: none that a bus can have.
  static std::uint32_t bit_rate(const Model& model, std::string_view name, std::uint32_t most) {
    const auto of_text = [most](std::string_view text) {
      const auto rate = base::parse_unsigned(text);
      return rate && *rate >= 1'000 && *rate <= most ? static_cast<std::uint32_t>(*rate) : 0U;
    };
    for (const AttributeModel& attribute : model.attributes)
      if (attribute.name == name) return of_text(attribute.text);
    for (const AttributeDefinitionModel& definition : model.definitions)
      if (definition.of == AttributeDefinitionModel::Of::bus && definition.name == name &&
          definition.default_text)
        return of_text(*definition.default_text);
    return 0;
  }

  void boards(dbc::Document& document, Model& model) {
    for (dbc::Node& node : document.nodes) {
      BoardModel board;
      board.name = std::move(node.name);
      board.description = std::move(node.comment);
      board.attributes = attributes_of(node.attributes);
      add_board(std::move(board), model);
    }
    // Many files have no BU_, or name only some nodes there.
    const auto undeclared = [&](const std::string& name) {
      if (name.empty() || boards_.find(name) != boards_.end()) return;
      BoardModel board;
      board.name = name;
      add_board(std::move(board), model);
    };
    for (const dbc::Message& message : document.messages) {
      undeclared(message.sender);
      for (const std::string& sender : message.other_senders) undeclared(sender);
    }
    for (const dbc::Message& message : document.messages)
      for (const dbc::Signal& signal : message.signals)
        for (const std::string& receiver : signal.receivers) undeclared(receiver);
    if (left_out_ != 0)
      doubt(
          1, std::to_string(model.boards.size() + left_out_) + " nodes",
          "the first " + std::to_string(protocol::no_board) + " are kept: messages of others have no sender");
  }
  void add_board(BoardModel board, Model& model) {
    const bool is_full = model.boards.size() == protocol::no_board;
    const auto number = is_full ? protocol::no_board : static_cast<std::uint8_t>(model.boards.size());
    if (!boards_.try_emplace(board.name, number).second) return;
    if (is_full)
      ++left_out_;
    else
      model.boards.push_back(std::move(board));
  }

  void add(dbc::Message& message, Model& model) {
    using Format = dbc::Message::Format;
    const bool j1939 = message.format == Format::j1939;
    const unsigned most = MessageModel::most_bytes(j1939);
    if (message.length > most) {
      model.too_long.push_back(message.name);
      return doubt(message.line, message.name + " has " + std::to_string(message.length) + " bytes",
                   "it is left out: a frame has at most " + std::to_string(most));
    }
    MessageModel out;
    out.name = std::move(message.name);
    out.description = std::move(message.comment);
    out.address = {j1939 ? protocol::Address::By::pgn : protocol::Address::By::identifier,
                   message.format != Format::base, message.id};
    out.length = message.length;
    out.fd = message.fd;
    if (const auto board = boards_.find(message.sender); board != boards_.end()) out.board = board->second;
    out.other_senders = std::move(message.other_senders);
    out.period = duration_of(message.cycle_ms);
    out.shortest_period = duration_of(message.delay_ms);
    out.send_type = std::move(message.send_type);
    out.attributes = attributes_of(message.attributes);
    out.source.general =
        std::filesystem::path{file_name_}.filename().string() + ':' + std::to_string(message.line);
    auto signals = std::move(message.signals);  // freed with this message, for the next one's fields
    const auto names = names_of(signals);
    out.fields.reserve(signals.size());
    for (dbc::Signal& signal : signals) out.fields.push_back(field(signal, signals, names));
    for (std::size_t i = 0; i < out.fields.size(); ++i)
      out.fields[i].name = names.empty() ? std::move(signals[i].name) : names[i];
    model.messages.push_back(std::move(out));
  }

  static bool are_unique(const std::vector<dbc::Signal>& signals) {
    std::vector<std::string_view> names;
    names.reserve(signals.size());
    for (const dbc::Signal& signal : signals) names.emplace_back(signal.name);
    std::sort(names.begin(), names.end());
    return std::adjacent_find(names.begin(), names.end()) == names.end();
  }
  /// Two signals of one name are distinguished by a number: a selector is found by its name. Empty where
  /// there are no such two: they have their own names.
  static std::vector<std::string> names_of(const std::vector<dbc::Signal>& signals) {
    if (are_unique(signals)) return {};
    std::unordered_set<std::string> taken;
    for (const dbc::Signal& signal : signals) taken.insert(signal.name);
    std::unordered_map<std::string, unsigned> times;
    std::vector<std::string> names;
    for (const dbc::Signal& signal : signals) {
      unsigned& number = times[signal.name];
      std::string name = signal.name;
      if (++number != 1)
        while (!taken.insert(name = signal.name + '_' + std::to_string(number)).second) ++number;
      names.push_back(std::move(name));
    }
    return names;
  }

  /// All but its name, which selectors are still looked up by.
  FieldModel field(dbc::Signal& signal, const std::vector<dbc::Signal>& all,
                   const std::vector<std::string>& names) {
    FieldModel out;
    out.description = std::move(signal.comment);
    out.position = signal.position;
    out.number = static_cast<protocol::Number>(signal.number);
    out.is_signed = signal.is_signed && out.number == protocol::Number::integer;
    out.scale = signal.scale;
    out.offset = signal.offset;
    out.unit = std::move(signal.unit);
    out.raw_min = protocol::lowest(signal.position.width, out.is_signed);
    out.raw_max = protocol::highest(signal.position.width, out.is_signed);
    if (signal.has_range) out.range = RangeModel{signal.min, signal.max};
    out.values.reserve(signal.values.size());
    for (dbc::NamedValue& value : signal.values) out.values.push_back({std::move(value.name), value.raw});
    if (signal.selector) {
      out.selector = names.empty() ? all[*signal.selector].name : names[*signal.selector];
      for (const auto& [first, last] : signal.selected) out.selected.push_back({first, last});
    }
    if (!signal.start_value.empty()) start(signal, out);
    out.receivers = std::move(signal.receivers);
    out.attributes = attributes_of(signal.attributes);
    return out;
  }

  void start(const dbc::Signal& signal, FieldModel& out) {
    out.start = out.start_from(signal.start_value);
    const std::string what = "the start value " + signal.start_value.substr(0, 40) + " of " + signal.name;
    const bool real = out.number != protocol::Number::integer;
    if (!out.start)
      return doubt(signal.line,
                   what + (real ? " is no number that a float holds"
                                : " is no raw number of " + std::to_string(signal.position.width) + " bits"),
                   "left out; the signal starts at 0");
    const auto exact = base::parse_decimal(signal.start_value);
    if (!real && exact && exact->exponent < 0)
      doubt(signal.line, what + " is no whole number", "read as " + out.raw_text(*out.start));
  }

  std::string file_name_;
  std::vector<Problem>& doubts_;
  std::unordered_map<std::string, std::uint8_t> boards_;  ///< no_board: one too many
  std::size_t left_out_ = 0;                              ///< boards
};

}  // namespace

bool is_dbc(std::string_view text, std::string_view file_name) noexcept {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  if (text.starts_with('{')) return false;  // JSON, whatever it is called
  constexpr std::string_view ending = ".dbc";
  const auto tail = file_name.substr(file_name.size() - std::min(file_name.size(), ending.size()));
  if (std::equal(tail.begin(), tail.end(), ending.begin(), ending.end(),
                 [](char a, char b) { return lower(a) == b; }))
    return true;
  constexpr std::array<std::string_view, 7> words{"VERSION", "NS_", "BS_", "BU_", "BO_", "CM_", "VAL_TABLE_"};
  return std::any_of(words.begin(), words.end(), [&](std::string_view word) {
    constexpr std::string_view ends = " \t\r\n:\"";
    return text.starts_with(word) && text.size() > word.size() &&
           ends.find(text[word.size()]) != std::string_view::npos;
  });
}

Model model_of(dbc::Document document, std::string_view file_name, std::vector<Problem>& doubts) {
  return Converter{file_name, doubts}.convert(std::move(document));
}

}  // namespace ocm::spec
