/// A terminal that is drawn on and read key by key: ncurses, seen by curses.cpp alone.
#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "ocm/transport/bus.hpp"

#include "cli/shared/terminal.hpp"
#include "cli/top/view.hpp"

namespace ocm::cli::top {

struct CursesOptions {
  std::string_view program = "top";  ///< for messages
  bool colour = true;
  bool mouse = false;
  std::string_view instead =
      "amiroctl stats and listen write to anything";  ///< what works without a terminal
};

/// Whether it was built with ncurses; where not, a program needs nothing of what only draws.
#ifdef OCM_HAS_CURSES
inline constexpr bool has_curses = true;
#else
inline constexpr bool has_curses = false;
#endif

/// From its making to its end the terminal is this program's; then it is as it was.
class Curses {
 public:
  /// Why `open` cannot draw, without touching the terminal: the output is no terminal, ncurses does not know
  /// its type, or that type cannot move its cursor. An empty failure: nothing is in the way, or there is no
  /// ncurses.
  [[nodiscard]] static transport::Failure obstacle(const CursesOptions& options);
  /// The failure says what is missing: as `obstacle`, or ncurses.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<Curses>> open(const CursesOptions& options);
  ~Curses();
  Curses(const Curses&) = delete;
  Curses& operator=(const Curses&) = delete;

  /// Whether it has the characters of UTF-8.
  [[nodiscard]] bool unicode() const noexcept;
  [[nodiscard]] TerminalSize size() const;
  void draw(const Picture& picture);
  /// A key that was pressed, without waiting; none: there is none.
  [[nodiscard]] std::optional<Key> key();
  /// What to poll for keys.
  [[nodiscard]] int input() const noexcept;
  /// The terminal is gone: no key will come any more.
  [[nodiscard]] bool gone() const noexcept;

 private:
  struct State;
  explicit Curses(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace ocm::cli::top
