/// Infrared distance sensor GP2Y0A21YK: from volts to centimetres and back. [GP2Y0A21YK data sheet; T2 §5.3]
///
///   V = a / d + b      between 10 and 80 cm, typically 2.3 V and 0.4 V
///
/// The two typical voltages of the data sheet fix a and b; single sensors differ (0.25 to 0.55 V at 80 cm),
/// so a sensor can have a curve of its own, through two points that were measured. Best is 10 to 40 cm. Below
/// 5 cm a sensor reads like far away, and no single reading can tell. constexpr, constant time. A voltage
/// that is no number reads as nothing.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ocm/motion/real.hpp"

namespace ocm::sensing {

/// Of the useful range. [Data sheet: distance measuring range]
inline constexpr float ir_nearest_cm = 10.0F;
inline constexpr float ir_farthest_cm = 80.0F;
/// Nearer things read like far ones. [T2 §5.3]
inline constexpr float ir_blind_cm = 5.0F;

/// What a voltage says.
enum class IrRange : std::uint8_t {
  useful,    ///< 10 to 80 cm
  too_near,  ///< under 10 cm: near, and how near is not certain
  nothing,   ///< beyond 80 cm, or under 5 cm
};

struct IrReading {
  float distance_cm = 0.0F;  ///< 0 where the range is `nothing`, as in the robot's sentences
  IrRange range = IrRange::nothing;
  friend bool operator==(const IrReading&, const IrReading&) = default;
};

/// V = slope / d + offset.
struct IrCurve {
  float slope_v_cm = 0.0F;
  float offset_v = 0.0F;
};

/// The curve through two measured points. [Straight in 1/d: triangulation]
[[nodiscard]] constexpr IrCurve ir_curve(float near_cm, float near_v, float far_cm, float far_v) noexcept {
  const float slope = (near_v - far_v) / (1.0F / near_cm - 1.0F / far_cm);
  return {slope, far_v - slope / far_cm};
}

/// A typical sensor: 0.4 V at 80 cm, and 1.9 V more at 10 cm. [Data sheet: electro-optical characteristics]
inline constexpr IrCurve typical_ir_curve = ir_curve(ir_nearest_cm, 2.3F, ir_farthest_cm, 0.4F);

/// What such a sensor puts out, for models of one. Below 5 cm: like at 80 cm; NaN and less than 0 cm, too.
[[nodiscard]] constexpr float ir_volts(float distance_cm, const IrCurve& curve = typical_ir_curve) noexcept {
  if (!(distance_cm >= ir_blind_cm)) return curve.slope_v_cm / ir_farthest_cm + curve.offset_v;
  return curve.slope_v_cm / distance_cm + curve.offset_v;
}

namespace detail {

constexpr IrReading ir_reading(float distance_cm) noexcept {
  if (!(distance_cm > 0.0F && distance_cm <= ir_farthest_cm + 0.001F)) return {};
  return {distance_cm, distance_cm < ir_nearest_cm - 0.001F ? IrRange::too_near : IrRange::useful};
}

}  // namespace detail

[[nodiscard]] constexpr IrReading ir_distance(float volts, const IrCurve& curve = typical_ir_curve) noexcept {
  if (!motion::is_finite(volts)) return {};
  const float above = volts - curve.offset_v;
  return above > 0.0F ? detail::ir_reading(curve.slope_v_cm / above) : IrReading{};
}

/// Volts of an analogue-to-digital converter of `bits`, whose full scale is the reference.
[[nodiscard]] constexpr float adc_volts(std::uint32_t count, unsigned bits, float reference_v) noexcept {
  return static_cast<float>(count) * reference_v / static_cast<float>((std::uint64_t{1} << bits) - 1);
}

}  // namespace ocm::sensing
