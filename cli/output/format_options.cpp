#include "cli/output/format_options.hpp"

#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"
#include "cli/shared/terminal.hpp"

namespace ocm::cli {
namespace {

Format format_of(const FormatOptions& options) {
  if (options.json) return Format::json;
  if (options.csv) return Format::csv;
  if (options.raw) return Format::raw;
  if (options.pretty || isatty(STDOUT_FILENO) != 0) return Format::pretty;
  return Format::json;
}

Selection selection_of(std::string_view verb, const protocol::Catalogue& catalogue,
                       const FormatOptions& options) {
  if (options.raw && !options.fields.empty())
    fail({fmt::format("{}: --field with --raw, which shows no fields", verb),
          "leave one of them out; topics select frames"},
         exit_usage);
  auto selection = Selection::of(catalogue, options.fields);
  if (!selection)
    fail({fmt::format("{}: {}", verb, selection.error.what), selection.error.remedy}, exit_usage);
  return std::move(*selection);
}

}  // namespace

void add_format_options(Verb verb, FormatOptions& options) {
  auto format = verb.add_choice("Format", "default: pretty on a terminal, JSON lines otherwise");
  format.add_flag("--pretty", options.pretty, "a line a sample, values with units");
  format.add_flag("--json", options.json, "an object a frame");
  format.add_flag("--csv", options.csv,
                  "a line a field: time, topic, field, value, unit; with --field a column a field");
  format.add_flag("--raw", options.raw, "candump's log line");
  verb.add_option("--field", options.fields,
                  "only this, such as gyroscope.x or odometry.velocity.x; repeatable")
      .type_name("FIELD")
      .one_a_mention();
}

std::unique_ptr<Output> chosen_output(std::string_view verb, const protocol::Catalogue& catalogue,
                                      bool colour, const FormatOptions& options) {
  return make_output(format_of(options), catalogue, selection_of(verb, catalogue, options), colour,
                     columns_of_output);
}

}  // namespace ocm::cli
