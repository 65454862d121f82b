// Made by ocm-generate from small.json. Do not edit: change the spec, and generate again.

/// The messages of 1st: a bus that says little.
///
/// A message is its bytes, which begin with the start values; what they mean is read and put in place. Name()
/// is the physical value, the named one or the number, Name_raw() the bits; set_Name() takes the nearest that
/// the width holds. Of a multiplexed field Name() is empty where the selector says that it is not there, and
/// set_Name() is false. ocm/protocol/message.hpp makes frames of them, and reads them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "ocm/base/binary64.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/message_field.hpp"
#include "ocm/protocol/topic.hpp"

namespace n1st {

/// Bits per second on the bus.
inline constexpr std::uint32_t bit_rate = 125'000;

/// One. 4 bytes, identifier 0x001, every 10 ms.
struct One {
  static constexpr std::string_view name = "One";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x001};
  static constexpr std::size_t length = 4;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{10'000'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "int";

  ocm::protocol::MessageBytes<8> bytes{0x00, 0x00, 0x07};

  /// a.
  static constexpr ocm::protocol::Position a_at{7, 16, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::uint16_t a() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, a_at);
  }
  constexpr void set_a(std::uint16_t value_) noexcept { ocm::protocol::write_field(bytes, a_at, value_); }

  /// b.
  static constexpr ocm::protocol::Position b_at{23, 8, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::uint8_t b() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, b_at);
  }
  constexpr void set_b(std::uint8_t value_) noexcept { ocm::protocol::write_field(bytes, b_at, value_); }

  /// c.
  static constexpr ocm::protocol::Position c_at{24, 8};
  [[nodiscard]] constexpr std::int8_t c() const noexcept {
    return ocm::protocol::read_field<std::int8_t>(bytes, c_at);
  }
  constexpr void set_c(std::int8_t value_) noexcept { ocm::protocol::write_field(bytes, c_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<One>(data_);
  }
  friend constexpr bool operator==(const One&, const One&) = default;
};

/// one. 4 bytes, identifier 0x7FF, every 1000 ms.
struct one {
  static constexpr std::string_view name = "one";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x7FF};
  static constexpr std::size_t length = 4;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{1'000'000'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "int";

  ocm::protocol::MessageBytes<8> bytes{0xFF, 0xFF, 0xFF, 0xFF};

  /// One.
  static constexpr ocm::protocol::Position One_at{7, 32, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::int32_t One() const noexcept {
    return ocm::protocol::read_field<std::int32_t>(bytes, One_at);
  }
  constexpr void set_One(std::int32_t value_) noexcept { ocm::protocol::write_field(bytes, One_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<one>(data_);
  }
  friend constexpr bool operator==(const one&, const one&) = default;
};

/// ONE. 0 bytes, identifier 0x007.
struct ONE {
  static constexpr std::string_view name = "ONE";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x007};
  static constexpr std::size_t length = 0;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<ONE>(data_);
  }
  friend constexpr bool operator==(const ONE&, const ONE&) = default;
};

}  // namespace n1st
