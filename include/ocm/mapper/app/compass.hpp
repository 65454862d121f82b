/// What became of a calibration of the mapper's compass: the verdict on a turn, and as the sentence that says
/// it. [docs/decisions/0029]
///
/// Pure and constexpr; no memory, no clock.
#pragma once

#include <cstdint>

#include "ocm/base/result.hpp"
#include "ocm/mapper/app/models.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/motion/angle.hpp"
#include "ocm/motion/real.hpp"
#include "ocm/sensing/compass_calibration.hpp"

namespace ocm::mapper::app {

/// How a calibration ended, or what is known without one.
struct CompassReport {
  std::int16_t verdict = link::Calibration::none;  ///< as in the sentence
  bool taken = false;                              ///< the robot corrects by it from now on
  sensing::CompassFit fit{};
};

/// Good, poor, disturbed or weak: of a turn that was all around.
[[nodiscard]] constexpr std::int16_t judge(const sensing::CompassFit& fit, const CompassUse& model) noexcept {
  if (!(fit.field >= model.least_field)) return link::Calibration::weak;
  if (fit.error_rad <= model.good_rad) return link::Calibration::good;
  return fit.error_rad <= model.most_rad ? link::Calibration::poor : link::Calibration::disturbed;
}
/// Of a turn that has no fit; `readings`: that there were of the compass.
[[nodiscard]] constexpr std::int16_t judge(base::Error error, std::uint32_t readings) noexcept {
  if (readings == 0 || error == base::Error::no_answer) return link::Calibration::silent;
  return error == base::Error::not_sampled ? link::Calibration::incomplete : link::Calibration::weak;
}

/// The sentence of a calibration; figures that it cannot hold are its nearest.
[[nodiscard]] constexpr link::Calibration calibration(std::int16_t number, const CompassReport& report,
                                                      std::int16_t use) noexcept {
  const auto whole = [](float value, std::int16_t least, std::int16_t most) {
    const float within = motion::is_finite(value)
                             ? motion::clamp(value, static_cast<float>(least), static_cast<float>(most))
                             : 0.0F;
    return static_cast<std::int16_t>(within + (within < 0.0F ? -0.5F : 0.5F));
  };
  using Said = link::Calibration;
  constexpr float mg_per_gauss = 1000.0F;
  return {.number = number,
          .verdict = report.verdict,
          .x = whole(report.fit.offset.x * mg_per_gauss, Said::fields[2].min, Said::fields[2].max),
          .y = whole(report.fit.offset.y * mg_per_gauss, Said::fields[3].min, Said::fields[3].max),
          .field = whole(report.fit.field * mg_per_gauss, Said::fields[4].min, Said::fields[4].max),
          .error = whole(motion::degrees(report.fit.error_rad), Said::fields[5].min, Said::fields[5].max),
          .use = use};
}

}  // namespace ocm::mapper::app
