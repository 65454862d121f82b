#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "cli/record/names.hpp"

namespace recording_names_test {

using namespace ocm::cli::record;

TEST_CASE("recordings: names of robots as a file can have them") {
  CHECK(ring_stem("AMiRo") == "amiro-ring");
  CHECK(ring_stem("AZaz 09/_ä") == "azaz09-ring");
  CHECK(ring_stem("/") == "robot-ring");
  std::tm local{};
  local.tm_year = 126, local.tm_mon = 10, local.tm_mday = 21, local.tm_hour = 16, local.tm_min = 30,
  local.tm_sec = 7;
  local.tm_isdst = -1;
  CHECK(default_stem("AMiRo", std::mktime(&local)) == "amiro-2026-11-21_163007");
}

TEST_CASE("recordings: names of several files") {
  const auto split = [](const std::string& path, std::string_view ending) {
    const FileName name = split_name(path, ending);
    return name.stem + "|" + name.ending;
  };
  CHECK(split("a/drive.log", ".log") == "a/drive|.log");
  CHECK(split("drive.log.gz", ".log") == "drive|.log.gz");
  CHECK(split("drive.log.zst", ".log") == "drive|.log.zst");
  CHECK(split("drive.txt", ".log") == "drive.txt|");
  CHECK(split(".log", ".log") == ".log|");
  CHECK(split("drive.log", "") == "drive.log|");
  CHECK(numbered({"drive", ".log"}, 7) == "drive_007.log");
  CHECK(numbered({"drive", ".log"}, 1000) == "drive_1000.log");
}

TEST_CASE("recordings: the files that are there, by number") {
  std::string folder = (std::filesystem::temp_directory_path() / "names-XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  const FileName name{folder + "/drive", ".log"};
  CHECK(numbered_files(name).empty());
  for (const char* file : {"drive_010.log", "drive_002.log", "drive_1000.log", "drive_7.log", "drive_.log",
                           "drive_003.csv", "other_001.log", "drive_0x1.log", "drive_004.log.gz"}) {
    std::FILE* const made = std::fopen((folder + "/" + file).c_str(), "w");
    REQUIRE(made != nullptr);
    std::fclose(made);
  }
  std::filesystem::create_directory(folder + "/drive_005.log");
  std::vector<std::uint64_t> numbers;
  for (const NumberedFile& file : numbered_files(name)) numbers.push_back(file.number);
  CHECK(numbers == std::vector<std::uint64_t>{2, 10, 1000});
  CHECK(numbered_files(name)[0].path == folder + "/drive_002.log");

  CHECK(claim(folder + "/new.log") == Claimed::ours);
  CHECK(claim(folder + "/new.log") == Claimed::taken);
  CHECK(claim(folder + "/drive_005.log") == Claimed::taken);
  CHECK(claim("/dev/null") == Claimed::ours);
  CHECK(claim("/dev/null", Devices::taken) == Claimed::taken);
  std::filesystem::create_symlink("nowhere", folder + "/link.log");
  CHECK(claim(folder + "/link.log") == Claimed::failed);
  CHECK(claim(folder + "/link.log", Devices::taken) == Claimed::taken);
  CHECK(claim(folder + "/none/new.log") == Claimed::failed);
  std::filesystem::remove_all(folder);
}

TEST_CASE("recordings: sizes as they are typed, and as they are printed") {
  struct Row {
    const char* text;
    std::uint64_t bytes;
  };
  for (const Row& row : {Row{"1", 1},
                         Row{"1B", 1},
                         Row{"20kB", 20'000},
                         Row{"2K", 2'000},
                         Row{"1.5MB", 1'500'000},
                         Row{"3M", 3'000'000},
                         Row{"2GB", 2'000'000'000},
                         Row{"1TB", 1'000'000'000'000},
                         Row{"1kiB", 1024},
                         Row{"1Ki", 1024},
                         Row{"2MiB", 2 << 20},
                         Row{"1GiB", 1 << 30},
                         Row{"0", 0},
                         Row{"-1", 0},
                         Row{"0.5", 0},
                         Row{"1m", 0},
                         Row{"MB", 0},
                         Row{"", 0},
                         Row{"9000000TB", 0},
                         Row{"8999999TB", 8'999'999'000'000'000'000U}}) {
    CAPTURE(row.text);
    CHECK(parse_size(row.text) == row.bytes);
  }
  CHECK(size_text(0) == "0 bytes");
  CHECK(size_text(999) == "999 bytes");
  CHECK(size_text(1000) == "1.0 kB");
  CHECK(size_text(1'250'000) == "1.2 MB");
  CHECK(size_text(3'000'000'000) == "3.0 GB");
  CHECK(size_text(4'560'000'000'000) == "4.6 TB");
  CHECK(size_text(1'000'000'000'000'000) == "1000.0 TB");
}

}  // namespace recording_names_test
