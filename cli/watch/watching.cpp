#include "cli/watch/watching.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>

#include <fmt/format.h>

#include "ocm/log/playback.hpp"

#include "cli/logs/opened_log.hpp"
#include "cli/shared/buses.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/values.hpp"

namespace ocm::cli {

void add_watch_options(Verb verb, WatchOptions& options) {
  verb.add_option("--from", options.format, "format of the logs; default: what they begin with says it")
      .type_name("FORMAT")
      .takes(accepted_words(logs::readable_formats()));
  add_lasting(verb, "--duration", options.duration,
              "end after this time; of a log: look at its first T only");
  verb.add_option("-n,--count", options.count, "end after so many frames").type_name("N").positive();
}

Words split_words(std::string_view verb, const std::vector<std::string>& words,
                  const std::function<bool(std::string_view)>& means_something) {
  Words split;
  bool live = false;
  for (const auto& word : words) {
    std::error_code unreadable;  // a file that cannot be examined is reported when it is opened
    if (word == "live")
      live = true;
    else if (!means_something(word) &&
             (word == "-" || logs::names_file(word) || std::filesystem::exists(word, unreadable)))
      split.files.push_back(word);
    else
      split.others.push_back(word);
  }
  if (live && !split.files.empty())
    fail({fmt::format("{}: {} is a log, and live is the bus", verb, split.files.front()), "name one of them"},
         exit_usage);
  return split;
}

Watching::Watching(Session& session, const WatchOptions& options, std::vector<std::string> files)
    : session_(&session),
      format_(options.format),
      files_(std::move(files)),
      duration_(options.duration),
      count_(options.count) {
  if (live() && !format_.empty())
    fail({"--from " + format_ + " is the format of a log, and there is none", "name the log, or drop --from"},
         exit_usage);
}

std::string Watching::source() const {
  if (live()) return bus_;
  if (files_.size() > 1) return fmt::format("{} logs", files_.size());
  return files_[0] == "-" ? "standard input" : std::filesystem::path{files_[0]}.filename().string();
}

int Watching::ending(int code) const {
  if (!gone_.what.empty()) fail(gone_);
  if (time_is_up_) expect_answer(bus_);
  return broke_off_ ? static_cast<int>(exit_failure) : code;
}

void Watching::run(const Take& take, const Lost& lost, const std::function<void()>& each_second) {
  catch_interrupts();
  if (live()) return listen(take, lost, each_second);
  for (const auto& file : files_)
    if (!done_ && interrupted() == 0) read(file, take, lost);
}

std::span<const log::Entry> Watching::within(std::span<const log::Entry> entries) {
  if (count_ != 0 && taken_ + entries.size() >= count_) {
    entries = entries.first(static_cast<std::size_t>(count_ - taken_));
    done_ = true;
  }
  if (duration_ && !entries.empty()) {
    if (!first_) first_ = entries.front().time;
    const auto beyond = std::find_if(entries.begin(), entries.end(), [this](const log::Entry& entry) {
      return log::Playback::distance(entry.time, *first_) > *duration_;
    });
    if (beyond != entries.end()) done_ = true;
    entries = entries.first(static_cast<std::size_t>(beyond - entries.begin()));
  }
  taken_ += entries.size();
  return entries;
}

void Watching::read(const std::string& file, const Take& take, const Lost& lost) {
  logs::OpenedLog log{file, format_, session_->catalogue()};
  std::array<log::Entry, log::batch> entries;
  while (!done_ && interrupted() == 0) {
    const std::size_t count = log.reader().read(entries);
    if (count == 0) break;
    take(within(std::span{entries}.first(count)), log.reader().interfaces());
  }
  const auto& recorded = log.reader().recorded();
  for (std::size_t i = 0; i < recorded.size(); ++i)
    if (recorded[i].dropped != 0)
      lost(log.reader().interfaces().name(static_cast<std::uint16_t>(i)), recorded[i].dropped);
  log.complain();
  if (interrupted() == 0 && log.ended_early()) broke_off_ = true;
}

void Watching::listen(const Take& take, const Lost& lost, const std::function<void()>& each_second) {
  const auto bus = session_->open_bus();
  bus_ = bus->name();
  const Over over = cli::listen(*bus, {duration_, count_}, take, lost, each_second);
  if (over == Over::gone) gone_ = bus->failure();
  time_is_up_ = over == Over::time;
}

}  // namespace ocm::cli
