/// A bus of these tests: a transmit queue that empties at its own pace, stops emptying, refuses frames, goes
/// down or away for good; and frames that come from others.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/transport/bus.hpp"

#include "tests/tool/clock/world.hpp"

namespace ocm::test {

class PlayedBus final : public transport::Bus {
 public:
  /// A frame that was sent: when the queue took it, and when it was on the bus.
  struct Sent {
    can::Frame frame;
    Moment taken;
    Moment left = Moment::max();
  };
  struct Time {
    Moment from, until;
    [[nodiscard]] bool has(Moment time) const { return time >= from && time < until; }
  };
  struct Incoming {
    Moment at;
    can::Frame frame;
  };
  /// What the bus is like, and what happens to it.
  struct Conditions {
    std::size_t room = 10;        ///< frames in the queue
    Duration frame_time = 250us;  ///< on the bus
    bool knows_delivery = true;
    bool is_simulated = false;
    std::vector<Time> stuck{};  ///< no frame leaves
    std::vector<Time> down{};   ///< no frame is taken, either
    Moment gone = Moment::max();
    std::vector<Incoming> incoming{};   ///< in order
    std::size_t listens_to = SIZE_MAX;  ///< of the incoming ones so many wait; others are lost
  };

  PlayedBus(World& world, Conditions conditions, std::string name = "can0", int descriptor = 500)
      : world_(&world), conditions_(std::move(conditions)), name_(std::move(name)), descriptor_(descriptor) {
    world_->inputs[descriptor_] = [this] { return std::min(next_incoming(), conditions_.gone); };
  }

  std::string_view name() const override { return name_; }
  base::Result<bool> send(const can::Frame& frame) override {
    world_->pass(2us);
    catch_up();
    if (is_gone()) return base::Error::closed;
    if (!can::validate(frame).ok()) return can::validate(frame).error;
    if (!takes()) {
      ++counters_.refused;
      return false;
    }
    sent_.push_back({frame, world_->now()});
    ++counters_.sent;
    return true;
  }
  base::Result<can::Received> receive(Duration timeout) override {
    if (timeout > 0s && next_incoming() > world_->now())
      world_->wait_until(std::min({world_->now() + timeout, next_incoming(), conditions_.gone}));
    world_->pass(2us);
    hear();
    if (!heard_.empty()) {
      const auto incoming = heard_.front();
      heard_.pop_front();
      ++counters_.received;
      return can::Received{world_->wall_at(incoming.at), incoming.frame};
    }
    if (is_gone()) return base::Error::closed;
    return base::Error::timed_out;
  }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  int descriptor() const override { return descriptor_; }
  bool is_simulated() const noexcept override { return conditions_.is_simulated; }
  const transport::BusCounters& counters() const override { return counters_; }
  transport::BusState state() const override {
    if (!failure_.what.empty()) return transport::BusState::closed;
    return is_in(conditions_.down) ? transport::BusState::down : transport::BusState::up;
  }
  transport::Delivery delivery() override {
    world_->pass(20us);
    catch_up();
    transport::Delivery delivery;
    delivery.known = conditions_.knows_delivery;
    if (delivery.known) delivery.pending = sent_.size() - left_;
    if (is_in(conditions_.down)) delivery.obstruction = {name_ + " is down", "bring it up"};
    return delivery;
  }
  const transport::Failure& failure() const override { return failure_; }

  /// All that a queue took, in order.
  [[nodiscard]] const std::vector<Sent>& sent() {
    catch_up();
    return sent_;
  }
  /// Whether there is room for a frame now.
  [[nodiscard]] bool takes() {
    catch_up();
    return sent_.size() - left_ < conditions_.room && !is_in(conditions_.down);
  }
  [[nodiscard]] const Conditions& conditions() const { return conditions_; }
  [[nodiscard]] bool is_in(const std::vector<Time>& times) const {
    return std::any_of(times.begin(), times.end(), [&](const Time& time) { return time.has(world_->now()); });
  }

 private:
  [[nodiscard]] bool is_gone() {
    if (world_->now() < conditions_.gone) return false;
    failure_ = {name_ + " is gone", "plug it in"};
    return true;
  }
  /// Lets leave what has left by now.
  void catch_up() {
    const Moment now = world_->now();
    for (; left_ < sent_.size(); ++left_) {
      Moment leaves = std::max(sent_[left_].taken, free_) + conditions_.frame_time;
      for (bool moved = true; moved;) {  // past all times in which none leaves
        moved = false;
        for (const auto* const times : {&conditions_.stuck, &conditions_.down})
          for (const Time& time : *times)
            if (time.has(leaves)) leaves = time.until, moved = true;
      }
      if (leaves > now || leaves >= conditions_.gone) return;
      sent_[left_].left = free_ = leaves;
    }
  }
  [[nodiscard]] Moment next_incoming() const {
    if (!heard_.empty()) return World::start;
    return next_ < conditions_.incoming.size() ? conditions_.incoming[next_].at : Moment::max();
  }
  void hear() {
    for (; next_ < conditions_.incoming.size() && conditions_.incoming[next_].at <= world_->now(); ++next_) {
      if (conditions_.incoming[next_].at >= conditions_.gone) continue;
      if (heard_.size() < conditions_.listens_to)
        heard_.push_back(conditions_.incoming[next_]);
      else
        ++counters_.lost;
    }
  }

  World* world_;
  Conditions conditions_;
  std::string name_;
  int descriptor_;
  std::vector<Sent> sent_;
  std::size_t left_ = 0;  ///< of `sent_`
  Moment free_ = World::start;
  std::deque<Incoming> heard_;
  std::size_t next_ = 0;  ///< of the incoming ones
  transport::BusCounters counters_;
  transport::Failure failure_;
};

}  // namespace ocm::test
