/// Reads what is in many places of an operator file: times, topics, fields of the catalogue and their values.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/operator.hpp"

#include "cli/operate/operator_file.hpp"
#include "generator/spec/node_reader.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::cli::operate {

/// What is read, into what, and where problems go.
struct Reading {
  std::string_view file_name;
  std::vector<spec::Problem>& problems;
  const protocol::Catalogue& catalogue;
  std::uint32_t bit_rate;  ///< bit/s, of the bus
  OperatorFile& file;
};

/// A field of the catalogue by its place in it.
struct FieldRef {
  std::uint16_t topic = reflective::none;
  std::uint16_t frame = 0;
  std::uint16_t field = 0;
  const protocol::Field* of = nullptr;
};

/// What each reader of a part builds on. Every function tells of a problem and has a value that does no harm
/// then.
class ValueReader : protected spec::NodeReader {
 protected:
  using At = spec::At;

  explicit ValueReader(const Reading& reading)
      : NodeReader(reading.file_name, reading.problems), catalogue_(reading.catalogue) {}

  /// Longer ones would make sums with a clock overflow, and wait for nothing.
  static constexpr base::Duration longest_time{std::chrono::hours{24}};
  /// Of what is analysed, instant by instant: minutes guard nothing, and would be analysed for hours.
  static constexpr base::Duration longest_analysed{std::chrono::seconds{60}};

  [[nodiscard]] std::optional<base::Duration> duration(const At& at, base::Duration longest = longest_time);
  /// At most `longest_analysed`.
  [[nodiscard]] base::Duration time(const At& object, std::string_view key, std::string_view remedy);
  [[nodiscard]] std::optional<std::string> word(const At& at, std::string_view remedy);
  [[nodiscard]] bool is_list(const At& at, std::string_view remedy);

  enum class Takes : std::uint8_t { streams, actuators, anything };
  [[nodiscard]] std::uint16_t topic(const At& at, Takes takes);
  /// The only field that a text names.
  [[nodiscard]] std::optional<FieldRef> field(const At& at, const std::string& text);
  [[nodiscard]] std::optional<FieldRef> field(const At& object, std::string_view key,
                                              std::string_view remedy);
  /// The name of what a derived field is derived of, quoted.
  [[nodiscard]] std::string measured(const FieldRef& of) const;
  [[nodiscard]] std::optional<std::int64_t> value(const At& at, const protocol::Field& of);
  /// How far apart two values are, in raw units, rounded up.
  [[nodiscard]] std::optional<std::int64_t> distance(const At& at, const protocol::Field& of);
  void unknown(const At& at, std::string_view what, const std::string& text,
               const std::vector<std::string>& names);

  const protocol::Catalogue& catalogue_;
};

}  // namespace ocm::cli::operate
