/// What the operator of the bus says of itself, asked twice a second by a thread of its own: an answer may
/// take a while, and the bus is not to wait for it.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace ocm::cli::serve {

class OperatorWatch {
 public:
  enum class Presence : std::uint8_t {
    unknown,  ///< it has not been looked for yet
    none,
    runs,
    silent,  ///< it runs, and does not answer
  };

  /// Of the bus of that name.
  explicit OperatorWatch(std::string bus);
  ~OperatorWatch();
  OperatorWatch(const OperatorWatch&) = delete;
  OperatorWatch& operator=(const OperatorWatch&) = delete;

  /// One JSON object: {"running":false}, or with who, status and why as `amiroctl operator --json` has them.
  [[nodiscard]] std::string newest() const;
  [[nodiscard]] Presence presence() const;

 private:
  void run();
  /// Until the next turn, or the end; false: the end.
  [[nodiscard]] bool pause();

  std::string bus_;
  mutable std::mutex mutex_;
  std::condition_variable ends_;
  bool stops_ = false;
  Presence presence_ = Presence::unknown;
  std::string newest_ = R"({"running":false})";
  std::thread thread_;
};

}  // namespace ocm::cli::serve
