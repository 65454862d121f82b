// Parts that answer anything, or nothing: whatever stands in their registers, the drivers above make a sample
// of it or say why not, and never get stuck.
#include "firmware/boards/di_wheel_drive/parts.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "firmware/boards/power_management/parts.hpp"
#include "firmware/drivers/bus.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
namespace boards = firmware::boards;

namespace {

/// All that a board hears of its parts comes from the input; at its end no part answers any more.
struct Noise {
  std::span<const std::uint8_t> bytes;
  std::uint8_t next() {
    if (bytes.empty()) return 0;
    const std::uint8_t first = bytes.front();
    bytes = bytes.subspan(1);
    return first;
  }
  /// Not inlined: GCC 12 takes an empty read for one that is written to.
  [[gnu::noinline]] base::Status fill(std::span<std::uint8_t> read) {
    if (bytes.empty()) return base::Error::no_answer;
    const std::uint8_t how = next();
    if (how < 16) return how < 8 ? base::Error::no_answer : base::Error::bus_fault;
    for (std::uint8_t& byte : read) byte = next();
    return {};
  }
};

struct NoisyI2c {
  Noise* noise;
  base::Status transfer(std::uint8_t, std::span<const std::uint8_t>, std::span<std::uint8_t> read) {
    return noise->fill(read);
  }
};
struct NoisySpi {
  Noise* noise;
  base::Status transfer(const firmware::drivers::SpiSettings&, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) {
    fuzz::expect(out.size() == in.size(), "a full-duplex transfer is as long both ways");
    return noise->fill(in);
  }
};
struct NoisyMotors {
  Noise* noise;
  std::array<std::uint16_t, 2> encoders() {
    const auto count = [this] { return static_cast<std::uint16_t>(noise->next() | noise->next() << 8); };
    return {count(), count()};
  }
  void set_duty(std::int16_t left, std::int16_t right) {
    fuzz::expect(left != INT16_MIN && right != INT16_MIN, "a duty is at most full");
  }
};
struct NoisyPins {
  Noise* noise;
  std::uint8_t read() { return noise->next(); }
  void write(std::uint8_t) {}
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Noise noise{{data, size}};
  NoisyI2c i2c{&noise};
  NoisySpi spi{&noise};
  NoisyMotors motors{&noise};
  NoisyPins pins{&noise};
  boards::di_wheel_drive::Parts<NoisyI2c, NoisyI2c, NoisySpi, NoisySpi, NoisyMotors, NoisyPins> bottom{
      i2c, i2c, spi, spi, motors, pins};
  boards::power_management::Parts<NoisyI2c, NoisyI2c, NoisyPins> middle{i2c, i2c, pins};

  base::Time now{};
  bottom.start(now);
  middle.start(now);
  for (int step = 0; step < 300 && !noise.bytes.empty(); ++step) {
    now += std::chrono::milliseconds{10};
    bottom.maintain(now);
    middle.maintain(now);
    (void)bottom.gyroscope();
    (void)bottom.accelerometer();
    if (const auto field = bottom.magnetometer())
      fuzz::expect(std::abs(field->x) <= 2560 * 2048 && std::abs(field->y) <= 2560 * 2048,
                   "a field is within the part's range");
    (void)bottom.floor();
    (void)bottom.encoders();
    bottom.set_wheels({noise.next() / 100.0 - 1, noise.next() / 10.0 - 12});
    bottom.control();
    if (const auto gauge = middle.gauge())
      fuzz::expect(gauge->state_of_charge_percent <= 100, "a state of charge is at most 100 %");
    (void)middle.ring();
    (void)middle.batteries();
    (void)middle.ring_light();
    if (step == 20) {
      (void)bottom.calibrate_floor(noise.next() < 128);
      (void)middle.calibrate_ring(noise.next() < 128);
    }
  }
  return 0;
}
