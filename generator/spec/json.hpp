/// JSON as the tool's files need it: numbers keep their digits (0.0175 stays 175 * 10^-4), members keep their
/// order, and every value knows where it stands in the text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/problem.hpp"

namespace ocm::spec {

struct Node {
  struct Member;
  enum class Kind { null, boolean, number, string, array, object };

  Kind kind = Kind::null;
  bool truth = false;
  std::string text;  ///< of a string; of a number as it was typed, or an equal spelling
  std::vector<Node> items;
  std::vector<Member> members;
  std::size_t line = 0;  ///< from 1

  [[nodiscard]] bool is(Kind k) const noexcept { return kind == k; }
  /// nullptr if missing; O(members).
  [[nodiscard]] const Node* find(std::string_view key) const noexcept;
};

struct Node::Member {
  std::string name;
  Node node;
};

/// In words, for messages: "a text", "an object".
[[nodiscard]] std::string_view describe(Node::Kind kind) noexcept;

/// What kind of document is read, for messages.
struct Document {
  std::string_view what = "a spec";
  std::string_view members = "robot, namespace, bus, boards and topics";  ///< of its outermost object
  std::string_view schema = "topics.schema.json";
  int levels = 7;               ///< how deep it is nested at most
  std::size_t max_text = 1000;  ///< bytes of a text
};

/// Reads `text`. Appends to `problems` where it is not JSON, nested deeper than `max_depth`, has a text
/// longer than the document's `max_text` or a member twice; then the node is not to be used. Throws
/// std::bad_alloc only.
[[nodiscard]] Node parse_json(std::string_view text, std::string_view file_name,
                              std::vector<Problem>& problems, const Document& document = {});

inline constexpr std::size_t max_depth = 32;

/// Two or four bytes a character, as some editors save text: by the byte order mark, or by NULs beside the
/// first character. Empty: it is neither.
[[nodiscard]] std::string_view wide_encoding(std::string_view text) noexcept;

/// What stands for `~` and `/` in a JSON pointer. [RFC 6901]
[[nodiscard]] std::string pointer_step(std::string_view key);

}  // namespace ocm::spec
