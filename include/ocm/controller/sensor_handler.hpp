/// The sensors of one board: the state machine of thesis figure 5.2. A request starts, changes or stops a
/// topic's publisher; when a topic is due its part is read, encoded, and its frames go to the bus back to
/// back.
///
/// No heap. RAM a topic: 40 bytes of schedule, 8 bytes a frame that waits for the bus, three pointers for its
/// reader. Not reentrant: call `handle` and `poll` from one context.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>

#include "ocm/base/inline_function.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/scheduling/publisher.hpp"

namespace ocm::controller {

namespace detail {
template <class Topic>
struct SensorSlot {
  base::InlineFunction<base::Result<Topic>(base::Time)> read;
  std::array<can::Payload, Topic::frames.size()> payloads{};
  std::uint8_t sent = Topic::frames.size();  // of `payloads`
  protocol::Priority priority = protocol::default_priority;

  [[nodiscard]] bool waiting() const noexcept { return sent < Topic::frames.size(); }
};
}  // namespace detail

template <class Sensors>
class SensorHandler;

template <class... Topics>
class SensorHandler<protocol::TopicList<Topics...>> {
 public:
  /// Reads a topic's part; not_sampled when it has nothing to say.
  template <class Topic>
  using Reader = base::InlineFunction<base::Result<Topic>(base::Time)>;

  template <class Topic>
  void serve(Reader<Topic> read) noexcept {
    std::get<Slot<Topic>>(slots_).read = read;
  }

  /// A command frame. False: not one of this board's sensors.
  bool handle(const can::Frame& frame, [[maybe_unused]] base::Time now,
              protocol::Counters& counters) noexcept {
    [[maybe_unused]] const protocol::TopicId topic = protocol::Identifier::decode(frame.id).topic;
    std::size_t stream = 0;
    return (
        (Topics::id == topic ? (request<Topics>(stream, frame, now, counters), true) : (++stream, false)) ||
        ...);
  }

  /// Releases what is due and hands frames to the bus until it takes no more.
  template <can::Sender Bus>
  void poll(base::Time now, Bus& bus, protocol::Counters& counters) noexcept {
    flush(bus, counters);
    scheduling::Release due;
    while (publisher_.take_due(now, due)) {
      counters.missed += due.missed;
      counters.late += due.late ? 1U : 0U;
      release(std::index_sequence_for<Topics...>{}, due, now, counters);
      flush(bus, counters);
    }
  }

  /// Frames of a sample wait for the bus: poll again as soon as it has room.
  [[nodiscard]] bool waiting() const noexcept { return (std::get<Slot<Topics>>(slots_).waiting() || ...); }
  [[nodiscard]] base::Time next_release() const noexcept { return publisher_.next_release(); }

 private:
  template <class Topic>
  using Slot = detail::SensorSlot<Topic>;

  template <class Topic>
  void request(std::size_t stream, const can::Frame& frame, base::Time now,
               protocol::Counters& counters) noexcept {
    auto request = protocol::decode_request(frame);
    if (!std::get<Slot<Topic>>(slots_).read) request = base::Error::unknown_topic;
    if (!request) return counters.refuse(request.error);
    ++counters.requests;
    switch (request->mode) {
      case protocol::Mode::stop:
        return publisher_.stop(stream);
      case protocol::Mode::once:
        return publisher_.once(stream, request->priority, now);
      case protocol::Mode::publish:
        // Without a period in the request, the topic's own default holds.
        return publisher_.start(stream, (frame.dlc == 1 ? Topic::period : request->period).duration(),
                                request->priority, now, Topic::jitter);
    }
  }

  template <std::size_t... I>
  void release(std::index_sequence<I...>, const scheduling::Release& due, [[maybe_unused]] base::Time now,
               protocol::Counters& counters) noexcept {
    ((I == due.stream ? sample(std::get<I>(slots_), due.priority, now, counters) : void()), ...);
  }

  template <class Topic>
  static void sample(Slot<Topic>& slot, protocol::Priority priority, base::Time now,
                     protocol::Counters& counters) noexcept {
    if (slot.waiting()) {  // half a sample is on the bus: a receiver must not get the rest of another one
      ++counters.overrun;
      return;
    }
    const base::Result<Topic> read = slot.read(now);
    if (!read) {
      ++counters.not_sampled;
      return;
    }
    for (std::size_t i = 0; i < slot.payloads.size(); ++i) slot.payloads[i] = read->encode(i);
    slot.priority = priority;
    slot.sent = 0;
    ++counters.samples;
  }

  /// Most urgent first; a topic's frames in their order.
  template <can::Sender Bus>
  void flush(Bus& bus, protocol::Counters& counters) noexcept {
    for (std::uint8_t level = 0; level < protocol::priority_levels; ++level)
      if (!(flush(std::get<Slot<Topics>>(slots_), static_cast<protocol::Priority>(level), bus, counters) &&
            ...))
        return;
  }
  /// False: the bus is full.
  template <class Topic, can::Sender Bus>
  static bool flush(Slot<Topic>& slot, protocol::Priority level, Bus& bus,
                    protocol::Counters& counters) noexcept {
    if (slot.priority != level) return true;
    while (slot.waiting()) {
      const auto& head = Topic::frames[slot.sent];
      const can::Frame frame{protocol::Identifier{protocol::Direction::sensor, level, head.id}.encode(),
                             head.dlc, slot.payloads[slot.sent]};
      const base::Result<bool> taken = bus.send(frame);
      if (!taken) {
        ++counters.send_failed;
        slot.sent = Topic::frames.size();
        return true;
      }
      if (!*taken) return false;
      ++counters.sent;
      ++slot.sent;
    }
    return true;
  }

  scheduling::Publisher<sizeof...(Topics)> publisher_;
  std::tuple<Slot<Topics>...> slots_;
};

}  // namespace ocm::controller
