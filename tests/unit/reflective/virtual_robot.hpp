/// A bus, boards and an operator in virtual time, which know no formula: what the bounds of the proof are
/// judged by. Boards take requests late, sample late and send; the bus arbitrates and is not preempted; the
/// operator is a Supervisor whose steps are late, with a queue that keeps its order. Tests only.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <optional>
#include <queue>
#include <vector>

#include "ocm/analysis/message_set.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/supervisor.hpp"

namespace ocm::test {

class VirtualRobot {
 public:
  using Ns = std::int64_t;
  static constexpr reflective::Room room{};

  // What chance or an adversary decides, each within what the tables say.
  std::function<Ns(std::uint16_t topic)> handling = [](std::uint16_t) { return 0; };
  std::function<Ns(std::uint16_t topic, Ns planned)> jitter = [](std::uint16_t, Ns) { return 0; };
  /// From the reading of a sample to the hand-over of its frames.
  std::function<Ns(std::uint16_t topic)> sampling = [](std::uint16_t) { return 0; };
  std::function<Ns(std::uint16_t topic)> reaction = [](std::uint16_t) { return 0; };  ///< none: to a timer
  /// After each sample that a board has read.
  std::function<void(std::uint16_t topic, Ns now)> sampled = [](std::uint16_t, Ns) {};
  /// The end of a sample's last frame, and when it was read.
  std::function<void(std::uint16_t topic, Ns read, Ns now)> came = [](std::uint16_t, Ns, Ns) {};
  /// A request has been taken by no board.
  std::function<void(std::uint16_t topic, Ns now)> lost = [](std::uint16_t, Ns) {};
  /// When a step's frames are handed to the bus, those that ask for a silent stream among them.
  std::function<void(Ns now)> asked_again = [](Ns) {};
  /// After each step; it may not change anything.
  std::function<void(Ns now)> stepped = [](Ns) {};

  std::vector<std::uint8_t> values;  ///< what each topic measures
  std::vector<bool> silent;          ///< a board that samples no more

  /// How a transition of a monitor acted: the first one after the event.
  struct Acted {
    std::uint16_t transition = reflective::none;
    std::uint16_t from = reflective::none;
    Ns entered = 0;  ///< when `from` was
    Ns at = 0;       ///< the end of its last set point's frame
  };
  std::optional<Acted> acted;
  std::size_t switches = 0;
  std::size_t steps = 0;

  VirtualRobot(const reflective::Operator& tables, std::uint32_t bit_rate)
      : tables_(&tables), bit_rate_(bit_rate), supervisor_(tables) {
    values.resize(tables.catalogue->topics.size());
    silent.resize(values.size());
    streams_.resize(values.size());
    boards_.resize(values.size());
  }

  void start() {
    entered_ = 0;
    hand_over(supervisor_.start(time(0)), 0, 0);
    plan_tick(0);
  }
  void at(Ns when, std::function<void()> what) { events_.push({when, order_++, std::move(what)}); }
  void request(Ns when, std::uint16_t configuration) {
    at(when, [this, configuration] {
      input({.kind = reflective::Event::Kind::request, .value = configuration}, {});
    });
  }
  /// Boards that have these topics lose their streams now, and take no request that begins before `up`. What
  /// they have read is sent all the same: the operator notices later then.
  void reset(Ns up, const std::vector<bool>& topics) {
    for (std::size_t topic = 0; topic < streams_.size(); ++topic) {
      if (!topics[topic]) continue;
      streams_[topic].runs = false;
      ++streams_[topic].generation;
      boards_[topic].up = up;
      ++boards_[topic].resets;
    }
  }
  /// All boards.
  void reset(Ns up) { reset(up, std::vector<bool>(streams_.size(), true)); }
  /// They take requests from then on, other than `reset` said.
  void back(Ns up, const std::vector<bool>& topics) {
    for (std::size_t topic = 0; topic < boards_.size(); ++topic)
      if (topics[topic]) boards_[topic].up = up;
  }
  void back(Ns up) { back(up, std::vector<bool>(streams_.size(), true)); }
  /// A frame of another program, handed over now.
  void other(std::uint32_t key, Ns cost) {
    pending_.push_back({key, cost, [](Ns) {}});
  }
  [[nodiscard]] Ns entered() const { return entered_; }
  void run(Ns until) {
    for (;;) {
      // What happens at one time has all happened before the bus arbitrates.
      if (events_.empty() || events_.top().when > now_) arbitrate();
      if (events_.empty() || events_.top().when > until) break;
      now_ = events_.top().when;
      const auto what = events_.top().what;
      events_.pop();
      what();
    }
    now_ = until;
  }
  [[nodiscard]] Ns now() const { return now_; }
  [[nodiscard]] const reflective::Supervisor<room>& supervisor() const { return supervisor_; }
  /// Transitions of monitors are of interest from now on.
  void watch() { watching_ = true; }

 private:
  using Action = reflective::Action;
  struct Later {
    Ns when;
    std::uint64_t order;
    std::function<void()> what;
    bool operator<(const Later& other) const {
      return when != other.when ? when > other.when : order > other.order;
    }
  };
  struct Pending {
    std::uint32_t key = 0;
    Ns cost = 0;
    std::function<void(Ns began)> sent;
  };
  struct Running {
    bool runs = false;
    Ns period = 0;
    protocol::Priority priority{};
    std::uint64_t generation = 0;
    Ns handed_over = 0;  ///< the last sample: a board keeps their order
  };
  /// Of each topic that of its board.
  struct Board {
    Ns up = 0;
    int resets = 0;
  };

  static base::Time time(Ns ns) { return base::Time{base::Duration{ns}}; }
  static Ns ns(base::Time time) { return time.time_since_epoch().count(); }
  [[nodiscard]] Ns bits(unsigned count) const { return analysis::bits_ns(count, bit_rate_); }

  // --- the bus ---

  void arbitrate() {
    if (busy_ || (pending_.empty() && queue_.empty())) return;
    auto best = pending_.begin();
    for (auto it = pending_.begin(); it != pending_.end(); ++it)
      if (it->key < best->key) best = it;
    Pending frame;
    if (!queue_.empty() && (best == pending_.end() || queue_.front().key < best->key)) {
      frame = queue_.front();
      queue_.pop_front();
    } else {
      frame = *best;
      pending_.erase(best);
    }
    busy_ = true;
    at(now_ + frame.cost, [this, sent = frame.sent, began = now_] {
      busy_ = false;
      sent(began);
    });
  }

  // --- the boards ---

  void take(const Action& action) {
    Running& stream = streams_[action.topic];
    ++stream.generation;
    stream.runs = action.kind != Action::Kind::unsubscribe;
    if (!stream.runs) return;
    stream.period = action.period.count();
    stream.priority = protocol::Identifier::decode(action.frame.id).priority;
    release(action.topic, now_, stream.generation);
  }
  void release(std::uint16_t topic, Ns planned, std::uint64_t generation) {
    at(planned, [=, this] {
      if (streams_[topic].generation != generation) return;
      at(planned + jitter(topic, planned), [=, this, resets = boards_[topic].resets] {
        if (resets == boards_[topic].resets) sample(topic, streams_[topic].priority);
      });
      release(topic, planned + streams_[topic].period, generation);
    });
  }
  void sample(std::uint16_t topic, protocol::Priority priority) {
    if (silent[topic]) return;
    const std::uint8_t value = values[topic];
    Ns& handed_over = streams_[topic].handed_over;
    handed_over = std::max(handed_over, now_ + sampling(topic));
    at(handed_over, [=, this, read = now_] { to_bus(topic, priority, value, read); });
    sampled(topic, now_);
  }
  void to_bus(std::uint16_t topic, protocol::Priority priority, std::uint8_t value, Ns read) {
    const auto& frames = tables_->topic(topic).frames;
    for (std::size_t f = 0; f < frames.size(); ++f) {
      const auto id = protocol::Identifier{protocol::Direction::sensor, priority, frames[f].id}.encode();
      const bool last = f + 1 == frames.size();
      pending_.push_back(
          {can::arbitration_key({.id = id}), bits(protocol::worst_bits(frames[f], priority)), [=, this](Ns) {
             if (!last) return;
             came(topic, read, now_);
             arrived(topic, value);
           }});
    }
  }

  // --- the operator ---

  void arrived(std::uint16_t topic, std::uint8_t value) {
    std::vector<std::uint8_t> bytes(sizeof(can::Payload) * tables_->topic(topic).frames.size());
    bytes[0] = value;
    input({.kind = reflective::Event::Kind::sample, .topic = topic}, std::move(bytes));
  }
  /// A step is at most `reaction` late, and its frames are handed over at most `reaction` after what it is
  /// for.
  void input(reflective::Event event, std::vector<std::uint8_t> bytes) {
    const Ns late = reaction(event.topic);
    step_at_ = std::max(step_at_, now_ + late);
    handed_over_at_ = std::max(handed_over_at_, now_ + std::max(late, reaction(event.topic)));
    at(step_at_, [this, event, bytes = std::move(bytes), over = handed_over_at_] {
      reflective::Event whole = event;
      whole.bytes = bytes;
      const std::uint16_t before = supervisor_.configuration();
      const Ns entered = entered_;
      const auto actions = supervisor_.step(whole, time(now_));
      ++steps;
      if (supervisor_.configuration() != before) {
        ++switches;
        entered_ = now_;
      }
      hand_over(actions, over, entered);
      plan_tick(now_);
      stepped(now_);
    });
  }
  void plan_tick(Ns now) {
    const base::Time next = supervisor_.next();
    if (next == base::never || ns(next) == tick_) return;
    tick_ = ns(next);
    at(std::max(tick_, now), [this, due = tick_] {
      if (tick_ != due) return;
      tick_ = -1;
      if (supervisor_.next() <= time(now_)) input({}, {});
    });
  }
  void hand_over(std::span<const Action> actions, Ns when, Ns entered) {
    const std::vector<Action> all{actions.begin(), actions.end()};
    at(when, [this, all, entered] {
      const Action* by_monitor = nullptr;
      std::size_t set_points = 0;
      for (const Action& action : all) {
        if (action.kind == Action::Kind::switched && action.transition != reflective::none &&
            tables_->transitions[action.transition].monitor != reflective::by_request && watching_ && !acted)
          by_monitor = &action;
        if (action.kind == Action::Kind::command) ++set_points;
      }
      std::size_t set_point = 0;
      if (std::any_of(all.begin(), all.end(), [](const Action& a) { return a.kind == Action::Kind::again; }))
        asked_again(now_);
      for (const Action& action : all) {
        if (!action.sends()) continue;
        const bool last = action.kind == Action::Kind::command && ++set_point == set_points;
        std::optional<Acted> acts;
        if (by_monitor != nullptr && last) acts = Acted{by_monitor->transition, by_monitor->from, entered, 0};
        const unsigned length = can::worst_frame_bits(can::Format::base, action.frame.dlc);
        queue_.push_back({can::arbitration_key(action.frame), bits(length), [this, action, acts](Ns began) {
                            if (acts) {
                              acted = acts;
                              acted->at = now_;
                            }
                            if (action.kind == Action::Kind::command) return;
                            const Board& board = boards_[action.topic];
                            at(now_ + handling(action.topic),
                               [this, &board, action, began, resets = board.resets] {
                                 if (began >= board.up && resets == board.resets) return take(action);
                                 lost(action.topic, now_);
                               });
                          }});
      }
    });
  }

  const reflective::Operator* tables_;
  std::uint32_t bit_rate_;
  reflective::Supervisor<room> supervisor_;
  std::vector<Running> streams_;
  std::priority_queue<Later> events_;
  std::uint64_t order_ = 0;
  Ns now_ = 0;
  bool busy_ = false;
  std::vector<Pending> pending_;
  std::deque<Pending> queue_;
  Ns step_at_ = 0;
  Ns handed_over_at_ = 0;
  Ns entered_ = 0;
  Ns tick_ = -1;
  bool watching_ = false;
  std::vector<Board> boards_;
};

}  // namespace ocm::test
