#include "cli/operate/runner.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/measure/bus_load.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/operator_link.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::operate {

using reflective::Action;
using reflective::BusState;
using reflective::none;

namespace {

std::string_view name_of(BusState state) {
  constexpr std::string_view names[] = {"active", "warning", "passive", "off", "down"};
  return names[static_cast<std::size_t>(state)];
}

/// A measured time, of which no more than four digits say something; rounded up.
std::string measured(base::Duration time) {
  std::int64_t step = 1;
  while (time.count() / step >= 10'000) step *= 10;
  return words::to_text(base::Duration{(time.count() + step - 1) / step * step});
}

/// That `why` tells.
constexpr std::size_t most_changes = 20;
constexpr base::Duration retry_sending{1'000'000};
/// The state of a bus shows in its object after a wait, without a frame.
constexpr base::Duration longest_wait{50'000'000};
/// So many frames that wait are taken before what time asks for: they came first, and a storm of them does
/// not hold that up.
constexpr int most_before_time = 64;
/// So far the two clocks part when one of them is set: NTP lets them part by 25 us in the longest wait, and
/// between two looks at them a busy machine may do something else.
constexpr base::Duration wall_clock_is_set{5'000'000};
/// What a run that is killed loses of its black box.
constexpr base::Duration keep_up_every{500'000'000};

}  // namespace

Runner::Runner(transport::Bus& bus, Control& control, const protocol::Catalogue& catalogue,
               const OperatorFile& file, const RunOptions& options)
    : bus_(&bus),
      control_(&control),
      catalogue_(&catalogue),
      file_(&file),
      options_(&options),
      box_(options.black_box, file.name, std::string{bus.name()}, catalogue),
      live_(bus, [this] { none_waits(); }, {control.descriptor(), [&control] { control.serve(); }}),
      receiver_(catalogue, client::Transport::together),
      index_(catalogue),
      refusals_(catalogue),
      supervisor_(file.tables),
      counted_(file) {
  for (const auto& condition : file.conditions)
    if (condition.watched == reflective::Watched::bus_load) window_ = condition.window;
  control.begin(file.name,
                [this](Caller& caller, std::string_view request) { return answer(caller, request); });
}

Over Runner::run() {
  none_waits();
  const base::Time begin = nothing_waited_;
  if (window_.count() > 0) window_end_ = begin + window_;
  if (box_.keeps()) keep_up_at_ = begin + keep_up_every;
  recover();
  carry_out(supervisor_.start(begin), begin);
  look_at_bus();  // a monitor that looks at its state would know nothing of it until it changes
  service_.ready(fmt::format("operator {} on {}", file_->tables.name, bus_->name()));
  for (;;) {
    base::Time until = std::min({supervisor_.next(), window_end_, keep_up_at_, now() + longest_wait});
    if (!queue_.empty()) until = std::min(until, now() + retry_sending);
    service_.runs(Clock::now());
    int taken = 0;
    const Over over =
        live_.receive_any(Clock::time_point{until.time_since_epoch()}, [&](const auto& received) {
          take(received);
          if (!queue_.empty() || supervisor_.next() < until) return false;  // it waits for less time now
          return ++taken < most_before_time || until > now();
        });
    if (over == Over::signal || over == Over::gone) {
      if (over == Over::gone) record();
      return over;
    }
    control_->serve();  // the loop above may have had no time for a wait
    look_at_bus();
    const base::Time at = now();
    if (window_end_ <= at) end_window(at);
    if (keep_up_at_ <= at) keep_up(at);
    if (look_at_socket_at_ <= at) look_at_socket(at);
    if (supervisor_.next() <= at) {
      const base::Duration late = at - supervisor_.next();
      step({}, at);
      judge(late);
    }
    flush();  // behind the step: it may have replaced what waits
  }
}

void Runner::recover() {
  const auto left = box_.recover(unix_time());
  for (const auto& file : left.files)
    tell("recovered", {{"file", file}},
         fmt::format("the last run of operator {} was killed; its last seconds are in {}", file_->tables.name,
                     file));
  if (!left.lost) return;
  ++counters_.recordings_lost;
  complain({fmt::format("operate: --black-box: {}", left.lost->what), left.lost->remedy});
}

void Runner::step(const Event& event, base::Time at) {
  const std::uint16_t waited = supervisor_.requested();
  const Actions actions = supervisor_.step(event, at);
  carry_out(actions, at);
  for (const Action& action : actions)
    if (action.kind == Action::Kind::switched && waited != none && action.to != waited) {
      const std::string_view name = file_->configurations[waited].name;
      tell("request_dropped", {{"configuration", name}},
           fmt::format("the request for {} is dropped: another transition came first", name));
    }
}

void Runner::carry_out(Actions actions, base::Time) {
  // First what acts, then what is said of it.
  for (const Action& action : actions)
    if (action.sends()) queue(action.frame);
  flush();
  for (const Action& action : actions) {
    if (action.kind == Action::Kind::switched) {
      tell_switch(action);
      if (action.to == file_->tables.fall_back && action.from != none) record();
    } else if (action.kind == Action::Kind::again) {
      const auto topic = file_->tables.topic(action.topic).name;
      tell("asked_again", {{"topic", topic}}, fmt::format("{} is silent, and is asked for again", topic));
    }
  }
}

void Runner::take(const transport::ReceivedAny& received) {
  const base::Time at = now();
  box_.add(log::Entry{received.time, received.frame}, Clock::now());
  const auto classic = received.frame.classic();
  if (received.frame.format == can::Format::error) return take_error(received.frame);
  if (classic) {
    bits_ += measure::bits_on_bus(*classic);
    if (const auto refused = refusals_.take({received.time, *classic}, at)) {
      ++counters_.refusals;
      tell("refused",
           {{"topic", refused->topic->name}, {"board", refused->board}, {"reason", refused->reason}},
           fmt::format("{} refuses {}: {}", refused->board, refused->topic->name,
                       refused->reason.empty() ? std::string_view{"it does not say why"} : refused->reason));
      step({.kind = Event::Kind::refusal}, at);
    }
  }
  const auto reception = receiver_.take(received.frame.view(), received.time);
  if (reception.meaning != client::Meaning::sample) return;
  const auto topic = static_cast<std::uint16_t>(reception.topic - catalogue_->topics.data());
  const std::uint64_t sent = counters_.sent;
  const auto age = waited(received.time);
  step({.kind = Event::Kind::sample, .topic = topic, .bytes = reception.sample.bytes, .age = age}, at);
  // What it sent must have been handed over in time, counted from the frame.
  if (counters_.sent != sent) judge(waited(received.time));
}

void Runner::none_waits() {
  nothing_waited_ = now();
  wall_clock_ = unix_time() - nothing_waited_;
}

base::Duration Runner::waited(base::Time stamp) const {
  const base::Time at = now();
  const base::Time wall = unix_time();
  const base::Duration longest = at - nothing_waited_;
  const base::Duration set = wall - at - wall_clock_;
  if (set > wall_clock_is_set || set < -wall_clock_is_set) return longest;
  return std::clamp(wall - stamp, base::Duration{}, longest);
}

void Runner::take_error(const can::AnyFrame& frame) {
  namespace cls = can::error_class;
  namespace controller = can::controller_error;
  if ((frame.id & cls::restarted) != 0) controller_ = BusState::active;
  if ((frame.id & cls::controller) != 0) {
    const unsigned bits = frame.data[1];
    if ((bits & (controller::rx_passive | controller::tx_passive)) != 0)
      controller_ = BusState::passive;
    else if ((bits & (controller::rx_warning | controller::tx_warning)) != 0)
      controller_ = BusState::warning;
    else if ((bits & controller::active) != 0)
      controller_ = BusState::active;
  }
  if ((frame.id & cls::bus_off) != 0) controller_ = BusState::off;
  look_at_bus();
}

void Runner::look_at_bus() {
  const bool down = bus_->state() == transport::BusState::down;
  if (down && controller_ != BusState::active) controller_ = BusState::active;  // it starts from active again
  set_bus_state(down ? BusState::down : controller_);
}

void Runner::set_bus_state(BusState state) {
  if (state == bus_state_) return;
  const bool news = bus_state_ || state != BusState::active;
  bus_state_ = state;
  if (news) tell("bus_state", {{"state", name_of(state)}}, fmt::format("the bus is {}", name_of(state)));
  step({.kind = Event::Kind::bus_state, .value = static_cast<std::int64_t>(state)}, now());
}

void Runner::end_window(base::Time at) {
  const auto passed = static_cast<double>((at - window_end_ + window_).count()) * 1e-9;
  const double there_was = passed * options_->bit_rate;
  const double load = there_was > 0 ? static_cast<double>(bits_) / there_was : 0;
  bits_ = 0;
  window_end_ = at + window_;
  step({.kind = Event::Kind::bus_load,
        .value = std::min<std::int64_t>(1000, static_cast<std::int64_t>(load * 1000 + 0.5))},
       at);
}

void Runner::queue(const can::Frame& frame) {
  const auto same = [&](const can::Frame& other) { return other.id == frame.id; };
  const auto old = std::find_if(queue_.begin(), queue_.end(), same);
  if (old != queue_.end()) {
    queue_.erase(old);
    ++counters_.replaced;
  }
  queue_.push_back(frame);
}

void Runner::flush() {
  while (!queue_.empty()) {
    const auto taken = bus_->send(queue_.front());
    if (!taken || !*taken) return;  // closed: the next wait says so
    const can::Frame& frame = queue_.front();
    ++counters_.sent;
    ++handed_over_;
    bits_ += measure::bits_on_bus(frame);
    refusals_.sent(frame, now());
    log::Entry entry{unix_time(), frame};
    entry.direction = log::Direction::sent;
    box_.add(entry, Clock::now());
    queue_.pop_front();
  }
}

void Runner::judge(base::Duration late) {
  if (late <= file_->tables.reaction) return;
  ++counters_.late;
  counters_.latest = std::max(counters_.latest, late.count());
  if (counters_.late == 1)
    tell("late", {{"took_ns", late.count()}},
         fmt::format("a step took {}, which is longer than \"reaction\": the bounds do not hold for it",
                     measured(late)));
}

void Runner::record() {
  if (!box_.keeps()) return;
  const auto recording = std::make_shared<BlackBox::Recording>(box_.take(Clock::now(), unix_time()));
  const std::size_t frames = recording->entries.size();
  std::string line = event_line("recorded", {{"file", recording->path}, {"frames", frames}},
                                fmt::format("{} before it {} in {}", counted(frames, "frame"),
                                            frames == 1 ? "is" : "are", recording->path));
  const bool taken = background_.post([this, recording, line = std::move(line)] {
    const auto written = box_.write(*recording);
    if (written) {
      ++written_.recordings;
      print(line);
      return;
    }
    ++written_.recordings_lost;
    complain({fmt::format("operate: {}: {}", recording->path, written.error.what), written.error.remedy});
  });
  if (!taken) ++counters_.recordings_lost;
}

void Runner::keep_up(base::Time at) {
  keep_up_at_ = at + keep_up_every;
  auto fresh = box_.take_fresh(unix_time());
  if (fresh.empty()) return;
  const std::size_t frames = fresh.size();
  const bool taken = background_.post([this, fresh = std::move(fresh)] {
    const auto written = box_.spool(fresh);
    if (written) return;
    if (written_.not_kept == 0)
      complain({fmt::format("operate: --black-box: {}", written.error.what), written.error.remedy});
    written_.not_kept += fresh.size();
  });
  if (!taken) counters_.not_kept += frames;
}

void Runner::tell_switch(const Action& action) {
  const auto& tables = file_->tables;
  const auto to = tables.configurations[action.to].name;
  service_.status(fmt::format("operator {} is in {}", tables.name, to));
  if (changes_.size() == most_changes) changes_.pop_front();
  auto& change = changes_.emplace_back(Change{unix_time(), action.from, action.to, {}, {}});
  if (action.from == none)
    return tell("started", {{"configuration", to}}, fmt::format("operator {} is in {}", tables.name, to));
  const auto from = tables.configurations[action.from].name;
  const auto& transition = tables.transitions[action.transition];
  std::string because;
  Json conditions = Json::array();
  if (transition.monitor != reflective::by_request) {
    const auto terms = tables.monitors[transition.monitor].terms;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      if (terms[t].op != reflective::Op::condition) continue;
      if (supervisor_.held(terms[t].condition) != reflective::truth(!reflective::negated(terms, t))) continue;
      const std::string name = term_text(tables, terms, t);
      because += fmt::format("{}{}", because.empty() ? "" : ", ", name);
      conditions.push_back(name);
      change.conditions.push_back(name);
    }
  }
  change.cause = transition.cause;
  tell("switched", {{"from", from}, {"to", to}, {"cause", transition.cause}, {"conditions", conditions}},
       fmt::format("{} -> {}: {}{}", from, to, transition.cause,
                   because.empty() ? std::string{} : fmt::format(" ({})", because)));
}

void Runner::tell(std::string_view event, std::initializer_list<Json::Member> facts,
                  const std::string& text) {
  const bool taken = background_.post([this, line = event_line(event, facts, text)] { print(line); });
  if (!taken) ++lines_lost_;
}

std::string Runner::event_line(std::string_view event, std::initializer_list<Json::Member> facts,
                               const std::string& text) const {
  if (!options_->json) return printable(text) + "\n";
  Json object{{"event", event}, {"time_ns", std::to_string(unix_time().time_since_epoch().count())}};
  for (const auto& [name, value] : facts) object[name] = value;
  return object.line() + "\n";
}

void Runner::print(const std::string& line) {
  const Written written = write_all(STDOUT_FILENO, line, Signals::blocked);
  if (written.bytes == line.size()) return;
  if (lines_lost_++ == 0 && written.error != EINTR)
    complain({fmt::format("operate: standard output: {}", std::strerror(written.error)),
              "the robot is guarded all the same; lines that are not printed are counted"});
}

void Runner::rest() {
  service_.stopping();
  queue_.clear();
  // What it may command anywhere.
  std::vector<std::uint16_t> actuators;
  const auto add = [&](std::uint16_t topic) {
    if (std::find(actuators.begin(), actuators.end(), topic) == actuators.end()) actuators.push_back(topic);
  };
  for (const auto& configuration : file_->configurations) {
    for (const auto& set_point : configuration.entry) add(set_point.topic);
    for (const auto& limit : configuration.limits) add(limit.topic);
  }
  Outgoing outgoing{*bus_, "operate", actuators.empty() ? std::string{} : still_moving};
  for (const std::uint16_t topic : actuators)
    outgoing.send(reflective::Supervisor<room>::frame_of(file_->tables, {.topic = topic}));
  const auto& configuration = file_->configurations[supervisor_.configuration()];
  for (const auto& stream : configuration.streams) {
    const auto& topic = file_->tables.topic(stream.topic);
    if (!topic.is_message()) outgoing.send(protocol::stop(topic.id, stream.priority));
  }
  outgoing.expect_all_left();
  tell("ended", {{"configuration", configuration.name}},
       fmt::format("operator {} has ended, everything that it commands is at rest", file_->tables.name));
}

void Runner::sum_up() {
  background_.finish();
  counters_.recordings += written_.recordings;
  counters_.recordings_lost += written_.recordings_lost;
  counters_.not_kept += written_.not_kept;
  box_.end();
  const auto& done = supervisor_.counters();
  std::string text =
      fmt::format("operate: {}, {} sent", counted(done.switches, "change"), counted(counters_.sent, "frame"));
  add_count(text, done.asked_again, "silent stream", "asked for again");
  add_count(text, done.adapted, "period", "adapted");
  add_count(text, counters_.refusals, "refusal", "");
  add_count(text, counters_.replaced, "frame", "replaced by newer ones before the bus took them");
  add_count(text, commands_.passed, "set point", "passed on");
  add_count(text, commands_.limited, "set point", "limited");
  add_count(text, commands_.refused, "set point", "refused");
  add_count(text, commands_.beyond, "set point", "more often, or more urgent, than the proof counts");
  add_count(text, control_->turned_away(), "program", "turned away");
  add_count(text, counters_.recordings, "recording", "");
  add_count(text, counters_.recordings_lost, "recording", "lost");
  add_count(text, counters_.not_kept, "frame", "that a kill would have lost from the black box");
  add_count(text, box_.dropped(), "frame", "that the black box had no room for");
  add_count(text, lines_lost_, "event line", "not printed");
  add_count(text, done.not_a_number, "value",
            done.not_a_number == 1 ? "that is no number" : "that are no number");
  add_count(text, bus_->counters().lost, "frame", "lost");
  if (counters_.late != 0)
    text += fmt::format(", {} later than \"reaction\", up to {}", counted(counters_.late, "step"),
                        measured(base::Duration{counters_.latest}));
  remark(text);
}

}  // namespace ocm::cli::operate
