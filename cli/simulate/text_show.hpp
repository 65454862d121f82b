/// A simulated world on the terminal while it runs: what `sim --show=text` is.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "cli/shared/session.hpp"
#include "sim/serve/seen.hpp"

namespace ocm::cli::simulate {

struct TextShowOptions {
  double speed = 1;  ///< times real time
  std::string bus;   ///< RoomScene::bus
};

/// As long as it lives the terminal is its, and messages are held; then it is as it was.
class TextShow {
 public:
  /// Leaves through `fail` where there is no terminal, one that cannot move its cursor, or no ncurses.
  TextShow(const Session& session, TextShowOptions options);
  ~TextShow();
  TextShow(const TextShow&) = delete;
  TextShow& operator=(const TextShow&) = delete;

  /// Takes keys, and draws where it is time to: ten pictures a second, at once after a key, and never more
  /// than twenty.
  void watch(const std::function<sim::SeenWorld()>& look);
  /// The user has quit, or the terminal is gone.
  [[nodiscard]] bool over() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ocm::cli::simulate
