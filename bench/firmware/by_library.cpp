// The same with the library: the generated header's board in a controller, on the same port, bus and parts.
#include <cstddef>
#include <new>

#include "ocm/controller/controller.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

#include "bench/firmware/work.h"

using namespace ocm;

namespace {

static_assert(sizeof(frame) == sizeof(can::Frame) && offsetof(frame, format) == offsetof(can::Frame, format));
const can::Frame& ours(const frame* f) noexcept {
  return *reinterpret_cast<const can::Frame*>(f);
}

struct Guard {  // inlined as the same two instructions are in C
  [[gnu::always_inline]] Guard() noexcept : mask(port_lock()) {}
  [[gnu::always_inline]] ~Guard() { port_unlock(mask); }
  std::uint32_t mask;
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;
};
struct Port {
  base::Time now() const noexcept { return base::Time{base::Duration{port_time}}; }
  void arm(base::Time when) noexcept { port_armed = when.time_since_epoch().count(); }
  void pend(scheduling::Level level) noexcept { port_pended = 1U << static_cast<unsigned>(level); }
  Guard lock() noexcept { return {}; }
};
struct Bus {
  base::Result<bool> send(const can::Frame& frame) noexcept {
    switch (bus_send(reinterpret_cast<const ::frame*>(&frame))) {
      case bus_took:
        return true;
      case bus_full:
        return false;
      default:
        return base::Error::closed;
    }
  }
};

struct DiWheelDrive {
  controller::Controller<amiro::DiWheelDrive, Bus, Port, 2> controller;

  DiWheelDrive(Bus& bus, Port& port) noexcept : controller(bus, port) {
    using base::Error;
    using base::Result;
    controller.serve<amiro::Odometry>([]() -> Result<amiro::Odometry> {
      std::int32_t velocity[2];
      std::int32_t pose[2];
      std::uint16_t orientation;
      if (!part_odometry(velocity, pose, &orientation)) return Error::not_sampled;
      return amiro::Odometry{{velocity[0], velocity[1]}, {pose[0], pose[1], orientation}};
    });
    controller.serve<amiro::FloorProximity>([]() -> Result<amiro::FloorProximity> {
      std::uint16_t counts[4];
      if (!part_floor(counts)) return Error::not_sampled;
      return amiro::FloorProximity{counts[0], counts[1], counts[2], counts[3]};
    });
    controller.serve<amiro::Magnetometer>([]() -> Result<amiro::Magnetometer> {
      std::int32_t field[3];
      if (!part_magnetometer(field)) return Error::not_sampled;
      return amiro::Magnetometer{{field[0]}, {field[1]}, {field[2]}};
    });
    controller.serve<amiro::Gyroscope>([]() -> Result<amiro::Gyroscope> {
      std::int16_t rate[3];
      if (!part_gyroscope(rate)) return Error::not_sampled;
      return amiro::Gyroscope{rate[0], rate[1], rate[2]};
    });
    controller.serve<amiro::Accelerometer>([]() -> Result<amiro::Accelerometer> {
      std::int16_t force[3];
      if (!part_accelerometer(force)) return Error::not_sampled;
      return amiro::Accelerometer{force[0], force[1], force[2]};
    });
    controller.accept<amiro::Motors>([](const amiro::Motors& target) { part_motors(target.x, target.z); });
    controller.accept<amiro::FloorCalibration>([](const amiro::FloorCalibration& command) {
      part_calibrate_floor(static_cast<std::uint8_t>(command.action));
    });
    controller.every<0>(std::chrono::milliseconds{50}, scheduling::Level::high, [] { task(0); });
    controller.every<1>(std::chrono::milliseconds{10}, scheduling::Level::urgent, [] { task(1); });
  }
};

Bus bus;
Port port;
alignas(DiWheelDrive) std::byte place[sizeof(DiWheelDrive)];
DiWheelDrive& drive() noexcept {
  return *reinterpret_cast<DiWheelDrive*>(place);
}

can::Payload& payload(std::uint8_t* at) noexcept {
  return *reinterpret_cast<can::Payload*>(at);
}

}  // namespace

const std::uint32_t wire_hash = amiro::wire_hash;

const board board_by_library{
    .set_up =
        [] {
          new (place) DiWheelDrive{bus, port};
        },
    .receive = [](const frame* f,
                  std::int64_t now) { drive().controller.receive(ours(f), base::Time{base::Duration{now}}); },
    .expire = [] { drive().controller.expire(); },
    .run = [](unsigned level) { drive().controller.run(static_cast<scheduling::Level>(level)); },
    .writable = [] { drive().controller.writable(); },
    .bus_lost = [] { drive().controller.bus_lost(); }};

const codec codec_by_library{
    .decode_request =
        [](const frame* f, std::uint8_t* mode, std::uint32_t* count_and_unit) {
          const auto request = protocol::decode_request(ours(f));
          *mode = static_cast<std::uint8_t>(request->mode);
          *count_and_unit = request->period.count | static_cast<std::uint32_t>(request->period.unit) << 16;
          return request.ok();
        },
    .encode_gyroscope =
        [](std::uint8_t* data, std::int16_t x, std::int16_t y, std::int16_t z) {
          payload(data) = amiro::Gyroscope{x, y, z}.encode();
        },
    .encode_odometry =
        [](std::uint8_t* data, std::int32_t vx, std::int32_t vz, std::int32_t x, std::int32_t y,
           std::uint16_t orientation) {
          const amiro::Odometry odometry{{vx, vz}, {x, y, orientation}};
          payload(data) = odometry.encode(0);
          payload(data + 8) = odometry.encode(1);
        },
    .encode_ring =
        [](std::uint8_t* data, const std::uint16_t* sensor) {
          for (std::size_t i = 0; i < 8; ++i)
            payload(data + 8 * i) = amiro::ProximityRingSensor{sensor[i]}.encode();
        },
};
