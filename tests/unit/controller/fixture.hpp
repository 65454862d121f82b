/// A board on a bus with a few mailboxes, for the tests of this floor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#include "unit/can/frame_of.hpp"

namespace fixture {

using namespace ocm;
using namespace std::chrono_literals;
using test::frame;

/// A bus with room for `room` frames.
struct Mailboxes {
  base::Result<bool> send(const can::Frame& frame) {
    if (broken) return base::Error::closed;
    if (room == 0) return false;
    --room;
    frames.push_back(frame);
    return true;
  }
  std::size_t room = 1000;
  bool broken = false;
  std::vector<can::Frame> frames;
};

inline std::vector<std::string> texts(const Mailboxes& bus) {
  std::vector<std::string> result;
  for (const auto& sent : bus.frames) result.emplace_back(can::to_text(sent).view());
  return result;
}

inline base::Time at(base::Duration offset) {
  return base::Time{offset};
}

/// Any number of sensors, for a board that has more of them than a report has bits.
template <std::size_t Number>
struct Part : amiro::Accelerometer {
  static constexpr protocol::TopicId id{static_cast<std::uint8_t>(0x40 + Number)};
};

/// DiWheelDrive with everything served: each sample says how many there were.
struct Board {
  Mailboxes bus;
  controller::Controller<amiro::DiWheelDrive, Mailboxes> controller{bus};
  std::int16_t reads = 0;
  std::vector<amiro::Motors> set_points;

  Board() {
    controller.serve<amiro::Gyroscope>([this] {
      ++reads;
      return base::Result<amiro::Gyroscope>{amiro::Gyroscope{reads, 0, -1}};
    });
    controller.serve<amiro::Magnetometer>([] {
      return base::Result<amiro::Magnetometer>{amiro::Magnetometer{{53760}, {-939520}, {1523200}}};
    });
    controller.serve<amiro::FloorProximity>(
        [](base::Time) { return base::Result<amiro::FloorProximity>{base::Error::not_sampled}; });
    controller.accept<amiro::Motors>([this](const amiro::Motors& motors) { set_points.push_back(motors); });
  }
  void receive(std::string_view text, base::Duration now) {
    controller.receive(frame(text), at(now));
    controller.poll(at(now));
  }
};

}  // namespace fixture
