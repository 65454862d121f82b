/// Reads an operator file, a JSON file that operator.schema.json describes, into the tables that
/// ocm/reflective works with. Every problem comes with its place, what is wrong and what would be right.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/analysis/message_set.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/operator.hpp"
#include "ocm/reflective/supervisor.hpp"

#include "generator/spec/problem.hpp"

namespace ocm::cli::operate {

/// How large an operator of a file may be.
inline constexpr reflective::Room room{};

/// Owns all that its tables point to, but for the catalogue; stays where it is.
struct OperatorFile {
  OperatorFile() = default;
  OperatorFile(const OperatorFile&) = delete;
  OperatorFile& operator=(const OperatorFile&) = delete;

  reflective::Operator tables;
  std::string name;
  std::string description;

  /// A name or a condition's text, and where it is in the file: "file:line: /json/path".
  struct Item {
    std::string text;
    std::string place;
  };
  struct Parts {
    Item of;
    std::vector<reflective::Stream> streams;
    std::vector<reflective::Limit> limits;
    std::deque<std::vector<std::int64_t>> raw;  ///< of the set points
    std::vector<reflective::SetPoint> entry;
    std::vector<reflective::Adaptation> adaptations;
    std::optional<std::vector<std::string>> commanders;  ///< verbs; nothing: all
    std::vector<reflective::Stream> expected;            ///< what else counts there: see count_others
    std::vector<analysis::Message> others;               ///< its frames
    std::vector<std::uint16_t> uncounted;  ///< actuators that may be commanded, of which no period is known
    std::vector<std::string> stream_places;
    std::vector<std::string> limit_places;
    std::vector<std::string> entry_places;
    std::vector<std::string> adaptation_places;
  };
  std::deque<Parts> parts;  ///< of the configurations
  std::deque<Item> condition_items;
  std::deque<Item> monitor_items;
  std::deque<Item> transition_items;  ///< text: the cause
  std::deque<std::vector<reflective::Term>> terms;
  std::string settle_place;

  std::vector<reflective::Configuration> configurations;
  std::vector<reflective::Condition> conditions;
  std::vector<reflective::Monitor> monitors;
  std::vector<reflective::Transition> transitions;
  std::vector<analysis::Message> others;
  std::vector<reflective::Stream> stated_others;  ///< of "others"
};

/// `file` is null exactly when there are problems: all that were found, in the order of the file.
struct Loaded {
  std::unique_ptr<OperatorFile> file;
  std::vector<spec::Problem> problems;
};

/// Any bytes are a problem at worst: throws std::bad_alloc only. `file_name` is for the places; `bit_rate` is
/// the bus's, for what others send. The catalogue must outlive what is loaded.
[[nodiscard]] Loaded parse(std::string_view text, std::string_view file_name,
                           const protocol::Catalogue& catalogue, std::uint32_t bit_rate);
[[nodiscard]] Loaded load(const std::string& file, const protocol::Catalogue& catalogue,
                          std::uint32_t bit_rate);

/// The condition of term `index` as it stands in its monitor: "ring>3000", "not ring>3000".
[[nodiscard]] std::string term_text(const reflective::Operator& tables,
                                    std::span<const reflective::Term> terms, std::size_t index);

/// The JSON schema that is compiled in: what `operator.schema.json` of this release says.
[[nodiscard]] std::string_view schema_text() noexcept;

}  // namespace ocm::cli::operate
