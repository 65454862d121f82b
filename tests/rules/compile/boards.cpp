// The three boards with hardware that is not there, as object code for a Cortex-M: every template of the
// floors below is instantiated. What the object then still needs is looked at: no heap, no exceptions, no
// RTTI, no streams.
#include "firmware/boards/di_wheel_drive/board.hpp"
#include "firmware/boards/light_ring/board.hpp"
#include "firmware/boards/power_management/board.hpp"

using namespace ocm;
using namespace ocm::firmware::boards;

// Defined nowhere: this is compiled, never linked.
struct Can {
  base::Result<bool> send(const can::Frame& frame);
};
struct Bottom {
  base::Result<AngularRate> gyroscope();
  base::Result<SpecificForce> accelerometer();
  base::Result<MagneticField> magnetometer();
  base::Result<FloorCounts> floor();
  base::Result<WheelTicks> encoders();
  void set_wheels(WheelSpeeds speeds);
  base::Status calibrate_floor(bool forget);
};
struct Middle {
  base::Result<GaugeReading> gauge();
  base::Result<RingCounts> ring();
  base::Result<BatteryReadings> batteries();
  base::Result<RingLight> ring_light();
  std::uint16_t ring_offset(std::size_t sensor);
  base::Status calibrate_ring(bool forget);
};
struct Top {
  void set_light(std::size_t light, Colour colour);
};

template <class Board>
base::Time step(Board& board, const can::Frame& frame, base::Time now) {
  board.receive(frame, now);
  board.poll(now);
  return board.waiting() ? now : board.next_event();
}

base::Time turn(const can::Frame& frame, base::Time now, Can& can, Bottom& bottom, Middle& middle, Top& top) {
  static di_wheel_drive::Board<Bottom, Can> drive{bottom, can};
  static power_management::Board<Middle, Can> power{middle, can};
  static light_ring::Board<Top, Can> ring{top, can};
  return std::min({step(drive, frame, now), step(power, frame, now), step(ring, frame, now)});
}
