/// The robot as a program on its Linux sees it: ask for topics, set actuators, take samples.
///
///     ocm::client::Robot robot{bus, amiro::catalogue};
///     robot.publish<amiro::Gyroscope>(500ms, Priority::high);
///     while (auto sample = robot.next(1s))
///       if (auto gyroscope = sample->as<amiro::Gyroscope>()) use(gyroscope->x_deg_per_s());
///
/// Errors: bad_period where the wire cannot carry the period, full where the bus takes no frame now (try
/// again), closed, timed_out. The bus and the catalogue must outlive the robot.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

/// A generated topic that can be asked for samples.
template <class T>
concept SensorType = protocol::TopicType<T> && T::kind == protocol::Kind::sensor;
/// A generated topic that takes set points.
template <class T>
concept ActuatorType = protocol::TopicType<T> && T::kind == protocol::Kind::actuator;

template <can::Bus Bus>
class Robot {
 public:
  Robot(Bus& bus, const protocol::Catalogue& catalogue) : bus_(&bus), receiver_(catalogue) {}

  template <SensorType T>
  base::Status publish(base::Duration period, protocol::Priority priority = T::priority) {
    const auto frame = protocol::publish_every(T::id, period, priority);
    if (!frame) return frame.error;
    return send(*frame);
  }
  template <SensorType T>
  base::Status once(protocol::Priority priority = T::priority) {
    return send(protocol::once(T::id, priority));
  }
  template <SensorType T>
  base::Status stop() {
    return send(protocol::stop(T::id));
  }
  /// `instance` counts from 1, for actuators of which there are several.
  template <ActuatorType T>
  base::Status set(const T& set_point, std::uint8_t instance = 1, protocol::Priority priority = T::priority) {
    if (instance < 1 || instance > T::instances) return base::Error::out_of_range;
    return send(protocol::command(set_point, priority, instance));
  }

  base::Status send(const can::Frame& frame) {
    const auto taken = bus_->send(frame);
    if (!taken) return taken.error;
    return *taken ? base::Status{} : base::Status{base::Error::full};
  }

  /// The next complete sample of any topic, at most `timeout` from now.
  base::Result<Sample> next(base::Duration timeout) {
    const auto begin = std::chrono::steady_clock::now();
    base::Duration left = timeout;
    for (;;) {
      const auto received = bus_->receive(left);
      if (!received) return received.error;
      const Reception reception = receiver_.take(*received);
      if (reception.meaning == Meaning::sample) return reception.sample;
      left = std::max(base::Duration{0}, timeout - (std::chrono::steady_clock::now() - begin));
    }
  }

  [[nodiscard]] const ReceiverCounters& counters() const noexcept { return receiver_.counters(); }

 private:
  Bus* bus_;
  Receiver receiver_;
};

}  // namespace ocm::client
