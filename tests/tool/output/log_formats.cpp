// Which formats of logs there are, and which one a name means.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/log/mcap.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/logs/format.hpp"
#include "tests/tool/captured.hpp"
#include "tests/unit/log/log_testing.hpp"

namespace tool_output_log_formats_test {

using namespace ocm;
using cli::logs::find_format;
using cli::logs::format_of_name;

std::string_view name_of(const cli::logs::LogFormat* format) {
  return format == nullptr ? "none" : format->name;
}

TEST_CASE("log formats: which are read, and which are written") {
  CHECK(cli::logs::readable_formats() == std::vector<std::string>{"pcapng", "pcap", "mcap", "blf", "asc",
                                                                  "candump", "candump-ns", "candump-screen",
                                                                  "csv", "json"});
  CHECK(cli::logs::writable_formats() == std::vector<std::string>{"pcapng", "pcap", "mcap", "mcap-raw", "asc",
                                                                  "candump", "candump-ns", "csv", "json"});
  for (const auto& format : cli::logs::log_formats()) CHECK(find_format(format.name) == &format);
  CHECK(find_format("") == nullptr);
  CHECK(find_format("candum") == nullptr);
}

TEST_CASE("log formats: a file's ending says its format, packed or not") {
  CHECK(name_of(format_of_name("a.log")) == "candump");
  CHECK(name_of(format_of_name("a.log.gz")) == "candump");
  CHECK(name_of(format_of_name("a.jsonl.zst")) == "json");
  CHECK(name_of(format_of_name("a.mcap")) == "mcap");
  CHECK(name_of(format_of_name(".csv")) == "csv");
  for (const std::string_view name : {"", "a", "a.gz", "log", "a.log.txt", "a.log.gz.txt"})
    CHECK(name_of(format_of_name(name)) == "none");
  for (const std::string_view word : {"a/b", "/", "a.log", "a.gz", "a.zst", "a.blf.gz"}) {
    CAPTURE(word);
    CHECK(cli::logs::names_file(word));
  }
  for (const std::string_view word : {"", "gyro", "gz", "a.txt"}) {
    CAPTURE(word);
    CHECK_FALSE(cli::logs::names_file(word));
  }
}

TEST_CASE(
    "log formats: what is written is of the format that is named, else of the ending's, else it is refused") {
  const auto to_write = [](const std::string& out, const std::string& named,
                           const char* for_stdout = nullptr) {
    return cli::logs::format_to_write("convert", out, named, for_stdout).name;
  };
  CHECK(to_write("a.log", "") == "candump");
  CHECK(to_write("a.log", "csv") == "csv");
  CHECK(to_write("-", "csv") == "csv");
  CHECK(to_write("-", "", "json") == "json");
  CHECK(to_write("-", "csv", "json") == "csv");
  CHECK(to_write("a.log", "", "json") == "candump");
  const auto refused = [&](const std::string& out, const std::string& named, std::string_view words) {
    const auto left = test::leaving([&] { static_cast<void>(to_write(out, named)); });
    CAPTURE(left.text);
    CHECK(left.code == 2);
    CHECK(left.text.find(words) != std::string::npos);
    CHECK(left.text.find("--to names a format: pcapng, pcap, ") != std::string::npos);
  };
  refused("a.log", "foo", "convert: no log format 'foo'");
  refused("-", "", "convert: what goes to the standard output has no ending to tell the format");
  refused("a.foo", "", "convert: the ending of a.foo is of no log format");
  refused("a.blf", "", "convert: blf is read only");
  refused("a.log", "blf", "convert: blf is read only");
}

std::size_t times(std::string_view text, std::string_view part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string_view::npos; at = text.find(part, at + part.size()))
    ++count;
  return count;
}

TEST_CASE("mcap: frames of all interfaces, and samples of the first 64") {
  log::Interfaces interfaces;
  for (int i = 0; i < 70; ++i) interfaces.add("can" + std::to_string(i));
  std::vector<log::Entry> entries;
  for (const int interface : {0, 1, 63, 64, 65, 69}) {
    // A gyroscope's: three digits of 0.0175 deg/s.
    log::Entry entry{base::Time{base::Duration{1'000'000'000}},
                     can::Frame{0x608, 6, {0x03, 0x00, 0xFF, 0xFF}}};
    entry.interface = static_cast<std::uint16_t>(interface);
    entries.push_back(entry);
  }
  for (const std::string_view name : {"mcap", "mcap-raw"}) {
    CAPTURE(name);
    const auto writer = find_format(name)->writer(amiro::catalogue);
    const std::string file = log::testing::write_all(*writer, entries, interfaces);
    CHECK(times(file, R"({"x":0.0525,"y":-0.0175,"z":0})") == (name == "mcap" ? 3U : 0U));
    const auto log = log::testing::read_all<log::McapReader>(file);
    CHECK(log.complained == 0);
    CHECK(log.names == std::vector<std::string>{"can0", "can1", "can63", "can64", "can65", "can69"});
  }
}

}  // namespace tool_output_log_formats_test
