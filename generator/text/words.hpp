/// Numbers and words as the generated files write them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "ocm/base/decimal.hpp"

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// "0.0525": exact, without an exponent.
[[nodiscard]] std::string print(base::Decimal number);

/// 36'000'000
[[nodiscard]] std::string grouped(std::uint64_t number);

/// "0x1E", at least two digits.
[[nodiscard]] std::string hex(unsigned number);

/// In double quotes, with those within escaped by a backslash.
[[nodiscard]] std::string quoted(std::string_view text);

[[nodiscard]] std::string capitalised(std::string text);

/// "power_status" -> "Power status"
[[nodiscard]] std::string title(std::string_view name);

/// "text [source]"
[[nodiscard]] std::string with_source(std::string text, const std::string& source);

/// How many frames a sample of the topic has on the bus.
[[nodiscard]] std::size_t frame_count(const spec::TopicModel& topic);

/// A name for each frame of the topic is needed: it has several, or an array of them.
[[nodiscard]] bool is_aggregate(const spec::TopicModel& topic);

/// The physical value of a raw number of the field, exactly: an error where 63 bits of decimal digits do not
/// hold it, as of wide fields of plain messages.
[[nodiscard]] base::Result<base::Decimal> exact_physical(const spec::FieldModel& field, std::int64_t raw);
/// Of a topic's field, which they hold.
[[nodiscard]] base::Decimal physical(const spec::FieldModel& field, std::int64_t raw);

/// A literal of a double, without marks between thousands.
[[nodiscard]] std::string double_literal(base::Decimal number);

/// Lowest and highest physical value that the spec allows. Of a float without a range there are none: 0 and
/// 0.
struct Range {
  base::Decimal low;
  base::Decimal high;
};
[[nodiscard]] Range range_of(const spec::FieldModel& field);

/// The unit, scale and range of a field behind its description, in brackets its source.
[[nodiscard]] std::string remark(const spec::FieldModel& field);

}  // namespace ocm::generate
