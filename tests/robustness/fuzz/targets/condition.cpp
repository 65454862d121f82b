// Conditions on a field's value: the parts lie within the text, and of a number every comparison agrees with
// every other.
#include "cli/words/condition.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using cli::words::Comparison;
using cli::words::Condition;

namespace {

constexpr protocol::NamedValue names[] = {{0, "off"}, {3, "on"}, {-2, "lost"}};

/// Of one kind each: with a unit, a float, 64 bits without sign, flags.
std::array<protocol::Field, 4> make_fields() {
  std::array<protocol::Field, 4> fields;
  for (protocol::Field& field : fields) {
    field.name = "x";
    field.position = {0, 16, protocol::ByteOrder::little};
    field.raw_max = UINT16_MAX;
  }
  fields[0].is_signed = true;
  fields[0].scale = {25, -2};
  fields[0].unit = "m/s";
  fields[0].values = names;
  fields[1].number = protocol::Number::float32;
  fields[1].position.width = 32;
  fields[2].position.width = 64;
  fields[3].flags = true;
  fields[3].values = std::span{names}.first(2);
  return fields;
}

void check(const protocol::Field& field, std::string_view value, std::int64_t raw) {
  bool holds[6] = {};
  for (const auto comparison : {Comparison::equal, Comparison::different, Comparison::less,
                                Comparison::at_most, Comparison::greater, Comparison::at_least}) {
    const auto condition = Condition::of(field, comparison, value);
    if (!condition) {
      fuzz::expect(!condition.error.empty(), "what is no value says what the field takes");
      return;
    }
    holds[static_cast<std::size_t>(comparison)] = condition->holds(raw);
  }
  const auto [equal, different, less, at_most, greater, at_least] = holds;
  fuzz::expect(equal != different, "it is equal or different");
  const bool is_number = !field.is_float() || field.value(raw) == field.value(raw);
  fuzz::expect(less + equal + greater == (is_number ? 1 : 0), "of less, equal and greater one holds");
  fuzz::expect(at_most == (less || equal) && at_least == (greater || equal), "at most is less or equal");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const auto fields = make_fields();
  fuzz::Input input{data, size};
  const auto raw = static_cast<std::int64_t>(input.number<std::uint64_t>());
  const auto rest = input.bytes(size);
  const std::string_view text = fuzz::text_of(rest.data(), rest.size());
  const auto parts = cli::words::split_condition(text);
  if (!parts) return 0;
  fuzz::expect(fuzz::within(parts->field, text) && fuzz::within(parts->value, text),
               "the parts lie in the text");
  fuzz::expect(!parts->field.empty() && !parts->value.empty(), "no part is empty");
  fuzz::expect(parts->field.find_first_of("<>=!") == std::string_view::npos,
               "a field has no comparison in it");
  for (const protocol::Field& field : fields) {
    if (field.flags) continue;  // are not ordered
    const auto width = field.position.width;
    check(field, parts->value,
          width == 64       ? raw
          : field.is_signed ? static_cast<std::int16_t>(raw)
          : width == 32     ? static_cast<std::int64_t>(static_cast<std::uint32_t>(raw))
                            : static_cast<std::int64_t>(static_cast<std::uint16_t>(raw)));
  }
  static_cast<void>(Condition::of(fields[3], parts->comparison, parts->value));
  return 0;
}
