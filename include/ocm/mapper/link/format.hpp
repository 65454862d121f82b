/// Text or packed updates: how robot and server agree. A robot that can pack says so in the field `formats`
/// of its handshake; a server that chooses it says `{S,BIN}` before it confirms. Older robots never offer,
/// older servers never ask, and both stay with text. Every link begins with text. A server reads both forms
/// at any time, so that no lost sentence parts the two.
///
/// No heap, constexpr; O(1).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/mapper/link/packed.hpp"
#include "ocm/mapper/link/packet.hpp"
#include "ocm/mapper/link/sentence.hpp"

namespace ocm::mapper::link {

[[nodiscard]] constexpr bool offers_packed(const Handshake& handshake) noexcept {
  constexpr std::uint8_t with_formats = 10;  // integers; older robots say no more
  return handshake.given >= with_formats && handshake.formats == Handshake::packed_offer;
}

/// What a server answers to a handshake: `{S,CON}`, and before it `{S,BIN}` where that is chosen and offered.
[[nodiscard]] constexpr base::Text<16> answer(const Handshake& handshake, bool want_packed) noexcept {
  base::Text<16> lines;
  if (want_packed && offers_packed(handshake)) lines << write(Kind::packed)->view();
  return lines << write(Kind::confirm)->view();
}

/// The robot's side: which form its updates have, and their numbers.
class UpdateWriter {
 public:
  /// `can_pack`: whether this robot offers it; if not, it does not listen either.
  constexpr explicit UpdateWriter(bool can_pack) noexcept : can_pack_(can_pack) {}

  /// A sentence from the server; only those about the form matter here.
  constexpr void hear(Kind kind) noexcept {
    if (kind == Kind::packed && can_pack_) packed_ = true;
    if (kind == Kind::text) packed_ = false;
  }
  /// A new link: text, numbers from 0.
  constexpr void restart() noexcept {
    packed_ = false;
    sequence_ = 0;
  }
  /// One update into the queue, whole or not at all. Error::out_of_range, and nothing queued, when a field
  /// is. An update for which the queue has no room, Error::full, takes a number: the server sees that one is
  /// missing.
  template <std::size_t N>
  constexpr base::Status send(const Update& update, Outbox<N>& outbox) noexcept {
    if (!packed_) {
      const auto line = write(update);
      return line ? outbox.put(line->view()) : base::Status{line.error};
    }
    const auto packet = pack({sequence_, update});
    if (!packet) return packet.error;
    ++sequence_;
    return outbox.put(*packet);
  }
  [[nodiscard]] constexpr bool packed() const noexcept { return packed_; }
  /// What goes into `Handshake::formats`.
  [[nodiscard]] constexpr std::int16_t offer() const noexcept {
    return can_pack_ ? Handshake::packed_offer : std::int16_t{0};
  }

 private:
  bool can_pack_;
  bool packed_ = false;
  std::uint8_t sequence_ = 0;
};

}  // namespace ocm::mapper::link
