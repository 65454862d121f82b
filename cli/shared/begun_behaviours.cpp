#include "cli/shared/begun_behaviours.hpp"

#include <string>

#include "cli/shared/set_points.hpp"

namespace ocm::cli {

void BegunBehaviours::sent(const can::Frame& frame) {
  const protocol::Topic* const topic = sensor_.commanded(index_, frame);
  if (topic == nullptr) return;
  std::erase_if(all_, [topic](const Begun& each) { return each.topic == topic; });
  if (is_rest(frame)) return;
  Begun begun{topic, frame};
  begun.end.data = {};
  all_.push_back(begun);
}

std::string BegunBehaviours::names() const {
  std::string text;
  for (const Begun& each : all_) text.append(text.empty() ? "" : ", ").append(each.topic->name);
  return all_.empty() ? text : text + (all_.size() == 1 ? " was" : " were");
}

}  // namespace ocm::cli
