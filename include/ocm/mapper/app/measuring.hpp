/// What a mapper finds out about itself before it says who it is: the bias of its gyro, and in which
/// direction it sees the field that its compass shows. At rest; a wheel that moves, or a gyro that shows a
/// turn, restarts it. [T2 §6.3: measured while it advertises]
///
/// It goes on for as long as the robot stands: each window of samples gives a new result, and takes the place
/// of the last. A part that does not answer is reported after some failures in a row, and asked again for
/// ever. O(1) a sample, 48 bytes, no heap.
#pragma once

#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/motion/heading.hpp"
#include "ocm/sensing/compass_calibration.hpp"

namespace ocm::mapper::app {

struct AtRest {
  float gyro_bias_rad_s = 0.0F;
  sensing::Field field{};  ///< mean, the robot's own included
};

class Measurement {
 public:
  constexpr explicit Measurement(const Measuring& model) noexcept
      : model_(&model), bias_(model.moving_rad_s) {}

  /// One sample of both; `moved`: a wheel did since the last one.
  constexpr void add(base::Result<float> gyro, base::Result<sensing::Field> field, bool moved) noexcept {
    const bool answered = gyro.ok() && field.ok();
    failures_ = answered ? std::uint8_t{0} : failures_ == UINT8_MAX ? failures_ : std::uint8_t(failures_ + 1);
    if (!answered || moved || !motion::all_finite(field->x, field->y) || !bias_.add(*gyro)) return begin();
    sum_.x += field->x;
    sum_.y += field->y;
    if (bias_.count() < model_->samples) return;
    const auto count = static_cast<float>(bias_.count());
    result_ = {bias_.bias_rad_s(), {sum_.x / count, sum_.y / count}};
    ready_ = fresh_ = true;
    begin();
  }
  /// The robot drives off: what is known of its direction is about to be wrong.
  constexpr void drive_off() noexcept {
    fresh_ = false;
    begin();
  }

  /// Known at all.
  [[nodiscard]] constexpr bool ready() const noexcept { return ready_; }
  /// Measured where the robot stands now.
  [[nodiscard]] constexpr bool fresh() const noexcept { return fresh_; }
  /// A part has not answered for some time.
  [[nodiscard]] constexpr bool failed() const noexcept { return failures_ >= model_->failures; }
  [[nodiscard]] constexpr const AtRest& result() const noexcept { return result_; }

 private:
  constexpr void begin() noexcept {
    bias_ = motion::GyroBias{model_->moving_rad_s};
    sum_ = {};
  }

  const Measuring* model_;
  motion::GyroBias bias_;
  sensing::Field sum_{};
  AtRest result_{};
  std::uint8_t failures_ = 0;  // in a row
  bool ready_ = false;
  bool fresh_ = false;
};

}  // namespace ocm::mapper::app
