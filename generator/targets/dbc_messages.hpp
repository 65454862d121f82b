/// The plain messages of a spec in Vector's DBC format. What our own reader makes of it is the spec again:
/// names, numbers, comments, attributes; docs/messages.md says what DBC cannot hold.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/model.hpp"
#include "generator/targets/dbc_names.hpp"

namespace ocm::generate {

/// The parts of a file, in the order in which programs expect them.
struct DbcParts {
  std::string messages;
  std::string senders;
  std::string comments;
  std::string definitions;
  std::string defaults;
  std::string attributes;
  std::string values;
  std::string numbers;
  std::string selectors;
};

/// A text within quotes, exactly. One that ends with a backslash gets a blank behind it.
[[nodiscard]] std::string dbc_text(std::string_view text);

/// `nodes` are the short names of the model's boards; `names` those that messages have already; `defined` the
/// attributes that the file defines already, each behind its kind of object: "BO_ GenMsgCycleTime".
[[nodiscard]] DbcParts dbc_messages(const spec::Model& model, const std::vector<std::string>& nodes,
                                    DbcNames& names, std::set<std::string> defined);

/// What of the model's messages DBC has no place for, a line each.
[[nodiscard]] std::vector<std::string> lost_in_dbc(const spec::Model& model);

/// As the bytes of a file: Windows-1252, which most programs expect, where it has all characters; else UTF-8.
[[nodiscard]] std::string dbc_bytes(std::string_view utf8);

}  // namespace ocm::generate
