/// How a field of a message moves where nothing is measured: a number wanders through its range, a
/// named value or a bit stays for seconds. What is sent depends on the seed, the field and the time alone,
/// and on no generator's state. Integers and sums only, so that every machine sends the same bits.
///
/// decided: a number takes a new direction every 2 to 8 s, a named value or a bit changes every 5 to 20 s at
/// most; as slow as what people look at in a car, and fast enough for a demonstration of a minute.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "ocm/base/decimal.hpp"
#include "ocm/base/time.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/topic.hpp"

#include "sim/physics/noise.hpp"

namespace ocm::sim {

/// The whole numbers that a field may be sent as.
struct RawRange {
  std::int64_t low = 0;
  std::int64_t high = 0;
  [[nodiscard]] constexpr bool holds(std::int64_t raw) const noexcept { return low <= raw && raw <= high; }
  [[nodiscard]] constexpr std::uint64_t span() const noexcept {
    return static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
  }
};

/// Whether the source says between which numbers a field lies.
[[nodiscard]] constexpr bool has_stated_range(const protocol::Field& field) noexcept {
  if (field.min.digits != 0 || field.max.digits != 0) return true;
  return !field.is_float() && (field.raw_min != protocol::lowest(field.position.width, field.is_signed) ||
                               field.raw_max != protocol::highest(field.position.width, field.is_signed));
}

/// What the bits hold and the stated range allows; nothing where no number is in both. An integer field.
[[nodiscard]] inline std::optional<RawRange> stated_range(const protocol::Field& field) noexcept {
  RawRange range{field.raw_min, field.raw_max};
  if (field.min.digits != 0 || field.max.digits != 0) {
    const bool mirrored = field.scale.digits < 0;
    // The nearest number may be just outside: then the next one inwards. Beyond 64 bits: as the bits allow.
    const auto bound = [&field](base::Decimal physical, int inwards, std::int64_t otherwise) {
      const auto above = base::subtract(physical, field.offset);
      const auto raw = above ? base::divide_rounded(*above, field.scale) : above.error;
      if (!raw) return otherwise;
      const auto back = field.physical(*raw);
      if (!back) return otherwise;
      const int side = base::compare(*back, physical) * (field.scale.digits < 0 ? -1 : 1);
      return side * inwards < 0 ? *raw + inwards : *raw;
    };
    range.low = std::max(range.low, bound(mirrored ? field.max : field.min, 1, range.low));
    range.high = std::min(range.high, bound(mirrored ? field.min : field.max, -1, range.high));
  }
  if (range.low > range.high) return std::nullopt;
  return range;
}

/// Where no range is stated, or none that the bits hold: near the start value, so that a mileage of 32 bits
/// does not jump by years. decided: an eighth of what the bits hold to both sides, at most 1000.
[[nodiscard]] constexpr RawRange near_start(const protocol::Field& field) noexcept {
  const std::int64_t lowest = protocol::lowest(field.position.width, field.is_signed);
  const std::int64_t highest = protocol::highest(field.position.width, field.is_signed);
  const std::uint64_t eighth = RawRange{lowest, highest}.span() / 8;
  const auto reach = static_cast<std::int64_t>(std::clamp<std::uint64_t>(eighth, 1, 1000));
  const std::int64_t start = std::clamp(field.start, lowest, highest);
  return {start < lowest + reach ? lowest : start - reach, start > highest - reach ? highest : start + reach};
}

/// One field's course.
class FieldMotion {
 public:
  /// `number`: another one for each field. The field must outlive it.
  FieldMotion(const protocol::Field& field, std::uint64_t seed, std::uint64_t number)
      : field_(&field), key_(split_mix(split_mix(seed, 1), number)) {
    if (field.is_float()) {
      plan_float();
      return;
    }
    const auto stated = stated_range(field);
    range_ = has_stated_range(field) && stated ? *stated : near_start(field);
    if ((field.position.width == 1 || field.flags) && !has_stated_range(field)) range_ = bits();
    take_names();
    if (named_.empty() && range_.span() == 1) named_ = {range_.low, range_.high};
    step_ = named_.empty() ? seconds(2, 8) : seconds(5, 20);
  }

  /// What is sent at this time, raw. O(1).
  [[nodiscard]] std::int64_t at(base::Time now) const noexcept {
    const auto elapsed =
        static_cast<std::uint64_t>(std::max<std::int64_t>(now.time_since_epoch().count(), 0));
    const std::uint64_t step = elapsed / step_;
    if (field_->flags && !field_->is_float()) return some_flags(step);
    if (!named_.empty()) return named_[static_cast<std::size_t>(split_mix(key_, step) % named_.size())];
    const double share = wandered(step, static_cast<double>(elapsed % step_) / static_cast<double>(step_));
    if (field_->is_float()) return nearest_float(share);
    return part_of(range_, share);
  }

 private:
  [[nodiscard]] RawRange bits() const noexcept {
    return {protocol::lowest(field_->position.width, field_->is_signed),
            protocol::highest(field_->position.width, field_->is_signed)};
  }
  [[nodiscard]] std::uint64_t seconds(std::uint64_t least, std::uint64_t most) const noexcept {
    constexpr std::uint64_t second = 1'000'000'000;
    return least * second + split_mix(key_, ~std::uint64_t{0} >> 1) % ((most - least) * second);
  }

  /// Two names or more are what the field is. Not where a wide field has few: they say "not available".
  void take_names() {
    if (field_->flags) return;
    const bool ranged = has_stated_range(*field_) && stated_range(*field_);
    const RawRange allowed = ranged ? range_ : bits();
    for (const auto& value : field_->values)
      if (allowed.holds(value.raw)) named_.push_back(value.raw);
    const bool wide = field_->position.width > 8 && named_.size() < allowed.span() / 2;
    if (named_.size() < 2 || wide) named_.clear();
  }
  [[nodiscard]] std::int64_t some_flags(std::uint64_t step) const noexcept {
    std::uint64_t set = 0;
    const std::uint64_t random = split_mix(key_, step);
    for (const auto& flag : field_->values)
      if (flag.raw >= 0 && flag.raw < field_->position.width) set |= std::uint64_t{1} << flag.raw;
    const auto raw = static_cast<std::int64_t>(set & random);
    return range_.holds(raw) ? raw : range_.low;
  }

  /// A float that states no range moves within 100 of its unit above its start value.
  void plan_float() {
    low_ = field_->value(field_->start);
    if (!(low_ - low_ == 0)) low_ = 0;  // a start value that is no number
    high_ = low_ + 100;
    const double least = field_->min.as_double();
    const double most = field_->max.as_double();
    if (has_stated_range(*field_) && least <= most) low_ = least, high_ = most;
    step_ = seconds(2, 8);
  }
  [[nodiscard]] std::int64_t nearest_float(double share) const noexcept {
    // Towards the middle until the rounding of 32 bits leaves it within its range.
    for (const double wanted : {share, 0.5}) {
      const auto raw = field_->float_from(low_ + wanted * (high_ - low_));
      if (raw && field_->value(*raw) >= low_ && field_->value(*raw) <= high_) return *raw;
    }
    return field_->start;
  }

  /// In [0, 1): from one random point to the next without a corner.
  [[nodiscard]] double wandered(std::uint64_t step, double way) const noexcept {
    const double smooth = way * way * (3 - 2 * way);
    const double from = point(step);
    return from + (point(step + 1) - from) * smooth;
  }
  [[nodiscard]] double point(std::uint64_t n) const noexcept {
    return static_cast<double>(split_mix(key_, n) >> 32) / 4294967296.0;
  }
  [[nodiscard]] static std::int64_t part_of(RawRange range, double share) noexcept {
    const std::uint64_t span = range.span();
    const double numbers = static_cast<double>(span) + 1;
    const double wanted = share * numbers;
    const std::uint64_t above =
        wanted >= static_cast<double>(span) ? span : static_cast<std::uint64_t>(wanted);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(range.low) + above);
  }

  const protocol::Field* field_;
  std::uint64_t key_;
  std::uint64_t step_ = 1'000'000'000;  // ns
  RawRange range_{};
  double low_ = 0;
  double high_ = 0;
  std::vector<std::int64_t> named_;
};

}  // namespace ocm::sim
