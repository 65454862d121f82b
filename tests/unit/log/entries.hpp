/// Entries for the tests of log formats: random ones that can exist, and short ways through a reader and a
/// writer.
#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/log/entry.hpp"
#include "ocm/log/input.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

#include "unit/base/random.hpp"

namespace ocm::test {

/// What random entries may have; what a format cannot hold is switched off.
struct Kinds {
  bool fd = true;
  bool errors = true;
  bool raw_dlc = true;
  bool direction = true;
  std::uint16_t interfaces = 3;
  std::int64_t tick = 1;  ///< times are multiples of it, in nanoseconds
};

/// Nothing that a bus cannot carry. Times go up, from 2015 on.
class RandomEntries {
 public:
  RandomEntries(std::uint64_t seed, Kinds kinds) : random_(seed), kinds_(kinds) {}

  log::Entry next() {
    log::Entry entry;
    time_ += random_.below(50'000'000);
    entry.time = base::Time{base::Duration{time_ / kinds_.tick * kinds_.tick}};
    entry.interface = static_cast<std::uint16_t>(random_.below(kinds_.interfaces));
    if (kinds_.direction) entry.direction = static_cast<log::Direction>(random_.below(3));
    entry.format = static_cast<can::Format>(random_.below(kinds_.errors ? 5 : 4));
    const bool wide = can::is_extended(entry.format) || entry.format == can::Format::error;
    entry.id = random_() & (wide ? can::max_extended_id : can::max_base_id);
    if (kinds_.fd && entry.format < can::Format::base_remote && random_.below(3) == 0) {
      entry.flags = static_cast<std::uint8_t>(log::flag::fd | random_.below(4));
      entry.length = log::fd_length(random_.below(16));
    } else {
      entry.length = static_cast<std::uint8_t>(entry.format == can::Format::error ? 8 : random_.below(9));
      if (kinds_.raw_dlc && entry.length == 8 && entry.format != can::Format::error && random_.below(4) == 0)
        entry.raw_dlc = static_cast<std::uint8_t>(9 + random_.below(7));
    }
    if (!can::is_remote(entry.format))
      for (std::size_t i = 0; i < entry.length; ++i) entry.data[i] = static_cast<std::uint8_t>(random_());
    return entry;
  }
  std::vector<log::Entry> many(std::size_t count) {
    std::vector<log::Entry> entries;
    while (entries.size() < count) entries.push_back(next());
    return entries;
  }

 private:
  Random random_;
  Kinds kinds_;
  std::int64_t time_ = 1'436'509'052'249'713'000;
};

inline log::Interfaces interfaces_named(std::initializer_list<std::string_view> names) {
  log::Interfaces interfaces;
  for (const auto name : names) interfaces.add(name);
  return interfaces;
}

/// All that a reader makes of `bytes`.
template <class R>
struct ReadLog {
  explicit ReadLog(std::string_view bytes) : source(bytes), input(source), reader(input) {
    log::Entry some[7];  // a batch that is no divisor of anything
    while (const std::size_t count = reader.read(some)) entries.insert(entries.end(), some, some + count);
  }
  log::MemorySource source;
  log::Input input;
  R reader;
  std::vector<log::Entry> entries;
};

template <class W>
std::string written(W& writer, std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  log::Bytes out;
  writer.begin(out);
  writer.write(out, entries, interfaces);
  writer.finish(out);
  return std::string{out.view()};
}

/// Hands out a few bytes at a time, and may fail at the end: a pipe, or a damaged file.
class Drops final : public log::Source {
 public:
  Drops(std::string_view bytes, std::size_t drop, std::string failure = {})
      : bytes_(bytes), drop_(drop), at_end_(std::move(failure)) {}
  std::size_t read(std::span<char> into) override {
    ++reads;
    const std::size_t count = bytes_.copy(into.data(), std::min(drop_, into.size()));
    bytes_.remove_prefix(count);
    if (count == 0) failure_ = at_end_;
    return count;
  }
  [[nodiscard]] const std::string& failure() const override { return failure_; }
  std::size_t reads = 0;

 private:
  std::string_view bytes_;
  std::size_t drop_;
  std::string at_end_;
  std::string failure_;
};

}  // namespace ocm::test
