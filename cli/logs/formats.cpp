#include <algorithm>
#include <concepts>
#include <iterator>

#include <fmt/format.h>

#include "ocm/log/asc.hpp"
#include "ocm/log/blf.hpp"
#include "ocm/log/candump.hpp"
#include "ocm/log/candump_screen.hpp"
#include "ocm/log/csv.hpp"
#include "ocm/log/pcap.hpp"
#include "ocm/log/pcapng.hpp"

#include "cli/logs/format.hpp"
#include "cli/logs/inflate.hpp"
#include "cli/logs/json_lines.hpp"
#include "cli/logs/mcap.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::logs {
namespace {

/// A reader takes the catalogue if its format holds decoded values; a writer likewise.
template <class T>
std::unique_ptr<log::Reader> make_reader(log::Input& input, const protocol::Catalogue& catalogue) {
  if constexpr (std::constructible_from<T, log::Input&, const protocol::Catalogue&>)
    return std::make_unique<T>(input, catalogue);
  else
    return std::make_unique<T>(input);
}

template <class T>
std::unique_ptr<log::Writer> make_writer([[maybe_unused]] const protocol::Catalogue& catalogue) {
  if constexpr (std::constructible_from<T, const protocol::Catalogue&>)
    return std::make_unique<T>(catalogue);
  else
    return std::make_unique<T>();
}

std::unique_ptr<log::Reader> make_blf_reader(log::Input& input, const protocol::Catalogue&) {
  return std::make_unique<log::BlfReader>(input, zlib_inflate());
}

/// In the order in which they are asked whether a file is theirs; of two with one ending the first is meant
/// by it. Beginnings that no other format has go first.
constexpr LogFormat formats[] = {
    {"pcapng", ".pcapng", "for Wireshark, with interfaces, directions and nanoseconds",
     log::PcapngReader::recognises, make_reader<log::PcapngReader>, make_writer<log::PcapngWriter>},
    {"pcap", ".pcap", "for tcpdump and older tools", log::PcapReader::recognises,
     make_reader<log::PcapReader>, make_writer<log::PcapWriter>},
    {"mcap", ".mcap", "for Foxglove: frames, and samples as JSON with schemas", log::McapReader::recognises,
     make_mcap_reader, make_mcap_writer},
    {"mcap-raw", ".mcap", "the same with frames only: half the size", nullptr, nullptr, make_mcap_raw_writer},
    {"blf", ".blf", "the binary log of Vector's tools", log::BlfReader::recognises, make_blf_reader, nullptr},
    {"asc", ".asc", "the text log of Vector's tools", log::AscReader::recognises, make_reader<log::AscReader>,
     make_writer<log::AscWriter>},
    {"candump", ".log", "text, as candump -l and -L write it", log::CandumpReader::recognises,
     make_reader<log::CandumpReader>, make_writer<log::CandumpWriter>},
    {"candump-ns", ".log", "the same with nine digits of a second, which other tools read as a wrong time",
     nullptr, make_reader<log::CandumpReader>, make_writer<log::CandumpNanoWriter>},
    {"candump-screen", "", "what candump shows on a terminal", log::CandumpScreenReader::recognises,
     make_reader<log::CandumpScreenReader>, nullptr},
    {"csv", ".csv", "comma-separated values, as python-can writes them", log::CsvReader::recognises,
     make_reader<log::CsvReader>, make_writer<log::CsvWriter>},
    {"json", ".jsonl", "JSON lines, as decode and listen print them", JsonLinesReader::recognises,
     make_reader<JsonLinesReader>, make_writer<JsonLinesWriter>},
};

constexpr std::string_view packed_endings[] = {".gz", ".zst"};

}  // namespace

std::span<const LogFormat> log_formats() {
  return formats;
}

std::vector<std::string> readable_formats() {
  std::vector<std::string> names;
  for (const LogFormat& format : formats)
    if (format.reader != nullptr) names.emplace_back(format.name);
  return names;
}

std::vector<std::string> writable_formats() {
  std::vector<std::string> names;
  for (const LogFormat& format : formats)
    if (format.writer != nullptr) names.emplace_back(format.name);
  return names;
}

const LogFormat* find_format(std::string_view name) {
  for (const LogFormat& format : formats)
    if (format.name == name) return &format;
  return nullptr;
}

const LogFormat* format_of_name(std::string_view file) {
  for (const std::string_view packed : packed_endings)
    if (file.ends_with(packed)) file.remove_suffix(packed.size());
  for (const LogFormat& format : formats)
    if (!format.ending.empty() && file.ends_with(format.ending)) return &format;
  return nullptr;
}

const LogFormat& format_to_write(std::string_view verb, const std::string& out, const std::string& named,
                                 const char* for_stdout) {
  const LogFormat* const format = !named.empty()                        ? find_format(named)
                                  : out == "-" && for_stdout != nullptr ? find_format(for_stdout)
                                                                        : format_of_name(out);
  const std::string remedy = fmt::format("--to names a format: {}", fmt::join(writable_formats(), ", "));
  if (format == nullptr && !named.empty())
    fail({fmt::format("{}: no log format '{}'", verb, named), remedy}, exit_usage);
  if (format == nullptr && out == "-")
    fail({fmt::format("{}: what goes to the standard output has no ending to tell the format", verb), remedy},
         exit_usage);
  if (format == nullptr)
    fail({fmt::format("{}: the ending of {} is of no log format", verb, out), remedy}, exit_usage);
  if (format->writer == nullptr)
    fail({fmt::format("{}: {} is read only", verb, format->name), remedy}, exit_usage);
  return *format;
}

bool names_file(std::string_view word) {
  return word.find('/') != std::string_view::npos || format_of_name(word) != nullptr ||
         std::any_of(std::begin(packed_endings), std::end(packed_endings),
                     [word](std::string_view packed) { return word.ends_with(packed); });
}

}  // namespace ocm::cli::logs
