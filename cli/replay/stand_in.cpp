#include "cli/replay/stand_in.hpp"

#include "ocm/controller/level.hpp"
#include "ocm/protocol/request.hpp"

namespace ocm::cli::replay {

StandIn::StandIn(const protocol::Catalogue& catalogue, std::size_t room)
    : catalogue_(&catalogue),
      receiver_(catalogue),
      index_(catalogue),
      recordings_(catalogue.topics.size()),
      publisher_(std::make_unique<scheduling::Publisher<most_topics>>()),
      room_(room) {}

bool StandIn::learn(const can::Frame& frame, std::uint16_t interface) {
  const auto reception = receiver_.take(can::FrameView{frame}, {}, interface);
  if (reception.meaning != client::Meaning::sample) return true;
  if (reception.topic->is_message()) return true;  // is asked for by no request
  const std::size_t count = reception.topic->frames.size();
  if (frames_ + count > room_) return false;
  auto& recorded = recordings_[index(*reception.topic)].payloads;
  for (std::size_t i = 0; i < count; ++i) recorded.push_back(reception.sample.payload(i));
  frames_ += count;
  return true;
}

std::size_t StandIn::samples() const {
  std::size_t sum = 0;
  for (const auto& topic : catalogue_->topics) sum += samples(topic);
  return sum;
}

std::size_t StandIn::samples(const protocol::Topic& topic) const {
  return topic.frames.empty() ? 0 : recordings_[index(topic)].payloads.size() / topic.frames.size();
}

StandIn::Answer StandIn::take(const can::Frame& frame, base::Time now) {
  if (frame.format != can::Format::base) return Answer::none;
  const auto* const topic = index_.requested(protocol::Identifier::decode(frame.id));
  if (topic == nullptr) return Answer::none;
  const auto request = protocol::decode_request(frame);
  if (!request) return Answer::refused;
  const std::size_t stream = index(*topic);
  if (stream >= most_topics) return Answer::silent;
  if (request->mode == protocol::Mode::stop) {
    publisher_->stop(stream);
    return Answer::accepted;
  }
  if (samples(*topic) == 0) return Answer::silent;
  if (request->mode == protocol::Mode::once) {
    publisher_->once(stream, controller::level_of(request->priority), now);
  } else {
    const auto period = frame.dlc == 1 ? topic->period : request->period;
    publisher_->start(stream, period.duration(), controller::level_of(request->priority), now);
  }
  return Answer::accepted;
}

const std::vector<can::Frame>& StandIn::due(base::Time now) {
  using protocol::Priority;
  sample_.clear();
  scheduling::Release release;
  for (const auto priority : {Priority::urgent, Priority::high, Priority::medium, Priority::low}) {
    if (!publisher_->take_due(now, controller::level_of(priority), release)) continue;
    publisher_->done(release.stream, now);
    const auto& layouts = catalogue_->topics[release.stream].frames;
    auto& [payloads, next] = recordings_[release.stream];
    for (const auto& layout : layouts) {
      const protocol::Identifier id{protocol::Direction::sensor, priority, layout.id};
      sample_.push_back({id.encode(), layout.dlc(), payloads[next++]});
    }
    if (next == payloads.size()) next = 0;
    break;
  }
  return sample_;
}

}  // namespace ocm::cli::replay
