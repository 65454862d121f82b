#include "cli/simulate/text_show.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "cli/shared/clock.hpp"
#include "cli/shared/messages.hpp"
#include "cli/simulate/room_view.hpp"
#include "cli/top/curses.hpp"
#include "cli/top/message_line.hpp"

namespace ocm::cli::simulate {
namespace {

using namespace std::chrono_literals;
using top::Key;

constexpr base::Duration usual_interval = 100ms;
constexpr base::Duration shortest_interval = 50ms;

}  // namespace

struct TextShow::State {
  TextShowOptions options;
  HeldMessages held;  // outlives the screen, so that what is held is written behind it
  std::unique_ptr<top::Curses> screen;
  Trails trails;
  bool beams = true;
  bool quit = false;
  std::size_t chosen = 0;
  std::size_t robots = 1;
  Clock::time_point drawn{};
  top::MessageLine message;

  void press(const Key& key) {
    const bool is_letter = key.kind == Key::Kind::character;
    if ((is_letter && key.text == "q") || (key.kind == Key::Kind::function && key.number == 10))
      quit = true;
    else if (is_letter && key.text == "b")
      beams = !beams;
    else if (is_letter && key.text == "t")
      trails.forget();
    else if (key.kind == Key::Kind::tabulator || key.kind == Key::Kind::down || key.kind == Key::Kind::right)
      chosen = (chosen + 1) % robots;
    else if (key.kind == Key::Kind::up || key.kind == Key::Kind::left)
      chosen = (chosen + robots - 1) % robots;
  }
};

TextShow::TextShow(const Session& session, TextShowOptions options) {
  if (!top::has_curses)
    fail({"this amiroctl was built without ncurses, which draws",
          "install libncurses-dev and build again, or leave --show out"},
         exit_usage);
  auto screen = top::Curses::open({.program = "sim --show=text",
                                   .colour = session.colour(),
                                   .instead = "leave --show out: the simulator needs no terminal"});
  if (!screen) fail(screen.error, exit_usage);
  state_ = std::make_unique<State>();
  state_->options = std::move(options);
  state_->screen = std::move(*screen);
}

TextShow::~TextShow() {
  state_->screen.reset();
}

void TextShow::watch(const std::function<sim::SeenWorld()>& look) {
  State& state = *state_;
  bool pressed = false;
  while (const auto key = state.screen->key()) {
    state.press(*key);
    pressed = true;
  }
  const auto now = Clock::now();
  if (now - state.drawn < (pressed ? shortest_interval : usual_interval)) return;
  state.drawn = now;
  const sim::SeenWorld world = look();
  state.robots = std::max<std::size_t>(world.robots.size(), 1);
  state.trails.take(world);
  RoomScene scene{state.options.speed, state.options.bus, state.chosen, state.beams};
  if (state.message.shows(HeldMessages::count(), now)) scene.message = HeldMessages::newest();
  state.screen->draw(draw_room(world, state.trails, scene, state.screen->size(), state.screen->unicode()));
}

bool TextShow::over() const noexcept {
  return state_->quit || state_->screen->gone();
}

}  // namespace ocm::cli::simulate
