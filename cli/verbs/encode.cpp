#include <array>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "cli/logs/file_source.hpp"
#include "cli/logs/json_lines.hpp"
#include "cli/logs/log_file.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/verbs/verb.hpp"
#include "cli/watch/frame_lines.hpp"

namespace ocm::cli {
namespace {

struct EncodeOptions {
  std::string in = "-";
  std::string out = "-";
  std::string to;
  bool force = false;
  bool keep_going = false;
};

void encode(Session& session, const EncodeOptions& options, int& exit_code) {
  const auto& format = logs::format_to_write("encode", options.out, options.to, "candump");
  refuse_same_file("encode", options.in, options.out);
  session.keep_specs("encode", options.out);
  catch_interrupts();
  FrameLines lines{options.in, session.catalogue(), options.keep_going,
                   options.force ? logs::Values::of_bits : logs::Values::as_stated};
  auto out = logs::LogFile::create(options.out, format, session.catalogue(),
                                   options.force ? logs::Existing::overwrite : logs::Existing::refuse);
  if (!out) fail(out.error);
  std::array<log::Entry, log::batch> entries;
  log::Interfaces interfaces;
  std::uint64_t frames = 0;
  std::size_t count = 0;
  bool written = true;
  const auto write = [&](bool now) {
    written =
        written && (*out)->write(std::span{entries}.first(count), interfaces) && (!now || (*out)->flush());
    frames += count;
    count = 0;
  };
  while (written) {
    if (count == entries.size() || (count != 0 && !lines.more_here())) write(!lines.more_here());
    std::string_view bus;
    if (!lines.next(entries[count], bus)) break;
    entries[count].interface = interfaces.number(bus);
    ++count;
  }
  write(false);
  lines.failed() && frames == 0 ? (*out)->discard() : (*out)->finish();
  remark(counted(frames, "frame") + ((*out)->failure().what.empty() ? " encoded" : " read"));
  lines.tell_unknown_keys();
  logs::tell_losses((*out)->lost(), format);
  if (!(*out)->failure().what.empty()) fail((*out)->failure(), exit_code_after_interrupt(exit_failure));
  if (lines.failed()) exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void declare_encode(Verb verb, Session& session, int& exit_code) {
  verb.describe(
      "make a log of what decode or listen printed as JSON", log_group,
      "  amiroctl decode a.log | jq -c 'select(.topic==\"motors\")' | amiroctl encode > motors.log\n"
      "  amiroctl decode a.log | jq -c '.fields.x *= 2' | amiroctl encode -o faster.pcapng\n"
      "  echo '{\"topic\":\"motors\",\"fields\":{\"x\":0.05}}' | amiroctl encode");
  const auto options = std::make_shared<EncodeOptions>();
  verb.add_option("file", options->in, "JSON lines; default: - (standard input)").type_name("[FILE]");
  verb.add_option("-o,--output", options->out, "the log; its ending says its format").type_name("FILE");
  verb.add_option("--to", options->to, "format of the log; default: candump")
      .type_name("FORMAT")
      .takes(accepted_words(logs::writable_formats()));
  verb.add_flag("--force", options->force,
                "overwrite the log if it is there; also values beyond the range that the spec states");
  verb.add_flag("--keep-going", options->keep_going, "report bad lines and go on; exit 1 at the end");
  verb.callback([options, &session, &exit_code] { encode(session, *options, exit_code); });
}

}  // namespace ocm::cli
