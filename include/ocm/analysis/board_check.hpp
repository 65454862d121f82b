/// Whether a board would admit the streams that it runs and one more, for a tool that knows the board from a
/// catalogue and hears what it sends: the rule of BoardAdmission (board_admission.hpp) without the board's
/// processor and with all of the bus. So a board with that admission refuses whatever does not fit here, and
/// may refuse more. A board without one takes everything.
///
///     BoardCheck<64> check{catalogue, gyroscope.board};
///     check.runs(accelerometer, 500ms, Priority::medium);    // as it was heard
///     check.runs(gyroscope, 1ms, Priority::medium);          // what is asked for
///     check.fits();
///
/// Cost: sensors^2 steps an iteration, 16 of them at most. No heap; 40 bytes a sensor. Constexpr.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "ocm/analysis/board_admission.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/scheduling/level.hpp"

namespace ocm::analysis {

template <std::size_t N>
class BoardCheck {
  using Load = detail::BoardLoad<N>;

 public:
  /// The catalogue must outlive it, and have a bit rate.
  constexpr BoardCheck(const protocol::Catalogue& catalogue, std::uint8_t board) noexcept {
    for (const protocol::Topic& topic : catalogue.topics) {
      if (topic.kind != protocol::Kind::sensor || topic.board != board) continue;
      if (count_ < N) {
        topics_[count_] = &topic;
        facts_.sensors[count_] = cost_of(topic, catalogue.bit_rate);
      }
      ++count_;
    }
    facts_.any_frame_us =
        detail::bits_us(can::worst_frame_bits(can::Format::base, can::max_dlc), catalogue.bit_rate);
    facts_.bit_us = detail::bits_us(1, catalogue.bit_rate);
  }

  /// It publishes this sensor of its own, from now on at this period. Other boards' topics change nothing.
  constexpr void runs(const protocol::Topic& topic, base::Duration period,
                      protocol::Priority priority) noexcept {
    const std::size_t end = std::min(count_, N);
    for (std::size_t i = 0; i < end; ++i)
      if (topics_[i] == &topic)
        streams_[i] = {detail::stream_us(period), static_cast<scheduling::Level>(priority)};
  }
  /// Every stream is in time. False, too, of a board with more than N sensors: then nothing is known.
  [[nodiscard]] constexpr bool fits() const noexcept { return count_ <= N && Load::fits(facts_, streams_); }

 private:
  static constexpr detail::SensorCost cost_of(const protocol::Topic& topic, std::uint32_t bit_rate) noexcept {
    detail::SensorCost cost;
    cost.deadline_us = detail::bounded_us(topic.deadline);
    cost.shortest_us = detail::bounded_us(topic.shortest_period);
    for (std::size_t level = 0; level < scheduling::level_count; ++level)
      cost.frames_us[level] =
          detail::frames_us(topic.frames, static_cast<protocol::Priority>(level), bit_rate);
    return cost;
  }

  std::array<const protocol::Topic*, N> topics_{};
  std::size_t count_ = 0;
  typename Load::Facts facts_{};
  typename Load::Streams streams_{};
};

}  // namespace ocm::analysis
