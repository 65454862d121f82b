#include "cli/analyse/study.hpp"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

namespace ocm::cli::analyse {
namespace {

using analysis::Explained;
using analysis::Reason;

std::string percent(std::int64_t parts_per_million) {
  return fmt::format("{}.{:02} %", parts_per_million / 10'000, parts_per_million % 10'000 / 100);
}

/// What a row and all that goes before it ask for.
std::int64_t load_down_to(const Study& study, std::size_t row) {
  analysis::Utilisation sum;
  for (std::size_t i = 0; i < study.rows.size(); ++i)
    if (i <= row || study.rows[i].rank == study.rows[row].rank)
      sum.add(study.rows[i].cost, study.rows[i].period);
  return sum.parts_per_million();
}

std::string ordinal(std::size_t number) {
  const std::size_t tens = number % 100;
  const char* ending = "th";
  if (tens < 11 || tens > 13)
    ending = number % 10 == 1 ? "st" : number % 10 == 2 ? "nd" : number % 10 == 3 ? "rd" : "th";
  return fmt::format("{}{}", number, ending);
}

}  // namespace

std::string time_text(std::int64_t nanoseconds) {
  // The largest unit of which there is one, exactly.
  struct Unit {
    std::string_view name;
    int exponent;
    std::uint64_t size;
  };
  constexpr Unit units[] = {{"s", -9, 1'000'000'000}, {"ms", -6, 1'000'000}, {"us", -3, 1'000}, {"ns", 0, 1}};
  const auto number = static_cast<std::uint64_t>(nanoseconds);
  const std::uint64_t magnitude = nanoseconds < 0 ? 0 - number : number;
  for (const Unit& unit : units)
    if (magnitude >= unit.size)
      return fmt::format("{}{}", base::to_text(base::normalised(nanoseconds, unit.exponent)).view(),
                         unit.name);
  return "0s";
}

bool Study::passes() const {
  return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.result.ok(); });
}

double Study::utilisation() const {
  if (load.denominator() != 0)
    return static_cast<double>(load.numerator()) / static_cast<double>(load.denominator());
  return static_cast<double>(load.parts_per_million()) / 1e6;
}

std::string explain(const Study& study, std::size_t row) {
  const Row& it = study.rows[row];
  const Explained& result = it.result;
  const bool bus = study.kind == Study::Kind::bus;
  if (result.reason == Reason::overloaded)
    return fmt::format(
        "no bound: it and what is more urgent ask for {} of the {}{}", percent(load_down_to(study, row)),
        !bus                ? "processor"
        : study.with_errors ? "bus, and errors take their part"
                            : "bus",
        result.largest < study.rows.size() ? fmt::format(", {} for the most", study.rows[result.largest].name)
                                           : "");
  if (!result.bounded()) return std::string{analysis::describe(result.reason)};

  std::string text = result.ok() ? fmt::format("ends {} before its deadline", time_text(result.slack()))
                                 : fmt::format("misses its deadline by {}", time_text(-result.slack()));
  text += fmt::format(": takes {}", time_text(it.cost));
  if (it.jitter > 0) text += fmt::format(", comes {} late", time_text(it.jitter));
  if (result.blocking > 0) {
    text += fmt::format(", waits {}", time_text(result.blocking));
    if (result.blocked_by == row)
      text += " for the release before it";
    else if (result.blocked_by < study.rows.size())
      text += fmt::format(" for {}, which is less urgent", study.rows[result.blocked_by].name);
    else
      text += bus ? " for errors" : " for less urgent ones";
  }
  if (result.interference > 0) {
    const auto as_urgent = [&it](const Row& other) { return &other != &it && other.rank == it.rank; };
    const bool equals = !bus && std::any_of(study.rows.begin(), study.rows.end(), as_urgent);
    // In a FIFO the most urgent one waits for others, too.
    const bool only_errors = study.with_errors && row == 0 && result.largest_share == 0;
    text += fmt::format(", {} for {}", time_text(result.interference),
                        only_errors         ? "errors"
                        : study.with_errors ? "more urgent ones and errors"
                        : equals            ? "ones as urgent or more"
                                            : "more urgent ones");
    if (result.largest < study.rows.size())
      text +=
          fmt::format(" ({} of that {})", time_text(result.largest_share), study.rows[result.largest].name);
  }
  if (result.instance > 0)
    text += fmt::format("; the {} of {} releases in a row is the worst, its wait counted from the first",
                        ordinal(result.instance + 1), result.instances);
  return text;
}

}  // namespace ocm::cli::analyse
