/// The statements of a DBC file, one after another, as they are written: references between them are not yet
/// looked up, since a comment may stand before the message that it is of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/dbc/document.hpp"
#include "generator/dbc/lexer.hpp"
#include "generator/dbc/reader.hpp"

namespace ocm::dbc {

/// What a statement is about, as it names it.
struct Subject {
  Of of = Of::network;
  std::string_view name;  ///< of a node, a signal or a variable
  std::uint32_t id = 0;   ///< of a message, flags included
  std::size_t line = 0;
};

struct CommentStatement {
  Subject subject;
  std::string text;
};
struct ValuesStatement {
  Subject subject;
  std::string_view table;  ///< the name of a VAL_TABLE_ in place of values
  std::vector<NamedValue> values;
};
struct AttributeStatement {
  Subject subject;
  std::string name;
  std::string text;
};
struct DefaultStatement {
  std::string name;
  std::string text;
  std::size_t line = 0;
};
struct NumberStatement {  ///< SIG_VALTYPE_
  Subject subject;
  std::uint64_t type = 0;
};
struct SelectorStatement {  ///< SG_MUL_VAL_
  Subject subject;
  std::string_view selector;
  std::vector<SelectorRange> ranges;
};
struct SendersStatement {  ///< BO_TX_BU_
  Subject subject;
  std::vector<std::string> names;
};
struct SignalStatement {
  Signal signal;
  std::optional<std::uint64_t> page;  ///< m3
  std::string_view selector;          ///< by SG_MUL_VAL_; looked up later
};
struct MessageStatement {
  Message message;
  std::uint32_t written_id = 0;  ///< flags included
  std::vector<SignalStatement> signals;
};

struct Statements {
  Document document;  ///< what needs no looking up
  std::vector<MessageStatement> messages;
  std::vector<CommentStatement> comments;
  std::vector<ValuesStatement> values;
  std::vector<AttributeStatement> attributes;
  std::vector<DefaultStatement> defaults;
  std::vector<NumberStatement> numbers;
  std::vector<SelectorStatement> selectors;
  std::vector<SendersStatement> senders;
};

/// Reads all statements of `text`, which must outlive them. Appends to `problems` and `doubts`.
[[nodiscard]] Statements parse(std::string_view text, std::vector<Finding>& problems,
                               std::vector<Finding>& doubts);

}  // namespace ocm::dbc
