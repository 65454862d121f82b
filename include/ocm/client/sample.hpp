/// From frames to samples. A topic of several frames makes one sample: it is complete when its last frame
/// came after all the others. There is no counter on the wire, so a frame that was lost shows as an
/// incomplete sample, which is counted. (Losing the end of one sample and exactly the rest of the next cannot
/// be distinguished from a whole one.)
///
/// A plain message is a sample by itself. One of J1939 may come in several frames by its transport protocol:
/// the packet that completes it is the sample.
///
/// Memory: 8 bytes a frame of the catalogue, 64 of one longer than that, and the index, allocated once; with
/// the transport protocol 60 KiB more. O(1) a frame.
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
#include "ocm/client/frame_index.hpp"
#include "ocm/client/selectors.hpp"
#include "ocm/j1939/transport.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

/// A complete sample of a topic, or a message. Valid until the next frame is taken.
struct Sample {
  const protocol::Topic* topic = nullptr;
  protocol::Priority priority = protocol::default_priority;  ///< a topic's
  base::Time time{};                                         ///< of its last frame
  /// Of all its frames, eight bytes each; of a message what came.
  std::span<const std::uint8_t> bytes;

  /// What frame `index` carries, with room to read as can::FrameView says.
  [[nodiscard]] std::span<const std::uint8_t> data(std::size_t index) const noexcept {
    if (topic->is_message()) return bytes;
    return bytes.subspan(index * sizeof(can::Payload), topic->frames[index].length);
  }
  /// A topic's frame as it came; the bytes beyond its length are zero.
  [[nodiscard]] can::Payload payload(std::size_t index) const noexcept {
    can::Payload payload;
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(index * payload.size()), payload.size(),
                payload.begin());
    return payload;
  }

  /// As the struct of the generated header; unknown_topic when the sample is of another topic.
  template <protocol::TopicType T>
  [[nodiscard]] base::Result<T> as() const noexcept {
    constexpr std::size_t count = T::frames.size();
    if (topic == nullptr || topic->is_message() || topic->id != T::id ||
        bytes.size() != count * sizeof(can::Payload))
      return base::Error::unknown_topic;
    std::array<can::Payload, count> frames;
    for (std::size_t i = 0; i < count; ++i) frames[i] = payload(i);
    return T::decode(frames);
  }
};

/// What a frame turned out to be.
enum class Meaning : std::uint8_t {
  part,       ///< of a sample that is not complete yet
  sample,     ///< the last frame of a complete sample, or a message
  request,    ///< an operator asks a sensor
  set_point,  ///< an operator commands an actuator
  unknown,    ///< no topic and no message has this identifier
  remote,     ///< a remote frame with the identifier of a topic or message
  wrong_dlc,  ///< a length that the topic has not, or that the message is longer than
  error,      ///< a report of the CAN controller
  transport,  ///< a frame of J1939's transport protocol that completes no message
};

struct Reception {
  Meaning meaning = Meaning::unknown;
  protocol::FrameRef frame;                ///< for part, sample, set_point, wrong_dlc
  const protocol::Topic* topic = nullptr;  ///< wherever there is one; a message's too
  Sample sample;                           ///< for Meaning::sample
  /// The message that this packet completes: Meaning::sample, however short it is, or unknown. Valid until
  /// the next frame is taken.
  const j1939::Transported* transported = nullptr;
};

struct ReceiverCounters {
  std::uint64_t frames = 0;
  std::uint64_t samples = 0;
  std::uint64_t commands = 0;
  std::uint64_t unknown = 0;
  std::uint64_t remote = 0;  ///< remote frames of known identifiers
  std::uint64_t fd = 0;      ///< CAN FD frames that no message has; no topic has any
  std::uint64_t wrong_dlc = 0;
  std::uint64_t incomplete =
      0;  ///< samples that lack a frame; the one that was under way at the start is not counted
  std::uint64_t errors = 0;
  std::uint64_t transport = 0;  ///< frames of J1939's transport protocol that complete no message
  /// Messages with a selector that chooses no field; they are among `samples`, and no faults: many specs
  /// leave pages out.
  std::uint64_t unselected = 0;
  /// Frames or samples that a listener should know of.
  [[nodiscard]] constexpr std::uint64_t faults() const noexcept {
    return unknown + remote + fd + wrong_dlc + incomplete + errors;
  }
  /// Those of several receivers together.
  constexpr ReceiverCounters& operator+=(const ReceiverCounters& other) noexcept {
    frames += other.frames;
    samples += other.samples;
    commands += other.commands;
    unknown += other.unknown;
    remote += other.remote;
    fd += other.fd;
    wrong_dlc += other.wrong_dlc;
    incomplete += other.incomplete;
    errors += other.errors;
    transport += other.transport;
    unselected += other.unselected;
    return *this;
  }
};

/// Whether messages of J1939's transport protocol are put together, if the catalogue has J1939 at all.
enum class Transport : std::uint8_t { as_frames, together };

/// Understands the frames of one robot. The catalogue must outlive it.
class Receiver {
 public:
  explicit Receiver(const protocol::Catalogue& catalogue, Transport transport = Transport::as_frames)
      : catalogue_(&catalogue), index_(catalogue) {
    if (transport == Transport::together && has_groups(catalogue)) transport_.resize(1);
    assemblies_.reserve(catalogue.topics.size());
    for (const protocol::Topic& topic : catalogue.topics) {
      Selectors selectors = topic.is_message() ? Selectors{topic.frames[0]} : Selectors{};
      std::uint32_t number = none;
      if (!selectors.empty()) {
        number = static_cast<std::uint32_t>(selectors_.size());
        selectors_.push_back(std::move(selectors));
      }
      assemblies_.push_back({bytes_.size(), 0, false, number});
      bytes_.resize(bytes_.size() + (topic.is_message() ? 0 : sizeof(can::Payload) * topic.frames.size()));
    }
  }

  [[nodiscard]] Reception take(const can::Received& received) {
    return take(can::FrameView{received.frame}, received.time);
  }
  /// `bus` tells several apart where nodes of different ones have the same addresses of J1939, and topics are
  /// on one of them only.
  [[nodiscard]] Reception take(const can::FrameView& frame, base::Time time, std::uint16_t bus = 0) {
    ++counters_.frames;
    if (frame.format == can::Format::error) {
      ++counters_.errors;
      return {Meaning::error, {}, nullptr, {}};
    }
    if (!transport_.empty() && frame.format == can::Format::extended && !frame.fd &&
        j1939::is_transport(frame.id))
      return take_transport(frame, time, bus);
    return take_frame(frame, time, bus);
  }

  /// Frames of `bus` come over the interface of this name: topics that are on another are none of theirs.
  void on_interface(std::uint16_t bus, std::string_view name) { index_.name(bus, name); }
  /// Whether names of interfaces matter.
  [[nodiscard]] bool has_buses() const noexcept { return index_.has_buses(); }

  [[nodiscard]] const ReceiverCounters& counters() const noexcept { return counters_; }
  /// How the messages of J1939's transport protocol ended until `now`.
  [[nodiscard]] j1939::TransportCounters transport_counters(base::Time now) noexcept {
    if (transport_.empty()) return {};
    transport_[0].expire(now);
    return transport_[0].counters();
  }
  /// The same as of the last frame: a message that did not go on since is still under way.
  [[nodiscard]] j1939::TransportCounters transport_counters() const noexcept {
    return transport_.empty() ? j1939::TransportCounters{} : transport_[0].counters();
  }
  /// Messages of it that are under way.
  [[nodiscard]] std::size_t transports_open() const noexcept {
    return transport_.empty() ? 0 : transport_[0].open();
  }
  [[nodiscard]] const protocol::Catalogue& catalogue() const noexcept { return *catalogue_; }

 private:
  struct Assembly {
    std::size_t first;        // of the topic's bytes
    std::uint64_t present;    // bit i: frame i of the sample under way has come
    bool synchronised;        // the sample under way was seen from its beginning
    std::uint32_t selectors;  // of a message; none: it has no selector
  };
  static constexpr std::uint32_t none = UINT32_MAX;
  /// As many messages at a time: one a sender is usual.
  using TransportSessions = j1939::Transport<32>;

  [[nodiscard]] static bool has_groups(const protocol::Catalogue& catalogue) noexcept {
    return std::any_of(catalogue.topics.begin(), catalogue.topics.end(), [](const protocol::Topic& topic) {
      return topic.is_message() && topic.frames[0].address.by == protocol::Address::By::pgn;
    });
  }

  Reception take_transport(const can::FrameView& frame, base::Time time, std::uint16_t bus) {
    if (transport_[0].take(frame.id, frame.bytes, time, bus) != j1939::Heard::message) {
      // A spec may describe the protocol's own frames.
      if (index_.of(bus).subject(frame.id, frame.format)) return take_frame(frame, time, bus);
      ++counters_.transport;
      return {Meaning::transport, {}, nullptr, {}};
    }
    const j1939::Transported& whole = transport_[0].message();
    const Subject subject = index_.of(bus).subject(whole.id.encode(), can::Format::extended);
    if (!subject) {
      ++counters_.unknown;
      return {Meaning::unknown, {}, nullptr, {}, &whole};
    }
    ++counters_.samples;
    count_unselected(*subject.topic, whole.data);
    return {Meaning::sample,
            subject.frame,
            subject.topic,
            {subject.topic, protocol::default_priority, time, whole.data},
            &whole};
  }

  Reception take_remote(const can::FrameView& frame, std::uint16_t bus) {
    const Subject subject = index_.of(bus).subject(frame.id, can::data_format(frame.format));
    ++(subject ? counters_.remote : counters_.unknown);
    return {subject ? Meaning::remote : Meaning::unknown, {}, subject.topic, {}};
  }

  Reception take_frame(const can::FrameView& frame, base::Time time, std::uint16_t bus) {
    if (can::is_remote(frame.format)) return take_remote(frame, bus);
    const Known known = index_.of(bus).known(frame.id, frame.format);
    const bool is_message = known.kind == Known::Kind::message;
    if (!known || (frame.fd && !is_message)) {
      ++(frame.fd ? counters_.fd : counters_.unknown);
      return {};
    }
    if (known.kind == Known::Kind::request) {
      ++counters_.commands;
      return {Meaning::request, {}, known.topic, {}};
    }
    const protocol::FrameRef ref = known.frame();
    if (!known.accepts(frame.bytes.size())) {
      ++counters_.wrong_dlc;
      return {Meaning::wrong_dlc, ref, ref.topic, {}};
    }
    if (is_message) {
      if (known.selects) count_unselected(*ref.topic, frame.bytes);
      return message(frame, time, ref);
    }
    const auto id = protocol::Identifier::decode(frame.id);
    if (id.direction == protocol::Direction::command) {
      ++counters_.commands;
      return {Meaning::set_point, ref, ref.topic, {}};
    }
    return assemble(frame, time, id.priority, ref);
  }

  void count_unselected(const protocol::Topic& message, std::span<const std::uint8_t> data) {
    const auto number = assemblies_[static_cast<std::size_t>(&message - catalogue_->topics.data())].selectors;
    if (number != none && selectors_[number].choose_nothing(data)) ++counters_.unselected;
  }

  Reception message(const can::FrameView& frame, base::Time time, protocol::FrameRef ref) {
    ++counters_.samples;
    const std::size_t room = frame.bytes.size() <= sizeof(can::Payload) ? sizeof(can::Payload) : 64;
    std::copy_n(frame.bytes.data(), room, message_.begin());
    return {Meaning::sample,
            ref,
            ref.topic,
            {ref.topic, protocol::default_priority, time, std::span{message_}.first(frame.bytes.size())}};
  }

  Reception assemble(const can::FrameView& frame, base::Time time, protocol::Priority priority,
                     protocol::FrameRef ref) {
    const std::size_t count = ref.topic->frames.size();
    Assembly& assembly = assemblies_[static_cast<std::size_t>(ref.topic - catalogue_->topics.data())];
    const std::uint64_t bit = std::uint64_t{1} << ref.frame;
    // Frames of a sample come in the order of the spec: one that does not come after the others begins a new
    // sample.
    if (assembly.present >> ref.frame != 0) abandon(assembly);
    assembly.present |= bit;
    std::copy_n(frame.bytes.data(), sizeof(can::Payload),
                &bytes_[assembly.first + sizeof(can::Payload) * ref.frame]);
    if (ref.frame + std::size_t{1} != count) return {Meaning::part, ref, ref.topic, {}};

    const std::uint64_t all = count == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    if (assembly.present != all) {
      abandon(assembly);
      return {Meaning::part, ref, ref.topic, {}};
    }
    assembly.present = 0;
    assembly.synchronised = true;
    ++counters_.samples;
    return {
        Meaning::sample,
        ref,
        ref.topic,
        {ref.topic, priority, time, std::span{bytes_}.subspan(assembly.first, sizeof(can::Payload) * count)}};
  }

  void abandon(Assembly& assembly) {
    assembly.present = 0;
    // A program that begins to listen in the middle of a sample has lost nothing.
    if (assembly.synchronised) ++counters_.incomplete;
    assembly.synchronised = true;
  }

  const protocol::Catalogue* catalogue_;
  InterfaceIndexes index_;
  std::vector<Assembly> assemblies_;
  std::vector<Selectors> selectors_;          // of the messages that have any
  std::vector<std::uint8_t> bytes_;           // of topics
  std::array<std::uint8_t, 64> message_{};    // that came last
  std::vector<TransportSessions> transport_;  // one or none
  ReceiverCounters counters_;
};

}  // namespace ocm::client
