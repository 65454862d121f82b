/// What the fuzz targets of log formats share.
#pragma once

#include <array>
#include <vector>

#include "ocm/log/entry.hpp"
#include "ocm/log/reader.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

namespace ocm::fuzz {

/// Of log::Input: so little that lines and records often lie across its end.
inline constexpr std::size_t small_room = 256;

/// Whether a bus could have carried it, or a controller reported it.
[[nodiscard]] inline bool can_exist(const log::Entry& entry) {
  const bool wide = can::is_extended(entry.format) || entry.format == can::Format::error;
  if (entry.id > (wide ? can::max_extended_id : can::max_base_id)) return false;
  for (std::size_t i = entry.bytes().size(); i < 8; ++i)
    if (entry.data[i] != 0) return false;
  if (entry.is_fd())
    return log::is_fd_length(entry.length) && entry.raw_dlc == 0 && !can::is_remote(entry.format) &&
           entry.format != can::Format::error;
  if (entry.raw_dlc != 0 && (entry.raw_dlc <= can::max_dlc || entry.raw_dlc > 15 ||
                             entry.length != can::max_dlc || entry.format == can::Format::error))
    return false;
  return entry.length <= can::max_dlc;
}

/// To the end; each entry is one that can exist, of an interface that the reader knows.
[[nodiscard]] inline std::vector<log::Entry> read_all(log::Reader& reader) {
  std::vector<log::Entry> entries;
  std::array<log::Entry, log::batch> some;
  while (const std::size_t count = reader.read(some))
    for (std::size_t i = 0; i < count; ++i) {
      expect(can_exist(some[i]), "an entry can exist");
      expect(some[i].interface < reader.interfaces().size(), "an entry is of a known interface");
      entries.push_back(some[i]);
    }
  return entries;
}

}  // namespace ocm::fuzz
