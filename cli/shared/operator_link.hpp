/// The operator that runs on a bus of this machine, as other programs of the same user see it: a socket on
/// which it is asked in words, and answers.
///
/// A request is one message, "status" or "send 201#50C3000000000000"; so is its answer: a first line "ok",
/// "wait" or "no", and what is to be said after it. Of "no" that is what is wrong, and on the next line the
/// remedy. The first request is "hello 1 VERB", whose answer is the operator's name. To "commands FRAME" it
/// answers whether it commands that actuator itself: nothing, or "repeats" or "once", and where it is.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

inline constexpr std::string_view operator_hello = "hello 1 ";
inline constexpr std::string_view operator_commands = "commands ";
inline constexpr std::string_view operator_repeats = "repeats";
inline constexpr std::size_t longest_operator_message = 60'000;

/// Where the operator of a bus listens: by the name that the bus has for itself.
[[nodiscard]] std::string operator_path(std::string_view bus);

struct OperatorAnswer {
  enum class Kind : std::uint8_t {
    ok,
    wait,    ///< not now
    no,      ///< `failure`
    silent,  ///< it is stopped, or has ended: `failure`
  };
  Kind kind = Kind::silent;
  std::string text;
  transport::Failure failure;
};

class OperatorLink {
 public:
  /// Null: no operator runs on that bus, or none of this user. A failure: one does, and does not answer.
  /// `verb` is who asks.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<OperatorLink>> connect(std::string_view bus,
                                                                                 std::string_view verb);

  /// Waits for the answer, at most `patience`. After a silence there is no other answer.
  [[nodiscard]] OperatorAnswer ask(std::string_view request,
                                   base::Duration patience = std::chrono::milliseconds{300});
  /// "operator guard (process 1234)"
  [[nodiscard]] const std::string& who() const noexcept { return who_; }

 private:
  OperatorLink(host::Descriptor socket, std::string who) : socket_(std::move(socket)), who_(std::move(who)) {}
  [[nodiscard]] OperatorAnswer silence(std::string what);

  host::Descriptor socket_;
  std::string who_;
};

}  // namespace ocm::cli
