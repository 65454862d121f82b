// What is read of a file, in pieces of any size.
#include "cli/logs/file_source.hpp"

#include <array>
#include <cstddef>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>

#include "cli/logs/inflate.hpp"
#include "unit/host/host_testing.hpp"

namespace tool_output_file_source_test {

using namespace ocm;
using namespace std::string_view_literals;
using cli::logs::FileSource;

/// A file that goes with it.
class File {
 public:
  explicit File(std::string_view text) { std::ofstream{path_, std::ios::binary} << text; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  test::TemporaryDirectory folder_;
  std::string path_ = folder_.file("source");
};

TEST_CASE("file source: its beginning was looked at, and all of it is read, in pieces of any size") {
  for (const std::string_view text : {""sv, "a"sv, "abc"sv, "abcd"sv, "abcde"sv, "abcdefghij"sv}) {
    const File file{text};
    for (const bool looked_at : {false, true})
      for (std::size_t piece = 1; piece <= 11; ++piece) {
        CAPTURE(text, looked_at, piece);
        FileSource source{file.path()};
        CHECK(source.size() == text.size());
        if (looked_at) CHECK(source.beginning() == text.substr(0, 4));
        std::string read;
        std::array<char, 11> into{};
        // A piece that is never the last one would be read again and again.
        for (int i = 0; i < 20; ++i) {
          const std::size_t count = source.read(std::span{into}.first(piece));
          if (count == 0) break;
          REQUIRE(count <= piece);
          read.append(into.data(), count);
        }
        CHECK(read == text);
        CHECK(source.position() == text.size());
        CHECK(source.failure().empty());
      }
  }
}

TEST_CASE("file source: the standard input stays open, and a file does not") {
  const File file{"abc"};
  const int before = ::open("/dev/null", O_RDONLY | O_CLOEXEC);  // 0, where there is no standard input
  REQUIRE(before >= 0);
  const int next = ::dup(before);
  ::close(next);
  { const FileSource source{"-"}; }
  CHECK(::fcntl(STDIN_FILENO, F_GETFD) != -1);
  {
    const FileSource source{file.path()};
    CHECK(::fcntl(next, F_GETFD) != -1);
  }
  CHECK(::fcntl(next, F_GETFD) == -1);
  if (before != STDIN_FILENO) ::close(before);
}

TEST_CASE("file source: a whole file is as long as it may be, and no longer") {
  const File file{"abcdefghij"};
  for (const std::size_t most : {10U, 11U}) {
    const auto whole = cli::logs::read_file(file.path(), most);
    CHECK(whole.text == "abcdefghij");
    CHECK(whole.failure.empty());
    CHECK_FALSE(whole.too_long);
  }
  const auto too_long = cli::logs::read_file(file.path(), 9);
  CHECK(too_long.text.empty());
  CHECK(too_long.failure.empty());
  CHECK(too_long.too_long);
  const auto folder = cli::logs::read_file(std::filesystem::temp_directory_path().string(), 10);
  CHECK(folder.text.empty());
  CHECK(folder.failure == "Is a directory");
  CHECK(cli::logs::read_file(file.path() + ".none", 10).failure == "No such file or directory");
}

TEST_CASE("file source: a byte order mark is passed over, and nothing that begins alike") {
  for (const auto& [text, rest] : {std::pair{"\xEF\xBB\xBF"
                                             "abc"sv,
                                             "abc"sv},
                                   {"\xEF\xBB\xBF"sv, ""sv},
                                   {""sv, ""sv},
                                   {"abc"sv, "abc"sv},
                                   {"\xEF\xBB"sv, "\xEF\xBB"sv},
                                   {"\xEF\xBC\x88("sv, "\xEF\xBC\x88("sv},
                                   {"\xEF\xBB\xBF\xEF\xBB\xBF"sv, "\xEF\xBB\xBF"sv}}) {
    log::MemorySource source{text};
    log::Input input{source};
    cli::logs::skip_byte_order_mark(input);
    CHECK(input.peek(100) == rest);
  }
}

TEST_CASE("inflate: data of zlib is unpacked as far as there is room for it, and as far as it is whole") {
  const log::Inflate unpack = cli::logs::zlib_inflate();
  if (unpack == nullptr) {
    WARN("built without zlib");
    return;
  }
  // Of Python's zlib.compress.
  constexpr std::string_view packed =
      "\x78\xDA\x4B\x4E\xCC\x4B\x29\xCD\x2D\x50\x48\x46\xA5\x01\x6A\xE5\x08\xF9"sv;
  constexpr std::string_view text = "candump candump candump";
  std::array<char, 100> into{};
  CHECK(std::string_view{into.data(), unpack(packed, into)} == text);
  into.fill('.');
  CHECK(unpack(packed, std::span{into}.first(5)) == 5);
  CHECK(std::string_view{into.data(), 6} == "candu.");
  CHECK(std::string_view{into.data(), unpack(packed.substr(0, 8), into)} == text.substr(0, 5));
  CHECK(unpack("candump", into) == 0);
  CHECK(unpack("", into) == 0);
}

}  // namespace tool_output_file_source_test
