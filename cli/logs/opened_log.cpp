#include "cli/logs/opened_log.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "cli/logs/packing.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::cli::logs {
namespace {

constexpr std::size_t recognised_by = 4096;

std::string formats_read() {
  std::string names;
  for (const LogFormat& format : log_formats())
    if (format.reader != nullptr) names += (names.empty() ? "" : ", ") + std::string{format.name};
  return names;
}

const LogFormat& named(std::string_view name) {
  const LogFormat* const format = find_format(name);
  if (format == nullptr)
    fail({fmt::format("no log format '{}'", name), "there are: " + formats_read()}, exit_usage);
  if (format->reader == nullptr)
    fail({fmt::format("{} is written only", name), "read are: " + formats_read()}, exit_usage);
  return *format;
}

/// Looks at no more than is there, and at more only if that says nothing: a pipe from a live bus may begin
/// with a single line.
const LogFormat* recognise(log::Input& input, const std::string& path) {
  for (std::size_t wanted = 1;; wanted = input.here() + 1) {
    const bool at_end = input.peek(wanted).size() < wanted;
    const std::string_view beginning = input.peek(std::min(input.here(), recognised_by));
    for (const LogFormat& format : log_formats())
      if (format.recognises != nullptr && format.recognises(beginning)) return &format;
    if (at_end || beginning.size() == recognised_by) break;
  }
  const LogFormat* const by_name = format_of_name(path);
  return by_name != nullptr && by_name->reader != nullptr ? by_name : nullptr;
}

std::string shown(const std::string& path) {
  return path == "-" ? "the standard input" : path;
}

}  // namespace

OpenedLog::OpenedLog(std::string path, std::string_view format, const protocol::Catalogue& catalogue,
                     Reading reading)
    : path_(std::move(path)) {
  if (!format.empty()) format_ = &named(format);
  auto file = std::make_unique<FileSource>(path_, reading);
  const Packing packing = packing_of(file->beginning());
  const auto readable = [&](const log::Source& source) {
    if (!source.failure().empty() && interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
    if (!source.failure().empty())
      fail({fmt::format("cannot read {}: {}", shown(path_), source.failure()),
            path_ == "-" ? "expected a log" : "give the name of a log, or - for the standard input"});
  };
  readable(*file);
  if (file->beginning().empty())
    fail({fmt::format("{} is empty", shown(path_)), "expected a log that contains frames"});
  file_ = std::move(file);
  if (packing != Packing::none) {
    auto unpacked = unpack(packing, *file_);
    if (!unpacked) fail(unpacked.error);
    unpacked_ = std::move(*unpacked);
  }
  input_ = std::make_unique<log::Input>(unpacked_ != nullptr ? *unpacked_ : *file_);
  skip_byte_order_mark(*input_);
  if (format_ == nullptr) format_ = recognise(*input_, path_);
  if (input_->here() == 0) readable(unpacked_ != nullptr ? *unpacked_ : *file_);
  if (format_ == nullptr)
    fail({fmt::format("{} is of no known log format", shown(path_)),
          fmt::format("it begins with \"{}\"; --from names a format: {}",
                      log::Complaints::printable(input_->peek(std::min<std::size_t>(input_->here(), 40))),
                      formats_read())});
  reader_ = format_->reader(*input_, catalogue);
}

OpenedLog::~OpenedLog() = default;

std::uint64_t OpenedLog::size() const noexcept {
  return static_cast<const FileSource&>(*file_).size();
}

bool OpenedLog::ended_early() const {
  return !input_->failure().empty();
}

bool OpenedLog::complain() const {
  const log::Complaints& complaints = reader_->complaints();
  const std::string failure = interrupted() != 0 ? std::string{} : input_->failure();
  for (const log::Complaint& complaint : complaints.first())
    remark(fmt::format("{}: {}: {}: {}", shown(path_), log::to_text(complaint.place),
                       log::describe(complaint.cause), complaint.detail));
  if (!failure.empty())
    remark(fmt::format("{}: cannot be read beyond byte {}: {}", shown(path_), input_->offset(), failure));
  const std::uint64_t total = complaints.total();
  if (total == 0) return !failure.empty();
  std::string text =
      fmt::format("{}: {} {} could not be read", shown(path_), total, total == 1 ? "place" : "places");
  for (std::size_t i = 0; i < log::causes; ++i) {
    const auto cause = static_cast<log::Cause>(i);
    if (complaints.count(cause) != 0)
      text += fmt::format(", {} {}", complaints.count(cause), log::describe(cause));
  }
  remark(text);
  return true;
}

}  // namespace ocm::cli::logs
