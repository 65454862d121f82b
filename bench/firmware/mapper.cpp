// Instructions of the mapper's steps on a Cortex-M: the estimator, the pose controller, sentences read
// and written. On QEMU's machines with -icount shift=0, where an instruction takes a nanosecond, and TIM2
// counts nanoseconds. bench/firmware/run mapper
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string_view>

#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/link/format.hpp"
#include "ocm/mapper/link/packet.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"
#include "ocm/motion/pose_controller.hpp"
#include "ocm/motion/pose_estimator.hpp"

#include "bench/firmware/counter.hpp"

using namespace ocm;

namespace {

/// Of many calls.
struct Cost {
  std::uint32_t sum = 0;
  std::uint32_t calls = 0;
  std::uint32_t greatest = 0;
  void add(std::uint32_t instructions) {
    sum += instructions;
    ++calls;
    if (instructions > greatest) greatest = instructions;
  }
  void print(const char* what) const {
    std::printf("%s: %lu %lu\n", what, static_cast<unsigned long>(sum / calls),
                static_cast<unsigned long>(greatest));
  }
};

constexpr auto& model = mapper::app::avr_robot;
constexpr float dt_s = 0.030F;

/// A robot that turns by 90 degrees and drives 60 cm, as its controller tells it, estimator and controller in
/// turn, on ideal wheels; then stands.
bool drive() {
  motion::Estimate estimate;
  motion::PoseController controller;
  motion::PoseCommand command;
  std::array<Cost, 3> estimating, controlling;  // by motion::Movement
  controller = motion::started(controller, motion::set_point(90, 60), estimate.pose);
  float left = 0, right = 0, heading = 0;
  bool arrived = false;
  for (int step = 0; step < 1200; ++step) {
    const auto efforts = motion::mixed(command.ahead, command.turn);
    left += efforts.left * model.motors.most_ticks_s * dt_s;
    right += efforts.right * model.motors.most_ticks_s * dt_s;
    const float per_tick =
        motion::two_pi * model.estimator.drive.wheel_radius_m / model.estimator.drive.ticks_per_turn;
    const float rate = (efforts.right - efforts.left) * model.motors.most_ticks_s * per_tick /
                       model.estimator.drive.wheelbase_m;
    heading += rate * dt_s;
    const motion::EstimatorReadings readings{
        .left_ticks = static_cast<std::uint32_t>(static_cast<std::int32_t>(left)),
        .right_ticks = static_cast<std::uint32_t>(static_cast<std::int32_t>(right)),
        .gyro_rad_s = rate + 0.001F,
        .compass_rad = motion::wrap(heading + 0.01F),
        .movement = command.movement};
    const auto movement = static_cast<std::size_t>(command.movement);
    estimating[movement].add(
        cost([&] { estimate = motion::estimate(estimate, readings, dt_s, model.estimator); }));
    motion::PoseControllerStep made;
    controlling[movement].add(
        cost([&] { made = motion::control(controller, estimate.pose, dt_s, model.controller); }));
    controller = made.state;
    command = made.command;
    arrived = arrived || command.arrived;
  }
  using motion::Movement;
  const auto of = [](auto& costs, Movement movement) -> const Cost& {
    return costs[static_cast<std::size_t>(movement)];
  };
  of(estimating, Movement::rotating).print("estimator step, rotating");
  of(estimating, Movement::straight).print("estimator step, straight");
  of(estimating, Movement::standing).print("estimator step, standing, compass");
  of(controlling, Movement::rotating).print("pose controller step, rotating");
  of(controlling, Movement::straight).print("pose controller step, straight");
  return arrived && motion::is_finite(estimate.pose);
}

bool read(std::string_view text) {
  static mapper::link::Reader reader{mapper::link::Direction::to_robot};
  mapper::link::Kind kind{};
  Cost characters;
  std::uint32_t whole = 0;
  for (const char c : text) {
    const std::uint32_t instructions = cost([&] {
      if (const auto heard = reader.feed(c); heard != mapper::link::Kind::none) kind = heard;
    });
    characters.add(instructions);
    whole += instructions;
  }
  std::printf("read %.*s: %lu %lu\n", static_cast<int>(text.size() - 1), text.data(),
              static_cast<unsigned long>(whole), static_cast<unsigned long>(characters.greatest));
  return kind != mapper::link::Kind::none;
}

bool write() {
  mapper::link::Update update{-123, 456, 178, 44, 80, 0, 33, 12};
  mapper::link::Handshake hello = model.handshake;
  asm volatile("" ::"r"(&update), "r"(&hello) : "memory");  // nothing of it is known beforehand
  base::Result<mapper::link::Line> text;
  Cost as_text, as_packed, queued, shaken;
  as_text.add(cost([&] { text = mapper::link::write(update); }));
  base::Result<mapper::link::Packet> packed;
  as_packed.add(cost([&] { packed = mapper::link::pack({7, update}); }));
  mapper::link::UpdateWriter writer{true};
  mapper::link::Outbox<4> outbox;
  queued.add(cost([&] { (void)writer.send(update, outbox); }));
  base::Result<mapper::link::Line> handshake;
  shaken.add(cost([&] { handshake = mapper::link::write(hello); }));
  as_text.print("write an update, 31 characters");
  queued.print("the same, into packets");
  as_packed.print("write an update packed, CRC included");
  shaken.print("write a handshake, 37 characters");
  return text->view() == "{U,-123,456,178,44,80,0,33,12}\n" && packed.ok() && handshake.ok() &&
         outbox.size() == 2;
}

}  // namespace

int main() {
  tim2_cr1 = 1;
  empty = cost([] {});
  return drive() && read("{U,-90,130}\n") && read("{S,CON}\n") && read("{}\n") && write() ? 0 : 1;
}
