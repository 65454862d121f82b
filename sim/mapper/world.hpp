/// A world with mappers in it: what they are in is a WorldModel, what they do is theirs.
///
///     sim::mapper::World world{model, {.seed = 7}};
///     world.robot(0).drive({1.0F, 1.0F});
///     world.advance_to(now);
///     world.robot(0).pose();  // the truth, which its application does not know
///
/// Time is handed in and only goes forwards, in steps of 1 ms. In each the robots move one after the other,
/// so that none is ever inside a wall or another: one that would be is pushed out, and its wheels slip.
/// Readings depend on seed, robot, part and time, not on who reads what; a world whose robots all rest lets
/// any time pass at once.
///
/// Host only. The robots stay where they are in memory until the world is destroyed. A step costs about 0.2
/// us a moving robot; one near something costs O(walls + robots) more.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"

#include "sim/mapper/robot.hpp"
#include "sim/mapper/world_model.hpp"
#include "sim/physics/step.hpp"

namespace ocm::sim::mapper {

struct WorldOptions {
  std::uint64_t seed = 1;
  base::Time start_time{};  ///< the world's time zero
};

class World {
 public:
  /// A robot for each start of the model: `starts_for` makes more.
  explicit World(WorldModel model, WorldOptions options = {}) : model_(std::move(model)), options_(options) {
    robots_.reserve(model_.starts.size());
    discs_.reserve(model_.starts.size());
    for (const Start& start : model_.starts) {
      robots_.emplace_back(start, model_of(start.kind), options_.seed, robots_.size());
      discs_.push_back(robots_.back().disc());
      fastest_step_m_ = std::max(fastest_step_m_, robots_.back().most_step_m());
    }
    for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i].begin(around(i));
  }
  World(const World&) = delete;  // others hold its robots
  World& operator=(const World&) = delete;

  /// Lets time pass up to the last whole millisecond; a time before that is ignored.
  void advance_to(base::Time now) noexcept {
    const std::int64_t until = (now - options_.start_time) / step;
    while (elapsed_ms_ < until) {
      if (at_rest()) {
        elapsed_ms_ = until;
      } else {
        for (std::size_t i = 0; i < robots_.size(); ++i) {
          robots_[i].move(around(i), elapsed_ms_);
          discs_[i] = robots_[i].disc();
        }
        ++elapsed_ms_;
      }
      for (std::size_t i = 0; i < robots_.size(); ++i) robots_[i].sample(around(i), elapsed_ms_ * step);
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return robots_.size(); }
  /// `number` below size(), in the order of the model's starts.
  [[nodiscard]] Robot& robot(std::size_t number) noexcept { return robots_[number]; }
  [[nodiscard]] const Robot& robot(std::size_t number) const noexcept { return robots_[number]; }
  [[nodiscard]] const WorldModel& model() const noexcept { return model_; }
  [[nodiscard]] base::Time time() const noexcept { return options_.start_time + elapsed_ms_ * step; }
  /// From robot to the server's dongle, metres.
  [[nodiscard]] double distance_to_central(std::size_t number) const noexcept {
    return length(robots_[number].pose().position() - model_.central.place);
  }

 private:
  static constexpr base::Duration step = step_length;

  [[nodiscard]] Surroundings around(std::size_t number) const noexcept {
    return {model_, discs_, number, fastest_step_m_};
  }
  [[nodiscard]] bool at_rest() const noexcept {
    return std::all_of(robots_.begin(), robots_.end(), [](const Robot& robot) { return robot.at_rest(); });
  }

  WorldModel model_;
  WorldOptions options_;
  std::vector<Robot> robots_;
  std::vector<Disc> discs_;
  double fastest_step_m_ = 0;
  std::int64_t elapsed_ms_ = 0;
};

}  // namespace ocm::sim::mapper
