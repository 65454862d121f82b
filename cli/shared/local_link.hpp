/// A program of the same user that is asked in words, on a socket of this machine
/// (cli/shared/local_server.hpp).
///
/// A request is one message, "status" or "send 201#50C3000000000000"; so is its answer: a first line "ok",
/// "wait" or "no", and what is to be said after it. Of "no" that is what is wrong, and on the next line the
/// remedy. The first request is "hello 1 VERB", whose answer is the other program's name.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "ocm/base/time.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

inline constexpr std::string_view local_hello = "hello 1 ";
inline constexpr std::size_t longest_local_message = 60'000;

/// The path of a socket in the user's own directory, or in another one: "KIND-NAME.sock".
[[nodiscard]] std::string local_socket(std::string_view kind, std::string_view name);
[[nodiscard]] std::string local_socket_in(std::string_view directory, std::string_view kind,
                                          std::string_view name);
/// Eight hexadecimal digits in place of a path, for such a name; of links to one file they are the same.
[[nodiscard]] std::string digits_of_path(std::string_view path);

struct LocalAnswer {
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

class LocalLink {
 public:
  /// Null: no program of this user serves there. A failure: one does, and does not answer. `verb` is who
  /// asks, `what` the other one in words: "the operator on can0". The greeting takes at most `patience`.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<LocalLink>> connect(
      const std::string& path, const std::string& what, std::string_view verb,
      base::Duration patience = std::chrono::seconds{1});

  /// Waits for the answer, at most `patience`. After a silence there is no other answer.
  [[nodiscard]] LocalAnswer ask(std::string_view request,
                                base::Duration patience = std::chrono::milliseconds{300});
  /// What it answered to the greeting: its name; empty: "wait".
  [[nodiscard]] const std::string& greeting() const noexcept { return greeting_; }
  /// " (process 1234)"
  [[nodiscard]] const std::string& process() const noexcept { return process_; }
  /// "operator guard (process 1234)", once it is known.
  [[nodiscard]] const std::string& who() const noexcept { return who_; }
  void set_who(std::string who) { who_ = std::move(who); }
  /// It has ended, or was silent.
  [[nodiscard]] bool over() const noexcept { return !socket_; }

 private:
  LocalLink(host::Descriptor socket, std::string who, std::string process)
      : socket_(std::move(socket)), who_(std::move(who)), process_(std::move(process)) {}
  [[nodiscard]] LocalAnswer silence(std::string what);

  host::Descriptor socket_;
  std::string who_;
  std::string process_;
  std::string greeting_;
  LocalAnswer silence_;  ///< once it was silent: why
};

}  // namespace ocm::cli
