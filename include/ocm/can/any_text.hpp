/// Frames of either kind as text, in the notation of can-utils: classic ones as in text.hpp, CAN FD ones with
/// two `#`, a hex digit of flags (1 BRS, 2 ESI, 4 FDF, which need not be given) and their data:
/// `123##1DEAD`, `1F334455##0`. [can-utils lib.h, cansend.c] Both ways, constexpr, no heap.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/can/text.hpp"

namespace ocm::can {

using AnyFrameText = base::Text<8 + 3 + 2 * max_fd_length>;

/// Longest: an extended CAN FD frame of 64 bytes, 139 characters. The flags digit is without FDF, as
/// candump's is.
[[nodiscard]] constexpr AnyFrameText to_text(const AnyFrame& frame) noexcept {
  AnyFrameText out;
  if (const auto classic = frame.classic()) {
    out << to_text(*classic).view();
    return out;
  }
  out.hex(frame.id, is_extended(frame.format) ? 8 : 3) << "##";
  out.hex(frame.flags & std::uint32_t{frame_flag::bit_rate_switch | frame_flag::error_state}, 1);
  for (const std::uint8_t byte : frame.bytes()) out.hex(byte, 2);
  return out;
}

/// Reads what `to_text` writes, lower-case too, and single dots between data bytes. Refuses with bad_syntax,
/// bad_identifier, bad_length (a length that such a frame cannot have). A flag that CAN FD does not have (8)
/// is kept, as can-utils keep it; `validate` refuses it.
[[nodiscard]] constexpr base::Result<AnyFrame> parse_any_frame(std::string_view text) noexcept {
  using base::Error;
  const auto hashes = text.find("##");
  if (hashes == std::string_view::npos || hashes != text.find('#')) {
    const auto classic = parse_frame(text);
    if (!classic) return classic.error;
    return AnyFrame{*classic};
  }
  const auto head = parse_frame(text.substr(0, hashes + 1));  // an identifier without data
  if (!head) return head.error;
  if (head->format == Format::error) return Error::bad_syntax;
  AnyFrame frame{*head};
  text.remove_prefix(hashes + 2);
  const int flags = text.empty() ? -1 : base::hex_digit(text.front());
  if (flags < 0) return Error::bad_syntax;
  frame.flags = static_cast<std::uint8_t>(static_cast<unsigned>(flags) | frame_flag::fd);
  text.remove_prefix(1);
  for (std::size_t i = 0; i < text.size(); i += 2) {
    if (text[i] == '.' && i > 0) ++i;  // one, between bytes
    if (i + 1 >= text.size()) return Error::bad_syntax;
    const int high = base::hex_digit(text[i]);
    const int low = base::hex_digit(text[i + 1]);
    if (high < 0 || low < 0) return Error::bad_syntax;
    if (frame.length == max_fd_length) return Error::bad_length;
    frame.data[frame.length++] = static_cast<std::uint8_t>(high << 4 | low);
  }
  if (is_remote(frame.format)) return Error::bad_syntax;
  if (!is_fd_length(frame.length)) return Error::bad_length;
  return frame;
}

}  // namespace ocm::can
