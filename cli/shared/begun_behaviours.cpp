#include "cli/shared/begun_behaviours.hpp"

#include <string>

#include "cli/shared/set_points.hpp"

namespace ocm::cli {

const protocol::Topic* BegunBehaviours::topic_of(const can::Frame& frame) const {
  const client::Subject subject = index_.subject(frame.id, frame.format);
  const protocol::Topic* const topic = subject.topic;
  if (frame.format != can::Format::base || !subject.frame || frame.dlc != subject.frame.layout().dlc())
    return nullptr;
  // Motors are set to rest by who holds them; what has no timeout, such as a light, stays as it was
  // commanded.
  if (topic->kind != protocol::Kind::actuator || topic->role == protocol::Role::drive ||
      topic->timeout.count() == 0)
    return nullptr;
  return topic;
}

bool BegunBehaviours::is_begun_by(const can::Frame& frame) const {
  return topic_of(frame) != nullptr && !is_rest(frame);
}

void BegunBehaviours::sent(const can::Frame& frame) {
  const protocol::Topic* const topic = topic_of(frame);
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
