#include "cli/output/field_text.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

#include "generator/spec/spec.hpp"

namespace tool_output_field_text_test {

using namespace ocm;
using cli::FieldText;

std::string printed(const protocol::Field& field, const can::Payload& data) {
  char text[FieldText::room];
  return {text, FieldText{field}.print(text, data)};
}

std::string printed_as_json(const protocol::Field& field, const can::Payload& data) {
  char text[FieldText::room];
  return {text, FieldText{field}.print_json(text, data.data())};
}

std::string expected(const protocol::Field& field, const can::Payload& data) {
  return std::string{base::to_text(*field.physical(field.raw(data))).view()};
}

can::Payload payload(std::uint64_t bits) {
  return std::bit_cast<can::Payload>(bits);
}

protocol::Field field_of(unsigned width, bool is_signed, base::Decimal scale, base::Decimal offset = {}) {
  protocol::Field field;
  field.position = {0, static_cast<std::uint8_t>(width), protocol::ByteOrder::little};
  field.is_signed = is_signed;
  field.scale = scale;
  field.offset = offset;
  return field;
}

/// Numbers of every size, not large ones only.
std::uint64_t any_bits(std::mt19937_64& random) {
  return random() >> random() % 64;
}

void check_fields(const protocol::Catalogue& catalogue, int rounds) {
  std::mt19937_64 random{1};
  for (const auto& topic : catalogue.topics)
    for (const auto& layout : topic.frames)
      for (const auto& field : layout.fields)
        for (int i = 0; i < rounds; ++i) {
          can::Payload data = payload(random());
          if (i % 2 == 0) protocol::put(data, field.position, static_cast<std::int64_t>(any_bits(random)));
          if (printed(field, data) != expected(field, data))
            FAIL(topic.name << '.' << field.name << ": " << printed(field, data) << " for "
                            << expected(field, data));
        }
}

TEST_CASE("numbers as digits", "[output]") {
  std::mt19937_64 random{2};
  char text[64];
  const auto text_to = [&](const char* end) {
    return std::string(text, static_cast<std::size_t>(end - text));
  };
  for (const std::int64_t number :
       {INT64_MIN, INT64_MAX, std::int64_t{0}, std::int64_t{-1}, std::int64_t{99'999'999},
        std::int64_t{100'000'000}, std::int64_t{9'999'999'999'999'999}, std::int64_t{10'000'000'000'000'000}})
    CHECK(text_to(cli::put_signed(text, number)) == std::to_string(number));
  for (int i = 0; i < 10'000; ++i) {
    const std::uint64_t number = any_bits(random);
    REQUIRE(text_to(cli::put_unsigned(text, number)) == std::to_string(number));
  }
  CHECK(text_to(cli::put_seconds(text, 1'436'509'052'249'713'000)) == "1436509052.249713000");
  CHECK(text_to(cli::put_seconds(text, 0)) == "0.000000000");
  CHECK(text_to(cli::put_seconds(text, -1'000'000'001)) == "-1.000000001");
  CHECK(text_to(cli::put_hex(text, 0x2A, 3)) == "02A");
}

TEST_CASE("a field's value is printed exactly", "[output]") {
  // The gyroscope: 0.0175 deg/s a digit. [L3G4200D data sheet, table 4]
  const auto gyroscope = field_of(16, true, {175, -4});
  CHECK(printed(gyroscope, payload(3)) == "0.0525");
  CHECK(printed(gyroscope, payload(0xFFFF)) == "-0.0175");
  CHECK(printed(gyroscope, payload(0)) == "0");
  CHECK(printed(gyroscope, payload(400)) == "7");
  CHECK(printed(field_of(32, true, {1, -6}), payload(0x8000'0000)) == "-2147.483648");
  CHECK(printed(field_of(8, false, {5, -1}, {-40, 0}), payload(81)) == "0.5");
  CHECK(printed(field_of(8, false, {1, 2}), payload(12)) == "1200");
  CHECK(printed(field_of(32, false, {1, 0}), payload(99'999'999)) == "99999999");
  CHECK(printed(field_of(32, false, {1, 0}), payload(100'000'000)) == "100000000");
  CHECK(printed(field_of(32, false, {1, -3}), payload(100'000'000)) == "100000");
  CHECK(printed(field_of(32, false, {1, -8}), payload(5)) == "0.00000005");
  CHECK(printed(field_of(64, true, {1, -18}), payload(std::uint64_t{1} << 63)) == "-9.223372036854775808");
}

TEST_CASE("the highest bit of an unsigned word is no sign", "[output]") {
  const auto all = payload(UINT64_MAX);
  CHECK(printed(field_of(64, false, {1, 0}), all) == "18446744073709551615");
  CHECK(printed(field_of(64, true, {1, 0}), all) == "-1");
  CHECK(printed(field_of(64, false, {1, -1}), all) == "1844674407370955161.5");
  CHECK(printed(field_of(64, false, {-25, -2}, {1, 0}), all) == "-4611686018427387902.75");
  CHECK(printed(field_of(64, false, {1, -18}), payload(std::uint64_t{1} << 63)) == "9.223372036854775808");
  CHECK(printed(field_of(64, false, {1, -3}), payload(7)) == "0.007");
  CHECK(printed(field_of(64, false, {1, 0}), payload(0)) == "0");
}

TEST_CASE("values just beyond the numbers of 64 bits with a sign are printed exactly", "[output]") {
  const auto least = payload(std::uint64_t{1} << 63);
  const auto most = payload(INT64_MAX);
  CHECK(printed(field_of(64, true, {1, 0}), least) == "-9223372036854775808");
  CHECK(printed(field_of(64, true, {-1, 0}), least) == "9223372036854775808");
  CHECK(printed(field_of(64, true, {1, 0}, {-1, 0}), least) == "-9223372036854775809");
  CHECK(printed(field_of(64, true, {1, 0}, {1, 0}), most) == "9223372036854775808");
  CHECK(printed(field_of(64, true, {-1, 0}), most) == "-9223372036854775807");
  CHECK(printed(field_of(64, true, {-1, 0}, {-2, 0}), most) == "-9223372036854775809");
  // The same of a field that is narrower, by what it is scaled with.
  const base::Decimal scale{std::int64_t{1} << 56, 0};
  CHECK(printed(field_of(8, true, scale), payload(0x80)) == "-9223372036854775808");
  CHECK(printed(field_of(8, true, scale, {-1, 0}), payload(0x80)) == "-9223372036854775809");
}

/// A whole number over 10^places, in the notation of a field's value.
std::string with_point(const std::string& digits, std::size_t places) {
  const std::string padded =
      std::string(digits.size() > places ? 0 : places + 1 - digits.size(), '0') + digits;
  std::string text = padded.substr(0, padded.size() - places) + "." + padded.substr(padded.size() - places);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

TEST_CASE("values of 16 digits and more are printed exactly", "[output]") {
  constexpr std::uint64_t whole_numbers[] = {
      1'234'567'890'123'456,     9'999'999'999'999'999,     10'000'000'000'000'000,
      10'000'000'000'000'001,    12'345'678'000'000'000,    12'345'678'900'000'000,
      99'999'999'999'999'999,    100'000'000'000'000'000,   300'000'000'000'000'000,
      999'999'999'999'999'999,   1'000'000'000'000'000'000, 1'000'000'000'000'000'010,
      1'234'567'890'123'456'789, 9'223'372'036'854'775'807};
  for (const std::uint64_t number : whole_numbers) {
    const std::string digits = std::to_string(number);
    const std::uint64_t negative = ~number + 1;
    CHECK(printed(field_of(64, true, {1, 0}), payload(number)) == digits);
    CHECK(printed(field_of(64, true, {1, 0}), payload(negative)) == "-" + digits);
    for (std::size_t places = 1; places <= 18; ++places) {
      const std::string text = with_point(digits, places);
      const auto field = field_of(64, true, {1, static_cast<std::int8_t>(-static_cast<int>(places))});
      CHECK(printed(field, payload(number)) == text);
      CHECK(printed(field, payload(negative)) == "-" + text);
    }
  }
}

TEST_CASE("a value has up to 39 digits behind the point, and is a float beyond them", "[output]") {
  CHECK(printed(field_of(64, false, {1, -39}), payload(1)) == "0." + std::string(38, '0') + "1");
  CHECK_THAT(printed(field_of(64, false, {1, -40}), payload(1)), Catch::Contains("e-"));
}

TEST_CASE("zeros at the end of a value say nothing, however many they are", "[output]") {
  for (std::uint64_t digit = 1; digit <= 9; ++digit) {
    std::uint64_t number = digit;
    for (int zeros = 0; zeros < 18; ++zeros, number *= 10)
      for (const std::uint64_t before : {std::uint64_t{0}, std::uint64_t{1'000'000'000'000'000'000}})
        for (std::size_t places = 1; places <= 18; ++places) {
          const auto field = field_of(64, true, {1, static_cast<std::int8_t>(-static_cast<int>(places))});
          CAPTURE(before + number, places);
          REQUIRE(printed(field, payload(before + number)) ==
                  with_point(std::to_string(before + number), places));
        }
  }
}

/// A number of IEEE 754 that fills a field of its width.
protocol::Field float_field(protocol::Number number, base::Decimal scale = {1, 0}) {
  auto field = field_of(number == protocol::Number::float32 ? 32 : 64, false, scale);
  field.number = number;
  return field;
}

TEST_CASE("a float is the shortest number that reads back as itself", "[output]") {
  const auto single = payload(std::bit_cast<std::uint32_t>(0.1F));
  const auto twice = payload(std::bit_cast<std::uint64_t>(0.1 + 0.2));
  for (const auto print : {printed, printed_as_json}) {
    CHECK(print(float_field(protocol::Number::float32), single) == "0.1");
    CHECK(print(float_field(protocol::Number::float64), twice) == "0.30000000000000004");
    // With a scale the product counts, of which a float32 would keep less.
    CHECK(print(float_field(protocol::Number::float32, {5, -1}), single) == "0.05000000074505806");
    CHECK(print(float_field(protocol::Number::float32), payload(0)) == "0");
    CHECK(print(float_field(protocol::Number::float32), payload(0xC0A0'0000)) == "-5");
  }
}

TEST_CASE("what is no number is a word, in JSON a string", "[output]") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto wide = float_field(protocol::Number::float64);
  const auto narrow = float_field(protocol::Number::float32);
  const auto wide_of = [](double value) { return payload(std::bit_cast<std::uint64_t>(value)); };
  CHECK(printed(wide, wide_of(infinity)) == "Infinity");
  CHECK(printed(wide, wide_of(-infinity)) == "-Infinity");
  CHECK(printed(wide, wide_of(std::nan(""))) == "NaN");
  CHECK(printed_as_json(wide, wide_of(infinity)) == R"("Infinity")");
  CHECK(printed_as_json(wide, wide_of(-infinity)) == R"("-Infinity")");
  CHECK(printed_as_json(wide, wide_of(std::nan(""))) == R"("NaN")");
  CHECK(printed_as_json(narrow, payload(0x7F80'0000)) == R"("Infinity")");
  CHECK(printed_as_json(narrow, payload(0x7FC0'0000)) == R"("NaN")");
}

TEST_CASE("a field's value is what the catalogue says, for every field and any bits", "[output]") {
  check_fields(amiro::catalogue, 2000);
  const auto other = spec::load(std::string{OCM_SOURCE_DIR} + "/examples/other-robot/topics.json");
  REQUIRE(other.spec != nullptr);
  check_fields(other.spec->catalogue(), 2000);
}

TEST_CASE("a field's value is exact for any scale, offset, width and byte order", "[output]") {
  std::mt19937_64 random{3};
  for (int i = 0; i < 20'000; ++i) {
    const auto width = static_cast<unsigned>(1 + random() % 64);
    const auto exponent = [&] { return static_cast<int>(random() % 29) - 22; };
    const auto scale =
        base::normalised(static_cast<std::int64_t>(any_bits(random) % 1'000'000) + 1, exponent());
    const auto offset =
        random() % 2 == 0
            ? base::Decimal{}
            : base::normalised(static_cast<std::int64_t>(any_bits(random) % 10'000) - 5000, exponent());
    auto field = field_of(width, random() % 2 == 0, scale, offset);
    if (random() % 2 == 0) {
      field.position = {7, static_cast<std::uint8_t>(width), protocol::ByteOrder::big};
    }
    for (int j = 0; j < 5; ++j) {
      can::Payload data = payload(random());
      protocol::put(data, field.position, static_cast<std::int64_t>(any_bits(random)));
      REQUIRE(FieldText{field}.raw(data.data()) == field.raw(data));
      if (field.physical(field.raw(data))) {
        REQUIRE(printed(field, data) == expected(field, data));
      } else {  // more than 63 bits: as near as a double
        const double value = field.value(field.raw(data));
        REQUIRE(std::abs(std::stod(printed(field, data)) - value) <= 1e-14 * std::abs(value));
      }
    }
  }
}

TEST_CASE("a field is read from where it is, anywhere in a CAN FD frame and in a longer message",
          "[output]") {
  using protocol::ByteOrder;
  std::mt19937_64 random{4};
  for (const unsigned width : {1U, 7U, 8U, 12U, 16U, 31U, 32U, 57U, 58U, 63U, 64U})
    for (const ByteOrder order : {ByteOrder::little, ByteOrder::big})
      for (unsigned first = 0; first + width <= 8 * 72; ++first) {
        auto field = field_of(width, true, {1, 0});
        const unsigned start = order == ByteOrder::little ? first : first / 8 * 8 + 7 - first % 8;
        field.position = {static_cast<std::uint16_t>(start), static_cast<std::uint8_t>(width), order};
        // As many bytes as there are to be: see can::FrameView and j1939::Transported.
        const std::size_t end = field.position.bytes();
        std::vector<std::uint8_t> bytes(end <= 8 ? 8 : end <= 64 ? 64 : end + 8);
        for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
        const std::int64_t raw = field.raw(std::span<const std::uint8_t>{bytes}.first(end));
        const FieldText field_text{field};
        char text[FieldText::room];
        CAPTURE(width, first, order == ByteOrder::big);
        REQUIRE(field_text.raw(bytes.data()) == raw);
        REQUIRE(std::string(text, field_text.print(text, bytes.data())) == std::to_string(raw));
      }
}

}  // namespace tool_output_field_text_test
