// The parts' line between an emulated board and its host, both readers.
#include "firmware/qemu/parts_frames.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <catch2/catch.hpp>

namespace {

using namespace ocm::firmware::qemu;
using ocm::base::Error;

using Bytes = std::vector<std::uint8_t>;

template <class Frame>
Bytes bytes_of(const Frame& frame, std::span<const std::uint8_t> rest) {
  Bytes bytes;
  for (const std::uint8_t byte : link::header(frame)) bytes.push_back(byte);
  for (const std::uint8_t byte : rest) bytes.push_back(byte);
  return bytes;
}

TEST_CASE("a request on the line, byte by byte") {
  const std::array<std::uint8_t, 2> written{0xA0, 0x01};
  const link::Request request{
      .sequence = 7, .kind = link::Kind::i2c, .unit = 2, .a = 0x55, .asked = 3, .written = written};
  CHECK(bytes_of(request, written) == Bytes{7, 1, 2, 0x55, 2, 3, 0xA0, 0x01});
  CHECK(static_cast<int>(link::Kind::spi) == 2);
  CHECK(static_cast<int>(link::Kind::set_duty) == 3);
  CHECK(static_cast<int>(link::Kind::encoders) == 4);
  CHECK(static_cast<int>(link::Kind::inputs) == 5);
  CHECK(static_cast<int>(link::Kind::outputs) == 6);
  CHECK(static_cast<int>(link::Kind::convert) == 7);
  CHECK(static_cast<int>(link::Kind::set_pulse) == 8);
}

TEST_CASE("an answer on the line, byte by byte") {
  CHECK(bytes_of(link::Answer{.sequence = 9, .status = Error::no_answer}, {}) ==
        Bytes{9, static_cast<std::uint8_t>(Error::no_answer), 0});
}

TEST_CASE("requests of every length come out as they went in, one after the other") {
  link::RequestReader reader;
  for (std::size_t length = 0; length <= link::max_bytes; ++length) {
    Bytes written(length);
    for (std::size_t i = 0; i < length; ++i) written[i] = static_cast<std::uint8_t>(i * 7 + length);
    const link::Request request{.sequence = static_cast<std::uint8_t>(length),
                                .kind = link::Kind::spi,
                                .unit = 1,
                                .a = 3,
                                .asked = static_cast<std::uint8_t>(255 - length),
                                .written = written};
    const Bytes line = bytes_of(request, written);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) REQUIRE_FALSE(reader.feed(line[i]));
    REQUIRE(reader.feed(line.back()));
    const link::Request read = reader.request();
    CHECK(read.sequence == request.sequence);
    CHECK(read.kind == request.kind);
    CHECK(read.unit == request.unit);
    CHECK(read.a == request.a);
    CHECK(read.asked == request.asked);
    CHECK(std::ranges::equal(read.written, written));
  }
}

TEST_CASE("answers of every length come out as they went in, one after the other") {
  link::AnswerReader reader;
  for (std::size_t length = 0; length <= link::max_bytes; ++length) {
    const Bytes bytes(length, static_cast<std::uint8_t>(length + 1));
    const link::Answer answer{.sequence = 0xFE, .status = Error::none, .bytes = bytes};
    const Bytes line = bytes_of(answer, bytes);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) REQUIRE_FALSE(reader.feed(line[i]));
    REQUIRE(reader.feed(line.back()));
    CHECK(reader.answer().sequence == 0xFE);
    CHECK(reader.answer().status == Error::none);
    CHECK(std::ranges::equal(reader.answer().bytes, bytes));
  }
}

}  // namespace
