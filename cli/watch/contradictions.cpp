#include "cli/watch/contradictions.hpp"

#include <string>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"

namespace ocm::cli {

void tell_contradictions(const Contradictions& found, std::string_view robot, std::string_view guess,
                         std::string_view beginning) {
  const auto& [frames, foreign, wrong_length, first] = found;
  if (frames == 0 || 10 * (foreign + wrong_length) < frames) return;
  if (foreign >= frames - frames / 10) {
    remark(fmt::format(
        "{}{} of {} frames are of no topic of {}: {} --spec FILE names the topics of another robot",
        beginning, foreign, frames, robot, guess));
    return;
  }
  std::string why;
  if (foreign != 0) why = fmt::format("{} of no topic", foreign);
  if (first)
    why += fmt::format("{}{} of wrong length, such as {:03X} with {} bytes in place of {}",
                       why.empty() ? "" : ", ", wrong_length, first->id, first->length, first->right);
  remark(fmt::format(
      "{}{} of {} frames contradict the spec of {} ({}): the others may be of another robot, too, "
      "and mean something else. --spec FILE names its topics",
      beginning, foreign + wrong_length, frames, robot, why));
}

}  // namespace ocm::cli
