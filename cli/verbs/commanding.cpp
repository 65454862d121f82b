#include "cli/verbs/commanding.hpp"

#include <memory>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/quantity.hpp"

#include "cli/verbs/verbs.hpp"

namespace ocm::cli {

Commanding::Commanding(CLI::App& verb, Session& session, std::string_view words_help, bool with_priority)
    : verb_(verb.get_name()), session_(&session) {
  verb.add_option("words", words_, std::string{words_help})->type_name("");
  if (with_priority)
    verb.add_option("--priority", priority_, "urgent, high, medium or low; default: the topic's own")
        ->type_name("P");
  verb.add_flag("--dry-run", dry_run_, "print the frames in candump notation and send nothing");
}

client::Command Commanding::parse() const {
  return parse({});
}

client::Command Commanding::parse(const std::vector<std::string>& options) const {
  std::vector<std::string_view> words{verb_};
  words.insert(words.end(), words_.begin(), words_.end());
  words.insert(words.end(), options.begin(), options.end());
  if (!priority_.empty()) {
    words.emplace_back("--priority");
    words.emplace_back(priority_);
  }
  auto command = client::CommandParser{session_->catalogue()}.parse(words);
  if (!command) fail({verb_ + ": " + command.error.what, command.error.remedy}, exit_usage);
  return std::move(command.value);
}

void print_frames(const std::vector<can::Frame>& frames) {
  for (const auto& frame : frames) fmt::print("{}\n", can::to_text(frame).view());
}

void carry_out(Session& session, const client::Command& command, bool dry_run) {
  if (dry_run) return print_frames(command.frames);
  const auto bus = session.open_bus();
  for (const auto& frame : command.frames) send_patiently(*bus, frame);
}

base::Duration duration_option(std::string_view option, const std::string& text) {
  const auto duration = client::parse_duration(text);
  if (!duration || duration->count() < 0)
    fail({fmt::format("{} {}: not a time", option, text), "write 500ms, 2s or 1.5s"}, exit_usage);
  return *duration;
}

std::uint32_t bit_rate_option(std::string_view text) {
  std::string_view digits = text;
  std::int64_t unit = 1;
  if (digits.ends_with('k') || digits.ends_with('K')) unit = 1000;
  if (digits.ends_with('M')) unit = 1'000'000;
  if (unit != 1) digits.remove_suffix(1);
  const auto number = base::parse_decimal(digits);
  const auto rate = number ? base::multiply(*number, {unit, 0}) : number;
  const auto whole = rate ? base::divide_rounded(*rate, {1, 0}) : base::Result<std::int64_t>{rate.error};
  // Bits a second, whole; classic CAN ends at a million.
  if (whole && *whole >= 1 && *whole <= 1'000'000 && base::compare(*rate, {*whole, 0}) == 0)
    return static_cast<std::uint32_t>(*whole);
  fail({fmt::format("--bitrate {}: no bit rate of CAN", text),
        "1 to 1000000 bits a second, such as 500k or 125000"},
       exit_usage);
}

CLI::App* add_verb(CLI::App& app, std::string_view name, std::string_view description, std::string_view group,
                   std::string_view examples) {
  auto* verb = app.add_subcommand(std::string{name}, std::string{description});
  verb->group(std::string{group});
  verb->footer("Examples:\n" + std::string{examples});
  verb->fallthrough();
  return verb;
}

void add_command_verb(CLI::App& app, Session& session, std::string_view name, std::string_view description,
                      std::string_view group, std::string_view words_help, std::string_view examples,
                      bool with_priority) {
  auto* verb = add_verb(app, name, description, group, examples);
  const auto commanding = std::make_shared<Commanding>(*verb, session, words_help, with_priority);
  verb->callback([commanding, &session] { carry_out(session, commanding->parse(), commanding->dry_run()); });
}

}  // namespace ocm::cli
