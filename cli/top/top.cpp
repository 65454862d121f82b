#include "cli/top/top.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <poll.h>
#include <span>
#include <utility>

#include "cli/bus_model/feed.hpp"
#include "cli/bus_model/models.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/top/curses.hpp"
#include "cli/top/message_line.hpp"
#include "cli/top/view.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli::top {
namespace {

using namespace std::chrono_literals;
using bus_model::LiveFeed;
using bus_model::LogFeed;

/// So often frames are taken, whether or not something is drawn: what a bus may keep for a reader is finite.
constexpr base::Duration pump_interval = 20ms;

/// Of the bus, where it can tell, else of the spec; 0: not known.
measure::BitRates known_bit_rates(const TopOptions& options, Session& session, const LiveFeed* live) {
  const std::uint32_t of_bus = live != nullptr ? live->bus().bit_rate() : 0;
  const std::uint32_t data = session.spec_files.empty() ? 0 : session.spec().model().data_bit_rate;
  return {options.bit_rate.value_or(of_bus != 0 ? of_bus : session.catalogue().bit_rate),
          options.data_bit_rate.value_or(data)};
}

class Top {
 public:
  Top(Session& session, const TopOptions& options, Curses& screen, std::unique_ptr<LiveFeed> live,
      std::unique_ptr<LogFeed> log)
      : catalogue_(session.catalogue()),
        bit_rates_(known_bit_rates(options, session, live.get())),
        interval_(options.interval),
        screen_(&screen),
        live_(std::move(live)),
        log_(std::move(log)),
        source_(live_ ? live_->name() : std::filesystem::path{options.log}.filename().string()),
        models_(new_models()),
        view_(screen.unicode()) {
    view_.only(options.topics);
  }

  /// Over::enough: the user quit.
  Over run() {
    auto before = Clock::now();
    auto next_draw = before;
    for (;;) {
      pollfd input{screen_->input(), POLLIN, 0};
      const base::Duration wait = std::clamp(next_draw - Clock::now(), base::Duration{0}, pump_interval);
      const bool pressed = wait_for_input(std::span{&input, 1}, wait);
      if (interrupted() != 0 || screen_->gone()) return Over::signal;
      const auto now = Clock::now();
      if (const Over over = pump(now - std::exchange(before, now)); over != Over::time) return over;
      if (!take_keys()) return Over::enough;
      if (pressed) next_draw = std::min(next_draw, drawn_ + shortest_interval);
      if (Clock::now() < next_draw) continue;
      draw();
      drawn_ = Clock::now();
      next_draw = drawn_ + interval_;
    }
  }

 private:
  [[nodiscard]] Models new_models() const {
    Models models{catalogue_, bit_rates_.nominal, bit_rates_.data};
    if (live_) models.of(live_->name());
    return models;
  }

  Over pump(base::Duration passed) {
    if (live_) {
      const Over over = live_->pump(models_);
      models_.until(live_->now());
      return over;
    }
    if (!paused_) log_->play(passed, taken());
    models_.until(log_->now());
    return interrupted() == 0 ? Over::time : Over::signal;
  }

  /// In a log.
  void go_to(base::Duration at) {
    at = std::clamp(at, base::Duration{0}, log_->playing().length);
    if (log_->is_behind(at))
      from_the_beginning_to(at);
    else
      log_->go_to(at, taken());
    models_.until(log_->now());
  }
  [[nodiscard]] LogFeed::Take taken() {
    return [this](const log::Entry& entry, const log::Interfaces& interfaces) {
      models_.take(entry, interfaces);
    };
  }
  /// Keeps what the view draws graphs of; whether there is anything new among it.
  bool follow() {
    bool any = false;
    for (std::size_t bus = 0; bus < models_.buses().size(); ++bus)
      any = models_.follow(bus, view_.graphs(bus)) || any;
    return any;
  }
  void from_the_beginning_to(base::Duration at) {
    models_ = new_models();
    log_->rewind();
    log_->go_to(base::Duration{0}, taken());  // the buses are known, so that graphs have a place
    models_.until(log_->now());
    follow();
    log_->go_to(at, taken());
    models_.until(log_->now());
  }

  /// false: quit.
  bool take_keys() {
    bool any = false;
    while (const auto key = screen_->key()) {
      any = true;
      if (!obey(view_.press(*key))) return false;
    }
    // A graph that is new shows what was before, too.
    if (any && follow() && log_) from_the_beginning_to(log_->playing().at);
    return true;
  }

  bool obey(const Effect& effect) {
    switch (effect.kind) {
      case Effect::Kind::none:
        break;
      case Effect::Kind::quit:
        return false;
      case Effect::Kind::pause:
        paused_ = !paused_;
        // What comes meanwhile counts, and is shown when it goes on.
        frozen_ = paused_ && live_ ? std::optional{std::pair{models_, live_->now()}} : std::nullopt;
        break;
      case Effect::Kind::move:
        if (log_) go_to(log_->playing().at + effect.by);
        break;
      case Effect::Kind::rewind:
        if (log_) go_to(base::Duration{0});
        break;
      case Effect::Kind::faster:
        if (log_) log_->faster(2);
        break;
      case Effect::Kind::slower:
        if (log_) log_->faster(0.5);
        break;
    }
    return true;
  }

  void draw() {
    const auto buses = frozen_ ? frozen_->first.buses() : models_.buses();
    Scene scene;
    scene.robot = catalogue_.robot;
    scene.source = source_;
    scene.buses = buses;
    scene.now = frozen_ ? frozen_->second : live_ ? live_->now() : log_->now();
    scene.paused = paused_;
    scene.waiting = live_ && live_->bus().state() == transport::BusState::down;
    if (log_) scene.playing = log_->playing();
    if (message_.shows(HeldMessages::count(), Clock::now())) scene.message = HeldMessages::newest();
    screen_->draw(view_.draw(scene, screen_->size()));
  }

  const protocol::Catalogue& catalogue_;
  measure::BitRates bit_rates_;
  base::Duration interval_;
  Curses* screen_;
  std::unique_ptr<LiveFeed> live_;
  std::unique_ptr<LogFeed> log_;
  std::string source_;
  Models models_;
  View view_;
  bool paused_ = false;
  std::optional<std::pair<Models, base::Time>> frozen_;
  Clock::time_point drawn_{};
  MessageLine message_;
};

}  // namespace

int run(Session& session, const TopOptions& options) {
  if (!has_curses)
    fail({"this amiroctl was built without ncurses, which draws",
          "install libncurses-dev and build again; amiroctl stats and listen need none"},
         exit_usage);
  const CursesOptions look{.colour = session.colour(), .mouse = options.mouse};
  // Before a bus is looked for, and said which.
  if (const auto obstacle = Curses::obstacle(look); options.log.empty() && !obstacle.what.empty())
    fail(obstacle, exit_usage);
  catch_interrupts();
  catch_hangups();
  std::unique_ptr<LiveFeed> live;
  std::unique_ptr<LogFeed> log;
  if (options.log.empty())
    live = std::make_unique<LiveFeed>(session.open_bus());
  else
    log = std::make_unique<LogFeed>(options.log, options.format, session.catalogue());
  if (interrupted() != 0) return exit_code_after_interrupt(exit_success);
  const LiveFeed* const bus = live.get();
  const LogFeed* const file = log.get();

  Over over = Over::signal;
  bool all = true;
  transport::Failure gone;
  {
    const HeldMessages held;
    auto screen = Curses::open(look);
    if (!screen) fail(screen.error, exit_usage);
    Top top{session, options, **screen, std::move(live), std::move(log)};
    over = top.run();
    if (over == Over::gone) gone = bus->bus().failure();
    all = file == nullptr || file->is_whole();
  }
  if (over == Over::gone) fail(gone);
  return exit_code_after_interrupt(all ? exit_success : exit_failure);
}

}  // namespace ocm::cli::top
