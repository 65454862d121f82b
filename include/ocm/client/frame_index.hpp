/// Which topic or message a frame is of: the one place that knows. Built from a catalogue; one or two steps a
/// frame, whatever their number.
///
///     const client::FrameIndex index{catalogue};
///     const auto subject = index.subject(frame.id, frame.format);
///     if (subject.is_request()) ...
///
/// An identifier of 11 bits is a topic's before it is a message's; one of 29 bits is a message's whose exact
/// identifier it is before it is the one of its parameter group [SAE J1939-21]. Memory: 32 KiB, and up to 96
/// bytes a message, allocated once.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/can/frame.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::client {

/// What a frame is about: a request to a topic, or a frame of a topic or message.
struct Subject {
  const protocol::Topic* topic = nullptr;  ///< nullptr: the catalogue does not know the identifier
  protocol::FrameRef frame{};              ///< sensor data, a set point or a message; empty for a request
  [[nodiscard]] constexpr bool is_request() const noexcept { return topic != nullptr && !frame; }
  constexpr explicit operator bool() const noexcept { return topic != nullptr; }
};

/// The same with what is asked of every frame, in two words: of hundreds of messages in any order neither
/// topic nor layout is in a near cache, and a receiver looks at neither.
struct Known {
  enum class Kind : std::uint8_t { nothing, request, frame, message };

  const protocol::Topic* topic = nullptr;
  std::uint16_t least = 0;  ///< bytes of a frame
  std::uint16_t most = 0;
  std::uint8_t number = 0;  ///< of the topic's frames
  Kind kind = Kind::nothing;
  bool selects = false;  ///< a field of it says which others are there

  constexpr Known() = default;
  constexpr Known(Kind what, protocol::FrameRef of) noexcept : topic(of.topic), number(of.frame), kind(what) {
    if (kind == Kind::request) return;
    const protocol::FrameLayout& layout = of.layout();
    least = layout.any_length() ? std::uint16_t{0} : layout.length;
    most = layout.address.by == protocol::Address::By::topic ? layout.length : std::uint16_t{UINT16_MAX};
    for (const protocol::Field& field : layout.fields)
      selects = selects || field.selector != protocol::no_selector;
  }

  constexpr explicit operator bool() const noexcept { return topic != nullptr; }
  /// As FrameLayout::accepts.
  [[nodiscard]] constexpr bool accepts(std::size_t bytes) const noexcept {
    return bytes >= least && bytes <= most;
  }
  /// Empty for a request.
  [[nodiscard]] constexpr protocol::FrameRef frame() const noexcept {
    return kind == Kind::request ? protocol::FrameRef{} : protocol::FrameRef{topic, number};
  }
  [[nodiscard]] constexpr Subject subject() const noexcept { return {topic, frame()}; }
};
static_assert(sizeof(Known) <= 16);

class FrameIndex {
 public:
  FrameIndex() : FrameIndex(protocol::Catalogue{}) {}
  /// The catalogue must outlive the index. Of two messages with one identifier the first is found.
  explicit FrameIndex(const protocol::Catalogue& catalogue)
      : FrameIndex(catalogue, [](const protocol::Topic&) { return true; }) {}
  /// Of what is on this interface.
  FrameIndex(const protocol::Catalogue& catalogue, std::string_view interface)
      : FrameIndex(catalogue, [interface](const protocol::Topic& topic) { return topic.is_on(interface); }) {}

  /// Nothing for remote and error frames.
  [[nodiscard]] Known known(std::uint32_t id, can::Format format) const noexcept {
    if (format == can::Format::base) return base_[id & can::max_base_id];
    if (format != can::Format::extended) return {};
    const Known exact = look_up(id);
    return exact ? exact : look_up(group_key(j1939::pgn_of(id)));
  }
  [[nodiscard]] Subject subject(std::uint32_t id, can::Format format) const noexcept {
    return known(id, format).subject();
  }
  /// The same of a topic's identifier alone: no message.
  [[nodiscard]] Subject subject(protocol::Identifier id) const noexcept {
    const Known& found = base_[id.encode()];
    return found.kind == Known::Kind::message ? Subject{} : found.subject();
  }
  /// Sensor data, or an actuator's set point; empty for requests and unknown identifiers.
  [[nodiscard]] protocol::FrameRef find(protocol::Identifier id) const noexcept { return subject(id).frame; }
  /// The sensor that a command frame asks; nullptr otherwise.
  [[nodiscard]] const protocol::Topic* requested(protocol::Identifier id) const noexcept {
    const Subject found = subject(id);
    return found.is_request() ? found.topic : nullptr;
  }

 private:
  template <class IsThere>
  requires std::predicate<IsThere, const protocol::Topic&> FrameIndex(const protocol::Catalogue& catalogue,
                                                                      IsThere is_there)
      : base_(can::max_base_id + std::size_t{1}) {
    std::size_t wide = 0;
    for (const auto& topic : catalogue.topics) wide += topic.is_message() ? 1 : 0;
    wide_.resize(std::bit_ceil(2 * wide + 2));  // half of it stays empty: few steps
    for (const auto& topic : catalogue.topics)
      if (!topic.is_message() && is_there(topic)) add_topic(topic);
    for (const auto& topic : catalogue.topics)
      if (topic.is_message() && is_there(topic)) add_message(topic);
  }

  struct Wide {
    std::uint32_t key = 0;
    Known known;
  };
  /// Above every identifier of 29 bits.
  [[nodiscard]] static constexpr std::uint32_t group_key(std::uint32_t pgn) noexcept {
    return std::uint32_t{1} << 29 | pgn;
  }

  void add_topic(const protocol::Topic& topic) {
    using protocol::Direction;
    const bool sensor = topic.kind == protocol::Kind::sensor;
    for (std::size_t level = 0; level < protocol::priority_levels; ++level) {
      const auto priority = static_cast<protocol::Priority>(level);
      if (sensor)
        base_[protocol::Identifier{Direction::command, priority, topic.id}.encode()] = {Known::Kind::request,
                                                                                        {&topic, 0}};
      const auto direction = sensor ? Direction::sensor : Direction::command;
      for (std::size_t i = 0; i < topic.frames.size(); ++i)
        base_[protocol::Identifier{direction, priority, topic.frames[i].id}.encode()] = {
            Known::Kind::frame, {&topic, static_cast<std::uint8_t>(i)}};
    }
  }
  void add_message(const protocol::Topic& message) {
    const Known known{Known::Kind::message, {&message, 0}};
    const protocol::Address& address = message.frames[0].address;
    if (address.by == protocol::Address::By::pgn)
      return insert(group_key(j1939::pgn_of(address.number)), known);
    if (address.extended) return insert(address.number, known);
    Known& place = base_[address.number & can::max_base_id];
    if (!place) place = known;
  }
  void insert(std::uint32_t key, const Known& known) {
    std::size_t at = place_of(key);
    while (wide_[at].known && wide_[at].key != key) at = (at + 1) & (wide_.size() - 1);
    if (!wide_[at].known) wide_[at] = {key, known};
  }
  [[nodiscard]] Known look_up(std::uint32_t key) const noexcept {
    std::size_t at = place_of(key);
    while (wide_[at].known && wide_[at].key != key) at = (at + 1) & (wide_.size() - 1);
    return wide_[at].known;
  }
  /// Fibonacci hashing: identifiers that follow one another come to places far apart. [Knuth, TAOCP 3, 6.4]
  [[nodiscard]] std::size_t place_of(std::uint32_t key) const noexcept {
    return key * 0x9E37'79B9U >> (32U - static_cast<unsigned>(std::countr_zero(wide_.size())));
  }

  std::vector<Known> base_;  // by identifier of 11 bits
  std::vector<Wide> wide_;   // a power of two, and at least one place is empty
};

/// An index for each interface of a log, where the catalogue has topics that are on one only; else the same
/// for all. Each log numbers its interfaces by itself.
class InterfaceIndexes {
 public:
  InterfaceIndexes() : InterfaceIndexes(protocol::Catalogue{}) {}
  /// The catalogue must outlive it, and so must its topics.
  explicit InterfaceIndexes(const protocol::Catalogue& catalogue)
      : catalogue_(catalogue), has_buses_(catalogue.has_buses()), any_(catalogue) {}

  /// Whether names of interfaces matter.
  [[nodiscard]] bool has_buses() const noexcept { return has_buses_; }
  /// From now on interface `number` has this name.
  void name(std::uint16_t number, std::string_view name) {
    if (!has_buses_) return;
    if (named_.size() <= number) named_.resize(number + std::size_t{1});
    if (auto& known = named_[number]; !known || known->name != name)
      known.emplace(Named{std::string{name}, FrameIndex{catalogue_, name}});
  }
  /// Of an interface without a name: all that there is.
  [[nodiscard]] const FrameIndex& of(std::uint16_t number) const noexcept {
    return number < named_.size() && named_[number] ? named_[number]->index : any_;
  }

 private:
  struct Named {
    std::string name;
    FrameIndex index;
  };
  protocol::Catalogue catalogue_;
  bool has_buses_;
  FrameIndex any_;
  std::vector<std::optional<Named>> named_;
};

}  // namespace ocm::client
