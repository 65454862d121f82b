#include "generator/text/words.hpp"

#include <algorithm>
#include <utility>

namespace ocm::generate {

using base::Decimal;
using spec::FieldModel;
using spec::FrameModel;
using spec::TopicModel;

std::string print(Decimal number) {
  return std::string{base::to_text(number).view()};
}

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, "'");
  return digits;
}

std::string hex(unsigned number) {
  base::Text<4> text;
  text << "0x";
  text.hex(number, 2);
  return std::string{text.view()};
}

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string title(std::string_view name) {
  std::string words{name};
  std::replace(words.begin(), words.end(), '_', ' ');
  return capitalised(words);
}

std::string with_source(std::string text, const std::string& source) {
  if (source.empty()) return text;
  return text.empty() ? "[" + source + "]" : text + " [" + source + "]";
}

bool is_aggregate(const TopicModel& topic) {
  return topic.frames.size() > 1 || topic.frames.front().is_array;
}

std::size_t frame_count(const TopicModel& topic) {
  std::size_t count = 0;
  for (const FrameModel& frame : topic.frames) count += frame.count;
  return count;
}

base::Result<Decimal> exact_physical(const FieldModel& field, std::int64_t raw) {
  const auto product = base::multiply({raw, 0}, field.scale);
  return product ? base::add(*product, field.offset) : product;
}

Decimal physical(const FieldModel& field, std::int64_t raw) {
  return *exact_physical(field, raw);
}

std::string double_literal(Decimal number) {
  const std::string text = print(number);
  return text.find('.') == std::string::npos ? text + ".0" : text;
}

Range range_of(const FieldModel& field) {
  if (field.number != protocol::Number::integer)
    return field.range ? Range{field.range->min, field.range->max} : Range{};
  Range range{physical(field, field.raw_min), physical(field, field.raw_max)};
  if (field.scale.digits < 0) std::swap(range.low, range.high);
  return range;
}

std::string remark(const FieldModel& field) {
  std::string text = field.description;
  const auto add = [&](const std::string& part, std::string_view glue = ", ") {
    if (!text.empty()) text += glue;
    text += part;
  };
  if (field.flags || field.is_enumeration()) return with_source(std::move(text), field.source.joined());
  const std::string unit = field.unit.empty() ? "" : " " + field.unit;
  const bool plain = field.scale == Decimal{1, 0} && field.offset.digits == 0;
  if (!plain) {
    add(print(field.scale) + unit + (field.number == protocol::Number::integer ? " a bit" : " a unit"), "; ");
    if (field.offset.digits != 0) add("from " + print(field.offset) + unit + " on");
  }
  if (field.number != protocol::Number::integer && !field.range) {
    if (plain && !unit.empty()) add("in" + unit, "; ");
    return with_source(std::move(text), field.source.joined());
  }
  const Range range = range_of(field);
  add("[" + print(range.low) + ", " + print(range.high) + "]" + unit, plain ? "; " : ", ");
  return with_source(std::move(text), field.source.joined());
}

}  // namespace ocm::generate
