#include <algorithm>
#include <cstdio>
#include <ctime>
#include <memory>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

#include <fmt/format.h>

#include "ocm/transport/socketcan.hpp"

#include "cli/logs/format.hpp"
#include "cli/logs/log_file.hpp"
#include "cli/record/capture.hpp"
#include "cli/record/files.hpp"
#include "cli/record/recorder.hpp"
#include "cli/shared/buses.hpp"
#include "cli/shared/filters.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/spec_word.hpp"
#include "cli/shared/unhurried_messages.hpp"
#include "cli/shared/values.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/chosen_topics.hpp"
#include "cli/words/command_options.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

struct RecordOptions {
  std::vector<std::string> topics;
  std::string file;
  std::string to;
  std::vector<std::string> filters;
  std::string split;
  std::uint64_t ring = 0;
  std::uint64_t count = 0;
  std::optional<base::Duration> duration;
  bool commands = false;
  bool force = false;
  bool no_sync = false;
  bool strict = false;
};

std::string format_names() {
  return fmt::format("{}", fmt::join(logs::writable_formats(), ", "));
}

/// --to, or what the file's name ends in; candump where neither says anything.
const logs::LogFormat& chosen_format(const RecordOptions& options) {
  const bool named = !options.file.empty() && options.file != "-";
  const auto* format = !options.to.empty() ? logs::find_format(options.to)
                       : named             ? logs::format_of_name(options.file)
                                           : logs::find_format("candump");
  if (format == nullptr && !options.to.empty())
    fail({fmt::format("record: no format '{}'", options.to), "one of: " + format_names()}, exit_usage);
  if (format == nullptr)
    fail({fmt::format("record: unknown file extension of {}", options.file),
          fmt::format("end it in .log (candump), .pcapng, ..., or --to one of: {}", format_names())},
         exit_usage);
  if (format->writer == nullptr)
    fail({fmt::format("record: {} is read only", format->name), "one of: " + format_names()}, exit_usage);
  return *format;
}

constexpr const char* a_split = "a size or a time, such as 100MB, 64MiB, 10min or 1h";

/// Never, where it is neither a size nor a time.
record::Split read_split(const std::string& text) {
  record::Split split;
  if (const auto time = words::parse_duration(text); time && time->count() > 0)
    split.time = *time;
  else
    split.size = record::parse_size(text);
  return split;
}

record::Split parse_split(const std::string& text) {
  if (text.empty()) return {};
  const record::Split split = read_split(text);
  if (!split.any())
    fail({fmt::format("--split {}: neither a size nor a time", text), "write 100MB, 64MiB, 10min or 1h"},
         exit_usage);
  return split;
}

Accepted accepted_split() {
  return {ValueKind::text, true, a_split, {}, [](const std::string& text) { return read_split(text).any(); }};
}

/// What is recorded of each bus: a topic that is on one interface only is not looked for on another.
class ChosenFilters {
 public:
  ChosenFilters(const RecordOptions& options, const protocol::Catalogue& catalogue)
      : topics_(chosen_topics("record", catalogue, options.topics)), commands_(options.commands) {
    for (const auto& text : options.filters) {
      const auto filter = parse_filter(text);
      if (!filter) fail(filter.error, exit_usage);
      filters_.push_back(*filter);
    }
  }

  [[nodiscard]] Filters of(std::string_view bus) const {
    std::vector<const protocol::Topic*> topics = topics_;
    const std::string interface = interface_of(bus);
    std::erase_if(topics, [&](const protocol::Topic* topic) { return !topic->is_on(interface); });
    Filters filters = filters_for(topics, commands_);
    filters.insert(filters.end(), filters_.begin(), filters_.end());
    if (filters.empty() && !topics_.empty()) filters.push_back(no_frame);
    return filters;
  }
  /// Whether anything of what is named can come on the bus.
  [[nodiscard]] bool has_any_on(std::string_view bus) const {
    const std::string interface = interface_of(bus);
    return topics_.empty() || !filters_.empty() ||
           std::any_of(topics_.begin(), topics_.end(),
                       [&](const auto* topic) { return topic->is_on(interface); });
  }

 private:
  std::vector<const protocol::Topic*> topics_;
  bool commands_;
  Filters filters_;
};

/// --bus can0,can1: several at once.
std::vector<std::string> bus_names(const std::string& list) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    names.push_back(list.substr(begin, end - begin));
    begin = end + 1;
    if (names.back().empty() && !list.empty())
      fail({fmt::format("record: --bus {} has an empty name", list), "a comma stands between two names"},
           exit_usage);
    if (std::find(names.begin(), names.end() - 1, names.back()) != names.end() - 1)
      fail({fmt::format("record: --bus {} names {} twice", list, names.back()), "name each bus once"},
           exit_usage);
  }
  return names;
}

std::vector<record::Port> open_ports(Session& session, const ChosenFilters& filters) {
  const std::string given = session.bus_name;
  if (given.empty())
    static_cast<void>(session.open_bus());  // says which it is, or that there is none or several
  const auto names = bus_names(session.bus_name);
  if (!given.empty()) remark("bus: " + given);
  std::vector<record::Port> ports;
  for (const std::string& name : names) {
    record::Port port;
    port.name = name;
    if (!filters.has_any_on(port.name))
      remark(fmt::format("none of the topics is on {}: of it error frames alone are recorded", port.name));
    auto capture = record::open_capture(port.name, filters.of(port.name));
    if (!capture) fail(capture.error);
    port.capture = std::move(capture.value);
    ports.push_back(std::move(port));
  }
  return ports;
}

record::FilesOptions file_options(const RecordOptions& options, const protocol::Catalogue& catalogue) {
  record::FilesOptions files;
  files.format = &chosen_format(options);
  files.split = parse_split(options.split);
  files.ring = options.ring;
  files.overwrite = options.force;
  files.sync = !options.no_sync;
  files.numbers_free = options.file.empty();
  files.path = options.file;
  if (files.path.empty())
    files.path = (files.ring != 0 ? record::ring_stem(catalogue.robot)
                                  : record::default_stem(catalogue.robot, std::time(nullptr))) +
                 std::string{files.format->ending};
  if (files.path == "-" && files.split.any())
    fail({"record: --split needs a file", "name one with -o"}, exit_usage);
  if (files.ring != 0 && !files.split.any())
    fail({"record: --ring keeps the newest of several files, and there is one",
          "give --split a size or a time"},
         exit_usage);
  return files;
}

/// Whether another program reads the file while it is written.
bool is_live(const std::string& path) {
  struct stat what {};
  const int found = path == "-" ? ::fstat(STDOUT_FILENO, &what) : ::stat(path.c_str(), &what);
  return found == 0 && !S_ISREG(what.st_mode);
}

/// What is in the files, and all that is not.
std::uint64_t summarise(const record::Recorder& recorder, const record::Files& files) {
  const auto seconds = std::chrono::duration_cast<std::chrono::milliseconds>(recorder.lasted());
  std::string text = fmt::format("recorded {} in {} to {}", counted(recorder.received(), "frame"),
                                 words::to_text(base::Duration{seconds}),
                                 files.first_path() == "-" ? "the standard output" : files.first_path());
  if (files.count() > 1) text += fmt::format(" .. {} ({} files)", files.path(), files.count());
  text += fmt::format(", {}", record::size_text(files.size()));
  add_count(text, files.deleted(), "of the files deleted again");
  if (files.keeps_none()) text += ", not kept: a ring keeps no file without a frame";
  std::uint64_t lost = 0;
  for (const auto& port : recorder.ports()) {
    const std::string on = recorder.ports().size() > 1 ? "on " + port.name : "";
    const std::string where = on.empty() ? "" : " " + on;
    add_count(text, port.errors, "error frame", on);
    add_count(text, port.lost() - port.lost_here, "lost in the receive queue" + where);
    add_count(text, port.lost_here, "lost because the disk was too slow" + where);
    add_count(text, port.overflows, "time", "frames lost in the controller" + where);
    lost += port.lost() + port.overflows;
  }
  remark(text);
  return lost;
}

void run_record(Session& session, const RecordOptions& options, int& exit_code) {
  const auto& catalogue = session.catalogue();
  auto chosen = file_options(options, catalogue);
  session.keep_specs("record", chosen.path);
  const bool live = is_live(chosen.path);
  const auto& format = *chosen.format;
  const ChosenFilters filters{options, catalogue};
  record::Limits limits{options.count, {}, catalogue.bit_rate};
  limits.duration = options.duration.value_or(base::Duration{});

  catch_interrupts();
  catch_hangups();
  never_wait_for_messages();
  auto ports = open_ports(session, filters);
  record::Files files{std::move(chosen), catalogue};
  if (const auto opened = files.open(); !opened) fail(opened.error);
  remark(fmt::format("recording to {}; Ctrl-C ends",
                     files.path() == "-" ? "the standard output" : files.path()));
  const auto reopen = [&filters](std::string_view name) {
    return record::open_capture(name, filters.of(name));
  };
  record::Recorder recorder{std::move(ports), reopen, files, limits, live};
  recorder.run();

  const std::uint64_t lost = summarise(recorder, files);
  logs::tell_losses(files.losses(), format);
  if (!files.failure().what.empty()) {
    const std::uint64_t readable = std::min(files.readable(), recorder.received());
    const std::uint64_t unwritten = recorder.received() - readable;
    if (options.file != "-")  // of a pipe its reader knows
      remark(fmt::format("{} can be read, {} {} not written", counted(readable, "frame"), unwritten,
                         unwritten == 1 ? "was" : "were"));
    fail(files.failure(), exit_code_after_interrupt(exit_failure));
  }
  if (!recorder.ended().what.empty()) fail(recorder.ended());
  if (options.duration && interrupted() == 0 && (options.count == 0 || recorder.received() < options.count))
    for (const auto& port : recorder.ports()) expect_answer(port.name);
  if (options.strict && lost != 0) exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void declare_record(Verb verb, Session& session, int& exit_code) {
  verb.describe("write what happens on the bus to a file", log_group,
                "  amiroctl record                        amiro-2026-11-21_163000.log, as candump -l\n"
                "  amiroctl record -o drive.pcapng        for Wireshark\n"
                "  amiroctl record -o drive.log.zst gyro odom --duration 10min\n"
                "  amiroctl record --split 100MB --ring 10  a black box of 1 GB\n"
                "  amiroctl --bus can0,can1 record -o both.pcapng");
  const auto options = std::make_shared<RecordOptions>();
  verb.add_option("topics", options->topics, "only these; default: everything, error frames too")
      .type_name("[TOPIC ...]");
  verb.add_option("-o,--output", options->file,
                  "the file; its ending chooses the format, with .gz or .zst it is packed; - for stdout")
      .type_name("FILE");
  verb.add_option("--to", options->to, "the format, whatever the name: " + format_names())
      .type_name("FORMAT")
      .takes(accepted_words(logs::writable_formats()));
  verb.add_flag("--force", options->force, "overwrite the file if it is there");
  verb.add_flag("--commands", options->commands, "with topics: their requests and set points too");
  verb.add_option("--filter,--raw-ids", options->filters,
                  "only frames with id & mask, hexadecimal as candump has it: 600:700; repeatable")
      .type_name("ID:MASK")
      .one_a_mention();
  verb.add_option("--split", options->split, "a new file after this size or time: 100MB, 10min")
      .type_name("SIZE|T")
      .takes(accepted_split());
  verb.add_option("--ring", options->ring,
                  "with --split: keep the newest N files of this name, over restarts")
      .type_name("N")
      .positive();
  verb.add_option("-n,--count", options->count, "end after so many frames").type_name("N").positive();
  add_lasting(verb, "--duration", options->duration, "end after this time");
  verb.add_flag("--no-sync", options->no_sync,
                "leave it to the kernel when data reach the disk; default: every second");
  verb.add_flag("--strict", options->strict, "exit 1 when frames were lost");
  verb.callback([options, &session, &exit_code] { run_record(session, *options, exit_code); });
}

}  // namespace ocm::cli
