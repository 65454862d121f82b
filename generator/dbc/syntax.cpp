#include "generator/dbc/syntax.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "ocm/base/decimal.hpp"
#include "ocm/base/text.hpp"

namespace ocm::dbc {
namespace {

constexpr std::string_view no_node = "Vector__XXX";
constexpr std::string_view independent = "VECTOR__INDEPENDENT_SIG_MSG";
constexpr std::uint32_t extended_flag = 0x8000'0000;
constexpr std::uint32_t extended_mask = 0x1FFF'FFFF;

/// As a message can show it: strings of a file may be long.
std::string shown(std::string_view text) {
  return "'" + std::string{text.substr(0, 40)} + (text.size() > 40 ? "...'" : "'");
}

class Parser {
 public:
  Parser(std::string_view text, std::vector<Finding>& problems, std::vector<Finding>& doubts)
      : lexer_(text), problems_(problems), doubts_(doubts) {}

  Statements parse() {
    bool any = false;
    while (lexer_.peek().kind != Token::Kind::end) {
      const Token first = lexer_.take();
      const Rule* rule = first.is_word() ? find(first.text) : nullptr;
      if (rule == nullptr) {
        unknown(first);
        continue;
      }
      any = true;
      line_ = first.line;
      keyword_ = rule->keyword;
      wrong_.clear();
      if ((this->*rule->read)()) continue;
      const bool over =
          lexer_.peek().kind == Token::Kind::end || lexer_.peek().kind == Token::Kind::open_string;
      Finding finding{wrong_line_, std::string{rule->keyword} + ": " + wrong_, std::string{rule->form}};
      // Without a message or its signals frames would mean something else; without a comment they do not.
      if (rule->essential || over)
        problems_.push_back(std::move(finding));
      else
        doubts_.push_back(std::move(finding));
      skip();
    }
    if (!any && problems_.empty())
      problems_.push_back({1, "there is no statement of DBC in it",
                           "a DBC file, with messages such as BO_ 256 Engine: 8 Motor"});
    return std::move(statements_);
  }

 private:
  struct Rule {
    std::string_view keyword;
    bool (Parser::*read)();
    bool essential;
    std::string_view form;
  };
  static const std::array<Rule, 28> rules;

  [[nodiscard]] static const Rule* find(std::string_view keyword) noexcept {
    for (const Rule& rule : rules)
      if (rule.keyword == keyword) return &rule;
    return nullptr;
  }

  // --- what is wrong ---

  bool wrong(const Token& token, std::string_view wanted) {
    wrong_line_ = token.line;
    switch (token.kind) {
      case Token::Kind::end:
        wrong_ = "the file ends here";
        break;
      case Token::Kind::open_string:
        wrong_ = "a string is not closed";
        break;
      case Token::Kind::string:
        wrong_ = "the string \"" + std::string{token.text.substr(0, 40)} + "\"";
        break;
      default:
        wrong_ = shown(token.text);
    }
    wrong_.append(", where ").append(wanted).append(" is expected");
    return false;
  }
  void doubt(std::size_t line, std::string what, std::string remedy) {
    doubts_.push_back({line, std::move(what), std::move(remedy)});
  }
  void unknown(const Token& token) {
    if (token.kind == Token::Kind::open_string) {
      problems_.push_back({token.line, "a string is not closed", "a \" at its end"});
    } else if (!token.is(';')) {
      doubt(token.line,
            (token.is_word() ? "unknown statement " : "no statement begins with ") + shown(token.text),
            "left out");
      skip();
    }
  }
  /// To the end of the statement: behind its semicolon, or before a line that begins another one.
  void skip() {
    for (;;) {
      const Token& next = lexer_.peek();
      if (next.kind == Token::Kind::end) return;
      if (next.first_of_line && next.is_word() && find(next.text) != nullptr) return;
      if (lexer_.take().is(';')) return;
    }
  }

  // --- tokens ---

  bool character(char wanted) {
    if (!lexer_.peek().is(wanted)) return wrong(lexer_.peek(), "'" + std::string(1, wanted) + "'");
    lexer_.take();
    return true;
  }
  bool name(std::string_view& to, std::string_view wanted) {
    if (!lexer_.peek().is_word()) return wrong(lexer_.peek(), wanted);
    to = lexer_.take().text;
    return true;
  }
  bool name(std::string& to, std::string_view wanted) {
    std::string_view text;
    if (!name(text, wanted)) return false;
    to = text;
    return true;
  }
  bool string(std::string& to, std::string_view wanted) {
    if (!lexer_.peek().is_string()) return wrong(lexer_.peek(), wanted);
    to = unescaped(lexer_.take().text);
    return true;
  }
  bool unsigned_number(std::uint64_t& to, std::uint64_t max, std::string_view wanted) {
    const Token& token = lexer_.peek();
    const auto number = token.is_word() ? base::parse_unsigned(token.text)
                                        : base::Result<std::uint64_t>{base::Error::bad_syntax};
    if (!number || *number > max) return wrong(token, wanted);
    to = *number;
    lexer_.take();
    return true;
  }
  bool id(std::uint32_t& to) {
    std::uint64_t number = 0;
    if (!unsigned_number(number, UINT32_MAX, "a message's identifier")) return false;
    to = static_cast<std::uint32_t>(number);
    return true;
  }
  /// Where a number has more digits than can be kept, the nearest with 18.
  bool decimal(base::Decimal& to, std::string_view wanted) {
    const Token& token = lexer_.peek();
    if (!token.is_word()) return wrong(token, wanted);
    const auto number = parse_number(token.text);
    if (!number) return wrong(token, wanted);
    to = *number;
    lexer_.take();
    return true;
  }
  [[nodiscard]] static base::Result<base::Decimal> parse_number(std::string_view text) {
    const auto number = base::parse_decimal(text);
    if (number || number.error != base::Error::out_of_range) return number;
    // Too many digits, or too large or small an exponent: the digits that can be kept, the others as zeros.
    std::string kept;
    int digits = 0;
    bool significant = false;
    for (const char c : text.substr(0, text.find_first_of("eE"))) {
      significant = significant || (c >= '1' && c <= '9');
      const bool drop = base::is_digit(c) && significant && ++digits > 18;
      kept += drop ? '0' : c;
    }
    if (const auto exponent = text.find_first_of("eE"); exponent != std::string_view::npos)
      kept += text.substr(exponent);
    return base::parse_decimal(kept);
  }
  /// The end of a statement. Some files forget the semicolon.
  bool end_of_statement() {
    const Token& next = lexer_.peek();
    if (next.is(';')) {
      lexer_.take();
      return true;
    }
    if (next.kind != Token::Kind::end && !next.first_of_line) return wrong(next, "';'");
    doubt(line_, "the statement has no semicolon at its end", "read as if it had one");
    return true;
  }
  /// Words up to the end of the line, with or without commas.
  void names_of_line(std::vector<std::string>& to) {
    for (;;) {
      const Token& next = lexer_.peek();
      if (next.first_of_line || (!next.is_word() && !next.is(','))) break;
      const Token token = lexer_.take();
      if (token.is_word() && token.text != no_node) to.emplace_back(token.text);
    }
    if (lexer_.peek().is(';') && !lexer_.peek().first_of_line) lexer_.take();
  }

  // --- what a statement is about ---

  [[nodiscard]] static std::optional<Of> kind_of(std::string_view word) noexcept {
    if (word == "BU_") return Of::node;
    if (word == "BO_") return Of::message;
    if (word == "SG_") return Of::signal;
    if (word == "EV_") return Of::variable;
    return std::nullopt;
  }
  /// `BO_ 256`, `SG_ 256 Speed`, `BU_ Motor`, or nothing at all, which is the network.
  bool subject(Subject& to) {
    to.line = line_;
    const Token& next = lexer_.peek();
    const auto of = next.is_word() ? kind_of(next.text) : std::nullopt;
    if (!of) return true;
    to.of = *of;
    lexer_.take();
    if (to.of == Of::message || to.of == Of::signal)
      if (!id(to.id)) return false;
    if (to.of == Of::message) return true;
    return name(to.name, to.of == Of::signal ? "a signal's name" : "a name");
  }
  bool signal_subject(Subject& to) {
    to.line = line_;
    to.of = Of::signal;
    return id(to.id) && name(to.name, "a signal's name");
  }

  // --- statements ---

  bool version() { return string(statements_.document.version, "a string"); }

  /// The words that this file may use: a line each, or all behind the colon.
  bool new_symbols() {
    if (!character(':')) return false;
    while (lexer_.peek().is_word()) {
      const Token& next = lexer_.peek();
      // A statement begins a line, and has something behind its keyword.
      if (next.first_of_line && !stands_alone_in_its_line()) return true;
      lexer_.take();
    }
    return true;
  }
  [[nodiscard]] bool stands_alone_in_its_line() const {
    Lexer ahead = lexer_;
    ahead.take();
    return ahead.peek().first_of_line || ahead.peek().kind == Token::Kind::end;
  }

  bool bit_timing() {
    if (!character(':')) return false;
    while (lexer_.peek().kind != Token::Kind::end && !lexer_.peek().first_of_line) lexer_.take();
    return true;
  }

  bool nodes() {
    if (!character(':')) return false;
    while (lexer_.peek().is_word()) {
      // Long lists are broken over lines.
      if (lexer_.peek().first_of_line && find(lexer_.peek().text) != nullptr) break;
      statements_.document.nodes.push_back({std::string{lexer_.take().text}, {}, {}});
      if (lexer_.peek().is(',')) lexer_.take();
    }
    return true;  // a semicolon is passed over where statements begin
  }

  bool message() {
    MessageStatement statement;
    Message& message = statement.message;
    message.line = line_;
    std::uint64_t length = 0;
    if (!id(statement.written_id) || !name(message.name, "the message's name") || !character(':') ||
        !unsigned_number(length, 1785, "a length of 0 to 1785 bytes"))
      return false;
    message.length = static_cast<std::uint16_t>(length);
    std::vector<std::string> senders;
    names_of_line(senders);
    if (!senders.empty()) message.sender = std::move(senders.front());
    const std::uint32_t number = statement.written_id;
    message.id = number & extended_mask;
    message.format = (number & extended_flag) != 0 ? Message::Format::extended : Message::Format::base;
    if (message.name != independent) {
      if ((number & 0x6000'0000) != 0)
        doubt(line_,
              "the identifier " + std::to_string(number) + " of " + message.name + " has more than 29 bits",
              "read as " + std::to_string(message.id));
      if (message.format == Message::Format::base && message.id > 0x7FF) {
        message.format = Message::Format::extended;
        doubt(line_,
              "the identifier " + std::to_string(number) + " of " + message.name +
                  " has more than 11 bits, and no flag that says so",
              "read as 29 bits, which are written " + std::to_string(message.id | extended_flag));
      }
    }
    statement.signals.reserve(4);
    statements_.messages.push_back(std::move(statement));
    return true;
  }

  bool signal() {
    SignalStatement statement;
    Signal& signal = statement.signal;
    signal.line = line_;
    if (statements_.messages.empty()) {
      wrong_ = "a signal before the first message";
      wrong_line_ = line_;
      return false;
    }
    if (!name(signal.name, "the signal's name")) return false;
    if (lexer_.peek().is_word() && !multiplexing(statement)) return false;
    if (!character(':') || !place(signal) || !conversion(signal)) return false;
    if (lexer_.peek().is_string()) signal.unit = unescaped(lexer_.take().text);
    names_of_line(signal.receivers);
    if (signal.position.width == 0) {
      doubt(line_, signal.name + " has no bits", "left out");
      return true;
    }
    statements_.messages.back().signals.push_back(std::move(statement));
    return true;
  }
  /// `M`, `m3` or `m3M`.
  bool multiplexing(SignalStatement& statement) {
    const Token token = lexer_.peek();
    std::string_view text = token.text;
    if (text.back() == 'M') {
      statement.signal.is_selector = true;
      text.remove_suffix(1);
    }
    if (!text.empty()) {
      const auto page = text.front() == 'm' ? base::parse_unsigned(text.substr(1))
                                            : base::Result<std::uint64_t>{base::Error::bad_syntax};
      if (!page) return wrong(token, "':', M or m with a number");
      statement.page = *page;
    }
    lexer_.take();
    return true;
  }
  /// `7|16@0+`
  bool place(Signal& signal) {
    std::uint64_t start = 0;
    std::uint64_t width = 0;
    static constexpr std::string_view bits = "a number of bits, at most 64";
    if (!unsigned_number(start, 8 * 1785 - 1, "the first bit, 0 to 14279") || !character('|') ||
        !unsigned_number(width, 64, bits))
      return false;
    signal.position.start = static_cast<std::uint16_t>(start);
    signal.position.width = static_cast<std::uint8_t>(width);
    if (!character('@')) return false;
    const Token token = lexer_.peek();
    static constexpr std::string_view form = "the byte order, 0 or 1, and the sign, + or -";
    std::string text{token.is_word() ? token.text : std::string_view{}};
    if (text.size() != 1 && text.size() != 2) return wrong(token, form);
    lexer_.take();
    if (text.size() == 1 && lexer_.peek().is_word() && lexer_.peek().text.size() == 1)
      text += lexer_.take().text;  // "@1 +"
    if (text.size() != 2 || (text[0] != '0' && text[0] != '1') || (text[1] != '+' && text[1] != '-'))
      return wrong(token, form);
    signal.position.order = text[0] == '0' ? protocol::ByteOrder::big : protocol::ByteOrder::little;
    signal.is_signed = text[1] == '-';
    return true;
  }
  /// `(0.5,10) [-40|215]`
  bool conversion(Signal& signal) {
    if (!character('(') || !decimal(signal.scale, "the scale") || !character(',') ||
        !decimal(signal.offset, "the offset") || !character(')'))
      return false;
    if (!lexer_.peek().is('[')) return true;
    if (!character('[') || !decimal(signal.min, "the least value") || !character('|') ||
        !decimal(signal.max, "the greatest value") || !character(']'))
      return false;
    const int order = base::compare(signal.min, signal.max);
    signal.has_range = order < 0 || (order == 0 && signal.min.digits != 0);
    if (order > 0) doubt(line_, "the range of " + signal.name + " is upside down", "read as if it had none");
    return true;
  }

  bool comment() {
    CommentStatement statement;
    if (!subject(statement.subject) || !string(statement.text, "a string") || !end_of_statement())
      return false;
    std::erase(statement.text, '\r');
    static constexpr std::string_view import = "IMPORT ";
    if (statement.subject.of != Of::network || statement.text.rfind(import, 0) != 0) {
      statements_.comments.push_back(std::move(statement));
      return true;
    }
    std::string& file = statements_.document.imports.emplace_back(statement.text.substr(import.size()));
    doubts_.push_back(
        {line_, "IMPORT: " + file + " goes in front of this file", "read without it: give that file, too"});
    return true;
  }

  /// Pairs of a number and a name, which may go on over several lines.
  bool named_values(std::vector<NamedValue>& to) {
    while (lexer_.peek().is_word()) {
      const Token token = lexer_.peek();
      if (token.first_of_line && find(token.text) != nullptr) break;  // the semicolon is missing
      std::string_view digits = token.text;
      const bool negative = digits.front() == '-';
      if (negative || digits.front() == '+') digits.remove_prefix(1);
      const auto number = base::parse_unsigned(digits);
      if (!number) return wrong(token, "a whole number");
      lexer_.take();
      NamedValue value{static_cast<std::int64_t>(negative ? 0 - *number : *number), {}};
      if (!string(value.name, "the value's name in quotes")) return false;
      to.push_back(std::move(value));
    }
    return true;
  }

  bool values() {
    ValuesStatement statement;
    statement.subject.line = line_;
    const Token first = lexer_.peek();
    if (first.is_word() && base::parse_unsigned(first.text)) {
      if (!signal_subject(statement.subject)) return false;
      const Token& next = lexer_.peek();
      if (next.is_word() && !base::is_digit(next.text.front()) && next.text.front() != '-' &&
          next.text.front() != '+' && !next.first_of_line)
        statement.table = lexer_.take().text;
    } else {  // of an environment variable
      statement.subject.of = Of::variable;
      if (!name(statement.subject.name, "a message's identifier")) return false;
    }
    if (!named_values(statement.values) || !end_of_statement()) return false;
    statements_.values.push_back(std::move(statement));
    return true;
  }

  bool value_table() {
    ValueTable table;
    if (!name(table.name, "the table's name") || !named_values(table.values) || !end_of_statement())
      return false;
    statements_.document.tables.push_back(std::move(table));
    return true;
  }

  bool attribute_definition() {
    using Type = AttributeDefinition::Type;
    AttributeDefinition definition;
    if (lexer_.peek().is_word()) {
      const auto of = kind_of(lexer_.peek().text);
      if (!of) return wrong(lexer_.peek(), "BU_, BO_, SG_, EV_ or the attribute's name in quotes");
      definition.of = *of;
      lexer_.take();
    }
    std::string_view type;
    if (!string(definition.name, "the attribute's name in quotes")) return false;
    const Token type_token = lexer_.peek();
    if (!name(type, "INT, HEX, FLOAT, STRING or ENUM")) return false;
    if (type == "INT" || type == "HEX" || type == "FLOAT") {
      definition.type = type == "INT" ? Type::integer : type == "HEX" ? Type::hexadecimal : Type::floating;
      if (lexer_.peek().is_word() && !lexer_.peek().first_of_line) {
        definition.min = lexer_.take().text;
        if (!name(definition.max, "the greatest value")) return false;
      }
    } else if (type == "ENUM") {
      definition.type = Type::enumeration;
      while (lexer_.peek().is_string() || lexer_.peek().is(',')) {
        const Token token = lexer_.take();
        if (token.is_string()) definition.names.push_back(unescaped(token.text));
      }
    } else if (type != "STRING") {
      return wrong(type_token, "INT, HEX, FLOAT, STRING or ENUM");
    }
    if (!end_of_statement()) return false;
    statements_.document.definitions.push_back(std::move(definition));
    return true;
  }

  bool attribute_text(std::string& to) {
    if (lexer_.peek().is_string()) return string(to, "");
    return name(to, "a value");
  }
  bool attribute_default() {
    DefaultStatement statement;
    statement.line = line_;
    if (!string(statement.name, "the attribute's name in quotes") || !attribute_text(statement.text) ||
        !end_of_statement())
      return false;
    statements_.defaults.push_back(std::move(statement));
    return true;
  }
  bool attribute() {
    AttributeStatement statement;
    if (!string(statement.name, "the attribute's name in quotes") || !subject(statement.subject) ||
        !attribute_text(statement.text) || !end_of_statement())
      return false;
    statements_.attributes.push_back(std::move(statement));
    return true;
  }

  bool value_type() {
    NumberStatement statement;
    if (!signal_subject(statement.subject)) return false;
    if (lexer_.peek().is(':')) lexer_.take();
    if (!unsigned_number(statement.type, 3, "0, 1 for float32 or 2 for float64") || !end_of_statement())
      return false;
    statements_.numbers.push_back(statement);
    return true;
  }

  /// `SG_MUL_VAL_ 256 Page2 Selector 2-5, 7-7;`
  bool selector_values() {
    SelectorStatement statement;
    if (!signal_subject(statement.subject) || !name(statement.selector, "the selector's name")) return false;
    for (;;) {
      const Token token = lexer_.peek();
      static constexpr std::string_view form = "values of the selector, such as 2-5";
      if (!token.is_word() || token.first_of_line) return wrong(token, form);
      const std::size_t dash = token.text.find('-');
      const auto first = base::parse_unsigned(token.text.substr(0, dash));
      const auto last =
          dash == std::string_view::npos ? first : base::parse_unsigned(token.text.substr(dash + 1));
      if (!first || !last || *first > *last) return wrong(token, form);
      statement.ranges.push_back({*first, *last});
      lexer_.take();
      if (!lexer_.peek().is(',')) break;
      lexer_.take();
    }
    if (!end_of_statement()) return false;
    statements_.selectors.push_back(std::move(statement));
    return true;
  }

  bool senders() {
    SendersStatement statement;
    statement.subject = {Of::message, {}, 0, line_};
    if (!id(statement.subject.id) || !character(':')) return false;
    while (lexer_.peek().is_word() || lexer_.peek().is(',')) {
      if (lexer_.peek().first_of_line && lexer_.peek().is_word() && find(lexer_.peek().text) != nullptr)
        break;
      const Token token = lexer_.take();
      if (token.is_word() && token.text != no_node) statement.names.emplace_back(token.text);
    }
    if (!end_of_statement()) return false;
    statements_.senders.push_back(std::move(statement));
    return true;
  }

  /// What means nothing for frames, up to its semicolon.
  bool unused() {
    for (;;) {
      const Token& next = lexer_.peek();
      if (next.kind == Token::Kind::end || next.kind == Token::Kind::open_string) return wrong(next, "';'");
      if (next.first_of_line && next.is_word() && find(next.text) != nullptr) break;
      if (lexer_.take().is(';')) break;
    }
    statements_.document.unused.push_back({std::string{keyword_}, line_});
    return true;
  }

  Lexer lexer_;
  std::vector<Finding>& problems_;
  std::vector<Finding>& doubts_;
  Statements statements_;
  std::size_t line_ = 1;  ///< where the statement begins
  std::string_view keyword_;
  std::string wrong_;
  std::size_t wrong_line_ = 1;
};

constexpr std::string_view unused_form = "a statement that ends with ';'";
const std::array<Parser::Rule, 28> Parser::rules{{
    {"SG_", &Parser::signal, true,
     "SG_ NAME : START|WIDTH@ORDER+ (SCALE,OFFSET) [MIN|MAX] \"UNIT\" RECEIVER"},
    {"BO_", &Parser::message, true, "BO_ IDENTIFIER NAME: LENGTH SENDER"},
    {"VAL_", &Parser::values, false, "VAL_ IDENTIFIER SIGNAL VALUE \"NAME\" ...;"},
    {"CM_", &Parser::comment, false, "CM_ [BO_ IDENTIFIER | SG_ IDENTIFIER SIGNAL | BU_ NODE] \"TEXT\";"},
    {"BA_", &Parser::attribute, false,
     "BA_ \"NAME\" [BO_ IDENTIFIER | SG_ IDENTIFIER SIGNAL | BU_ NODE] VALUE;"},
    {"BA_DEF_", &Parser::attribute_definition, false, "BA_DEF_ [BO_ | SG_ | BU_] \"NAME\" TYPE ...;"},
    {"BA_DEF_DEF_", &Parser::attribute_default, false, "BA_DEF_DEF_ \"NAME\" VALUE;"},
    {"BU_", &Parser::nodes, true, "BU_: NODE ..."},
    {"VERSION", &Parser::version, false, "VERSION \"TEXT\""},
    {"NS_", &Parser::new_symbols, false, "NS_ : WORD ..."},
    {"BS_", &Parser::bit_timing, false, "BS_:"},
    {"VAL_TABLE_", &Parser::value_table, false, "VAL_TABLE_ NAME VALUE \"NAME\" ...;"},
    {"SIG_VALTYPE_", &Parser::value_type, true, "SIG_VALTYPE_ IDENTIFIER SIGNAL : TYPE;"},
    {"SG_MUL_VAL_", &Parser::selector_values, true,
     "SG_MUL_VAL_ IDENTIFIER SIGNAL SELECTOR FIRST-LAST, ...;"},
    {"BO_TX_BU_", &Parser::senders, false, "BO_TX_BU_ IDENTIFIER : NODE, ...;"},
    {"EV_", &Parser::unused, false, unused_form},
    {"EV_DATA_", &Parser::unused, false, unused_form},
    {"ENVVAR_DATA_", &Parser::unused, false, unused_form},
    {"SIG_GROUP_", &Parser::unused, false, unused_form},
    {"SGTYPE_", &Parser::unused, false, unused_form},
    {"SIG_TYPE_REF_", &Parser::unused, false, unused_form},
    {"SIGTYPE_VALTYPE_", &Parser::unused, false, unused_form},
    {"BA_DEF_REL_", &Parser::unused, false, unused_form},
    {"BA_DEF_DEF_REL_", &Parser::unused, false, unused_form},
    {"BA_REL_", &Parser::unused, false, unused_form},
    {"BA_DEF_SGTYPE_", &Parser::unused, false, unused_form},
    {"BA_SGTYPE_", &Parser::unused, false, unused_form},
    {"CAT_DEF_", &Parser::unused, false, unused_form},
}};

}  // namespace

Statements parse(std::string_view text, std::vector<Finding>& problems, std::vector<Finding>& doubts) {
  return Parser{text, problems, doubts}.parse();
}

}  // namespace ocm::dbc
