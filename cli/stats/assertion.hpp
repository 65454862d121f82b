/// What a person demands of a bus, as one word: gyro.rate>1.9, odom.gap<=120ms, bus.load<40%. For scripts and
/// tests: the exit code says whether it holds.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/stats/figures.hpp"

namespace ocm::cli::stats {

/// How a measured number is written and compared.
enum class Unit : std::uint8_t { none, hertz, time, percent };

/// 1234567.0 as a time: "1.235 ms". `digits` significant ones.
[[nodiscard]] std::string to_text(double number, Unit unit, int digits = 4);

struct Quantity;

inline constexpr const char* assertion_form = "TOPIC.QUANTITY>NUMBER, such as gyro.rate>1.9 or bus.load<40%";

class Assertion {
 public:
  /// "TOPIC.QUANTITY OP NUMBER", or "bus.QUANTITY...". The failure says what would be right.
  [[nodiscard]] static transport::Outcome<Assertion> parse(std::string_view text,
                                                           const protocol::Catalogue& catalogue);

  /// Whether it is right but for its topic, which only a catalogue knows.
  [[nodiscard]] static bool is_well_formed(std::string_view text);

  struct Verdict {
    bool holds = false;
    std::optional<double> measured;  ///< of the first bus where it does not hold, or the last; empty: no
                                     ///< data, which does not hold
    std::string said;                ///< "gyro.rate>1.9: it is 0.95 Hz"
  };
  /// Holds where it holds on every bus on which the topic was seen.
  [[nodiscard]] Verdict check(std::span<const Bus> buses) const;

  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  enum class Relation : std::uint8_t { less, at_most, greater, at_least, equal, other };
  struct Parts {
    std::string_view subject;
    const Quantity* quantity = nullptr;
    Relation relation = Relation::equal;
    double limit = 0;
  };
  /// The failure says what would be right.
  [[nodiscard]] static transport::Outcome<Parts> read(std::string_view text);
  [[nodiscard]] bool holds(double measured) const noexcept;

  std::string text_;
  const protocol::Topic* topic_ = nullptr;  // nullptr: the bus
  const Quantity* quantity_ = nullptr;
  Relation relation_ = Relation::equal;
  double limit_ = 0;
};

}  // namespace ocm::cli::stats
