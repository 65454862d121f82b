/// Names of recordings: by default the robot's and the moment, numbered where a recording has several files,
/// and never those of a file that is there.
#pragma once

#include <cstdint>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/transport/bus.hpp"

namespace ocm::cli::record {

/// "amiro-2026-11-21_163000", in local time; of a robot's name what a file's name can hold.
[[nodiscard]] std::string default_stem(std::string_view robot, std::time_t now);
/// "amiro-ring": the same for every recording, so that each finds the files of those before. Without the
/// moment, which a robot does not know at boot if its clock has no battery.
[[nodiscard]] std::string ring_stem(std::string_view robot);

/// "drive.log.gz" with ".log" -> "drive" and ".log.gz"; where the name does not end so, all of it and
/// nothing.
struct FileName {
  std::string stem;
  std::string ending;
};
[[nodiscard]] FileName split_name(const std::string& path, std::string_view ending);

/// "drive_007.log": the seventh file of a recording; more digits where 999 are not enough.
[[nodiscard]] std::string numbered(const FileName& name, std::uint64_t number);

/// The files of a recording that are there, by number.
struct NumberedFile {
  std::uint64_t number = 0;
  std::string path;
};
[[nodiscard]] std::vector<NumberedFile> numbered_files(const FileName& name);

enum class Claimed : std::uint8_t { ours, taken, failed };
/// Whose a pipe or a device is that has the name already: a user's word means it, a number that follows does
/// not. An ordinary file is always another's.
enum class Devices : bool { taken, ours };
/// Creates `path` empty where nothing is there, so that no other program gets the name. `errno` says why it
/// failed.
[[nodiscard]] Claimed claim(const std::string& path, Devices devices = Devices::ours);

/// 0: not a size. "100MB", "64k", "1.5GiB"; k, M, G are powers of ten, with i powers of two.
[[nodiscard]] std::uint64_t parse_size(std::string_view text);
/// "1.2 MB"
[[nodiscard]] std::string size_text(std::uint64_t bytes);

}  // namespace ocm::cli::record
