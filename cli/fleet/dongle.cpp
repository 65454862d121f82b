#include "cli/fleet/dongle.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <poll.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/base/time.hpp"
#include "ocm/mapper/link/prefix.hpp"
#include "ocm/mapper/server/central_stream.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"

namespace ocm::cli::fleet {
namespace {

using namespace std::chrono_literals;
using mapper::server::Dialect;

base::Time now() {
  return base::Time{std::chrono::steady_clock::now().time_since_epoch()};
}

/// The base firmware has 38400 baud; a line to `amiroctl central`, or a USB device that ignores it, any.
std::vector<std::uint32_t> speeds(const DongleOptions& options) {
  if (options.baud != 0) return {options.baud};
  return {38'400, 115'200};
}

transport::SerialPort open_port(std::string_view verb, const std::string& path, std::uint32_t baud,
                                bool rts_cts) {
  auto port = transport::SerialPort::open(
      path, baud, rts_cts ? transport::SerialFlow::rts_cts : transport::SerialFlow::none);
  if (!port) fail({fmt::format("{}: {}", verb, port.error.what), port.error.remedy});
  return std::move(*port);
}

/// A line, or the beginning of a robot's packet: noise of a wrong speed is neither.
bool is_readable(std::string_view text) {
  mapper::link::PrefixFilter filter;
  std::size_t printed = 0;
  for (const char c : text) {
    if (filter.feed(c) == mapper::link::PrefixFilter::Step::source) return true;
    if (c == '\n' && printed >= 3) return true;
    if (c == '\r') continue;
    printed = c >= ' ' && c <= '~' ? printed + 1 : 0;
  }
  return false;
}
bool says_found(std::string_view text) {
  for (std::size_t at = text.find("found "); at != std::string_view::npos; at = text.find("found ", at + 1)) {
    const std::size_t end = text.find('\n', at);
    if (end != std::string_view::npos && mapper::server::parse_central_line(text.substr(at, end - at)).kind ==
                                             mapper::server::CentralLine::Kind::found)
      return true;
  }
  return false;
}
bool says_ok(std::string_view text) {
  return text.find("OK.") != std::string_view::npos;
}

class Probe {
 public:
  Probe(std::string_view verb, transport::SerialPort& port) : verb_(verb), port_(port) {}

  [[nodiscard]] std::optional<Dialect> find_out() {
    ask("*\nstop\n", 600ms, says_found);
    if (says_found(heard_)) return Dialect::words;
    // The dot ends what the base firmware holds of the words above.
    if (!says_ok(heard_)) ask(".", 100ms, [](std::string_view) { return false; });
    const std::size_t before = heard_.size();
    ask("AT?.", 600ms,
        [before](std::string_view text) { return says_found(text) || says_ok(text.substr(before)); });
    if (const auto known = from_an_answer()) return known;
    // It may have heard a beginning of a command: a line end, and its list, whatever it has answered before.
    const std::size_t asked = heard_.size();
    ask("\nlist\n", 600ms, [asked](std::string_view text) { return is_readable(text.substr(asked)); });
    if (const auto late = from_an_answer()) return late;
    if (is_readable(heard_)) return Dialect::thesis;
    return std::nullopt;
  }
  /// Of a dongle that is known: a program that was killed may have left it in data mode, where all that is
  /// said goes to a robot.
  void leave_data_mode(Dialect dialect) {
    ask(dialect == Dialect::at ? "*." : "*\n", 100ms, [](std::string_view) { return false; });
  }
  [[nodiscard]] std::string& heard() { return heard_; }

 private:
  /// By what only one kind says, however late it is.
  [[nodiscard]] std::optional<Dialect> from_an_answer() const {
    if (says_ok(heard_)) return Dialect::at;
    if (says_found(heard_)) return Dialect::words;
    return std::nullopt;
  }

  template <class Done>
  void ask(std::string_view words, base::Duration time, Done done) {
    const base::Time end = now() + time;
    std::string_view rest = words;
    while (!done(heard_) && now() < end && interrupted() == 0) {
      const auto taken = port_.write(rest);
      if (!taken) lose();
      rest.remove_prefix(*taken);
      pollfd line{port_.descriptor(), static_cast<short>(rest.empty() ? POLLIN : POLLIN | POLLOUT), 0};
      (void)::poll(&line, 1, 20);
      std::array<char, 512> room;
      const auto size = port_.read(room);
      if (!size) lose();
      heard_.append(room.data(), *size);
    }
    if (interrupted() != 0) throw Exit{exit_code_after_interrupt(exit_failure)};
  }
  [[noreturn]] void lose() {
    const auto failure = port_.failure();
    fail({fmt::format("{}: {}", verb_, failure.what), failure.remedy});
  }

  std::string verb_;
  transport::SerialPort& port_;
  std::string heard_;
};

[[noreturn]] void silent(std::string_view verb, const std::string& path, const DongleOptions& options) {
  std::string tried;
  for (const std::uint32_t baud : speeds(options))
    tried += fmt::format("{}{}", tried.empty() ? "" : " or ", baud);
  const bool rts_cts = options.flow == "rtscts";
  fail(
      {fmt::format("{}: nothing at {} answers as a central does, at {} baud{}", verb, path, tried,
                   rts_cts ? " with RTS/CTS" : ""),
       fmt::format("is it the central's dongle, and not a robot's? Unplug it and plug it in again; another "
                   "speed: --baud N; {}; the thesis's dongle, where it answers nothing: --dongle thesis",
                   rts_cts ? "a line without RTS/CTS: --flow none" : "a board with RTS/CTS: --flow rtscts")});
}

}  // namespace

void add_dongle_options(Verb verb, DongleOptions& options) {
  verb.add_option("--baud", options.baud, "of the central's line; default: 38400, then 115200")
      .type_name("N")
      .range(1U, 4'000'000U);
  (void)add_dongle_kind(verb, options);
}

std::array<Option, 2> add_dongle_kind(Verb verb, DongleOptions& options) {
  return {verb.add_option("--flow", options.flow, "of the central's line")
              .type_name("FLOW")
              .one_of({"none", "rtscts"})
              .show_default(),
          verb.add_option("--dongle", options.kind, "whose commands the central takes; auto asks it")
              .type_name("KIND")
              .one_of({"auto", "ours", "at", "thesis"})
              .show_default()};
}

Dongle open_dongle(std::string_view verb, const std::string& path, const DongleOptions& options) {
  const bool rts_cts = options.flow == "rtscts";
  if (options.kind != "auto") {
    const Dialect dialect = options.kind == "at"       ? Dialect::at
                            : options.kind == "thesis" ? Dialect::thesis
                                                       : Dialect::words;
    auto port = open_port(verb, path, speeds(options).front(), rts_cts);
    Probe probe{verb, port};
    probe.leave_data_mode(dialect);
    return {std::move(port), dialect, std::move(probe.heard())};
  }
  for (const std::uint32_t baud : speeds(options)) {
    auto port = open_port(verb, path, baud, rts_cts);
    Probe probe{verb, port};
    if (const auto dialect = probe.find_out()) return {std::move(port), *dialect, std::move(probe.heard())};
  }
  silent(verb, path, options);
}

}  // namespace ocm::cli::fleet
