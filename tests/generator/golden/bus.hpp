// Made by ocm-generate from bus.dbc. Do not edit: change the spec, and generate again.

/// The messages of bus: a small  car.
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

namespace bus {

/// Bits per second on the bus.
inline constexpr std::uint32_t bit_rate = 500'000;

/// Engine. 8 bytes, identifier 0x100, every 12.5 ms. [bus.dbc:18]
struct Engine {
  static constexpr std::string_view name = "Engine";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x100};
  static constexpr std::size_t length = 8;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{12'500'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  enum class TorqueValue : std::int16_t {
    none = -1,
    five = 5,
  };
  enum class GearValue : std::uint8_t {
    P = 0,
    R = 1,
    N = 2,
  };
  enum class HeatValue : std::uint8_t {
    lost = 255,
    cold = 254,
  };
  ocm::protocol::MessageBytes<8> bytes{0x03, 0x20, 0xFF, 0x0F, 0x0D};

  /// Rpm: at the crank. In rpm. Stated range: 0 to 16383.75.
  static constexpr ocm::protocol::Position Rpm_at{7, 16, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::uint16_t Rpm_raw() const noexcept {
    return ocm::protocol::read_field<std::uint16_t>(bytes, Rpm_at);
  }
  constexpr void set_Rpm_raw(std::uint16_t value_) noexcept {
    ocm::protocol::write_field(bytes, Rpm_at, value_);
  }
  [[nodiscard]] constexpr double Rpm() const noexcept { return static_cast<double>(Rpm_raw()) / 4.0; }
  constexpr void set_Rpm(double value_) noexcept {
    ocm::protocol::write_nearest<std::uint16_t>(bytes, Rpm_at, value_ * 4.0);
  }

  /// Torque. In Nm. Stated range: -1124 to 923.5.
  static constexpr ocm::protocol::Position Torque_at{16, 12};
  [[nodiscard]] constexpr std::int16_t Torque_raw() const noexcept {
    return ocm::protocol::read_field<std::int16_t>(bytes, Torque_at);
  }
  constexpr void set_Torque_raw(std::int16_t value_) noexcept {
    ocm::protocol::write_field(bytes, Torque_at, value_);
  }
  [[nodiscard]] constexpr double Torque() const noexcept {
    return (static_cast<double>(Torque_raw()) * 5.0 - 1'000.0) / 10.0;
  }
  constexpr void set_Torque(double value_) noexcept {
    ocm::protocol::write_nearest<std::int16_t>(bytes, Torque_at, (value_ * 10.0 + 1'000.0) / 5.0);
  }
  [[nodiscard]] constexpr bool Torque_is(TorqueValue value_) const noexcept {
    return Torque_raw() == static_cast<std::int16_t>(value_);
  }

  /// Gear.
  static constexpr ocm::protocol::Position Gear_at{28, 4};
  [[nodiscard]] constexpr std::uint8_t Gear_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Gear_at);
  }
  constexpr void set_Gear_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Gear_at, value_);
  }
  [[nodiscard]] constexpr GearValue Gear() const noexcept { return static_cast<GearValue>(Gear_raw()); }
  constexpr void set_Gear(GearValue value_) noexcept {
    ocm::protocol::write_field(bytes, Gear_at, static_cast<std::uint8_t>(value_));
  }

  /// Heat. In °C. Stated range: -40 to 87.5.
  static constexpr ocm::protocol::Position Heat_at{32, 8};
  [[nodiscard]] constexpr std::uint8_t Heat_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Heat_at);
  }
  constexpr void set_Heat_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Heat_at, value_);
  }
  [[nodiscard]] constexpr double Heat() const noexcept {
    return (static_cast<double>(Heat_raw()) * 5.0 - 400.0) / 10.0;
  }
  constexpr void set_Heat(double value_) noexcept {
    ocm::protocol::write_nearest<std::uint8_t>(bytes, Heat_at, (value_ * 10.0 + 400.0) / 5.0);
  }
  [[nodiscard]] constexpr bool Heat_is(HeatValue value_) const noexcept {
    return Heat_raw() == static_cast<std::uint8_t>(value_);
  }

  /// Precise. In a "unit".
  static constexpr ocm::protocol::Position Precise_at{40, 24};
  [[nodiscard]] constexpr std::uint32_t Precise_raw() const noexcept {
    return ocm::protocol::read_field<std::uint32_t>(bytes, Precise_at);
  }
  constexpr void set_Precise_raw(std::uint32_t value_) noexcept {
    ocm::protocol::write_field(bytes, Precise_at, value_);
  }
  [[nodiscard]] constexpr double Precise() const noexcept {
    return static_cast<double>(Precise_raw()) * 1'234'567'890'123'456'789.0 / 1e19;
  }
  constexpr void set_Precise(double value_) noexcept {
    ocm::protocol::write_nearest<std::uint32_t>(bytes, Precise_at, value_ * 1e19 / 1'234'567'890'123'456'789.0);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Engine>(data_);
  }
  friend constexpr bool operator==(const Engine&, const Engine&) = default;
};

/// Group. 20 bytes, parameter group 0x0FEF0. [bus.dbc:25]
struct Group {
  static constexpr std::string_view name = "Group";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::pgn, true, 0x18FEF0FE};
  static constexpr std::size_t length = 20;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "";

  ocm::protocol::MessageBytes<20> bytes{};

  /// Part. Stated range: 3 to 3.
  static constexpr ocm::protocol::Position Part_at{159, 8, ocm::protocol::ByteOrder::big};
  [[nodiscard]] constexpr std::int8_t Part() const noexcept {
    return ocm::protocol::read_field<std::int8_t>(bytes, Part_at);
  }
  constexpr void set_Part(std::int8_t value_) noexcept { ocm::protocol::write_field(bytes, Part_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Group>(data_);
  }
  friend constexpr bool operator==(const Group&, const Group&) = default;
};

/// To_one. 3 bytes, parameter group 0x02000. [bus.dbc:27]
struct To_one {
  static constexpr std::string_view name = "To_one";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::pgn, true, 0x002000FF};
  static constexpr std::size_t length = 3;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<To_one>(data_);
  }
  friend constexpr bool operator==(const To_one&, const To_one&) = default;
};

/// Wide. 0 bytes, identifier 0x00000000. [bus.dbc:28]
struct Wide {
  static constexpr std::string_view name = "Wide";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, true, 0x00000000};
  static constexpr std::size_t length = 0;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Trunk";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Wide>(data_);
  }
  friend constexpr bool operator==(const Wide&, const Wide&) = default;
};

/// Long. 48 bytes of CAN FD, identifier 0x200, every 1000 ms. [bus.dbc:29]
struct Long {
  static constexpr std::string_view name = "Long";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x200};
  static constexpr std::size_t length = 48;
  static constexpr bool fd = true;
  static constexpr ocm::base::Duration period{1'000'000'000};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "A_door_with_a_name_of_more_than_32_letters";

  ocm::protocol::MessageBytes<48> bytes{0x00, 0x00, 0xC0, 0x3F, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0xD0, 0xBF};

  /// F. Stated range: 0 to 1.
  static constexpr ocm::protocol::Position F_at{0, 32};
  [[nodiscard]] constexpr std::uint32_t F_raw() const noexcept {
    return ocm::protocol::read_field<std::uint32_t>(bytes, F_at);
  }
  constexpr void set_F_raw(std::uint32_t value_) noexcept { ocm::protocol::write_field(bytes, F_at, value_); }
  [[nodiscard]] constexpr float F() const noexcept { return std::bit_cast<float>(F_raw()); }
  constexpr void set_F(float value_) noexcept {
    ocm::protocol::write_field(bytes, F_at, std::bit_cast<std::uint32_t>(value_));
  }

  /// D.
  static constexpr ocm::protocol::Position D_at{64, 64};
  [[nodiscard]] constexpr std::uint64_t D_raw() const noexcept {
    return ocm::protocol::read_field<std::uint64_t>(bytes, D_at);
  }
  constexpr void set_D_raw(std::uint64_t value_) noexcept { ocm::protocol::write_field(bytes, D_at, value_); }
  [[nodiscard]] constexpr double D() const noexcept {
    return static_cast<double>(ocm::base::from_binary64(D_raw())) * 2.0 + 1.0;
  }
  constexpr void set_D(double value_) noexcept {
    ocm::protocol::write_field(bytes, D_at, ocm::base::to_binary64((value_ - 1.0) / 2.0));
  }

  /// Last.
  static constexpr ocm::protocol::Position Last_at{376, 8};
  [[nodiscard]] constexpr std::uint8_t Last() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Last_at);
  }
  constexpr void set_Last(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, Last_at, value_);
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Long>(data_);
  }
  friend constexpr bool operator==(const Long&, const Long&) = default;
};

/// Pages_of_a_message_with_a_long_name. 8 bytes of CAN FD, identifier 0x201. [bus.dbc:33]
struct Pages_of_a_message_with_a_long_name {
  static constexpr std::string_view name = "Pages_of_a_message_with_a_long_name";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x201};
  static constexpr std::size_t length = 8;
  static constexpr bool fd = true;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// A_page_with_a_name_of_more_than_32_letters.
  static constexpr ocm::protocol::Position A_page_with_a_name_of_more_than_32_letters_at{0, 8};
  [[nodiscard]] constexpr std::uint8_t A_page_with_a_name_of_more_than_32_letters() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, A_page_with_a_name_of_more_than_32_letters_at);
  }
  constexpr void set_A_page_with_a_name_of_more_than_32_letters(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, A_page_with_a_name_of_more_than_32_letters_at, value_);
  }

  /// P0.
  static constexpr ocm::protocol::Position P0_at{8, 8};
  [[nodiscard]] constexpr bool has_P0() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, A_page_with_a_name_of_more_than_32_letters_at);
    return selector_ == 0;
  }
  [[nodiscard]] constexpr std::uint8_t P0_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, P0_at);
  }
  constexpr void set_P0_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, P0_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> P0() const noexcept {
    if (!has_P0()) return std::nullopt;
    return P0_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_P0(std::uint8_t value_) noexcept {
    if (!has_P0()) return false;
    ocm::protocol::write_field(bytes, P0_at, value_);
    return true;
  }

  /// P1.
  static constexpr ocm::protocol::Position P1_at{8, 4};
  [[nodiscard]] constexpr bool has_P1() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, A_page_with_a_name_of_more_than_32_letters_at);
    return selector_ == 1 || (selector_ >= 7 && selector_ <= 9);
  }
  [[nodiscard]] constexpr std::uint8_t P1_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, P1_at);
  }
  constexpr void set_P1_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, P1_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> P1() const noexcept {
    if (!has_P1()) return std::nullopt;
    return P1_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_P1(std::uint8_t value_) noexcept {
    if (!has_P1()) return false;
    ocm::protocol::write_field(bytes, P1_at, value_);
    return true;
  }

  /// P2.
  static constexpr ocm::protocol::Position P2_at{16, 8};
  [[nodiscard]] constexpr bool has_P2() const noexcept {
    if (!has_P1()) return false;
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, P1_at);
    return selector_ == 2;
  }
  [[nodiscard]] constexpr std::uint8_t P2_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, P2_at);
  }
  constexpr void set_P2_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, P2_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> P2() const noexcept {
    if (!has_P2()) return std::nullopt;
    return P2_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_P2(std::uint8_t value_) noexcept {
    if (!has_P2()) return false;
    ocm::protocol::write_field(bytes, P2_at, value_);
    return true;
  }

  /// P3.
  static constexpr ocm::protocol::Position P3_at{16, 8};
  [[nodiscard]] constexpr bool has_P3() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, A_page_with_a_name_of_more_than_32_letters_at);
    return selector_ == 3;
  }
  [[nodiscard]] constexpr std::uint8_t P3_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, P3_at);
  }
  constexpr void set_P3_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, P3_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> P3() const noexcept {
    if (!has_P3()) return std::nullopt;
    return P3_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_P3(std::uint8_t value_) noexcept {
    if (!has_P3()) return false;
    ocm::protocol::write_field(bytes, P3_at, value_);
    return true;
  }

  /// P3_2.
  static constexpr ocm::protocol::Position P3_2_at{24, 8};
  [[nodiscard]] constexpr bool has_P3_2() const noexcept {
    const auto selector_ = ocm::protocol::read_field<std::uint8_t>(bytes, A_page_with_a_name_of_more_than_32_letters_at);
    return selector_ == 4;
  }
  [[nodiscard]] constexpr std::uint8_t P3_2_raw() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, P3_2_at);
  }
  constexpr void set_P3_2_raw(std::uint8_t value_) noexcept {
    ocm::protocol::write_field(bytes, P3_2_at, value_);
  }
  [[nodiscard]] constexpr std::optional<std::uint8_t> P3_2() const noexcept {
    if (!has_P3_2()) return std::nullopt;
    return P3_2_raw();
  }
  /// False, and nothing changes, where the selector says that it is not there.
  constexpr bool set_P3_2(std::uint8_t value_) noexcept {
    if (!has_P3_2()) return false;
    ocm::protocol::write_field(bytes, P3_2_at, value_);
    return true;
  }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Pages_of_a_message_with_a_long_name>(data_);
  }
  friend constexpr bool operator==(const Pages_of_a_message_with_a_long_name&, const Pages_of_a_message_with_a_long_name&) = default;
};

/// Short. 1 byte, identifier 0x202. Beyond its length, and not here: C. [bus.dbc:40]
struct Short {
  static constexpr std::string_view name = "Short";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x202};
  static constexpr std::size_t length = 1;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// A.
  static constexpr ocm::protocol::Position A_at{0, 5};
  [[nodiscard]] constexpr std::uint8_t A() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, A_at);
  }
  constexpr void set_A(std::uint8_t value_) noexcept { ocm::protocol::write_field(bytes, A_at, value_); }

  /// B.
  static constexpr ocm::protocol::Position B_at{4, 4};
  [[nodiscard]] constexpr std::uint8_t B() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, B_at);
  }
  constexpr void set_B(std::uint8_t value_) noexcept { ocm::protocol::write_field(bytes, B_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Short>(data_);
  }
  friend constexpr bool operator==(const Short&, const Short&) = default;
};

/// Forgotten. 8 bytes, identifier 0x00000800. [bus.dbc:45]
struct Forgotten {
  static constexpr std::string_view name = "Forgotten";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, true, 0x00000800};
  static constexpr std::size_t length = 8;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Forgotten>(data_);
  }
  friend constexpr bool operator==(const Forgotten&, const Forgotten&) = default;
};

/// Too_wide. 8 bytes, identifier 0x00000001. [bus.dbc:46]
struct Too_wide {
  static constexpr std::string_view name = "Too_wide";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, true, 0x00000001};
  static constexpr std::size_t length = 8;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Too_wide>(data_);
  }
  friend constexpr bool operator==(const Too_wide&, const Too_wide&) = default;
};

/// Kept. 2 bytes, identifier 0x206. [bus.dbc:49]
struct Kept {
  static constexpr std::string_view name = "Kept";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x206};
  static constexpr std::size_t length = 2;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Kept>(data_);
  }
  friend constexpr bool operator==(const Kept&, const Kept&) = default;
};

/// Engine. 2 bytes, identifier 0x203. [bus.dbc:50]
struct Engine_2 {
  static constexpr std::string_view name = "Engine";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x203};
  static constexpr std::size_t length = 2;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Motor";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Engine_2>(data_);
  }
  friend constexpr bool operator==(const Engine_2&, const Engine_2&) = default;
};

/// Zero. 1 byte, identifier 0x000. [bus.dbc:51]
struct Zero {
  static constexpr std::string_view name = "Zero";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x000};
  static constexpr std::size_t length = 1;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Dash";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Z.
  static constexpr ocm::protocol::Position Z_at{0, 8};
  [[nodiscard]] constexpr std::uint8_t Z() const noexcept {
    return ocm::protocol::read_field<std::uint8_t>(bytes, Z_at);
  }
  constexpr void set_Z(std::uint8_t value_) noexcept { ocm::protocol::write_field(bytes, Z_at, value_); }

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<Zero>(data_);
  }
  friend constexpr bool operator==(const Zero&, const Zero&) = default;
};

/// By_default. 8 bytes, identifier 0x205. [bus.dbc:54]
struct By_default {
  static constexpr std::string_view name = "By_default";
  static constexpr ocm::protocol::Address address{ocm::protocol::Address::By::identifier, false, 0x205};
  static constexpr std::size_t length = 8;
  static constexpr bool fd = false;
  static constexpr ocm::base::Duration period{0};  ///< ns; 0: none is stated
  static constexpr std::string_view sender = "Dash";

  ocm::protocol::MessageBytes<8> bytes{};

  /// Of a can::Frame or of bytes: nothing where it is another message, or shorter than this one.
  [[nodiscard]] static constexpr auto decode(const auto& data_) noexcept {
    return ocm::protocol::message_from<By_default>(data_);
  }
  friend constexpr bool operator==(const By_default&, const By_default&) = default;
};

}  // namespace bus
