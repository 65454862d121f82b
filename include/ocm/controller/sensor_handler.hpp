/// The sensors of one board: the state machine of thesis figure 5.2. A request starts, changes or stops a
/// topic's stream; when it is released its part is read, encoded, and its frames go to the bus back to back.
/// When the bus has no room the rest of the sample waits, and the topic is not released again until it is
/// gone.
///
/// `handle` may preempt `run` and be preempted by it; `run` of one stream is in one context at a time (the
/// dispatcher sees to that), those of two streams may preempt each other. A topic's slot is touched by its
/// `run` only; counters and bus under the port's lock, frame by frame.
///
/// No heap. RAM a topic: 8 bytes a frame, three pointers for its reader, 2 bytes; its stream is the
/// dispatcher's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <utility>

#include "ocm/base/inline_function.hpp"
#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/level.hpp"
#include "ocm/controller/report.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/dispatcher.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::controller {

namespace detail {
/// A sample on its way to the bus.
struct Sending {
  protocol::Priority priority = protocol::default_priority;
  std::uint8_t sent = 0;  // of its frames
};
template <class Topic>
struct SensorSlot {
  base::InlineFunction<base::Result<Topic>(base::Time)> read;
  std::array<can::Payload, Topic::frames.size()> payloads{};
  Sending sending;
};
/// What holds when a request does not say otherwise.
struct SensorDefaults {
  base::Duration period{};
  base::Duration jitter{};
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

  /// A command frame. The sensors' streams are those of `dispatcher` from `first_stream` on.
  template <class Dispatcher, scheduling::Port P, scheduling::Admission A>
  Verdict handle(const can::Frame& frame, [[maybe_unused]] base::Time now,
                 [[maybe_unused]] Dispatcher& dispatcher, std::size_t first_stream, [[maybe_unused]] P& port,
                 [[maybe_unused]] protocol::Counters& counters, [[maybe_unused]] A& admission) noexcept {
    [[maybe_unused]] const protocol::TopicId topic = protocol::Identifier::decode(frame.id).topic;
    std::size_t sensor = 0;
    Verdict verdict;
    static_cast<void>(
        ((Topics::id == topic ? (verdict = {true, request(sensor, first_stream, frame, now,
                                                          bool{std::get<Slot<Topics>>(slots_).read},
                                                          {Topics::period.duration(), Topics::jitter},
                                                          dispatcher, port, counters, admission)},
                                 true)
                              : (++sensor, false)) ||
         ...));
    return verdict;
  }

  /// Samples sensor number `sensor`, or goes on with what waits of it, until the bus takes no more.
  template <scheduling::Port P, can::Sender Bus>
  scheduling::Outcome run(std::size_t sensor, const scheduling::Release& release, P& port, Bus& bus,
                          protocol::Counters& counters) noexcept {
    return run(std::index_sequence_for<Topics...>{}, sensor, release, port, bus, counters);
  }

  /// Bit n: sensor number n had nothing to say when it was read last. To be called with the port's lock held.
  [[nodiscard]] std::uint32_t faults() const noexcept { return faults_; }

 private:
  template <class Topic>
  using Slot = detail::SensorSlot<Topic>;

  // What does not depend on the topic's type is compiled once: a board has few kilobytes.

  /// Why it is refused, if it is.
  template <class Dispatcher, class P, class A>
  [[gnu::noinline]] static base::Error request(std::size_t sensor, std::size_t first_stream,
                                               const can::Frame& frame, base::Time now, bool served,
                                               const detail::SensorDefaults& defaults, Dispatcher& dispatcher,
                                               P& port, protocol::Counters& counters, A& admission) noexcept {
    const std::size_t stream = first_stream + sensor;
    auto request = protocol::decode_request(frame);
    if (!served) request = base::Error::unknown_topic;
    // Without a period in the request, the topic's own default holds.
    const base::Duration period = frame.dlc == 1 ? defaults.period : request.value.period.duration();
    if (request && request->mode == protocol::Mode::publish) {
      // Asked without the lock: this takes longer than a lock may.
      if (const base::Error error = admission.admit(sensor, period, level_of(request->priority));
          error != base::Error::none)
        request = error;
    }
    {
      [[maybe_unused]] const auto guard = port.lock();
      if (!request) {
        counters.refuse(request.error);
        return request.error;
      }
      ++counters.requests;
    }
    switch (request->mode) {
      case protocol::Mode::stop:
        dispatcher.stop(stream);
        admission.ended(sensor);
        break;
      case protocol::Mode::once:
        dispatcher.once(stream, level_of(request->priority), now);
        admission.ended(sensor);
        break;
      case protocol::Mode::publish:
        dispatcher.start(stream, period, level_of(request->priority), now, defaults.jitter);
        break;
    }
    return base::Error::none;
  }

  template <std::size_t... I, class P, class Bus>
  scheduling::Outcome run(std::index_sequence<I...>, [[maybe_unused]] std::size_t sensor,
                          [[maybe_unused]] const scheduling::Release& release, [[maybe_unused]] P& port,
                          [[maybe_unused]] Bus& bus, [[maybe_unused]] protocol::Counters& counters) noexcept {
    auto outcome = scheduling::Outcome::done;
    ((I == sensor ? void(outcome = step<I>(std::get<I>(slots_), release, port, bus, counters)) : void()),
     ...);
    return outcome;
  }

  template <std::size_t Sensor, class Topic, class P, class Bus>
  scheduling::Outcome step(Slot<Topic>& slot, const scheduling::Release& release, P& port, Bus& bus,
                           protocol::Counters& counters) noexcept {
    if (!release.resumed && !sample<Sensor>(slot, priority_of(release.level), port, counters))
      return scheduling::Outcome::done;
    return send(slot.sending, Topic::frames, slot.payloads.data(), port, bus, counters);
  }

  /// False: the part delivered nothing.
  template <std::size_t Sensor, class Topic, class P>
  bool sample(Slot<Topic>& slot, protocol::Priority priority, P& port,
              protocol::Counters& counters) noexcept {
    const base::Result<Topic> read = slot.read(port.now());
    if (read) {
      for (std::size_t i = 0; i < slot.payloads.size(); ++i) slot.payloads[i] = read->encode(i);
      slot.sending = {priority, 0};
    }
    count(Sensor, read.ok(), port, counters);
    return read.ok();
  }
  template <class P>
  [[gnu::noinline]] void count(std::size_t sensor, bool sampled, P& port,
                               protocol::Counters& counters) noexcept {
    [[maybe_unused]] const auto guard = port.lock();
    ++(sampled ? counters.samples : counters.not_sampled);
    const std::uint32_t bit = sensor < 32 ? std::uint32_t{1} << sensor : 0;
    faults_ = sampled ? faults_ & ~bit : faults_ | bit;
  }

  template <class P, class Bus>
  [[gnu::noinline]] static scheduling::Outcome send(detail::Sending& sending,
                                                    std::span<const protocol::FrameHead> heads,
                                                    const can::Payload* payloads, P& port, Bus& bus,
                                                    protocol::Counters& counters) noexcept {
    for (; sending.sent < heads.size(); ++sending.sent) {
      const auto& head = heads[sending.sent];
      const can::Frame frame{
          protocol::Identifier{protocol::Direction::sensor, sending.priority, head.id}.encode(), head.dlc,
          payloads[sending.sent]};
      [[maybe_unused]] const auto guard = port.lock();
      const base::Result<bool> taken = bus.send(frame);
      if (!taken) {  // the rest of the sample is given up
        ++counters.send_failed;
        return scheduling::Outcome::done;
      }
      if (!*taken) return scheduling::Outcome::waits;
      ++counters.sent;
    }
    return scheduling::Outcome::done;
  }

  std::tuple<Slot<Topics>...> slots_;
  std::uint32_t faults_ = 0;
};

}  // namespace ocm::controller
