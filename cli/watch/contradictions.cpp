#include "cli/watch/contradictions.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "cli/shared/messages.hpp"

namespace ocm::cli {

namespace {

/// What frames are of and not of, by what the spec has.
struct Wording {
  std::string_view of;      ///< "topic"
  std::string_view named;   ///< what --spec FILE names
  std::string_view others;  ///< whose the others may be
};

Wording wording_of(const protocol::Catalogue& catalogue) {
  const auto is_message = [](const protocol::Topic& topic) { return topic.is_message(); };
  const auto begin = catalogue.topics.begin();
  const auto end = catalogue.topics.end();
  if (begin != end && std::none_of(begin, end, is_message)) return {"topic", "topics", "robot"};
  if (begin != end && std::all_of(begin, end, is_message)) return {"message", "messages", "bus"};
  return {"topic or message", "topics or messages", "bus"};
}

}  // namespace

void tell_contradictions(const Contradictions& found, const protocol::Catalogue& catalogue, Seen where,
                         std::string_view beginning) {
  const auto& [frames, foreign, wrong_length, first] = found;
  if (frames == 0 || 10 * (foreign + wrong_length) < frames) return;
  const Wording words = wording_of(catalogue);
  if (foreign >= frames - frames / 10) {
    const std::string guess =
        where == Seen::in_log ? "a log of another bus?" : fmt::format("another {}?", words.others);
    remark(fmt::format("{}{} of {} {} of no {} of {}: {} --spec FILE names the {} of another {}", beginning,
                       foreign, counted(frames, "frame"), foreign == 1 ? "is" : "are", words.of,
                       catalogue.robot, guess, words.named, words.others));
    return;
  }
  std::string why;
  if (foreign != 0) why = fmt::format("{} of no {}", foreign, words.of);
  if (first)
    why += fmt::format("{}{} of wrong length, such as {:03X} with {} in place of {}", why.empty() ? "" : ", ",
                       wrong_length, first->id, counted(first->length, "byte"), first->right);
  const auto wrong = foreign + wrong_length;
  const std::string others = wrong == frames ? "another " : "the others may be of another ";
  remark(fmt::format("{}{} of {} {} the spec of {} ({}): {}{}{} --spec FILE names its {}", beginning, wrong,
                     counted(frames, "frame"), wrong == 1 ? "contradicts" : "contradict", catalogue.robot,
                     why, others, words.others, wrong == frames ? "?" : ", too, and mean something else.",
                     words.named));
}

}  // namespace ocm::cli
