/// Packets of the radio: at most 20 bytes of a link's stream each, so that an update spans two to four; and
/// the queue in which they wait for the radio.
///
/// No heap, constexpr. `Outbox<N>` takes 21 bytes a packet; a line goes in whole or not at all, and what is
/// not sent is counted. When a link dies its queue goes with it: the next connection hears nothing of the
/// last. [Thesis 2, 4.5.2]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/mapper/link/sentences.hpp"

namespace ocm::mapper::link {

struct Packet {
  std::uint8_t size = 0;
  std::array<std::uint8_t, max_packet> data{};

  [[nodiscard]] constexpr std::span<const std::uint8_t> bytes() const noexcept { return {data.data(), size}; }
  [[nodiscard]] constexpr bool full() const noexcept { return size == max_packet; }
  /// False, and nothing happens, when it is full.
  constexpr bool push(std::uint8_t byte) noexcept {
    if (full()) return false;
    data[size++] = byte;
    return true;
  }
  friend constexpr bool operator==(const Packet& a, const Packet& b) noexcept {
    if (a.size != b.size) return false;
    for (std::size_t i = 0; i < a.size; ++i)
      if (a.data[i] != b.data[i]) return false;
    return true;
  }
};

[[nodiscard]] constexpr std::size_t packets_of(std::size_t bytes) noexcept {
  return (bytes + max_packet - 1) / max_packet;
}

/// The first packet of `text`, which then begins behind it; empty when there is nothing left.
[[nodiscard]] constexpr Packet take_packet(std::string_view& text) noexcept {
  Packet packet;
  while (!text.empty() && packet.push(static_cast<std::uint8_t>(text.front()))) text.remove_prefix(1);
  return packet;
}

/// What became of packets. They wrap.
struct OutboxCounters {
  std::uint32_t sent = 0;     ///< taken by the radio
  std::uint32_t refused = 0;  ///< there was no room: each a packet, or those of a line
  std::uint32_t dropped = 0;  ///< waited for a link that died
  friend constexpr bool operator==(const OutboxCounters&, const OutboxCounters&) = default;
};

/// Packets that wait for the radio, oldest first.
template <std::size_t N>
class Outbox {
 public:
  /// Error::full, and nothing changes but the counter, when not all of it has room.
  constexpr base::Status put(std::string_view line) noexcept {
    const std::size_t count = packets_of(line.size());
    if (count > N - size_) {
      counters_.refused += static_cast<std::uint32_t>(count);
      return base::Error::full;
    }
    for (; !line.empty(); ++size_) packets_[(first_ + size_) % N] = take_packet(line);
    return {};
  }
  constexpr base::Status put(const Packet& packet) noexcept {
    if (size_ == N) {
      ++counters_.refused;
      return base::Error::full;
    }
    packets_[(first_ + size_++) % N] = packet;
    return {};
  }
  /// The oldest, which is then the radio's; Error::no_answer when none waits.
  constexpr base::Result<Packet> take() noexcept {
    if (size_ == 0) return base::Error::no_answer;
    const Packet packet = packets_[first_];
    first_ = (first_ + 1) % N;
    --size_;
    ++counters_.sent;
    return packet;
  }
  /// The link is dead. How many packets waited.
  constexpr std::size_t drop_all() noexcept {
    const std::size_t count = size_;
    counters_.dropped += static_cast<std::uint32_t>(count);
    size_ = 0;
    return count;
  }
  [[nodiscard]] constexpr std::size_t size() const noexcept { return size_; }
  [[nodiscard]] constexpr const OutboxCounters& counters() const noexcept { return counters_; }

 private:
  std::array<Packet, N> packets_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  OutboxCounters counters_{};
};

}  // namespace ocm::mapper::link
