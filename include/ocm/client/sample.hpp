/// From frames to samples. A topic of several frames makes one sample: it is complete when its last frame
/// came after all the others. There is no counter on the wire, so a frame that was lost shows as an
/// incomplete sample, which is counted. (Losing the end of one sample and exactly the rest of the next cannot
/// be distinguished from a whole one.)
///
/// Memory: 8 bytes a frame of the catalogue and 4 KiB of index, allocated once. O(1) a frame.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/protocol/frame_index.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

/// A complete sample of a topic. `payloads` is valid until the next frame is taken.
struct Sample {
  const protocol::Topic* topic = nullptr;
  protocol::Priority priority = protocol::default_priority;
  base::Time time{};  ///< of its last frame
  std::span<const can::Payload> payloads;

  /// As the struct of the generated header; unknown_topic when the sample is of another topic.
  template <protocol::TopicType T>
  [[nodiscard]] base::Result<T> as() const noexcept {
    if (topic == nullptr || topic->id != T::id || payloads.size() != T::frames.size())
      return base::Error::unknown_topic;
    std::array<can::Payload, T::frames.size()> frames;
    std::copy(payloads.begin(), payloads.end(), frames.begin());
    return T::decode(frames);
  }
};

/// What a frame turned out to be.
enum class Meaning : std::uint8_t {
  part,       ///< of a sample that is not complete yet
  sample,     ///< the last frame of a complete sample
  request,    ///< an operator asks a sensor
  set_point,  ///< an operator commands an actuator
  unknown,    ///< no topic has this identifier, or the frame is remote or extended
  wrong_dlc,  ///< a topic's identifier with a length that it does not have
  error,      ///< a report of the CAN controller
};

struct Reception {
  Meaning meaning = Meaning::unknown;
  protocol::FrameRef frame;                ///< for part, sample, set_point, wrong_dlc
  const protocol::Topic* topic = nullptr;  ///< wherever there is one
  Sample sample;                           ///< for Meaning::sample
};

struct ReceiverCounters {
  std::uint64_t frames = 0;
  std::uint64_t samples = 0;
  std::uint64_t commands = 0;
  std::uint64_t unknown = 0;
  std::uint64_t wrong_dlc = 0;
  std::uint64_t incomplete =
      0;  ///< samples that lack a frame; the one that was under way at the start is not counted
  std::uint64_t errors = 0;
  /// Frames or samples that a listener should know of.
  [[nodiscard]] constexpr std::uint64_t faults() const noexcept {
    return unknown + wrong_dlc + incomplete + errors;
  }
};

/// Understands the frames of one robot. The catalogue must outlive it.
class Receiver {
 public:
  explicit Receiver(const protocol::Catalogue& catalogue) : catalogue_(&catalogue), index_(catalogue) {
    assemblies_.reserve(catalogue.topics.size());
    for (const protocol::Topic& topic : catalogue.topics) {
      assemblies_.push_back({payloads_.size(), 0, false});
      payloads_.resize(payloads_.size() + topic.frames.size());
    }
  }

  [[nodiscard]] Reception take(const can::Received& received) {
    const can::Frame& frame = received.frame;
    ++counters_.frames;
    if (frame.format == can::Format::error) {
      ++counters_.errors;
      return {Meaning::error, {}, nullptr, {}};
    }
    if (frame.format != can::Format::base) {
      ++counters_.unknown;
      return {};
    }
    const auto id = protocol::Identifier::decode(frame.id);
    const protocol::Subject subject = index_.subject(id);
    if (!subject) {
      ++counters_.unknown;
      return {};
    }
    if (subject.is_request()) {
      ++counters_.commands;
      return {Meaning::request, {}, subject.topic, {}};
    }
    const protocol::FrameRef ref = subject.frame;
    if (frame.dlc != ref.layout().dlc) {
      ++counters_.wrong_dlc;
      return {Meaning::wrong_dlc, ref, ref.topic, {}};
    }
    if (id.direction == protocol::Direction::command) {
      ++counters_.commands;
      return {Meaning::set_point, ref, ref.topic, {}};
    }
    return assemble(received, id.priority, ref);
  }

  [[nodiscard]] const ReceiverCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const protocol::Catalogue& catalogue() const noexcept { return *catalogue_; }

 private:
  struct Assembly {
    std::size_t first;      // of the topic's payloads
    std::uint64_t present;  // bit i: frame i of the sample under way has come
    bool synchronised;      // the sample under way was seen from its beginning
  };

  Reception assemble(const can::Received& received, protocol::Priority priority, protocol::FrameRef ref) {
    const std::size_t count = ref.topic->frames.size();
    Assembly& assembly = assemblies_[static_cast<std::size_t>(ref.topic - catalogue_->topics.data())];
    const std::uint64_t bit = std::uint64_t{1} << ref.frame;
    // Frames of a sample come in the order of the spec: one that does not come after the others begins a new
    // sample.
    if (assembly.present >> ref.frame != 0) abandon(assembly);
    assembly.present |= bit;
    payloads_[assembly.first + ref.frame] = received.frame.data;
    if (ref.frame + std::size_t{1} != count) return {Meaning::part, ref, ref.topic, {}};

    const std::uint64_t all = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    if (assembly.present != all) {
      abandon(assembly);
      return {Meaning::part, ref, ref.topic, {}};
    }
    assembly.present = 0;
    assembly.synchronised = true;
    ++counters_.samples;
    return {Meaning::sample,
            ref,
            ref.topic,
            {ref.topic, priority, received.time, std::span{payloads_}.subspan(assembly.first, count)}};
  }

  void abandon(Assembly& assembly) {
    assembly.present = 0;
    // A program that begins to listen in the middle of a sample has lost nothing.
    if (assembly.synchronised) ++counters_.incomplete;
    assembly.synchronised = true;
  }

  const protocol::Catalogue* catalogue_;
  protocol::FrameIndex index_;
  std::vector<Assembly> assemblies_;
  std::vector<can::Payload> payloads_;
  ReceiverCounters counters_;
};

}  // namespace ocm::client
