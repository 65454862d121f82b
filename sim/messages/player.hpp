/// A bus without its hardware: the messages of a catalogue, each at its period, with fields that move.
///
///     sim::MessagePlayer player{catalogue, {.seed = 7}};
///     player.advance(now, [&](const sim::PlayedMessage& message, const can::AnyFrame& frame, base::Time due)
///     {
///       ... frame goes onto the bus at `due`, sent by node message.board ...
///     });
///
/// A message of J1939 with more than eight bytes is broadcast by its transport protocol: announced
/// (TP.CM_BAM), then a packet every 50 ms [SAE J1939-21, 5.10.2.1]. A source has one at a time: others of it
/// wait, and a message that takes longer than its period is sent every second time, or every third.
///
/// Time is handed in. What is sent depends on the catalogue, the seed and the time, however seldom `advance`
/// is called. O(log messages) a frame, and O(fields squared) for its content. The catalogue must outlive it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <queue>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/any_frame.hpp"
#include "ocm/j1939/broadcast.hpp"
#include "ocm/j1939/identifier.hpp"
#include "ocm/protocol/topic.hpp"

#include "sim/messages/motion.hpp"
#include "sim/messages/pages.hpp"
#include "sim/physics/noise.hpp"

namespace ocm::sim {

struct PlayOptions {
  std::uint64_t seed = 1;
  /// How far apart messages without a period are, on average; 0: they are not sent.
  base::Duration sporadic{};
  bool fd = true;  ///< whether there is a bus that carries CAN FD
  /// Nodes that send nothing, since real ones are to be connected in their place: what the others send is the
  /// same as with them.
  std::vector<std::uint8_t> without{};
};

/// A message that is played, or why it is not.
struct PlayedMessage {
  const protocol::Topic* topic = nullptr;
  std::uint8_t board = protocol::no_board;
  std::uint32_t id = 0;  ///< with which it is sent
};

/// Messages that stay out, by cause, in the order of the catalogue.
struct LeftOut {
  std::vector<const protocol::Topic*> switched_off;  ///< PlayOptions::without
  std::vector<const protocol::Topic*> without_period;
  std::vector<const protocol::Topic*> no_fd;     ///< CAN FD, where the bus has none
  std::vector<const protocol::Topic*> too_long;  ///< more bytes than a frame has: 8, CAN FD 64; of J1939 1785
};

/// The identifier of a message. A J1939 message whose source is the null address, with which a node may not
/// send, gets one that its sender may choose for itself, 128 to 247 [SAE J1939-81]: one a node.
[[nodiscard]] constexpr std::uint32_t played_identifier(const protocol::Topic& message) noexcept {
  const auto& address = message.frames[0].address;
  auto id = j1939::Identifier::decode(address.number);
  if (address.by != protocol::Address::By::pgn || id.source != j1939::null_address) return address.number;
  id.source = static_cast<std::uint8_t>(128U + message.board % 120U);
  return id.encode();
}

class MessagePlayer {
 public:
  explicit MessagePlayer(const protocol::Catalogue& catalogue, PlayOptions options = {})
      : options_(std::move(options)) {
    std::uint64_t number = 0;
    for (const auto& topic : catalogue.topics) {
      if (!topic.is_message() || topic.frames.empty()) continue;
      const auto& layout = topic.frames[0];
      if (std::find(options_.without.begin(), options_.without.end(), topic.board) != options_.without.end())
        left_out_.switched_off.push_back(&topic);
      else if (topic.cycle.count() <= 0 && options_.sporadic.count() <= 0)
        left_out_.without_period.push_back(&topic);
      else if (layout.fd && !options_.fd)
        left_out_.no_fd.push_back(&topic);
      else if (layout.length > (layout.fd ? can::max_fd_length : can::max_dlc) && !is_broadcast(layout))
        left_out_.too_long.push_back(&topic);
      else
        take(topic, number);
      number += 1 + layout.fields.size();
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return messages_.size(); }
  [[nodiscard]] const LeftOut& left_out() const noexcept { return left_out_; }
  /// Played messages of a node, protocol::no_board: of unknown senders.
  [[nodiscard]] std::size_t sent_by(std::uint8_t board) const noexcept {
    return static_cast<std::size_t>(std::count_if(
        messages_.begin(), messages_.end(), [board](const Message& m) { return m.played.board == board; }));
  }

  /// When the next message is due; the end of time where there is none.
  [[nodiscard]] base::Time next_event() const noexcept {
    return due_.empty() ? base::Time::max() : due_.top().first;
  }

  /// Calls `send(message, frame, due)` for everything that is due until `now`, in its order.
  template <class Send>
  void advance(base::Time now, Send send) {
    while (!due_.empty() && due_.top().first <= now) {
      const auto [due, index] = due_.top();
      due_.pop();
      Message& message = messages_[index];
      if (is_broadcast(message.played.topic->frames[0])) {
        due_.push({broadcast(message, due, send), index});
        continue;
      }
      send(std::as_const(message.played), content(message, due), due);
      ++message.sent;
      due_.push({due + distance(message), index});
    }
  }

 private:
  struct Message {
    PlayedMessage played;
    Pages pages;
    std::vector<FieldMotion> motions;
    std::uint64_t key = 0;
    std::uint64_t sent = 0;
    std::uint32_t parts = 0;           ///< of a broadcast under way: frames that were sent
    base::Time announced{};            ///< when it should have been
    std::vector<std::uint8_t> data{};  ///< of it
  };
  using Due = std::pair<base::Time, std::size_t>;

  void take(const protocol::Topic& topic, std::uint64_t number) {
    const auto& layout = topic.frames[0];
    Message message{{&topic, topic.board, played_identifier(topic)},
                    Pages{layout},
                    {},
                    split_mix(split_mix(options_.seed, 0), number)};
    for (const auto& field : layout.fields) message.motions.emplace_back(field, options_.seed, ++number);
    // Nodes are not switched on in one moment: each message begins somewhere in its first period.
    const base::Duration period = topic.cycle.count() > 0 ? topic.cycle : options_.sporadic;
    const auto phase =
        split_mix(message.key, ~std::uint64_t{0} >> 1) % static_cast<std::uint64_t>(period.count());
    message.announced = base::Time{base::Duration{static_cast<std::int64_t>(phase)}};
    due_.push({message.announced, messages_.size()});
    messages_.push_back(std::move(message));
  }

  /// Without a period: evenly between half and one and a half of what was asked for, and never nearer than
  /// the spec allows.
  [[nodiscard]] base::Duration distance(const Message& message) const noexcept {
    const auto& topic = *message.played.topic;
    if (topic.cycle.count() > 0) return topic.cycle;
    const auto mean = static_cast<std::uint64_t>(options_.sporadic.count());
    const auto wanted =
        static_cast<std::int64_t>(mean - mean / 2 + split_mix(message.key, message.sent) % mean);
    return std::max(base::Duration{wanted}, topic.shortest_period);
  }

  [[nodiscard]] static bool is_broadcast(const protocol::FrameLayout& layout) noexcept {
    return layout.any_length() && layout.length <= j1939::most_transported;
  }

  /// The next frame of a broadcast, its announcement first, or none while its source has another. Returns
  /// when to go on.
  template <class Send>
  base::Time broadcast(Message& message, base::Time due, Send& send) {
    const auto& layout = message.played.topic->frames[0];
    const auto own = j1939::Identifier::decode(message.played.id);
    if (message.data.empty()) {
      base::Time& free = free_[own.source];
      if (free > due) return free;  // `announced` stays
      message.data.assign(layout.length, 0);
      fill(message, message.data, due);
      free = due + j1939::broadcast_time(layout.length);
    }
    const auto part = j1939::broadcast_frame(own, message.data, message.parts);
    const can::Frame frame{part.id, can::max_dlc, part.data, can::Format::extended};
    send(std::as_const(message.played), can::AnyFrame{frame}, due);
    if (++message.parts != j1939::broadcast_frames(layout.length)) return due + j1939::broadcast_distance;
    message.parts = 0;
    message.data.clear();
    ++message.sent;
    // After those that wait for their turn.
    do message.announced += distance(message);
    while (message.announced <= due + j1939::broadcast_distance);
    return message.announced;
  }

  [[nodiscard]] static can::AnyFrame content(const Message& message, base::Time now) noexcept {
    const auto& layout = message.played.topic->frames[0];
    can::AnyFrame frame;
    frame.id = message.played.id;
    frame.format = protocol::format_of(layout);
    frame.length = static_cast<std::uint8_t>(layout.length);
    const std::span<std::uint8_t> data{frame.data.data(), frame.length};
    if (layout.fd) {  // filled up with zeros to a length that there is
      frame.flags = can::fd_flags(layout.bit_rate_switch);
      frame.length = can::fd_length(can::fd_dlc(layout.length));
    }
    fill(message, data, now);
    return frame;
  }

  static void fill(const Message& message, std::span<std::uint8_t> data, base::Time now) noexcept {
    const auto& layout = message.played.topic->frames[0];
    // Selectors first, since they decide what else is there, and last, should a field lie over one.
    message.pages.put(message.sent, data);
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      const auto& field = layout.fields[i];
      if (!message.pages.chosen(i) && layout.has(field, data))
        protocol::put(data, field.position, message.motions[i].at(now));
    }
    message.pages.put(message.sent, data);
  }

  PlayOptions options_;
  LeftOut left_out_;
  std::vector<Message> messages_;
  std::priority_queue<Due, std::vector<Due>, std::greater<>> due_;
  std::array<base::Time, 256> free_{};  ///< of each source: when it has no broadcast any more
};

}  // namespace ocm::sim
