#include <cstddef>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "sim/qemu/robot.hpp"
#include "sim/serve/boards.hpp"

namespace ocm::sim {
namespace {

class QemuBoards final : public Boards {
 public:
  QemuBoards(std::unique_ptr<QemuRobot> robot, Ports& ports) : ports_(&ports), robot_(std::move(robot)) {}
  void receive(const can::Frame& frame, base::Time now) override {
    robot_->receive(frame, now, switched_on(*ports_));
  }
  base::Status advance(base::Time now) override {
    return robot_->advance(now, [this](std::size_t board, const can::Frame& frame) {
      const auto taken = (*ports_)[board].send(frame);
      return !taken || *taken;  // what a bus will never take is gone
    });
  }
  [[nodiscard]] base::Time next_event() const override { return base::never; }
  [[nodiscard]] bool waiting() const override {
    return robot_->waiting(0) || robot_->waiting(1) || robot_->waiting(2);
  }
  [[nodiscard]] bool ready() const override { return robot_->ready(); }
  [[nodiscard]] std::vector<int> descriptors() const override {
    const auto all = robot_->descriptors();
    return {all.begin(), all.end()};
  }
  [[nodiscard]] transport::Failure failure() const override { return robot_->failure(); }
  [[nodiscard]] const World& world() const override { return robot_->world(); }
  void summarise(const Shell& shell) const override {
    for (std::size_t i = 0; i < QemuRobot::boards; ++i) {
      const auto& counters = robot_->counters(i);
      shell.report(
          fmt::format("{:<17} sent {}, heard {}, lost on its line {}, garbage {}, exchanges with parts {}",
                      robot_->name(i), counters.sent, counters.heard, counters.deaf, counters.garbage,
                      counters.exchanges));
      for (const std::string& text : robot_->violations(i).texts())
        shell.report(fmt::format("{:<17} against a data sheet: {}", robot_->name(i), text));
    }
  }

 private:
  Ports* ports_;
  std::unique_ptr<QemuRobot> robot_;
};

std::string default_images() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  for (const char* place : {"firmware", "../firmware", "../share/ocm/firmware"}) {
    const auto folder = program.parent_path() / place;
    if (std::filesystem::exists(folder / "light_ring_qemu_m3.elf", error)) return folder.lexically_normal();
  }
  return (program.parent_path() / "firmware").lexically_normal();
}

}  // namespace

transport::Outcome<std::unique_ptr<Boards>> boards_in_qemu(const WorldOptions& world, Ports& ports,
                                                           const std::string& images,
                                                           std::function<base::Time()> clock) {
  auto started = QemuRobot::start(world, images.empty() ? default_images() : images, std::move(clock));
  if (!started) return started.error;
  return std::unique_ptr<Boards>{std::make_unique<QemuBoards>(std::move(*started), ports)};
}

}  // namespace ocm::sim
