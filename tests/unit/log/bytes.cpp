#include "ocm/log/bytes.hpp"

#include <string>

#include <catch2/catch.hpp>

namespace log_bytes_test {

using ocm::log::Bytes;

TEST_CASE("bytes are appended, overwritten and emptied") {
  Bytes bytes;
  CHECK(bytes.view().empty());
  bytes.append("ab");
  bytes.append('c');
  bytes.append("");
  bytes.zeros(2);
  bytes.zeros(0);
  bytes.little(std::uint32_t{0x0403'0201});
  bytes.little(std::int16_t{-2});
  using namespace std::string_literals;
  CHECK(bytes.view() == "abc\0\0\x01\x02\x03\x04\xFE\xFF"s);
  bytes.little_at(3, std::uint16_t{0x4241});
  CHECK(bytes.view().substr(0, 5) == "abcAB");
  bytes.clear();
  CHECK(bytes.size() == 0);
}

TEST_CASE("what is appended has room where there is none any more") {
  using namespace std::string_literals;
  for (std::size_t left = 0; left <= 9; ++left) {
    Bytes bytes;
    bytes.zeros((std::size_t{1} << 16) - left);  // what is taken at first is so large
    bytes.append('c');
    bytes.append("ab");
    bytes.little(std::uint32_t{0x0403'0201});
    bytes.zeros(1);
    CHECK(bytes.view().substr(bytes.size() - 8) == "cab\x01\x02\x03\x04\0"s);
  }
  Bytes bytes;
  bytes.append('a');
  bytes.zeros(std::size_t{1} << 17);
  CHECK(bytes.view().front() == 'a');
}

TEST_CASE("room that is not used is not part of the run, and growing keeps what is there") {
  Bytes bytes;
  bytes.append("begin");
  std::string expected = "begin";
  for (int i = 0; i < 100; ++i) {
    char* const at = bytes.room(4000);
    for (int k = 0; k < 3000; ++k) at[k] = static_cast<char>('a' + (i + k) % 26);
    expected.append(at, 3000);
    if (i % 2 == 0)
      bytes.grow(3000);
    else
      bytes.grow_to(at + 3000);
  }
  CHECK(bytes.view() == expected);
}

}  // namespace log_bytes_test
