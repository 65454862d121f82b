/// What the tests of binary formats and of those of Vector's tools share, beyond entries.hpp: bytes in words,
/// time zones, and all that a log holds.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"

#include "tests/robustness/fuzz/log_entries.hpp"
#include "tests/unit/log/entries.hpp"

namespace ocm::log::testing {

using fuzz::can_exist;

/// So long after the epoch.
constexpr base::Time at(std::int64_t ns) {
  return base::Time{base::Duration{ns}};
}

/// "0A 0D 0D 0A": bytes as their sources print them; blanks and line ends do not count.
inline std::string bytes(std::string_view hex) {
  std::string out;
  int high = -1;
  for (const char c : hex) {
    const int digit = base::hex_digit(c);
    if (digit < 0) continue;
    if (high >= 0) out += static_cast<char>(high << 4 | digit);
    high = high >= 0 ? -1 : digit;
  }
  return out;
}

/// The time zone of the process, for as long as this lives.
class Zone {
 public:
  explicit Zone(const char* name) {
    if (const char* const before = std::getenv("TZ")) before_ = before;
    set(name);
  }
  ~Zone() {
    if (before_.empty())
      unsetenv("TZ"), tzset();
    else
      set(before_.c_str());
  }
  Zone(const Zone&) = delete;
  Zone& operator=(const Zone&) = delete;

 private:
  static void set(const char* name) {
    setenv("TZ", name, 1);
    tzset();
  }
  std::string before_;
};

/// All that a log holds.
struct Log {
  std::vector<Entry> entries;
  std::vector<std::string> names;  ///< of the entries' interfaces
  std::vector<Complaint> complaints;
  std::vector<Recorded> recorded;
  std::uint64_t complained = 0;
};

template <class R, class... More>
Log read_from(Source& source, std::size_t batch_size, More... more) {
  Input input{source};
  R reader{input, more...};
  Log log;
  std::vector<Entry> some(batch_size);
  while (const std::size_t count = reader.read(some)) {
    for (const Entry& entry : std::span{some}.first(count)) {
      log.entries.push_back(entry);
      log.names.emplace_back(reader.interfaces().name(entry.interface));
    }
  }
  log.complaints = reader.complaints().first();
  log.complained = reader.complaints().total();
  log.recorded = reader.recorded();
  return log;
}

template <class R, class... More>
Log read_all(std::string_view text, More... more) {
  MemorySource source{text};
  return read_from<R>(source, batch, more...);
}

/// As bytes of a file that was finished.
template <class W>
std::string write_all(W& writer, std::span<const Entry> entries, const Interfaces& interfaces,
                      std::span<const Recorded> recorded = {}) {
  Bytes out;
  writer.begin(out);
  writer.write(out, entries, interfaces);
  writer.recorded(out, recorded);
  writer.finish(out);
  return std::string{out.view()};
}

}  // namespace ocm::log::testing
