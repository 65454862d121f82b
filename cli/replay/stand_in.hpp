/// A robot that is a log: answers requests with the samples that were recorded, topic by topic, at the period
/// and the priority that are asked for. Time is handed in. Memory: 16 bytes a recorded frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/scheduling/publisher.hpp"

namespace ocm::cli::replay {

class StandIn {
 public:
  /// 1 GB.
  static constexpr std::size_t most_frames = std::size_t{64} << 20;

  /// The catalogue must outlive it. It learns `room` frames at most.
  explicit StandIn(const protocol::Catalogue& catalogue, std::size_t room = most_frames);

  /// Frames of `interface` of the log come over the one of this name: topics that are on another are none of
  /// theirs.
  void on_interface(std::uint16_t interface, std::string_view name) {
    receiver_.on_interface(interface, name);
  }
  /// A frame of the log. false: there is no room for more.
  [[nodiscard]] bool learn(const can::Frame& frame, std::uint16_t interface = 0);
  [[nodiscard]] std::size_t samples() const;  ///< of all topics
  [[nodiscard]] std::size_t samples(const protocol::Topic& topic) const;

  enum class Answer : std::uint8_t {
    none,     ///< no request to a sensor
    refused,  ///< a request that no board takes
    silent,   ///< nothing was recorded of the topic
    accepted,
  };
  /// A frame of the bus, at `now`.
  Answer take(const can::Frame& frame, base::Time now);

  /// When the next sample is due; base::never: no request.
  [[nodiscard]] base::Time next() const { return publisher_->next_release(); }
  /// The frames of a sample that is due at `now`, of the most urgent one first; empty: none is. After the
  /// last sample of a topic comes its first. Valid until the next call.
  [[nodiscard]] const std::vector<can::Frame>& due(base::Time now);

 private:
  struct Recording {
    std::vector<can::Payload> payloads;  ///< sample after sample
    std::size_t next = 0;
  };
  static constexpr std::size_t most_topics = 256;  ///< of a spec are answered: its first

  [[nodiscard]] std::size_t index(const protocol::Topic& topic) const {
    return static_cast<std::size_t>(&topic - catalogue_->topics.data());
  }

  const protocol::Catalogue* catalogue_;
  client::Receiver receiver_;
  client::FrameIndex index_;
  std::vector<Recording> recordings_;
  std::unique_ptr<scheduling::Publisher<most_topics>> publisher_;
  std::size_t room_;
  std::size_t frames_ = 0;
  std::vector<can::Frame> sample_;
};

}  // namespace ocm::cli::replay
