#include <array>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "cli/logs/log_file.hpp"
#include "cli/logs/opened_log.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

struct ConvertOptions {
  std::string in, out;
  std::string from, to;
  bool force = false;
  bool strict = false;
};

/// Copies to the end, or until a signal or a full disk; how many frames were read.
std::uint64_t copy(logs::OpenedLog& in, logs::LogFile& out) {
  std::array<log::Entry, log::batch> entries;
  std::uint64_t frames = 0;
  const bool live = in.size() == 0;  // a reader behind a pipe needs frames as they come
  while (interrupted() == 0) {
    const std::size_t count = in.reader().read(entries);
    if (count == 0) break;
    frames += count;
    if (!out.write(std::span{entries}.first(count), in.reader().interfaces())) return frames;
    if (live && count < entries.size() && !out.flush()) return frames;
  }
  return frames;
}

void convert(Session& session, const ConvertOptions& options, int& exit_code) {
  const logs::LogFormat& format = logs::format_to_write("convert", options.out, options.to);
  catch_interrupts();
  refuse_same_file("convert", options.in, options.out);
  session.keep_specs("convert", options.out);
  logs::OpenedLog in{options.in, options.from, session.catalogue()};
  auto out = logs::LogFile::create(options.out, format, session.catalogue(),
                                   options.force ? logs::Existing::overwrite : logs::Existing::refuse);
  if (!out) fail(out.error);

  const std::uint64_t frames = copy(in, **out);
  const bool nothing = frames == 0 && (in.reader().complaints().total() != 0 || in.ended_early());
  if (nothing) {
    (*out)->discard();
  } else if ((*out)->failure().what.empty()) {
    (*out)->recorded(in.reader().recorded());
    (*out)->finish();
  }
  const bool written = (*out)->failure().what.empty();
  const bool whole = written && interrupted() == 0 && !in.ended_early();
  const std::string kept = (*out)->size() == 0
                               ? ": nothing of it was written"
                               : fmt::format(": {} holds the beginning only",
                                             options.out == "-" ? "the standard output" : options.out);
  // How many of them a full disk took is not known: they are handed to it in large pieces.
  remark(fmt::format("{}{}, {} to {}{}", counted(frames, "frame"), written ? "" : " read", in.format().name,
                     format.name, whole ? "" : kept));
  const bool unreadable = in.complain();
  logs::tell_losses((*out)->lost(), format);
  if (!written) fail((*out)->failure(), exit_code_after_interrupt(exit_failure));
  const bool not_all = unreadable || (*out)->lost().any();
  if (in.ended_early() || nothing || (options.strict && not_all)) exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

std::string list_of_formats() {
  std::string text =
      "  amiroctl convert drive.log drive.pcapng\n"
      "  candump -L can0 | amiroctl convert - - --to csv\n"
      "  amiroctl convert drive.log.gz drive.csv --strict   exit 1 when anything is lost\n"
      "\nFormats:\n";
  for (const logs::LogFormat& format : logs::log_formats())
    text += fmt::format("  {:<14} {:<8} {}{}\n", format.name, format.ending, format.description,
                        format.writer == nullptr   ? " (read only)"
                        : format.reader == nullptr ? " (written only)"
                                                   : "");
  return text + "A name that ends in .gz or .zst is packed; what is read is unpacked whatever its name.";
}

}  // namespace

void declare_convert(Verb verb, Session& session, int& exit_code) {
  verb.describe("a log in another format", log_group, list_of_formats());
  const auto options = std::make_shared<ConvertOptions>();
  verb.add_option("in", options->in, "the log to read; - for the standard input").type_name("IN").required();
  verb.add_option("out", options->out, "the log to write; - for the standard output")
      .type_name("OUT")
      .required();
  verb.add_option("--from", options->from, "format of IN; default: what it begins with, then its ending")
      .type_name("FORMAT")
      .takes(accepted_words(logs::readable_formats()));
  verb.add_option("--to", options->to, "format of OUT; default: its ending")
      .type_name("FORMAT")
      .takes(accepted_words(logs::writable_formats()));
  verb.add_flag("--force", options->force, "overwrite OUT if it is there");
  verb.add_flag("--strict", options->strict, "exit 1 when anything was lost or could not be read");
  verb.callback([options, &session, &exit_code] { convert(session, *options, exit_code); });
}

}  // namespace ocm::cli
