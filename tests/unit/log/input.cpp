#include "ocm/log/input.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "unit/log/entries.hpp"

namespace log_input_test {

using namespace ocm;
using log::Input;

// 16 MiB, and what quick ways of readers look at behind a view.
static_assert(Input::longest == 16'777'216 && Input::padding == 64);

std::vector<std::string> lines_of(log::Source& source) {
  Input input{source};
  std::vector<std::string> lines;
  std::string_view line;
  for (;;) {
    const auto taken = input.take_line(line);
    if (taken == Input::Line::none) return lines;
    lines.emplace_back((taken == Input::Line::last ? "last:" : "") + std::string{line});
    CHECK(input.line_number() == lines.size());
  }
}

TEST_CASE("lines end with LF or CR LF, and the last may lack its end") {
  for (const std::size_t drop : {1U, 2U, 3U, 100U}) {
    test::Drops drops{"a\r\n\nb\rc\n\r\nlast", drop};
    CHECK(lines_of(drops) == std::vector<std::string>{"a", "", "b\rc", "", "last:last"});
  }
  test::Drops nothing{"", 1};
  CHECK(lines_of(nothing).empty());
}

TEST_CASE("lines of every length cross the borders of blocks whole") {
  std::string text;
  std::vector<std::string> expected;
  for (std::size_t length = 0; text.size() < 3 * Input::block; length = (length * 7 + 13) % 5003) {
    expected.emplace_back(length, static_cast<char>('a' + length % 26));
    text += expected.back() + '\n';
  }
  for (const std::size_t drop : {4096U, 65537U, 1U << 20}) {
    test::Drops drops{text, drop};
    CHECK(lines_of(drops) == expected);
  }
}

TEST_CASE("a line that is longer than any log has is passed over, and the next one is read") {
  const std::string text = std::string(Input::longest + 5, 'x') + "\nnext\n";
  test::Drops drops{text, 1 << 16};
  Input input{drops};
  std::string_view line;
  CHECK(input.take_line(line) == Input::Line::too_long);
  CHECK(line == std::string(64, 'x'));
  CHECK(input.take_line(line) == Input::Line::whole);
  CHECK(line == "next");
  CHECK(input.line_number() == 2);
}

TEST_CASE("who does not wait gets what is there, and reads nothing") {
  test::Drops drops{"one\ntw", 6};
  Input input{drops};
  std::string_view line;
  CHECK(input.take_line(line, Input::Wait::yes) == Input::Line::whole);
  CHECK(drops.reads == 1);
  CHECK(input.take_line(line, Input::Wait::no) == Input::Line::later);
  CHECK(drops.reads == 1);
  CHECK(input.take_line(line, Input::Wait::yes) == Input::Line::last);
  CHECK(line == "tw");
}

TEST_CASE("peek shows without taking, and zeros behind") {
  test::Drops drops{"abcdef", 2};
  Input input{drops};
  CHECK(input.peek(3) == "abc");
  CHECK(input.here() == 4);
  CHECK(input.offset() == 0);
  input.skip(2);
  CHECK(input.offset() == 2);
  const auto rest = input.peek(100);
  CHECK(rest == "cdef");
  for (std::size_t i = 0; i < Input::padding; ++i) CHECK(rest.data()[rest.size() + i] == '\0');
  CHECK(input.peek(Input::longest + 1) == "cdef");
}

TEST_CASE("peek reads no more than it needs") {
  test::Drops drops{"abcdef", 2};
  Input input{drops};
  CHECK(input.peek(2) == "ab");
  CHECK(input.peek(2) == "ab");
  CHECK(drops.reads == 1);
}

TEST_CASE("zeros are behind what is read where something else has stood") {
  test::Drops drops{"abcdefghij", 8};
  Input input{drops, 8};
  CHECK(input.peek(8) == "abcdefgh");
  input.skip(8);
  const auto rest = input.peek(2);
  CHECK(rest == "ij");
  for (std::size_t i = 0; i < Input::padding; ++i) CHECK(rest.data()[rest.size() + i] == '\0');
}

TEST_CASE("lines are whole however little room there is at first") {
  std::string text;
  std::vector<std::string> expected;
  for (std::size_t i = 0; i < 40; ++i) {
    expected.emplace_back(i * 7 % 40, static_cast<char>('a' + i % 26));
    text += expected.back() + '\n';
  }
  for (std::size_t room = 1; room <= 80; ++room) {
    log::MemorySource source{text};
    Input input{source, room};
    std::vector<std::string> lines;
    std::string_view line;
    while (input.take_line(line) == Input::Line::whole) lines.emplace_back(line);
    CAPTURE(room);
    CHECK(lines == expected);
    CHECK(input.offset() == text.size());
  }
}

TEST_CASE("discard takes more than memory holds") {
  const std::string text(5 * Input::block, 'x');
  log::MemorySource source{text};
  Input input{source};
  CHECK(input.discard(5 * Input::block - 1));
  CHECK(input.peek(1) == "x");
  CHECK(input.discard(1));
  CHECK_FALSE(input.discard(1));
  CHECK(input.offset() == text.size());
}

TEST_CASE("skip_line counts a line") {
  log::MemorySource source{"one\ntwo\n"};
  Input input{source};
  CHECK(input.peek(4).starts_with("one\n"));
  input.skip_line(4);
  std::string_view line;
  CHECK(input.take_line(line) == Input::Line::whole);
  CHECK(line == "two");
  CHECK(input.line_number() == 2);
}

TEST_CASE("the source's failure is the input's") {
  test::Drops drops{"x", 1, "the disk is gone"};
  Input input{drops};
  CHECK(input.failure().empty());
  CHECK(input.peek(2) == "x");
  CHECK(input.failure() == "the disk is gone");
}

}  // namespace log_input_test
