/// What an operator asks of a sensor: stop, publish at a period, or one sample. [Thesis 4.2, figure 4.2]
///
/// A request is a command frame on the sensor's topic: data[0] = mode, and for a period data[1..2] = count
/// (little endian), data[3] = unit. Anything else is refused with a reason.
#pragma once

#include <chrono>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::protocol {

enum class Mode : std::uint8_t { stop = 0, publish = 1, once = 2 };
enum class PeriodUnit : std::uint8_t { milliseconds = 0, seconds = 1, microseconds = 2 };

/// A period as the wire carries it: a count of 1..65535 and one of three units; 1 us to 18.2 h.
struct Period {
  std::uint16_t count = 50;
  PeriodUnit unit = PeriodUnit::milliseconds;

  [[nodiscard]] constexpr base::Duration duration() const noexcept {
    return base::Duration{std::int64_t{count} * nanoseconds_of(unit)};
  }
  [[nodiscard]] static constexpr std::int64_t nanoseconds_of(PeriodUnit unit) noexcept {
    return unit == PeriodUnit::seconds ? 1'000'000'000 : unit == PeriodUnit::milliseconds ? 1'000'000 : 1'000;
  }

  /// Exactly `period`, or bad_period. Milliseconds where they are exact (what the thesis's demo sends), else
  /// microseconds, else seconds. `nearest` says what could be asked for instead.
  [[nodiscard]] static constexpr base::Result<Period> from(base::Duration period) noexcept {
    for (const auto unit : {PeriodUnit::milliseconds, PeriodUnit::microseconds, PeriodUnit::seconds}) {
      const std::int64_t size = nanoseconds_of(unit);
      if (period.count() > 0 && period.count() % size == 0 && period.count() / size <= UINT16_MAX)
        return Period{static_cast<std::uint16_t>(period.count() / size), unit};
    }
    return base::Error::bad_period;
  }

  /// The period on the wire that is nearest to `period`; of two at the same distance the shorter.
  [[nodiscard]] static constexpr Period nearest(base::Duration period) noexcept {
    const std::int64_t wanted = period.count() < 0 ? 0 : period.count();
    Period best{};
    std::int64_t best_distance = INT64_MAX;
    for (const auto unit : {PeriodUnit::milliseconds, PeriodUnit::microseconds, PeriodUnit::seconds}) {
      const std::int64_t size = nanoseconds_of(unit);
      for (std::int64_t count = wanted / size; count <= wanted / size + 1; ++count) {
        const std::int64_t held = count < 1 ? 1 : count > UINT16_MAX ? UINT16_MAX : count;
        const std::int64_t distance = held * size > wanted ? held * size - wanted : wanted - held * size;
        const bool shorter = held * size < best.duration().count();
        if (distance < best_distance || (distance == best_distance && shorter)) {
          best = {static_cast<std::uint16_t>(held), unit};
          best_distance = distance;
        }
      }
    }
    return best;
  }
  friend constexpr bool operator==(const Period&, const Period&) = default;
};

/// Asked for with DLC 1, that is without a period. [Thesis figure 4.2]
inline constexpr Period default_period{50, PeriodUnit::milliseconds};

struct Request {
  TopicId topic{};
  Mode mode = Mode::stop;
  Period period = default_period;  ///< for Mode::publish
  Priority priority = default_priority;
  friend constexpr bool operator==(const Request&, const Request&) = default;
};

[[nodiscard]] constexpr can::Frame encode(const Request& request) noexcept {
  can::Frame frame;
  frame.id = Identifier{Direction::command, request.priority, request.topic}.encode();
  frame.dlc = request.mode == Mode::publish ? 4 : 1;
  frame.data[0] = static_cast<std::uint8_t>(request.mode);
  if (request.mode == Mode::publish) {
    frame.data[1] = static_cast<std::uint8_t>(request.period.count);
    frame.data[2] = static_cast<std::uint8_t>(request.period.count >> 8);
    frame.data[3] = static_cast<std::uint8_t>(request.period.unit);
  }
  return frame;
}

/// A publish request that leaves the period to the board: DLC 1.
[[nodiscard]] constexpr can::Frame encode_default_publish(TopicId topic,
                                                          Priority priority = default_priority) noexcept {
  can::Frame frame;
  frame.id = Identifier{Direction::command, priority, topic}.encode();
  frame.dlc = 1;
  frame.data[0] = static_cast<std::uint8_t>(Mode::publish);
  return frame;
}

/// Reads a command frame on a sensor's topic. Refuses with bad_identifier (not a command, not a base data
/// frame), bad_length (stop and once: DLC 1; publish: 1 or 4), bad_mode, bad_unit, bad_period (0). A publish
/// request of DLC 1 comes out with `default_period`; a topic with another default must look at the DLC.
[[nodiscard]] constexpr base::Result<Request> decode_request(const can::Frame& frame) noexcept {
  using base::Error;
  if (frame.format != can::Format::base) return Error::bad_identifier;
  if (const auto valid = can::validate(frame); !valid) return valid.error;
  const Identifier id = Identifier::decode(frame.id);
  if (id.direction != Direction::command) return Error::bad_identifier;
  if (frame.dlc == 0) return Error::bad_length;
  if (frame.data[0] > static_cast<std::uint8_t>(Mode::once)) return Error::bad_mode;
  Request request{id.topic, static_cast<Mode>(frame.data[0]), default_period, id.priority};
  if (request.mode != Mode::publish)
    return frame.dlc == 1 ? base::Result<Request>{request} : Error::bad_length;
  if (frame.dlc == 1) return request;
  if (frame.dlc != 4) return Error::bad_length;
  if (frame.data[3] > static_cast<std::uint8_t>(PeriodUnit::microseconds)) return Error::bad_unit;
  request.period = {static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8),
                    static_cast<PeriodUnit>(frame.data[3])};
  if (request.period.count == 0) return Error::bad_period;
  return request;
}

/// Publish `topic` every `period`, the ordinary case. Error::bad_period where the wire cannot carry it
/// exactly.
[[nodiscard]] constexpr base::Result<can::Frame> publish_every(
    TopicId topic, base::Duration period, Priority priority = default_priority) noexcept {
  const auto wire = Period::from(period);
  if (!wire) return wire.error;
  return encode(Request{topic, Mode::publish, *wire, priority});
}

[[nodiscard]] constexpr can::Frame once(TopicId topic, Priority priority = default_priority) noexcept {
  return encode(Request{topic, Mode::once, default_period, priority});
}

[[nodiscard]] constexpr can::Frame stop(TopicId topic, Priority priority = default_priority) noexcept {
  return encode(Request{topic, Mode::stop, default_period, priority});
}

}  // namespace ocm::protocol
