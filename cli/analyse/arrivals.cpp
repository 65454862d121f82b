#include "cli/analyse/arrivals.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "ocm/measure/bus_load.hpp"

#include "cli/analyse/set.hpp"
#include "cli/logs/opened_log.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::analyse {
namespace {

/// What could not be read, as mistakes at their places. A last line that is cut off is none: what is before
/// it is what the bus carried until its writer was killed.
std::vector<Mistake> mistakes_of(const log::Reader& reader, const std::string& file) {
  std::vector<Mistake> mistakes;
  for (const log::Complaint& complaint : reader.complaints().first()) {
    if (complaint.cause == log::Cause::cut_line) continue;
    mistakes.push_back(
        {fmt::format("{}:{}{}", file, complaint.place.is_line ? "" : "byte ", complaint.place.number),
         fmt::format("no frame of a log: {}: {}", log::describe(complaint.cause), complaint.detail),
         "(1436509052.249713) can0 605#00D20000, as candump -l writes it, or another format of "
         "amiroctl convert"});
  }
  return mistakes;
}

Arrival arrival_of(const log::Entry& entry, std::int64_t time) {
  if (const auto frame = entry.classic())
    return {time, {measure::bits_on_bus(*frame), 0}, frame->dlc, *frame};
  can::FdBits bits = can::fd_frame_bits(entry.frame());
  bits.nominal += can::intermission_bits;
  can::Frame head;
  head.id = entry.id;
  head.format = entry.format;
  return {time, bits, entry.length, head};
}

}  // namespace

Arrivals read_arrivals(const std::string& file, const protocol::Catalogue& catalogue) {
  logs::OpenedLog opened{file, {}, catalogue};
  log::Reader& reader = opened.reader();
  Arrivals log;
  std::size_t others = 0;
  std::size_t backwards = 0;
  std::optional<std::uint16_t> interface;
  std::array<log::Entry, log::batch> entries;
  while (const std::size_t count = reader.read(entries)) {
    for (const log::Entry& entry : std::span{entries}.first(count)) {
      if (!interface) interface = entry.interface;
      if (entry.interface != *interface) {
        ++others;
      } else if (entry.format == can::Format::error) {
        ++log.errors;
      } else {
        const std::int64_t time = entry.time.time_since_epoch().count();
        if (!log.all.empty() && time < log.all.back().time) ++backwards;
        log.all.push_back(arrival_of(entry, time));
      }
    }
  }
  std::vector<Mistake> mistakes = mistakes_of(reader, file);
  if (mistakes.empty() && opened.ended_early()) {
    opened.complain();
    throw Exit{exit_failure};
  }
  if (mistakes.empty() && log.all.empty())
    mistakes.push_back({file, "no frame", "a log as candump -l writes it"});
  stop_at(mistakes, file);
  if (reader.complaints().count(log::Cause::cut_line) > 0)
    log.remarks.emplace_back("The log's last line is cut off (its writer was ended): it was passed over.");
  if (others > 0)
    log.remarks.push_back(fmt::format("Only the frames of {}: {} of other interfaces {} passed over.",
                                      reader.interfaces().name(*interface), others,
                                      others == 1 ? "was" : "were"));
  if (backwards > 0) {
    log.remarks.push_back(fmt::format("{} {} older than the one before: sorted by time.",
                                      counted(backwards, "frame"), backwards == 1 ? "is" : "are"));
    std::stable_sort(log.all.begin(), log.all.end(),
                     [](const Arrival& a, const Arrival& b) { return a.time < b.time; });
  }
  return log;
}

}  // namespace ocm::cli::analyse
