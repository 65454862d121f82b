// What is packed comes back, in pieces of any size; what is cut off or damaged says so.
#include "cli/logs/packing.hpp"

#include <cstddef>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/log/input.hpp"

namespace tool_output_packing_test {

using namespace ocm;
using namespace std::string_view_literals;
using cli::logs::Packer;
using cli::logs::Packing;

/// All that a source hands out, in pieces of at most so many bytes, and why it ended.
struct Unpacked {
  std::string text;
  std::string failure;
};
Unpacked unpacked(Packing packing, std::string_view packed, std::size_t piece = 1000) {
  log::MemorySource source{packed};
  const auto made = cli::logs::unpack(packing, source);
  REQUIRE(made);
  Unpacked out;
  std::string into(piece, '\0');
  for (std::size_t count = 1; count != 0;) {
    count = made.value->read(std::span{into.data(), into.size()});
    REQUIRE(count <= piece);
    out.text += into.substr(0, count);
  }
  CHECK(made.value->read(std::span{into.data(), into.size()}) == 0);  // it stays at its end
  out.failure = made.value->failure();
  return out;
}

std::string packed(Packing packing, std::string_view text) {
  const auto packer = cli::logs::make_packer(packing);
  REQUIRE(packer);
  std::string out;
  packer.value->pack(text, out, Packer::Until::ended);
  return out;
}

/// Hard to pack.
std::string noise(std::size_t size) {
  std::mt19937 random{7};
  std::string text(size, '\0');
  for (char& c : text) c = static_cast<char>(random() & 0xFF);
  return text;
}

/// Those that this build has.
std::vector<Packing> packings() {
  std::vector<Packing> all;
  for (const Packing packing : {Packing::gzip, Packing::zstd})
    if (cli::logs::make_packer(packing)) all.push_back(packing);
  return all;
}

std::string in_the_middle(Packing packing) {
  return packing == Packing::gzip ? "the gzip data ends in the middle" : "the zstd data ends in the middle";
}

TEST_CASE("packing: known by the first bytes, and by the ending of a name") {
  using cli::logs::packing_of;
  using cli::logs::packing_of_name;
  CHECK(packing_of("\x1F\x8B"sv) == Packing::gzip);
  CHECK(packing_of("\x1F\x8B\x08\x00"sv) == Packing::gzip);
  CHECK(packing_of("\x28\xB5\x2F\xFD"sv) == Packing::zstd);
  for (const std::string_view beginning :
       {""sv, "\x1F"sv, "\x1F\x8C"sv, "\x28\xB5\x2F"sv, "\x28\xB5\x2F\xFE"sv})
    CHECK(packing_of(beginning) == Packing::none);
  CHECK(packing_of_name("a.log.gz") == Packing::gzip);
  CHECK(packing_of_name(".zst") == Packing::zstd);
  for (const std::string_view name : {"", "a.log", "gz", "a.gz.log", "azst"})
    CHECK(packing_of_name(name) == Packing::none);
}

TEST_CASE("packing: what was packed comes back, in pieces of any size") {
  for (const Packing packing : packings())
    for (const std::size_t size : {0U, 1U, 1000U, 300'000U})
      for (const std::size_t piece : {1U, 7U, 1000U, 400'000U}) {
        if (size > 1000 && piece < 1000) continue;
        CAPTURE(static_cast<int>(packing), size, piece);
        const std::string text = noise(size);
        const auto out = unpacked(packing, packed(packing, text), piece);
        CHECK((out.text == text));
        CHECK(out.failure.empty());
      }
}

TEST_CASE("packing: all that was taken so far can be read, once that is asked for") {
  for (const Packing packing : packings())
    for (const std::size_t size : {10U, 200'000U}) {
      CAPTURE(static_cast<int>(packing), size);
      const auto packer = cli::logs::make_packer(packing);
      REQUIRE(packer);
      const std::string text = noise(3 * size);
      const auto part = [&](std::size_t number) {
        return std::string_view{text}.substr(number * size, size);
      };
      std::string out = "before";
      packer.value->pack(part(0), out, Packer::Until::more);
      packer.value->pack(part(1), out, Packer::Until::here);
      REQUIRE(out.starts_with("before"));
      out.erase(0, 6);
      const auto so_far = unpacked(packing, out);
      CHECK((so_far.text == text.substr(0, 2 * size)));
      CHECK(so_far.failure == in_the_middle(packing));
      packer.value->pack(part(2), out, Packer::Until::ended);
      const auto all = unpacked(packing, out);
      CHECK((all.text == text));
      CHECK(all.failure.empty());
    }
}

TEST_CASE("packing: what is cut off anywhere says so, behind what could be read of it") {
  const std::string_view text = "(1000000000.000000) can0 123#00\n(1000000000.100000) can0 123#01\n";
  for (const Packing packing : packings()) {
    const std::string whole = packed(packing, text);
    for (std::size_t size = 1; size < whole.size(); ++size) {
      CAPTURE(static_cast<int>(packing), size);
      const auto out = unpacked(packing, whole.substr(0, size));
      CHECK(text.starts_with(out.text));
      CHECK(out.failure == in_the_middle(packing));
    }
  }
}

TEST_CASE("packing: packed files behind each other are one, and what is none behind them is damage") {
  for (const Packing packing : packings()) {
    CAPTURE(static_cast<int>(packing));
    const auto two = unpacked(packing, packed(packing, "abc") + packed(packing, "") + packed(packing, "def"));
    CHECK(two.text == "abcdef");
    CHECK(two.failure.empty());
    const auto damaged = unpacked(packing, packed(packing, "abc") + "words");
    CHECK(damaged.text == "abc");
    CHECK(damaged.failure == (packing == Packing::gzip
                                  ? "the gzip data is damaged: incorrect header check"
                                  : "the zstd data is damaged: Unknown frame descriptor"));
    if (packing != Packing::gzip) continue;
    // Tapes and tools pad with zeros; nothing begins with them.
    const std::string zeros(70'000, '\0');
    const auto padded = unpacked(packing, packed(packing, "abc") + zeros + packed(packing, "def") + zeros);
    CHECK(padded.text == "abcdef");
    CHECK(padded.failure.empty());
    const auto zeros_first = unpacked(packing, zeros + packed(packing, "abc"));
    CHECK(zeros_first.text.empty());
    CHECK(zeros_first.failure == "the gzip data is damaged: incorrect header check");
  }
}

}  // namespace tool_output_packing_test
