/// This machine in place of the central dongle: robots on serial lines, behind the central's own commands. A
/// line that is there is "found", one that is open is a link, one that is unplugged is a link that is lost.
///
/// Bytes of a robot are cut into packets as its dongle would: 20 of them, or at a line feed; or when the line
/// has fallen silent. Never waits. What cannot be passed on is counted.
#pragma once

#include <cstdint>
#include <memory>
#include <poll.h>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/mapper/link/central.hpp"
#include "ocm/simulation/dongle.hpp"
#include "ocm/transport/serial_port.hpp"

namespace ocm::cli::central {

struct RobotLine {
  std::string name;
  std::string path;
};

struct SwitchboardOptions {
  std::vector<RobotLine> robots;
  std::string folder;  ///< without `robots`: all lines in it, looked at with each `start`
  std::uint32_t baud = 38'400;
};

class Switchboard {
 public:
  static constexpr std::size_t max_robots = 64;
  /// What the server has not read yet; a robot's packet that would make it more is lost.
  static constexpr std::size_t max_output = 65'536;

  explicit Switchboard(SwitchboardOptions options);

  /// What the server types.
  void feed(std::string_view text, base::Time now);
  /// Everything else that can be done without waiting: reads the lines and writes to them.
  void work(base::Time now);
  /// When there is something to do without input.
  [[nodiscard]] base::Time due() const noexcept { return due_; }
  void watch(std::vector<pollfd>& inputs) const;

  /// For the server; what takes from it calls back.
  [[nodiscard]] std::string_view output() const noexcept { return output_; }
  void taken(std::size_t size) { output_.erase(0, size); }
  /// No server hears it.
  void discard();

  /// Whether robots' packets wait for their lines.
  [[nodiscard]] bool busy() const;
  /// On stderr, what went where and what did not.
  void print_summary() const;

  // --- as the central's port (mapper::link::CentralPort); not for others ---
  void say(std::string_view text) { output_ += text; }
  void start_scan();
  void stop_scan() { scanning_ = false; }
  void connect(const mapper::link::Address& address) { wire(address).order = Order::open; }
  void disconnect(const mapper::link::Address& address) { wire(address).order = Order::close; }
  void restart();

 private:
  enum class Order : std::uint8_t { none, open, close };
  struct Wire {
    RobotLine robot;
    mapper::link::Address address{};
    transport::SerialPort port{};
    Order order = Order::none;
    base::Time close_at{};  ///< of an order to close: what is under way has until then
    simulation::PacketCutter cutter{};
    base::Time last_byte{};
    std::string out{};                                ///< of a packet, what the line has not taken yet
    std::uint64_t links = 0, from_it = 0, to_it = 0;  ///< packets
    std::uint64_t unheard = 0;                        ///< packets that the server did not read
    std::uint64_t unsent = 0;  ///< bytes that its line did not take before it was closed
  };
  using Central = mapper::link::Central<max_robots, max_robots, 64>;

  void add(RobotLine robot);
  [[nodiscard]] Wire& wire(const mapper::link::Address& address);
  void look_for_robots();
  void settle(Wire& wire, base::Time now);
  void open(Wire& wire);
  void close(Wire& wire);
  void read(Wire& wire, base::Time now);
  void hand_over(Wire& wire);
  void write(Wire& wire);
  void lose(Wire& wire);

  SwitchboardOptions options_;
  std::unique_ptr<Central> central_;
  std::vector<std::unique_ptr<Wire>> wires_;
  std::string output_;
  std::uint64_t unheard_bytes_ = 0;
  bool scanning_ = false;
  base::Time look_again_{};
  base::Time due_{};
};

}  // namespace ocm::cli::central
