/// What happens on a bus now: a row a topic, message or unknown identifier, with its newest values. Pure:
/// frames and times in, rows out; it knows no terminal and reads no clock.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/measure/recent.hpp"
#include "ocm/measure/statistics.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::bus_model {

/// Whether samples come when they are due.
enum class Health : std::uint8_t {
  fine,
  late,     ///< one and a half periods without a sample
  missing,  ///< three
};

/// A field of what a row is about.
struct FieldKey {
  std::size_t row = 0;  ///< Row::number
  std::uint8_t frame = 0;
  std::uint16_t field = 0;
  friend auto operator<=>(const FieldKey&, const FieldKey&) = default;
};

/// A topic, a message, or an identifier that the spec does not know.
struct Row {
  std::size_t number = 0;  ///< as long as the model lives
  const protocol::Topic* topic = nullptr;
  std::string name;              ///< of an unknown identifier as candump writes it
  std::uint64_t count = 0;       ///< samples, set points, or frames
  std::uint64_t frames = 0;      ///< all but requests; those of incomplete samples and of a wrong length, too
  std::uint64_t incomplete = 0;  ///< samples
  std::uint64_t wrong_length = 0;  ///< frames
  std::uint64_t faults = 0;        ///< missing and incomplete samples, frames of a wrong length, bad requests
  measure::RecentTimes::Figures recent;
  std::optional<double> share;              ///< of the bus, in the last second, 0..1
  std::optional<base::Duration> age;        ///< since the newest came; nothing came: none
  std::optional<base::Duration> unchanged;  ///< since it had other bytes than the one before it
  std::optional<base::Duration> period;     ///< that it is asked for, or has
  Health health = Health::fine;
  /// The newest; without bytes where nothing came. Until the next frame is taken.
  client::Sample newest;
  /// Whether `newest` has fields that can be shown.
  [[nodiscard]] bool has_bytes() const noexcept { return count > 0 && newest.topic != nullptr; }
};

/// The bus as a whole.
struct Summary {
  bool load_known = false;
  double load = 0;        ///< in the last second, 0..1
  double worst_load = 0;  ///< in the worst tenth of a second of all
  double rate_hz = 0;     ///< frames, in the last second
  std::uint64_t frames = 0;
  std::uint64_t errors = 0;      ///< reports of the CAN controller
  std::uint64_t overflows = 0;   ///< of these, frames lost in it
  std::uint64_t lost = 0;        ///< frames that were on the bus and did not reach this program
  std::uint64_t incomplete = 0;  ///< samples
  std::uint64_t wrong_length = 0;
  std::uint64_t unknown = 0;         ///< frames
  std::uint64_t not_in_load = 0;     ///< CAN FD frames whose data go at a bit rate that is not known
  std::uint64_t transport = 0;       ///< messages of J1939's transport protocol that were put together
  std::uint64_t transport_lost = 0;  ///< messages of it that lost a packet or were not ended
  std::uint64_t not_shown = 0;       ///< frames of unknown identifiers that have no row
  std::optional<can::ControllerState> controller;    ///< as the newest report says; none came: nothing
  std::optional<can::ErrorCounters> error_counters;  ///< likewise
};

class Model {
 public:
  /// Unknown identifiers that get a row; the frames of others are counted.
  static constexpr std::size_t most_unknown = 1024;
  /// Values that are kept of a field that is followed.
  static constexpr std::size_t history_size = 240;

  /// The catalogue must outlive it. Without a bit rate, 0, nothing is known of the load.
  Model(const protocol::Catalogue& catalogue, std::uint32_t bit_rate, std::uint32_t data_bit_rate = 0,
        std::string_view interface = {});

  void take(const log::Entry& entry);
  void lost(std::uint64_t frames) noexcept { lost_ += frames; }
  /// What the controller's driver says now, beside what error frames have said. Counters that it does not say
  /// stay as they were.
  void controller_is(can::ControllerState state, std::optional<can::ErrorCounters> counters) noexcept {
    controller_ = state;
    if (counters) error_counters_ = counters;
  }

  /// In the order of the catalogue; those of which nothing came only where `all`. Unknown ones last.
  [[nodiscard]] std::vector<Row> rows(base::Time now, bool all) const;
  /// What came last of the catalogue's topic of that number, of all its frames; none: nothing did. Until the
  /// next frame is taken.
  [[nodiscard]] std::optional<client::Sample> newest_of(std::size_t topic) const;
  [[nodiscard]] Summary summary(base::Time now) const;
  /// Of the newest frame; none came: nothing.
  [[nodiscard]] std::optional<base::Time> newest() const noexcept { return newest_; }

  /// From now on, keeps a value of the field at each `tick`. Only of topics and messages.
  /// Whether it was not followed before.
  bool follow(FieldKey field) { return histories_.try_emplace(field).second; }
  void tick();
  /// Oldest first; NaN where there was no value.
  [[nodiscard]] std::vector<double> history(FieldKey field) const;

 private:
  struct Subject {
    measure::RecentTimes times;
    measure::RecentLoad load;
    std::uint64_t count = 0;
    std::uint64_t frames = 0;  ///< but requests
    base::Time last{};
    base::Time changed{};
    protocol::Priority priority = protocol::default_priority;
    std::vector<std::uint8_t> bytes;  ///< with room behind them as can::FrameView says
    std::size_t size = 0;             ///< of these
  };
  struct Unknown {
    std::uint32_t id = 0;
    can::Format format = can::Format::base;
    Subject subject;
  };

  void take_sample(Subject& subject, base::Time time, std::span<const std::uint8_t> bytes);
  [[nodiscard]] Subject* find_unknown(std::uint32_t id, can::Format format);
  [[nodiscard]] static client::Sample sample_of(const protocol::Topic* topic, const Subject& subject);

  const protocol::Catalogue* catalogue_;
  std::uint32_t bit_rate_;
  measure::BitRates rates_;
  measure::BusStatistics statistics_;
  std::vector<Subject> subjects_;  ///< of the catalogue's topics
  std::vector<Unknown> unknown_;
  std::map<std::uint64_t, std::size_t> unknown_by_id_;
  measure::RecentLoad load_;
  measure::RecentLoad frames_;  ///< each as one bit
  std::map<FieldKey, std::deque<double>> histories_;
  std::optional<base::Time> newest_;
  base::Time begin_{};  ///< of the first frame, or of the first since the clock was set back
  std::optional<can::ControllerState> controller_;
  std::optional<can::ErrorCounters> error_counters_;
  std::uint64_t not_shown_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace ocm::cli::bus_model
