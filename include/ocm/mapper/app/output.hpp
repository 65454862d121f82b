/// What a mapper says: sentences, written and handed to the dongle's UART, by whichever task has
/// something to say. One at a time, under a mutex with priority inheritance. [T2 table 6.3, xUartMutex]
///
/// Nothing is kept: a sentence goes to the UART now, or not at all, so nothing can be said to a later link
/// that was meant for an earlier one. What the UART has no room for is lost and counted, together with the
/// rest of its sentence. 100 bytes of stack for the packets of one sentence; no heap.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/mapper/app/parts.hpp"
#include "ocm/mapper/link/format.hpp"
#include "ocm/mapper/link/packet.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/scheduling/resource.hpp"

namespace ocm::mapper::app {

/// What became of sentences. They wrap.
struct OutputCounters {
  std::uint32_t unsent = 0;        ///< the link was gone
  std::uint32_t out_of_range = 0;  ///< numbers that no sentence holds
  std::uint32_t full = 0;          ///< bytes without room
};

template <RobotParts Parts, class Clock, scheduling::Lockable Mutex>
class Output {
 public:
  Output(Parts& parts, Clock& clock, bool can_pack) noexcept
      : parts_(&parts), uart_(clock), writer_(can_pack) {}

  /// `alive()`: whether the link that it is meant for is still there; asked last of all. True: it was sent,
  /// all of it.
  template <class Alive>
  bool say(link::Kind kind, Alive alive) noexcept {
    return say(link::write(kind), alive);
  }
  template <class Alive>
  bool say(const link::Calibration& calibration, Alive alive) noexcept {
    return say(link::write(calibration), alive);
  }
  template <class Alive>
  bool say(link::Handshake handshake, Alive alive) noexcept {
    handshake.formats = writer_.offer();  // the same at any time
    return say(link::write(handshake), alive);
  }
  template <class Alive>
  bool say(const link::Update& update, Alive alive) noexcept {
    return send(alive, [this, &update](Packets& packets) { return writer_.send(update, packets); });
  }

  /// The form that the operator asked for.
  void hear(link::Kind kind) noexcept {
    [[maybe_unused]] const auto claim = uart_.claim();
    writer_.hear(kind);
  }
  /// A new link.
  void restart() noexcept {
    [[maybe_unused]] const auto claim = uart_.claim();
    writer_.restart();
  }

  [[nodiscard]] OutputCounters counters() noexcept {
    [[maybe_unused]] const auto claim = uart_.claim();
    return counters_;
  }

 private:
  using Packets = link::Outbox<link::packets_of(link::max_line)>;

  template <class Alive>
  bool say(const base::Result<link::Line>& line, Alive alive) noexcept {
    return send(alive, [&line](Packets& packets) { return line ? packets.put(line->view()) : line.error; });
  }
  template <class Alive, class Write>
  bool send(Alive alive, Write write) noexcept {
    Packets packets;
    [[maybe_unused]] const auto claim = uart_.claim();
    if (!alive()) {
      ++counters_.unsent;
      return false;
    }
    if (!write(packets).ok()) {  // there is room for the longest sentence
      ++counters_.out_of_range;
      return false;
    }
    std::size_t lost = 0;
    for (auto packet = packets.take(); packet; packet = packets.take()) {
      const auto bytes = packet->bytes();
      lost += bytes.size();
      if (lost == bytes.size()) lost -= parts_->send(bytes);  // nothing of this sentence was lost before
    }
    counters_.full += static_cast<std::uint32_t>(lost);
    return lost == 0;
  }

  Parts* parts_;
  scheduling::Resource<Mutex, Clock> uart_;
  link::UpdateWriter writer_;
  OutputCounters counters_{};
};

}  // namespace ocm::mapper::app
