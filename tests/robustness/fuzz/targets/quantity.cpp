// Numbers with units and durations: what parses, prints, and reparses equal; converting never fails badly.
#include "cli/words/quantity.hpp"

#include <string>

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

void check_quantity(std::string_view text) {
  const auto quantity = cli::words::parse_quantity(text);
  if (!quantity) return;
  fuzz::expect(fuzz::within(quantity->unit, text), "the unit points into the text");
  for (const std::string_view unit : {"", "m/s", "mm/s", "rad", "deg/s", "G", "mW", "s", "no unit"}) {
    const auto converted = cli::words::convert(*quantity, unit);
    if (quantity->unit.empty() || quantity->unit == unit)
      fuzz::expect(converted.ok() && *converted == quantity->number,
                   "in its own unit a quantity stays as it is");
  }
  if (!cli::words::detail::parse_unit(quantity->unit)) return;  // "1e5e6": its unit reads as an exponent
  const std::string printed =
      std::string{base::to_text(quantity->number).view()} + std::string{quantity->unit};
  const auto again = cli::words::parse_quantity(printed);
  fuzz::expect(again.ok() && again->number == quantity->number && again->unit == quantity->unit,
               "a quantity that is printed reparses equal");
}

void check_duration(std::string_view text) {
  const auto duration = cli::words::parse_duration(text);
  if (!duration) return;
  const auto again = cli::words::parse_duration(cli::words::to_text(*duration));
  fuzz::expect(again.ok() && *again == *duration, "a duration that is printed reparses equal");

  const auto nearest = protocol::Period::nearest(*duration);
  const auto wire = protocol::Period::from(nearest.duration());
  fuzz::expect(wire.ok() && wire->duration() == nearest.duration(), "the nearest period is one of the wire");
  if (const auto exact = protocol::Period::from(*duration))
    fuzz::expect(exact->duration() == *duration && nearest.duration() == *duration,
                 "a period that the wire can carry is its own nearest");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_quantity(fuzz::text_of(data, size));
  check_duration(fuzz::text_of(data, size));
  return 0;
}
