#include "cli/top/curses.hpp"

#include <array>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <langinfo.h>
#include <poll.h>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/utf8.hpp"

#ifdef OCM_HAS_CURSES
#define NCURSES_NOMACROS 1
#define NCURSES_WIDECHAR 1
#include <curses.h>
#include <term.h>
#endif

namespace ocm::cli::top {

#ifndef OCM_HAS_CURSES

struct Curses::State {};
transport::Failure Curses::obstacle(const CursesOptions&) {
  return {};
}

transport::Outcome<std::unique_ptr<Curses>> Curses::open(const CursesOptions&) {
  return transport::Failure{};  // top looks at has_curses first
}
Curses::Curses(std::unique_ptr<State> state) : state_(std::move(state)) {}
Curses::~Curses() = default;
bool Curses::unicode() const noexcept {
  return false;
}
TerminalSize Curses::size() const {
  return {};
}
void Curses::draw(const Picture&) {}
std::optional<Key> Curses::key() {
  return {};
}
int Curses::input() const noexcept {
  return STDIN_FILENO;
}
bool Curses::gone() const noexcept {
  return true;
}

#else

struct Curses::State {
  SCREEN* screen = nullptr;
  bool unicode = false;
  bool gone = false;
  std::array<attr_t, 9> attributes{};
};

namespace {

/// By Style.
std::array<attr_t, 9> attributes_of(bool colour) {
  if (!colour)
    return {A_NORMAL, A_NORMAL, A_BOLD, A_REVERSE, A_REVERSE | A_BOLD, A_REVERSE, A_NORMAL, A_BOLD, A_BOLD};
  ::start_color();
  ::use_default_colors();
  ::init_pair(1, COLOR_GREEN, -1);
  ::init_pair(2, COLOR_YELLOW, -1);
  ::init_pair(3, COLOR_RED, -1);
  ::init_pair(4, COLOR_BLACK, COLOR_GREEN);
  ::init_pair(5, COLOR_BLACK, COLOR_CYAN);
  const auto pair = [](int number) { return static_cast<attr_t>(COLOR_PAIR(number)); };
  return {A_NORMAL, A_DIM, A_BOLD, pair(4), pair(5), pair(5), pair(1), pair(2), pair(3) | A_BOLD};
}

bool speaks_unicode() {
  std::setlocale(LC_CTYPE, "");
  return std::string_view{::nl_langinfo(CODESET)} == "UTF-8";
}

std::string ascii(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (base::continues_character(c)) continue;
    out += base::utf8_length({&c, 1}) == 1 ? c : '?';
  }
  return out;
}

std::optional<Key> named_key(int code) {
  using Kind = Key::Kind;
  switch (code) {
    case KEY_UP:
      return Key{Kind::up};
    case KEY_DOWN:
      return Key{Kind::down};
    case KEY_LEFT:
      return Key{Kind::left};
    case KEY_RIGHT:
      return Key{Kind::right};
    case KEY_PPAGE:
      return Key{Kind::page_up};
    case KEY_NPAGE:
      return Key{Kind::page_down};
    case KEY_HOME:
      return Key{Kind::home};
    case KEY_END:
      return Key{Kind::end};
    case KEY_ENTER:
      return Key{Kind::enter};
    case KEY_BACKSPACE:
      return Key{Kind::backspace};
    default:
      break;
  }
  if (code >= KEY_F(1) && code <= KEY_F(12))
    return Key{Kind::function, {}, static_cast<unsigned>(code - KEY_F0)};
  if (code != KEY_MOUSE) return {};
  MEVENT event{};
  if (::getmouse(&event) != OK) return {};
  if ((event.bstate & BUTTON4_PRESSED) != 0) return Key{Kind::up};
  if ((event.bstate & BUTTON5_PRESSED) != 0) return Key{Kind::down};
  if ((event.bstate & (BUTTON1_PRESSED | BUTTON1_CLICKED)) == 0 || event.y < 0) return {};
  return Key{Kind::click, {}, static_cast<unsigned>(event.y)};
}

std::string utf8(wint_t character) {
  return std::string{base::utf8_of(static_cast<char32_t>(character)).view()};
}

}  // namespace

/// What ncurses knows of a terminal, before it takes it: newterm is said to leave the program otherwise.
transport::Failure Curses::obstacle(const CursesOptions& options) {
  if (::isatty(STDOUT_FILENO) == 0 || ::isatty(STDIN_FILENO) == 0)
    return {fmt::format("{} draws on a terminal, and {} is none", options.program,
                        ::isatty(STDOUT_FILENO) == 0 ? "standard output" : "standard input"),
            std::string{options.instead}};
  const char* const name = std::getenv("TERM");
  if (name == nullptr || *name == '\0')
    return {"TERM is not set, so that nothing is known of this terminal",
            fmt::format("TERM=xterm-256color amiroctl {}", options.program)};
  int error = 0;
  if (::setupterm(name, STDOUT_FILENO, &error) != OK)
    return {fmt::format("TERM is '{}', of which nothing is known here", name),
            fmt::format("TERM=xterm-256color amiroctl {}, or install ncurses-term", options.program)};
  char cup[] = "cup";
  const char* const moves = ::tigetstr(cup);
  const bool can_move = moves != nullptr && moves != reinterpret_cast<const char*>(-1);
  ::del_curterm(::cur_term);  // newterm makes its own
  if (!can_move)
    return {fmt::format("TERM is '{}', a terminal that cannot move its cursor", name),
            std::string{options.instead}};
  return {};
}

transport::Outcome<std::unique_ptr<Curses>> Curses::open(const CursesOptions& options) {
  if (transport::Failure failure = obstacle(options); !failure.what.empty()) return failure;
  auto state = std::make_unique<State>();
  state->unicode = speaks_unicode();
  state->screen = ::newterm(nullptr, stdout, stdin);
  if (state->screen == nullptr)
    return transport::Failure{"ncurses cannot use this terminal", std::string{options.instead}};
  ::cbreak();
  ::noecho();
  ::nonl();
  ::keypad(stdscr, TRUE);
  ::nodelay(stdscr, TRUE);
  ::set_escdelay(25);
  ::curs_set(0);
  if (options.mouse) {
    ::mousemask(BUTTON1_PRESSED | BUTTON1_CLICKED | BUTTON4_PRESSED | BUTTON5_PRESSED, nullptr);
    ::mouseinterval(0);
  }
  state->attributes = attributes_of(options.colour && ::has_colors());
  return std::unique_ptr<Curses>{new Curses{std::move(state)}};
}

Curses::Curses(std::unique_ptr<State> state) : state_(std::move(state)) {}

Curses::~Curses() {
  ::endwin();
  ::delscreen(state_->screen);
}

bool Curses::unicode() const noexcept {
  return state_->unicode;
}

TerminalSize Curses::size() const {
  return {static_cast<std::size_t>(getmaxx(stdscr)), static_cast<std::size_t>(getmaxy(stdscr))};
}

void Curses::draw(const Picture& picture) {
  ::werase(stdscr);
  int y = 0;
  for (const Line& line : picture) {
    if (y >= getmaxy(stdscr)) break;
    ::wmove(stdscr, y++, 0);
    for (const Piece& piece : line) {
      ::wattrset(stdscr, static_cast<int>(state_->attributes[static_cast<std::size_t>(piece.style)]));
      const std::string text = state_->unicode ? piece.text : ascii(piece.text);
      ::waddnstr(stdscr, text.data(), static_cast<int>(text.size()));
    }
  }
  ::wattrset(stdscr, A_NORMAL);
  ::wrefresh(stdscr);
}

std::optional<Key> Curses::key() {
  for (;;) {
    wint_t code = 0;
    const int kind = ::wget_wch(stdscr, &code);
    if (kind == ERR) {
      // A terminal that is closed is readable, and has nothing.
      pollfd input{STDIN_FILENO, POLLIN, 0};
      int waiting = 0;
      if (::poll(&input, 1, 0) > 0 && ((input.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0 ||
                                       (::ioctl(STDIN_FILENO, FIONREAD, &waiting) == 0 && waiting == 0)))
        state_->gone = true;
      return {};
    }
    if (kind == KEY_CODE_YES) {
      if (const auto key = named_key(static_cast<int>(code))) return key;
      continue;
    }
    if (code == L'\r' || code == L'\n') return Key{Key::Kind::enter};
    if (code == L'\t') return Key{Key::Kind::tabulator};
    if (code == 0x1B) return Key{Key::Kind::escape};
    if (code == 0x7F || code == 0x08) return Key{Key::Kind::backspace};
    if (code >= 0x20) return Key{Key::Kind::character, utf8(code)};
  }
}

int Curses::input() const noexcept {
  return STDIN_FILENO;
}

bool Curses::gone() const noexcept {
  return state_->gone;
}

#endif

}  // namespace ocm::cli::top
