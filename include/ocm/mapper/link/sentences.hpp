// Made by ocm-generate from sentences.json. Do not edit: change the spec, and generate again.

/// What the FreeRTOS mapping robots and their server say to each other: ASCII, integers only, each sentence
/// ended by a line feed.
///
/// The facts: which sentences there are, their fields with unit and range, their letters and words.
/// ocm/mapper/link/sentence.hpp writes them, sentence_reader.hpp reads them. No heap; everything is
/// constexpr.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "ocm/mapper/link/field.hpp"

namespace ocm::mapper::link {

/// Bytes of a packet, at most. [Thesis 2, table 4.1 and 16.1: ATT_MTU of 23 bytes (Bluetooth core
/// specification 4.0, volume 3, part F, 3.2.8), of which the header takes 3]
inline constexpr std::size_t max_packet = 20;
/// Integers of a sentence, at most.
inline constexpr std::size_t max_integers = 16;

/// Which sentence; none: not one, or not yet.
enum class Kind : std::uint8_t {
  none,
  confirm,      ///< `{S,CON}` the handshake has come: start
  set_point,    ///< `{U,angle,distance}` new set point, relative to the present pose; 0, 0 stops
  pause,        ///< `{S,PAU}` hold the tower and send no updates; control goes on
  unpause,      ///< `{S,UNP}` go on as before the pause
  packed,       ///< `{S,BIN}` send updates packed; only to a robot whose handshake offers it
  text,         ///< `{S,TXT}` send updates as text again
  who,          ///< `{S,WHO}` say the handshake again; nothing else changes
  calibrate,    ///< `{C,number}` turn around once for the compass; the last one's number only asks
  ping,         ///< `{}` are you there; printed with a blank between the braces, which is read as well
  handshake,    ///< `{H,...}` what robot this is, each second from the connection until confirmed
  update,       ///< `{U,x,y,heading,servo,s1,s2,s3,s4}` pose and what the tower sees
  calibration,  ///< `{C,number,verdict,x,y,field,error,use}` the compass, while it turns and when asked
  idle,         ///< `{S,IDL}` at the set point, once and then at an interval; also when paused
  pong,         ///< `\t!` answers a ping
};

/// As the spec calls it.
[[nodiscard]] constexpr std::string_view name(Kind kind) noexcept {
  if (kind == Kind::confirm) return "confirm";
  if (kind == Kind::set_point) return "set_point";
  if (kind == Kind::pause) return "pause";
  if (kind == Kind::unpause) return "unpause";
  if (kind == Kind::packed) return "packed";
  if (kind == Kind::text) return "text";
  if (kind == Kind::who) return "who";
  if (kind == Kind::calibrate) return "calibrate";
  if (kind == Kind::ping) return "ping";
  if (kind == Kind::handshake) return "handshake";
  if (kind == Kind::update) return "update";
  if (kind == Kind::calibration) return "calibration";
  if (kind == Kind::idle) return "idle";
  if (kind == Kind::pong) return "pong";
  return "none";
}

/// `{U,angle,distance}` new set point, relative to the present pose; 0, 0 stops. [Thesis 2, table 4.3 and
/// appendix J]
struct SetPoint {
  /// deg, turn first, counter-clockwise; [-360, 360] [decided: a whole turn either way]
  std::int16_t angle = 0;
  /// cm, then drive, forwards
  std::int16_t distance = 0;

  static constexpr Kind kind = Kind::set_point;
  static constexpr Direction direction = Direction::to_robot;
  static constexpr char letter = 'U';
  static constexpr std::array<Field<SetPoint>, 2> fields{{
      {&SetPoint::angle, "angle", "deg", -360, 360},
      {&SetPoint::distance, "distance", "cm"},
  }};
  friend constexpr bool operator==(const SetPoint&, const SetPoint&) = default;
};

/// `{C,number}` turn around once for the compass; the last one's number only asks. [decided:
/// docs/decisions/0029]
struct Calibrate {
  /// another one than the last: begin; 0: only ask; [0, 9999] [decided: two copies of a word begin one
  /// calibration]
  std::int16_t number = 0;

  static constexpr Kind kind = Kind::calibrate;
  static constexpr Direction direction = Direction::to_robot;
  static constexpr char letter = 'C';
  static constexpr std::array<Field<Calibrate>, 1> fields{{
      {&Calibrate::number, "number", "", 0, 9999},
  }};
  friend constexpr bool operator==(const Calibrate&, const Calibrate&) = default;
};

/// `{H,...}` what robot this is, each second from the connection until confirmed. [Thesis 2, table 4.4, 17.1
/// and 17.4: robot data, with the offsets of axle and tower; it fixes no list; fields decided: order, units
/// and the last two fields]
struct Handshake {
  std::int16_t width = 0;         ///< cm, of the robot
  std::int16_t length = 0;        ///< cm, of the robot
  std::int16_t axle_offset = 0;   ///< cm, from the centre forwards
  std::int16_t tower_offset = 0;  ///< cm, from the centre forwards
  std::int16_t sensor1 = 0;       ///< deg, where it looks when the tower is at 0
  std::int16_t sensor2 = 0;       ///< deg, where it looks when the tower is at 0
  std::int16_t sensor3 = 0;       ///< deg, where it looks when the tower is at 0
  std::int16_t sensor4 = 0;       ///< deg, where it looks when the tower is at 0
  std::int16_t deadline = 0;      ///< ms, without a word from the robot after which it counts as lost
  std::int16_t formats = 0;       ///< packed_offer: can send packed updates; others: text only
  std::int16_t sensor_out = 0;    ///< cm, from the tower's axis to its sensors' faces
  /// integers in the sentence, 1 to 16: fields that were not given are 0, integers beyond the last field are
  /// let go
  std::uint8_t given = 11;

  static constexpr Kind kind = Kind::handshake;
  static constexpr Direction direction = Direction::from_robot;
  static constexpr char letter = 'H';
  static constexpr std::size_t fewest_integers = 1, most_integers = 16;
  static constexpr std::int16_t packed_offer = 20225;  ///< of formats
  static constexpr std::array<Field<Handshake>, 11> fields{{
      {&Handshake::width, "width", "cm"},
      {&Handshake::length, "length", "cm"},
      {&Handshake::axle_offset, "axle_offset", "cm"},
      {&Handshake::tower_offset, "tower_offset", "cm"},
      {&Handshake::sensor1, "sensor1", "deg"},
      {&Handshake::sensor2, "sensor2", "deg"},
      {&Handshake::sensor3, "sensor3", "deg"},
      {&Handshake::sensor4, "sensor4", "deg"},
      {&Handshake::deadline, "deadline", "ms"},
      {&Handshake::formats, "formats", ""},
      {&Handshake::sensor_out, "sensor_out", "cm"},
  }};
  friend constexpr bool operator==(const Handshake&, const Handshake&) = default;
};

/// `{U,x,y,heading,servo,s1,s2,s3,s4}` pose and what the tower sees. [Thesis 2, table 4.4]
struct Update {
  /// cm, from the start, along the heading at the start
  std::int16_t x = 0;
  /// cm, from the start, to its left
  std::int16_t y = 0;
  /// deg, counter-clockwise; [-360, 360] [decided: table 13.1 has 358, others wrap at 180]
  std::int16_t heading = 0;
  /// deg, angle of the tower; [0, 90] [Thesis 2, 6.3]
  std::int16_t servo = 0;
  /// cm, distance, 0: nothing seen; [0, 255] [decided: the part (GP2Y0A21YK) sees to 80 cm; with room for
  /// another one]
  std::int16_t s1 = 0;
  /// cm, distance, 0: nothing seen; [0, 255]
  std::int16_t s2 = 0;
  /// cm, distance, 0: nothing seen; [0, 255]
  std::int16_t s3 = 0;
  /// cm, distance, 0: nothing seen; [0, 255]
  std::int16_t s4 = 0;

  static constexpr Kind kind = Kind::update;
  static constexpr Direction direction = Direction::from_robot;
  static constexpr char letter = 'U';
  static constexpr std::array<Field<Update>, 8> fields{{
      {&Update::x, "x", "cm"},
      {&Update::y, "y", "cm"},
      {&Update::heading, "heading", "deg", -360, 360},
      {&Update::servo, "servo", "deg", 0, 90},
      {&Update::s1, "s1", "cm", 0, 255},
      {&Update::s2, "s2", "cm", 0, 255},
      {&Update::s3, "s3", "cm", 0, 255},
      {&Update::s4, "s4", "cm", 0, 255},
  }};
  friend constexpr bool operator==(const Update&, const Update&) = default;
};

/// `{C,number,verdict,x,y,field,error,use}` the compass, while it turns and when asked. [decided:
/// docs/decisions/0029]
struct Calibration {
  /// of the last one; 0: none since it was switched on; [0, 9999]
  std::int16_t number = 0;
  /// none: not calibrated; turning: not done yet; the others: how the last one ended, or what is stored; [0,
  /// 8]
  std::int16_t verdict = 0;
  /// mG, field of the robot itself, ahead; [-2000, 2000] [HMC5883L data sheet: 1.3 G at the usual gain]
  std::int16_t x = 0;
  /// mG, and to its left; [-2000, 2000]
  std::int16_t y = 0;
  /// mG, of the earth, where the robot turned, horizontally; [0, 2000]
  std::int16_t field = 0;
  /// deg, the compass is wrong by, at most: what was not a circle; [0, 180]
  std::int16_t error = 0;
  /// of the calibration that the robot corrects by; until_off: not stored, or not yet; [0, 2]
  std::int16_t use = 0;

  static constexpr Kind kind = Kind::calibration;
  static constexpr Direction direction = Direction::from_robot;
  static constexpr char letter = 'C';
  static constexpr std::int16_t none = 0;        ///< of verdict
  static constexpr std::int16_t turning = 1;     ///< of verdict
  static constexpr std::int16_t good = 2;        ///< of verdict
  static constexpr std::int16_t poor = 3;        ///< of verdict
  static constexpr std::int16_t stopped = 4;     ///< of verdict
  static constexpr std::int16_t incomplete = 5;  ///< of verdict
  static constexpr std::int16_t disturbed = 6;   ///< of verdict
  static constexpr std::int16_t weak = 7;        ///< of verdict
  static constexpr std::int16_t silent = 8;      ///< of verdict
  static constexpr std::int16_t unused = 0;      ///< of use
  static constexpr std::int16_t until_off = 1;   ///< of use
  static constexpr std::int16_t stored = 2;      ///< of use
  static constexpr std::array<Field<Calibration>, 7> fields{{
      {&Calibration::number, "number", "", 0, 9999},
      {&Calibration::verdict, "verdict", "", 0, 8},
      {&Calibration::x, "x", "mG", -2000, 2000},
      {&Calibration::y, "y", "mG", -2000, 2000},
      {&Calibration::field, "field", "mG", 0, 2000},
      {&Calibration::error, "error", "deg", 0, 180},
      {&Calibration::use, "use", "", 0, 2},
  }};
  friend constexpr bool operator==(const Calibration&, const Calibration&) = default;
};

/// A sentence of a word behind `word_letter`.
struct Word {
  Kind kind;
  Direction direction;
  std::string_view text;
};
inline constexpr char word_letter = 'S';
inline constexpr std::size_t word_length = 3;
inline constexpr std::array<Word, 7> words{{
    {Kind::confirm, Direction::to_robot, "CON"},
    {Kind::pause, Direction::to_robot, "PAU"},
    {Kind::unpause, Direction::to_robot, "UNP"},
    {Kind::packed, Direction::to_robot, "BIN"},
    {Kind::text, Direction::to_robot, "TXT"},
    {Kind::who, Direction::to_robot, "WHO"},
    {Kind::idle, Direction::from_robot, "IDL"},
}};

/// Of a sentence that is fixed text: all of it but its line feed. Empty for others.
[[nodiscard]] constexpr std::string_view fixed_text(Kind kind) noexcept {
  if (kind == Kind::ping) return "{}";
  if (kind == Kind::pong) return "\t!";
  return {};
}

/// An update in one packet: tag, then seven bits a byte below a bit of 1, most significant first, then 5 bits
/// of 0 and the CRC-16 (0x1021, start 0xFFFF) of the 17 bytes before. [decided: docs/mapper-link.md]
inline constexpr std::uint8_t packed_version = 1;
/// Its first byte.
inline constexpr std::uint8_t packed_tag = 0xB1;
/// Bits of the sequence number in front of the fields, and of each of Update::fields.
inline constexpr std::uint8_t packed_sequence_bits = 8;
inline constexpr std::array<std::uint8_t, 8> packed_widths{16, 16, 16, 8, 12, 12, 12, 12};

}  // namespace ocm::mapper::link
