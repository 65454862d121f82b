#include "cli/operate/runner.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/measure/bus_load.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/outgoing.hpp"
#include "cli/shared/set_points.hpp"
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
      live_(bus, [this] { nothing_waited_ = now(); },
            {control.descriptor(), [&control] { control.serve(); }}),
      receiver_(catalogue, client::Transport::together),
      index_(catalogue),
      refusals_(catalogue),
      supervisor_(file.tables) {
  for (const auto& condition : file.conditions)
    if (condition.watched == reflective::Watched::bus_load) window_ = condition.window;
  control.begin(file.name,
                [this](Caller& caller, std::string_view request) { return answer(caller, request); });
}

Over Runner::run() {
  const base::Time begin = nothing_waited_ = now();
  if (window_.count() > 0) window_end_ = begin + window_;
  if (box_.keeps()) keep_up_at_ = begin + keep_up_every;
  if (const auto left = box_.recover(unix_time()))
    tell("recovered", {{"file", *left}},
         fmt::format("the last run of operator {} was killed; its last seconds are in {}", file_->tables.name,
                     *left));
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
    if (supervisor_.next() <= at) {
      const base::Duration late = at - supervisor_.next();
      step({}, at);
      judge(late);
    }
    flush();  // behind the step: it may have replaced what waits
  }
}

void Runner::step(const Event& event, base::Time at) {
  carry_out(supervisor_.step(event, at), at);
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
  // By the wall clock, which may be set: but it came after the last time that none waited.
  const auto age = std::clamp(unix_time() - received.time, base::Duration{}, at - nothing_waited_);
  step({.kind = Event::Kind::sample, .topic = topic, .bytes = reception.sample.bytes, .age = age}, at);
  // What it sent must have been handed over in time, counted from the frame.
  if (counters_.sent != sent) judge(unix_time() - received.time);
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
  // The wall clock, by which frames are stamped, may have been set.
  if (late > std::chrono::hours{1}) return;
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
  ++counters_.recordings;
  const bool taken = background_.post([this, recording] {
    const auto written = box_.write(*recording);
    if (!written)
      complain({fmt::format("operate: {}: {}", recording->path, written.error.what), written.error.remedy});
  });
  if (!taken) ++counters_.recordings_lost;
  tell("recorded", {{"file", recording->path}, {"frames", recording->entries.size()}},
       fmt::format("{} frames before it are in {}", recording->entries.size(), recording->path));
}

void Runner::keep_up(base::Time at) {
  keep_up_at_ = at + keep_up_every;
  auto fresh = box_.take_fresh(unix_time());
  if (fresh.empty()) return;
  const std::size_t frames = fresh.size();
  const bool taken = background_.post([this, fresh = std::move(fresh)] {
    const auto written = box_.spool(fresh);
    if (written) return;
    if (not_kept_ == 0)
      complain({fmt::format("operate: --black-box: {}", written.error.what), written.error.remedy});
    not_kept_ += fresh.size();
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
  if (transition.monitor != reflective::by_request)
    for (const auto& term : tables.monitors[transition.monitor].terms)
      if (term.op == reflective::Op::condition && supervisor_.held(term.condition)) {
        const auto name = tables.conditions[term.condition].name;
        because += fmt::format("{}{}", because.empty() ? "" : ", ", name);
        conditions.push_back(name);
        change.conditions.emplace_back(name);
      }
  change.cause = transition.cause;
  tell("switched", {{"from", from}, {"to", to}, {"cause", transition.cause}, {"conditions", conditions}},
       fmt::format("{} -> {}: {}{}", from, to, transition.cause,
                   because.empty() ? std::string{} : fmt::format(" ({})", because)));
}

void Runner::tell(std::string_view event, std::initializer_list<Json::Member> facts,
                  const std::string& text) {
  std::string line;
  if (options_->json) {
    Json object{{"event", event}, {"time_ns", std::to_string(unix_time().time_since_epoch().count())}};
    for (const auto& [name, value] : facts) object[name] = value;
    line = object.line() + "\n";
  } else {
    line = printable(text) + "\n";
  }
  const bool taken = background_.post([this, line = std::move(line)] {
    const Written written = write_all(STDOUT_FILENO, line, Signals::blocked);
    if (written.bytes == line.size()) return;
    if (lines_lost_++ == 0 && written.error != EINTR)
      complain({fmt::format("operate: standard output: {}", std::strerror(written.error)),
                "the robot is guarded all the same; lines that are not printed are counted"});
  });
  if (!taken) ++lines_lost_;
}

std::string Runner::answer(Caller& caller, std::string_view request) {
  const auto line = [](const Json& json) { return json.line() + "\n"; };
  if (request == "status") return yes(answers().status(now()));
  if (request == "status json") return yes(line(answers().status_json(now())));
  if (request == "why") return yes(answers().why());
  if (request == "why json") return yes(line(answers().why_json()));
  if (request == "hold") return hold(caller, true);
  if (request == "resume") return hold(caller, false);
  if (request == "delivery") {
    const auto delivery = bus_->delivery();
    if (!delivery.obstruction.what.empty()) return no(delivery.obstruction.what, delivery.obstruction.remedy);
    if (!delivery.known) return yes("unknown");
    // What was handed over behind this program's last frame is none of its frames.
    const std::uint64_t behind = handed_over_ - caller.handed_over;
    return yes(std::to_string(delivery.pending > behind ? delivery.pending - behind : 0));
  }
  if (request.starts_with(operator_commands)) return commands(request.substr(operator_commands.size()));
  constexpr std::string_view switches = "switch ", sends = "send ";
  if (request.starts_with(switches)) return switch_to(caller, request.substr(switches.size()));
  if (request.starts_with(sends)) return pass_on(caller, request.substr(sends.size()));
  return no("that is no request to an operator", "status, why, switch, hold, resume");
}

std::string Runner::switch_to(const Caller& caller, std::string_view name) {
  const auto& tables = file_->tables;
  const auto& configurations = tables.configurations;
  const auto found = std::find_if(configurations.begin(), configurations.end(),
                                  [&](const auto& each) { return each.name == name; });
  if (found == configurations.end()) {
    std::string names;
    for (const auto& each : configurations)
      names += fmt::format("{}{}", names.empty() ? "" : ", ", each.name);
    return no(fmt::format("operator {} has no configuration \"{}\"", tables.name, printable(name)),
              fmt::format("one of {}", names));
  }
  const auto to = static_cast<std::uint16_t>(found - configurations.begin());
  const auto from = supervisor_.configuration();
  if (to == from) return yes(fmt::format("operator {} is in {} already\n", tables.name, name));
  if (!supervisor_.leads_to(to))
    return no(fmt::format("no request leads from {} to {}", configurations[from].name, name),
              "`amiroctl operator why` shows what leads from here");
  tell("requested", {{"configuration", name}, {"by", caller.verb}, {"process", caller.process}},
       fmt::format("{} (process {}) asks for {}", caller.verb, caller.process, name));
  const base::Time at = now();
  step({.kind = Event::Kind::request, .value = to}, at);
  if (supervisor_.configuration() == to)
    return yes(fmt::format("{} -> {}\n", configurations[from].name, name));
  if (supervisor_.requested() == to)
    return yes(fmt::format("{} follows when the last change is over\n", name));
  return no(fmt::format("another transition came first: it is in {}",
                        configurations[supervisor_.configuration()].name),
            "`amiroctl operator why` says which");
}

std::string Runner::hold(const Caller& caller, bool held) {
  const auto& tables = file_->tables;
  const bool was = supervisor_.on_hold();
  supervisor_.hold(held);
  if (was != held)
    tell(held ? "held" : "resumed", {{"by", caller.verb}, {"process", caller.process}},
         fmt::format("{} (process {}) {}", caller.verb, caller.process,
                     held ? "holds it: monitors lead to the fall-back only" : "lets it go on"));
  step({}, now());
  return yes(fmt::format("operator {} {}{}: it is in {}\n", tables.name, was == held ? "already " : "",
                         held ? "is on hold, and guards the robot" : "goes on",
                         tables.configurations[supervisor_.configuration()].name));
}

bool Runner::may_command(const Caller& caller) const {
  const auto& commanders = file_->parts[supervisor_.configuration()].commanders;
  return !commanders || std::find(commanders->begin(), commanders->end(), caller.verb) != commanders->end();
}

const reflective::SetPoint* Runner::own_set_point(std::uint16_t topic) const {
  for (const auto& set_point : file_->configurations[supervisor_.configuration()].entry)
    if (set_point.topic == topic) return &set_point;
  return nullptr;
}

std::string Runner::commands(std::string_view text) const {
  const auto frame = can::parse_frame(text);
  const auto found = frame ? index_.subject(frame->id, frame->format) : client::Subject{};
  if (!found.frame) return no(fmt::format("{} commands no actuator", printable(text)), "a frame of the spec");
  const auto* const own = own_set_point(static_cast<std::uint16_t>(found.topic - catalogue_->topics.data()));
  if (own == nullptr) return yes();
  return yes(fmt::format("{}\n{}", own->repeat.count() > 0 ? operator_repeats : "once",
                         file_->configurations[supervisor_.configuration()].name));
}

std::string Runner::pass_on(Caller& caller, std::string_view text) {
  auto frame = can::parse_frame(text);
  const auto found = frame ? index_.subject(frame->id, frame->format) : client::Subject{};
  if (!found.frame || found.topic->is_message() || found.topic->kind != protocol::Kind::actuator)
    return no(fmt::format("{} commands no actuator", printable(text)), "it goes to the bus itself");
  const auto& tables = file_->tables;
  const auto& topic = *found.topic;
  const auto number = static_cast<std::uint16_t>(&topic - catalogue_->topics.data());
  const auto& layout = found.frame.layout();
  if (frame->dlc != layout.dlc()) {
    ++commands_.refused;
    return no(fmt::format("{} has {} bytes, and {} takes {}", text, frame->dlc, topic.name, layout.dlc()),
              "is --spec that of the robot?");
  }
  const bool rests = (topic.role == protocol::Role::drive || topic.timeout.count() != 0) && is_rest(*frame);
  if (!rests && !may_command(caller)) {
    ++commands_.refused;
    return no(fmt::format("operator {} is in {}, where {} may not command {}", tables.name,
                          tables.configurations[supervisor_.configuration()].name, caller.verb, topic.name),
              "`amiroctl operator why` says why it is there");
  }
  // The board would follow the two in turns.
  const auto* const own = own_set_point(number);
  if (!rests && own != nullptr && own->repeat.count() > 0) {
    ++commands_.refused;
    return no(fmt::format("operator {} is in {}, where it commands {} itself", tables.name,
                          tables.configurations[supervisor_.configuration()].name, topic.name),
              "`amiroctl operator why` says why it is there");
  }
  if (!queue_.empty()) return wait();
  std::vector<std::int64_t> raw;
  for (const auto& field : layout.fields) raw.push_back(field.raw(frame->data));
  const auto asked = raw;
  std::string limited;
  if (rests) {
    supervisor_.commanded(number, raw, now());
  } else if (supervisor_.permit(number, raw, now()) != 0) {
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] == asked[i]) continue;
      const auto& field = layout.fields[i];
      protocol::put(frame->data, field.position, raw[i]);
      limited += fmt::format("{}{}.{}", limited.empty() ? "" : ", ", topic.name, field.name);
    }
  }
  const auto taken = bus_->send(*frame);
  if (!taken || !*taken) return wait();
  ++commands_.passed;
  caller.handed_over = ++handed_over_;
  if (!limited.empty()) ++commands_.limited;
  bits_ += measure::bits_on_bus(*frame);
  log::Entry entry{unix_time(), *frame};
  entry.direction = log::Direction::sent;
  box_.add(entry, Clock::now());
  tell_command(caller, number, limited);
  return yes(fmt::format("{}\n{}", can::to_text(*frame).view(), limited));
}

void Runner::tell_command(Caller& caller, std::uint16_t topic, const std::string& limited) {
  const auto first = [topic](std::vector<std::uint16_t>& told) {
    if (std::find(told.begin(), told.end(), topic) != told.end()) return false;
    told.push_back(topic);
    return true;
  };
  const auto name = file_->tables.topic(topic).name;
  if (first(caller.commanded))
    tell("commanded", {{"topic", name}, {"by", caller.verb}, {"process", caller.process}},
         fmt::format("{} (process {}) commands {}", caller.verb, caller.process, name));
  if (!limited.empty() && first(caller.limited))
    tell("limited", {{"fields", limited}, {"by", caller.verb}, {"process", caller.process}},
         fmt::format("{} (process {}) is limited: {}", caller.verb, caller.process, limited));
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
  counters_.not_kept += not_kept_;
  box_.end();
  const auto& done = supervisor_.counters();
  std::string text = fmt::format("operate: {} changes, {} frames sent", done.switches, counters_.sent);
  add_count(text, done.asked_again, "silent streams asked for again");
  add_count(text, done.adapted, "periods adapted");
  add_count(text, counters_.refusals, "refusals");
  add_count(text, counters_.replaced, "frames replaced by newer ones before the bus took them");
  add_count(text, commands_.passed, "set points passed on");
  add_count(text, commands_.limited, "set points limited");
  add_count(text, commands_.refused, "set points refused");
  add_count(text, control_->turned_away(), "programs turned away");
  add_count(text, counters_.recordings, "recordings");
  add_count(text, counters_.recordings_lost, "recordings lost");
  add_count(text, counters_.not_kept, "frames that a kill would have lost from the black box");
  add_count(text, box_.dropped(), "frames that the black box had no room for");
  add_count(text, lines_lost_, "event lines not printed");
  add_count(text, done.not_a_number, "values that are no number");
  add_count(text, bus_->counters().lost, "frames lost");
  if (counters_.late != 0)
    text += fmt::format(", {} steps later than \"reaction\", up to {}", counters_.late,
                        measured(base::Duration{counters_.latest}));
  remark(text);
}

}  // namespace ocm::cli::operate
