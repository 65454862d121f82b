#include "cli/central/switchboard.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <span>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/transport/pty.hpp"

#include "cli/shared/messages.hpp"

namespace ocm::cli::central {
namespace {

using namespace std::chrono_literals;

/// Longer than any serial adapter keeps a byte for company.
constexpr base::Duration silence = 20ms;
constexpr base::Duration scan_period = 250ms;
/// A line that is closed may still send what it has.
constexpr base::Duration farewell = 300ms;

/// Locally administered. [IEEE 802, the second bit]
mapper::link::Address address_of(std::size_t number) {
  return {0x02, 0, 0, 0, static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)};
}

/// Without opening it: that would reset many an Arduino.
bool is_there(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && S_ISCHR(status.st_mode) &&
         ::access(path.c_str(), R_OK | W_OK) == 0;
}

}  // namespace

Switchboard::Switchboard(SwitchboardOptions options)
    : options_(std::move(options)), central_(std::make_unique<Central>()) {
  for (const RobotLine& robot : options_.robots) add(robot);
}

void Switchboard::add(RobotLine robot) {
  auto wire = std::make_unique<Wire>();
  wire->robot = std::move(robot);
  wire->address = address_of(wires_.size());
  wires_.push_back(std::move(wire));
}
Switchboard::Wire& Switchboard::wire(const mapper::link::Address& address) {
  return *wires_[static_cast<std::size_t>(address[4] << 8 | address[5])];
}

// --- the server ---

void Switchboard::feed(std::string_view text, base::Time now) {
  for (const char c : text) {
    central_->feed(c, *this);
    if (c != '\n' && c != '*') continue;
    for (const auto& wire : wires_) settle(*wire, now);
  }
}
void Switchboard::discard() {
  unheard_bytes_ += output_.size();
  output_.clear();
}

// --- serial lines in place of a radio ---

void Switchboard::start_scan() {
  scanning_ = true;
  look_again_ = {};
  if (!options_.folder.empty()) {
    std::error_code error;
    std::vector<RobotLine> found;
    for (const auto& entry : std::filesystem::directory_iterator{options_.folder, error})
      if (entry.path().extension() != ".lock")
        found.push_back({transport::robot_of_line(entry.path().filename().string()), entry.path().string()});
    std::sort(found.begin(), found.end(),
              [](const RobotLine& a, const RobotLine& b) { return a.path < b.path; });
    for (RobotLine& robot : found) {
      const bool known = std::any_of(wires_.begin(), wires_.end(),
                                     [&](const auto& wire) { return wire->robot.path == robot.path; });
      if (!known && wires_.size() < max_robots) add(std::move(robot));
    }
  }
  look_for_robots();
}
void Switchboard::look_for_robots() {
  for (const auto& wire : wires_) {
    const bool simulated = !options_.folder.empty();
    if (wire->port || !is_there(wire->robot.path)) continue;
    if (!simulated || transport::is_served(wire->robot.path))
      central_->found(wire->address, wire->robot.name, *this);
  }
}
void Switchboard::restart() {
  scanning_ = false;
  for (const auto& wire : wires_) {
    wire->order = Order::none;
    close(*wire);
  }
}

// --- the lines ---

void Switchboard::settle(Wire& wire, base::Time now) {
  if (wire.order == Order::open && !wire.port) {
    wire.order = Order::none;
    open(wire);
  }
  if (wire.order == Order::close) {
    if (wire.close_at == base::Time{}) wire.close_at = now + farewell;
    const bool sends = wire.port && (!wire.out.empty() || wire.port.unsent() != 0);
    if (!sends || now >= wire.close_at) {
      wire.order = Order::none;
      close(wire);
      central_->closed(wire.address, *this);
    }
  }
  if (wire.port) write(wire);
}
void Switchboard::open(Wire& wire) {
  auto opened = transport::SerialPort::open(wire.robot.path, options_.baud);
  if (!opened) {
    remark(fmt::format("{}: {}", wire.robot.name, opened.error.what));
    remark(fmt::format("{:>{}}  {}", "", wire.robot.name.size(), opened.error.remedy));
    return central_->closed(wire.address, *this);
  }
  wire.port = std::move(*opened);
  ++wire.links;
  central_->connected(wire.address, *this);
}
void Switchboard::close(Wire& wire) {
  wire.close_at = {};
  wire.unsent += wire.out.size() + (wire.port ? wire.port.unsent() : 0);
  wire.out.clear();
  (void)wire.cutter.take();
  wire.port.close();
}
void Switchboard::lose(Wire& wire) {
  remark(fmt::format("{}: {}", wire.robot.name, wire.port.failure().what));
  if (wire.cutter.begun() != 0) hand_over(wire);
  wire.order = Order::none;
  close(wire);
  central_->closed(wire.address, *this);
}

void Switchboard::work(base::Time now) {
  for (const auto& wire : wires_) {
    if (wire->port) read(*wire, now);
    settle(*wire, now);
  }
  if (scanning_ && now >= look_again_) {
    look_again_ = now + scan_period;
    look_for_robots();
  }
  due_ = scanning_ ? look_again_ : base::never;
  for (const auto& wire : wires_) {
    if (wire->cutter.begun() != 0) due_ = std::min(due_, wire->last_byte + silence);
    if (wire->order == Order::close) due_ = std::min(due_, now + 2ms);
  }
}
void Switchboard::read(Wire& wire, base::Time now) {
  std::array<char, 4096> room;  // NOLINT: filled by the kernel
  const auto size = wire.port.read(room);
  if (!size) return lose(wire);
  for (const char c : std::span{room}.first(*size)) {
    wire.last_byte = now;
    if (wire.cutter.feed(static_cast<std::uint8_t>(c))) hand_over(wire);
  }
  if (wire.cutter.begun() != 0 && now - wire.last_byte >= silence) hand_over(wire);
}
void Switchboard::hand_over(Wire& wire) {
  const mapper::link::Packet packet = wire.cutter.take();
  ++wire.from_it;
  if (output_.size() + packet.size + mapper::link::write_prefix(255, wire.robot.name).view().size() >
      max_output)
    ++wire.unheard;
  else
    central_->heard(wire.address, packet.bytes(), *this);
}
void Switchboard::write(Wire& wire) {
  for (;;) {
    if (wire.out.empty()) {
      const auto packet = central_->take(wire.address);
      if (!packet) return;
      for (const std::uint8_t byte : packet->bytes()) wire.out += static_cast<char>(byte);
      ++wire.to_it;
    }
    const auto taken = wire.port.write(wire.out);
    if (!taken) return lose(wire);
    wire.out.erase(0, *taken);
    if (!wire.out.empty()) return;
  }
}

void Switchboard::watch(std::vector<pollfd>& inputs) const {
  for (const auto& wire : wires_)
    if (wire->port)
      inputs.push_back(
          {wire->port.descriptor(), static_cast<short>(POLLIN | (wire->out.empty() ? 0 : POLLOUT)), 0});
}
bool Switchboard::busy() const {
  return central_->waiting() != 0 || std::any_of(wires_.begin(), wires_.end(), [](const auto& wire) {
           return wire->order != Order::none ||
                  (wire->port && (!wire->out.empty() || wire->port.unsent() != 0));
         });
}

// --- the end ---

void Switchboard::print_summary() const {
  std::size_t width = 6;
  for (const auto& wire : wires_) width = std::max(width, wire->robot.name.size());
  for (const auto& wire : wires_) {
    std::string text = fmt::format("{:<{}}  links {}, packets from it {}, to it {}", wire->robot.name, width,
                                   wire->links, wire->from_it, wire->to_it);
    if (wire->unheard != 0) text += fmt::format(", {} lost: the server did not read", wire->unheard);
    if (wire->unsent != 0) text += fmt::format(", {} not sent", counted(wire->unsent, "byte"));
    remark(text);
  }
  const mapper::link::CentralCounters& counters = central_->counters();
  std::string text;
  const auto add = [&text](std::uint64_t count, std::string_view what) {
    if (count != 0) text += (text.empty() ? "" : ", ") + counted(count, what);
  };
  add(counters.refused_commands, "command* refused");
  add(counters.unsent_bytes, "byte* for links that were gone or full");
  add(counters.dropped_packets, "packet* dropped with a link");
  add(central_->waiting(), "packet* not sent at the end");
  add(counters.unlisted, "robot* beyond the list");
  add(counters.stray_reports, "stray report");
  add(unheard_bytes_, "byte* sent with no server connected");
  remark(fmt::format("{:<{}}  {}", "server", width, text.empty() ? "nothing was lost" : text));
}

}  // namespace ocm::cli::central
