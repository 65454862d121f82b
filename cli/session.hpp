/// What all verbs share: the options before the verb, the robot's catalogue, the bus, and how to say that
/// something went wrong.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "ocm/can/frame.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "generator/spec/spec.hpp"

namespace ocm::cli {

/// Documented in docs/amiroctl.md. 128 + signal when a signal ended the command.
enum ExitCode : int { exit_success = 0, exit_failure = 1, exit_usage = 2 };

/// Thrown after the message was printed; main returns the code.
struct Exit {
  int code;
};

/// Prints "amiroctl: what" and the remedy on stderr and leaves with `code`.
[[noreturn]] void fail(const transport::Failure& failure, int code = exit_failure);
/// A remark for the person at the terminal, on stderr.
void remark(std::string_view text);

class Session {
 public:
  /// The options that every verb takes.
  void add_options(CLI::App& app);

  /// The AMiRo's, compiled in, or that of --spec.
  [[nodiscard]] const protocol::Catalogue& catalogue();
  /// The same with all that its spec says, read when it is asked for.
  [[nodiscard]] const spec::Spec& spec();

  /// The bus of --bus, AMIROCTL_BUS, or the only one there is; says on stderr which.
  [[nodiscard]] std::unique_ptr<transport::Bus> open_bus();
  /// As open_bus, by name.
  [[nodiscard]] static std::unique_ptr<transport::Bus> open_bus(std::string_view name);

  /// Whether to colour what goes to stdout: a terminal, and neither --no-color nor NO_COLOR.
  [[nodiscard]] bool colour() const;

  std::string bus_name;
  std::string spec_file;
  std::string config_file;

 private:
  [[nodiscard]] static std::string only_bus();

  bool no_colour_ = false;
  std::unique_ptr<spec::Spec> spec_;
};

/// Tells once when the bus goes down, and once when it is back.
class StateWatch {
 public:
  void look(const transport::Bus& bus);

 private:
  transport::BusState state_ = transport::BusState::up;
};

/// Waits for room when the bus is full, at most `patience`; then fails with the bus's words.
void send_patiently(transport::Bus& bus, const can::Frame& frame,
                    base::Duration patience = std::chrono::seconds{1});

}  // namespace ocm::cli
