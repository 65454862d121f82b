/// The robot's end of the line protocol and nothing else: says who it is until it is confirmed, answers a
/// ping, and each set point by the update of a robot that is there at once, and `{S,IDL}`. What the line
/// headers are tried with on an 8-bit processor; the same source runs on the host beside it.
///
/// Time and the link are handed in, what it says is taken out packet by packet: no clock, no heap. 0.5 KiB.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/mapper/link/format.hpp"
#include "ocm/mapper/link/packet.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

namespace ocm::firmware::avr {

class LinkEcho {
 public:
  static constexpr std::uint32_t handshake_period_ms = 1000;  ///< [Thesis 2, 6.3]

  /// A byte of the line.
  constexpr void receive(std::uint8_t byte) noexcept {
    const ocm::mapper::link::Kind kind = reader_.feed(static_cast<char>(byte));
    if (kind == ocm::mapper::link::Kind::none || !linked_) return;
    writer_.hear(kind);
    switch (kind) {
      case ocm::mapper::link::Kind::confirm:
        confirmed_ = true;
        return;
      case ocm::mapper::link::Kind::ping:
        return say(ocm::mapper::link::Kind::pong);
      case ocm::mapper::link::Kind::set_point:
        return go(*reader_.sentence().as<ocm::mapper::link::SetPoint>());
      case ocm::mapper::link::Kind::pause:
        paused_ = true;
        return say(ocm::mapper::link::Kind::idle);
      case ocm::mapper::link::Kind::unpause:
        paused_ = false;
        return;
      default:
        return;
    }
  }

  /// To be called at least each few milliseconds.
  constexpr void tick(std::uint32_t now_ms, bool linked) noexcept {
    if (linked != linked_) {
      linked_ = linked;
      reader_.restart();
      writer_.restart();
      (void)outbox_.drop_all();
      confirmed_ = paused_ = false;
      here_ = {};
      next_handshake_ms_ = now_ms;
    }
    if (!linked_ || confirmed_ || static_cast<std::int32_t>(now_ms - next_handshake_ms_) < 0) return;
    next_handshake_ms_ = now_ms + handshake_period_ms;
    ocm::mapper::link::Handshake hello{
        .width = 20, .length = 20, .sensor2 = 90, .sensor3 = 180, .sensor4 = 270, .deadline = 5000};
    hello.formats = writer_.offer();
    count(outbox_.put(ocm::mapper::link::write(hello)->view()));
  }

  /// The oldest packet that is to be sent; Error::no_answer when there is none.
  constexpr base::Result<ocm::mapper::link::Packet> take() noexcept { return outbox_.take(); }

  [[nodiscard]] constexpr const ocm::mapper::link::Reader& reader() const noexcept { return reader_; }
  [[nodiscard]] constexpr const ocm::mapper::link::OutboxCounters& outbox() const noexcept {
    return outbox_.counters();
  }
  /// Sentences and updates that could not be said: no room, or a field beyond its range. It wraps.
  [[nodiscard]] constexpr std::uint16_t unsaid() const noexcept { return unsaid_; }

 private:
  constexpr void go(ocm::mapper::link::SetPoint to) noexcept {
    if (!confirmed_ || paused_) return;
    const int heading = here_.heading + to.angle;
    here_.heading = static_cast<std::int16_t>(heading > 180    ? heading - 360
                                              : heading < -180 ? heading + 360
                                                               : heading);
    here_.x = static_cast<std::int16_t>(static_cast<std::uint16_t>(here_.x) +
                                        static_cast<std::uint16_t>(to.distance));
    count(writer_.send(here_, outbox_));
    say(ocm::mapper::link::Kind::idle);
  }
  constexpr void say(ocm::mapper::link::Kind kind) noexcept {
    count(outbox_.put(ocm::mapper::link::write(kind)->view()));
  }
  constexpr void count(base::Status said) noexcept {
    if (!said) ++unsaid_;
  }

  ocm::mapper::link::Reader reader_{ocm::mapper::link::Direction::to_robot};
  ocm::mapper::link::UpdateWriter writer_{true};
  ocm::mapper::link::Outbox<12> outbox_{};
  ocm::mapper::link::Update here_{};
  std::uint32_t next_handshake_ms_ = 0;
  std::uint16_t unsaid_ = 0;
  bool linked_ = false;
  bool confirmed_ = false;
  bool paused_ = false;
};

}  // namespace ocm::firmware::avr
