#include "cli/output/output.hpp"

#include <iterator>

namespace ocm::cli {

std::unique_ptr<Output> make_output(Format format, const protocol::Catalogue& catalogue,
                                    const Selection& selection, bool colour, Columns columns) {
  switch (format) {
    case Format::json:
      return make_json(catalogue, selection);
    case Format::csv:
      return make_csv(catalogue, selection);
    case Format::raw:
      return make_raw();
    case Format::pretty:
      break;
  }
  return make_pretty(catalogue, selection, colour, columns);
}

void vappend_formatted(Buffer& out, fmt::string_view text, fmt::format_args arguments) {
  fmt::memory_buffer buffer;
  fmt::vformat_to(std::back_inserter(buffer), text, arguments);
  out.append({buffer.data(), buffer.size()});
}

}  // namespace ocm::cli
