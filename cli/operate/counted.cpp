#include "cli/operate/counted.hpp"

#include <algorithm>

namespace ocm::cli::operate {

const reflective::Stream* Counted::find(std::uint16_t configuration, std::uint16_t topic) const {
  for (const auto* const streams : {&file_->parts[configuration].expected, &file_->stated_others}) {
    const auto found = std::find_if(streams->begin(), streams->end(),
                                    [topic](const auto& stream) { return stream.topic == topic; });
    if (found != streams->end()) return &*found;
  }
  return nullptr;
}

bool Counted::take(std::uint16_t configuration, std::uint16_t topic, protocol::Priority priority,
                   base::Time now) {
  const reflective::Stream* const counted = find(configuration, topic);
  if (counted == nullptr) return true;
  if (priority < counted->priority) return false;  // the lower number is more urgent
  base::Time& due = due_[topic];
  if (now < due - counted->period) return false;
  due = std::max(due, now) + counted->period;
  return true;
}

}  // namespace ocm::cli::operate
