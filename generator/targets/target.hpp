/// What can be generated from a spec: one file a target, one row in a table that ocm-generate and amiroctl
/// share.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/model.hpp"

namespace ocm::generate {

struct Options {
  std::string spec_name;                       ///< the spec's file name, named in the first line
  std::optional<protocol::Priority> priority;  ///< dbc: frames at this priority only
};

struct Target {
  std::string_view name;         ///< what it is called on a command line
  std::string_view description;  ///< one line
  /// The file's text. The same model and options give the same bytes. The model must come from a spec without
  /// problems.
  std::string (*make)(const spec::Model& model, const Options& options);
  bool of_topics = true;     ///< it has the model's topics
  bool of_messages = false;  ///< it has the model's plain messages
};

[[nodiscard]] std::span<const Target> targets() noexcept;

/// nullptr if there is no target of this name.
[[nodiscard]] const Target* find_target(std::string_view name) noexcept;

/// "cpp, dbc, c, ...", for messages.
[[nodiscard]] std::string target_names();

/// Whether a file of this target would have anything of the model in it.
[[nodiscard]] bool has_any(const Target& target, const spec::Model& model) noexcept;

/// What of the model the target's file cannot say, a line each.
[[nodiscard]] std::vector<std::string> left_out(const Target& target, const spec::Model& model);

/// "cpp, spec, dbc": the targets that have plain messages, for messages.
[[nodiscard]] std::string message_target_names();

[[nodiscard]] std::string make_spec(const spec::Model& model, const Options& options);
[[nodiscard]] std::string make_dbc(const spec::Model& model, const Options& options);
[[nodiscard]] std::string make_c(const spec::Model& model, const Options& options);
[[nodiscard]] std::string make_markdown(const spec::Model& model, const Options& options);
[[nodiscard]] std::string make_wireshark(const spec::Model& model, const Options& options);
[[nodiscard]] std::string make_json_schema(const spec::Model& model, const Options& options);

}  // namespace ocm::generate
