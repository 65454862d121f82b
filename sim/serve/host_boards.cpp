#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "ocm/protocol/counters.hpp"

#include "sim/amiro/robot.hpp"
#include "sim/serve/boards.hpp"

namespace ocm::sim {
namespace {

class HostBoards final : public Boards {
 public:
  HostBoards(const WorldOptions& world, Ports& ports)
      : ports_(&ports), robot_{world, ports[0], ports[1], ports[2]} {}
  void receive(const can::Frame& frame, base::Time now) override {
    robot_.receive(frame, now, switched_on(*ports_));
  }
  base::Status advance(base::Time now) override {
    robot_.advance(now);
    return {};
  }
  [[nodiscard]] base::Time next_event() const override { return robot_.next_event(); }
  [[nodiscard]] bool waiting() const override { return robot_.waiting(); }
  [[nodiscard]] const World& world() const override { return robot_.world(); }
  void summarise(const Shell& shell) const override {
    shell.report(line(0, robot_.di_wheel_drive().counters()));
    shell.report(line(1, robot_.power_management().counters()));
    shell.report(line(2, robot_.light_ring().counters()));
  }

 private:
  [[nodiscard]] std::string line(std::size_t board, const protocol::Counters& counters) const {
    if (!(*ports_)[board].on) return fmt::format("{:<17} switched off", board_names[board]);
    std::string text;
    protocol::for_each(counters, [&text](std::string_view name, std::uint32_t value) {
      if (value != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, value);
    });
    return fmt::format("{:<17} {}", board_names[board], text.empty() ? "nothing came" : text);
  }

  const Ports* ports_;
  SimulatedRobot<Port> robot_;
};

}  // namespace

std::unique_ptr<Boards> boards_of_the_host(const WorldOptions& world, Ports& ports) {
  return std::make_unique<HostBoards>(world, ports);
}

}  // namespace ocm::sim
