/// A robot's dongle, in virtual time: what the robot writes comes over a UART byte by byte, is cut into
/// packets and waits for the radio. [Thesis 2, 4.3.2]
///
/// What is written without a link goes nowhere, and what waits when a link ends goes with it: the next
/// connection hears none of it. A packet that finds no room is lost, the rest of its line goes on: that is a
/// torn sentence. All of it is counted.
///
/// Nothing happens by itself: bytes whose time has come are cut when a member is called. O(bytes). Host side.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/link/packet.hpp"

namespace ocm::simulation {

/// Makes packets of a stream: one ends with a line feed, or when it is full.
class PacketCutter {
 public:
  /// Whether the byte completes a packet, which is then to be taken.
  constexpr bool feed(std::uint8_t byte) noexcept {
    (void)packet_.push(byte);
    return packet_.full() || byte == '\n';
  }
  /// What there is, whole or begun; the next packet begins.
  constexpr mapper::link::Packet take() noexcept {
    const mapper::link::Packet packet = packet_;
    packet_ = {};
    return packet;
  }
  /// Bytes of the packet that has begun.
  [[nodiscard]] constexpr std::size_t begun() const noexcept { return packet_.size; }

 private:
  mapper::link::Packet packet_{};
};

struct DongleModel {
  /// Of the UART, at ten bits a byte, at least 1. [nRF5 SDK, UART example, and thesis 2, appendix E]
  std::uint32_t baud = 38'400;
  std::size_t uart_room = 256;  ///< bytes that may wait for the UART
};

/// What was not sent, and why.
struct DongleCounters {
  std::uint64_t unlinked = 0;  ///< bytes written without a link
  std::uint64_t refused = 0;   ///< bytes that the UART had no room for: the writer knows
  std::uint64_t dropped = 0;   ///< bytes that had not become a packet when the link ended
  friend bool operator==(const DongleCounters&, const DongleCounters&) = default;
};

/// `Waiting`: packets that may wait for the radio; `outbox` counts those that found no room and those that
/// went with a link.
template <std::size_t Waiting = 16>
class Dongle {
 public:
  explicit Dongle(const DongleModel& model = {})
      : room_(model.uart_room), byte_(10'000'000'000 / std::max(model.baud, 1U)) {}

  /// The pin: there is a link.
  [[nodiscard]] bool linked() const noexcept { return linked_; }

  /// From the robot; how many bytes found room, the first ones. Without a link all do, and go nowhere.
  std::size_t write(std::span<const std::uint8_t> bytes, base::Time now) {
    if (!linked_) {
      counters_.unlinked += bytes.size();
      return bytes.size();
    }
    work(now);
    const std::size_t taken = std::min(bytes.size(), room_ - std::min(room_, uart_.size()));
    if (uart_.empty()) first_ = now + byte_;
    uart_.insert(uart_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    counters_.refused += bytes.size() - taken;
    return taken;
  }
  /// The radio has room: the oldest packet, or Error::no_answer.
  base::Result<mapper::link::Packet> take(base::Time now) {
    work(now);
    return outbox_.take();
  }
  /// The radio says whether there is a link.
  void link(bool up, base::Time now) {
    if (linked_ == up) return;
    work(now);
    linked_ = up;
    counters_.dropped += uart_.size() + cutter_.begun();
    uart_.clear();
    (void)cutter_.take();
    (void)outbox_.drop_all();
  }

  [[nodiscard]] const DongleCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const mapper::link::OutboxCounters& outbox() const noexcept { return outbox_.counters(); }

 private:
  /// The bytes that the UART has carried until now.
  void work(base::Time now) {
    for (; !uart_.empty() && first_ <= now; first_ += byte_) {
      if (cutter_.feed(uart_.front())) (void)outbox_.put(cutter_.take());
      uart_.pop_front();
    }
  }

  std::size_t room_;
  base::Duration byte_;  ///< time of one on the UART
  std::deque<std::uint8_t> uart_;
  base::Time first_{};  ///< when the first that waits is over
  PacketCutter cutter_;
  mapper::link::Outbox<Waiting> outbox_;
  bool linked_ = false;
  DongleCounters counters_;
};

}  // namespace ocm::simulation
