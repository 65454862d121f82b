/// What an error frame says, in words. The CAN controller's driver makes them on the host (Format::error);
/// the identifier holds the classes, the data the details. [linux/can/error.h, linux 6.1]
/// constexpr, no heap; one pass over the classes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "ocm/base/text.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::can {

/// Classes: bits of the identifier of an error frame, several at a time.
namespace error_class {
inline constexpr std::uint32_t tx_timeout = 0x001;
inline constexpr std::uint32_t arbitration_lost = 0x002;  ///< data[0]: bit number, 0 unknown
inline constexpr std::uint32_t controller = 0x004;        ///< data[1]: bits of `controller_error`
inline constexpr std::uint32_t protocol = 0x008;     ///< data[2]: bits of `protocol_error`, data[3]: where
inline constexpr std::uint32_t transceiver = 0x010;  ///< data[4]: high nibble CANL, low nibble CANH
inline constexpr std::uint32_t no_acknowledgement = 0x020;
inline constexpr std::uint32_t bus_off = 0x040;
inline constexpr std::uint32_t bus_error = 0x080;
inline constexpr std::uint32_t restarted = 0x100;
inline constexpr std::uint32_t counters =
    0x200;  ///< data[6]: transmit, data[7]: receive; set since linux 6.0
inline constexpr std::uint32_t all = 0x3FF;
}  // namespace error_class

/// Bits of data[1].
namespace controller_error {
inline constexpr std::uint8_t rx_overflow = 0x01;
inline constexpr std::uint8_t tx_overflow = 0x02;
inline constexpr std::uint8_t rx_warning = 0x04;
inline constexpr std::uint8_t tx_warning = 0x08;
inline constexpr std::uint8_t rx_passive = 0x10;
inline constexpr std::uint8_t tx_passive = 0x20;
inline constexpr std::uint8_t active = 0x40;
}  // namespace controller_error

/// Bits of data[2].
namespace protocol_error {
inline constexpr std::uint8_t bit = 0x01;
inline constexpr std::uint8_t form = 0x02;
inline constexpr std::uint8_t stuff = 0x04;
inline constexpr std::uint8_t dominant_bit = 0x08;
inline constexpr std::uint8_t recessive_bit = 0x10;
inline constexpr std::uint8_t overload = 0x20;
inline constexpr std::uint8_t active = 0x40;
inline constexpr std::uint8_t transmission = 0x80;
}  // namespace protocol_error

/// Whether the controller had no room for a frame from the bus: at least one is lost, and it is not known how
/// many.
[[nodiscard]] constexpr bool lost_in_controller(const Frame& frame) noexcept {
  return frame.format == Format::error && (frame.id & error_class::controller) != 0 &&
         (frame.data[1] & controller_error::rx_overflow) != 0;
}

/// The state of a CAN controller, as its error counters give it. [ISO 11898-1]
enum class ControllerState : std::uint8_t {
  active,
  warning,  ///< a counter from 96 on
  passive,  ///< a counter from 128 on
  bus_off,  ///< the transmit counter beyond 255: it neither sends nor receives
};

[[nodiscard]] constexpr std::string_view name(ControllerState state) noexcept {
  constexpr std::string_view names[] = {"error active", "error warning", "error passive", "bus-off"};
  return names[static_cast<std::size_t>(state)];
}

/// The state that an error frame reports; nothing: it reports none.
[[nodiscard]] constexpr std::optional<ControllerState> controller_state(const Frame& frame) noexcept {
  if (frame.format != Format::error) return {};
  if ((frame.id & error_class::bus_off) != 0) return ControllerState::bus_off;
  if ((frame.id & error_class::controller) != 0) {
    namespace bits = controller_error;
    const unsigned what = frame.data[1];
    if ((what & (bits::rx_passive | bits::tx_passive)) != 0) return ControllerState::passive;
    if ((what & (bits::rx_warning | bits::tx_warning)) != 0) return ControllerState::warning;
    if ((what & bits::active) != 0) return ControllerState::active;
  }
  if ((frame.id & error_class::restarted) != 0) return ControllerState::active;
  return {};
}

/// TEC and REC.
struct ErrorCounters {
  std::uint8_t transmit = 0;
  std::uint8_t receive = 0;
  friend constexpr bool operator==(ErrorCounters, ErrorCounters) = default;
};

/// Those that an error frame reports, as drivers do since Linux 6.0; nothing: it reports none.
[[nodiscard]] constexpr std::optional<ErrorCounters> error_counters(const Frame& frame) noexcept {
  if (frame.format != Format::error || (frame.id & error_class::counters) == 0) return {};
  return ErrorCounters{frame.data[6], frame.data[7]};
}

using ErrorText = base::Text<704>;

namespace detail {

/// Where in a frame a protocol error was seen: data[3]. Empty when the driver does not say.
[[nodiscard]] constexpr std::string_view error_location(std::uint8_t code) noexcept {
  switch (code) {
    case 0x03:
      return "the start of frame";
    case 0x02:
    case 0x06:
    case 0x07:
    case 0x0F:
    case 0x0E:
      return "the identifier";
    case 0x04:
      return "the SRR bit";
    case 0x05:
      return "the IDE bit";
    case 0x0C:
      return "the RTR bit";
    case 0x0D:
    case 0x09:
      return "a reserved bit";
    case 0x0B:
      return "the data length code";
    case 0x0A:
      return "the data";
    case 0x08:
      return "the CRC";
    case 0x18:
      return "the CRC delimiter";
    case 0x19:
      return "the acknowledge slot";
    case 0x1B:
      return "the acknowledge delimiter";
    case 0x1A:
      return "the end of frame";
    case 0x12:
      return "the intermission";
    default:
      return "";
  }
}

/// State of one wire: a nibble of data[4].
[[nodiscard]] constexpr std::string_view wire_state(unsigned nibble) noexcept {
  switch (nibble) {
    case 4:
      return "not connected";
    case 5:
      return "shorted to the battery";
    case 6:
      return "shorted to the supply";
    case 7:
      return "shorted to ground";
    case 8:
      return "shorted to CANH";
    default:
      return "in an unknown state";
  }
}

/// Joins what is wrong with commas.
class ErrorList {
 public:
  constexpr explicit ErrorList(ErrorText& out) noexcept : out_(out) {}
  constexpr ErrorText& item(std::string_view text) noexcept {
    if (any_) out_ << ", ";
    any_ = true;
    return out_ << text;
  }
  constexpr void item_if(bool condition, std::string_view text) noexcept {
    if (condition) item(text);
  }
  /// For what a controller reports of the sending and the receiving side apart.
  constexpr void sides(std::uint8_t bits, std::uint8_t tx, std::uint8_t rx, std::string_view text) noexcept {
    if ((bits & (tx | rx)) == 0) return;
    item(text) << ((bits & tx) == 0 ? " (receiving)" : (bits & rx) == 0 ? " (sending)" : " (both ways)");
  }
  [[nodiscard]] constexpr bool any() const noexcept { return any_; }

 private:
  ErrorText& out_;
  bool any_ = false;
};

constexpr void describe_controller(ErrorList& list, std::uint8_t bits) noexcept {
  namespace e = controller_error;
  list.item_if((bits & e::rx_overflow) != 0, "the controller's receive buffer overflowed: frames are lost");
  list.item_if((bits & e::tx_overflow) != 0, "the controller's transmit buffer overflowed");
  list.sides(bits, e::tx_warning, e::rx_warning, "error warning");
  list.sides(bits, e::tx_passive, e::rx_passive, "error passive");
  list.item_if((bits & e::active) != 0, "error active again");
  list.item_if((bits & 0x7F) == 0, "controller problem");
}

constexpr void describe_protocol(ErrorList& list, std::uint8_t bits, std::uint8_t location) noexcept {
  namespace e = protocol_error;
  ErrorText types;
  ErrorList names{types};
  names.item_if((bits & e::bit) != 0, "bit error");
  names.item_if((bits & e::form) != 0, "form error");
  names.item_if((bits & e::stuff) != 0, "stuff error");
  names.item_if((bits & e::dominant_bit) != 0, "dominant bit could not be sent");
  names.item_if((bits & e::recessive_bit) != 0, "recessive bit could not be sent");
  names.item_if((bits & e::overload) != 0, "overload");
  names.item_if((bits & e::active) != 0, "active error flag");
  names.item_if(!names.any(), "protocol error");
  ErrorText& out = list.item(types.view());
  if (const std::string_view where = error_location(location); !where.empty()) out << " in " << where;
  if ((bits & e::transmission) != 0) out << " while sending";
}

}  // namespace detail

/// "bus-off: the controller has left the bus, error counters: sending 255, receiving 0". Names every class
/// that is set; classes that this version does not know as a number. Empty when `frame` is no error frame.
[[nodiscard]] constexpr ErrorText describe(const Frame& frame) noexcept {
  namespace c = error_class;
  ErrorText out;
  if (frame.format != Format::error) return out;
  detail::ErrorList list{out};
  const auto has = [&](std::uint32_t flag) { return (frame.id & flag) != 0; };

  list.item_if(has(c::bus_off), "bus-off: the controller has left the bus");
  list.item_if(has(c::restarted), "the controller was restarted");
  if (has(c::controller)) detail::describe_controller(list, frame.data[1]);
  list.item_if(has(c::no_acknowledgement), "no acknowledgement: no other node, or another bit rate");
  // Some drivers say the same twice: no acknowledgement, and an error in its slot.
  const bool said = has(c::no_acknowledgement) && frame.data[2] == 0 && frame.data[3] == 0x19;
  if (has(c::protocol) && !said) detail::describe_protocol(list, frame.data[2], frame.data[3]);
  list.item_if(has(c::bus_error) && !has(c::protocol) && !has(c::no_acknowledgement), "bus error");
  if (has(c::transceiver)) {
    const unsigned canh = frame.data[4] & 0xFU;
    const unsigned canl = frame.data[4] >> 4U;
    if (canh != 0) list.item("CANH is ") << detail::wire_state(canh);
    if (canl != 0) list.item("CANL is ") << detail::wire_state(canl);
    list.item_if(frame.data[4] == 0, "transceiver problem");
  }
  if (has(c::arbitration_lost)) {
    ErrorText& text = list.item("arbitration lost");
    if (frame.data[0] != 0) (text << " in bit ").decimal(frame.data[0]);
  }
  list.item_if(has(c::tx_timeout), "the driver gave up sending: timeout");
  if ((frame.id & ~c::all) != 0) (list.item("unknown error class ") << "0x").hex(frame.id & ~c::all, 8);
  list.item_if(!list.any() && !has(c::counters), "error frame without a class");

  // Before linux 6.0 drivers gave the counters without a flag, and always with one of these classes.
  const bool unflagged = has(c::controller | c::bus_off) && (frame.data[6] != 0 || frame.data[7] != 0);
  if (has(c::counters) || unflagged) {
    ErrorText& text = list.item("error counters: sending ").decimal(frame.data[6]);
    (text << ", receiving ").decimal(frame.data[7]);
  }
  return out;
}

}  // namespace ocm::can
