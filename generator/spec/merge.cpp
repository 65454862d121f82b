#include "generator/spec/merge.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "ocm/j1939/identifier.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::spec {
namespace {

/// What frames of one bus must not share: an identifier, or a parameter group.
struct Key {
  bool group = false;
  bool extended = false;
  std::uint32_t number = 0;
  friend auto operator<=>(const Key&, const Key&) = default;
};

std::string text_of(const Key& key) {
  static constexpr std::string_view digits = "0123456789ABCDEF";
  std::string hex;
  for (unsigned shift = key.extended ? 32 : 12; shift != 0; shift -= 4)
    hex += digits[key.number >> (shift - 4) & 0xF];
  return (key.group ? "parameter group " : "identifier ") + hex;
}

/// Calls take(key, name) for all that a model says on the bus.
template <class Take>
void each_key(const Model& model, Take take) {
  using protocol::Direction;
  for (const TopicModel& topic : model.topics) {
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const auto all_priorities = [&](Direction direction, unsigned id) {
      for (unsigned level = 0; level < protocol::priority_levels; ++level)
        take(Key{false, false,
                 protocol::Identifier{direction, static_cast<protocol::Priority>(level),
                                      protocol::TopicId{static_cast<std::uint8_t>(id)}}
                     .encode()},
             topic.name);
    };
    for (unsigned instance = 0; instance < topic.count; ++instance) {
      if (sensor) all_priorities(Direction::command, topic.id + instance);
      for (const FrameModel& frame : topic.frames)
        for (unsigned i = 0; i < frame.count; ++i)
          all_priorities(sensor ? Direction::sensor : Direction::command, frame.id + i + instance);
    }
  }
  for (const MessageModel& message : model.messages) {
    const bool group = message.address.by == protocol::Address::By::pgn;
    take(Key{group, message.address.extended,
             group ? j1939::pgn_of(message.address.number) : message.address.number},
         message.name);
  }
}

class Merger {
 public:
  Merger(Model& into, const std::string& place, std::vector<Problem>& problems)
      : into_(into), place_(place), problems_(problems) {
    each_key(into, [&](const Key& key, const std::string& name) { keys_.emplace(key, name); });
    for (const TopicModel& topic : into.topics) names_.emplace(topic.name, "topic");
    for (const MessageModel& message : into.messages) names_.emplace(message.name, "message");
  }

  void add(Model from) {
    rate(from);
    std::string_view told;  // a topic has many identifiers: one conflict is enough
    each_key(from, [&](const Key& key, const std::string& name) {
      const auto other = keys_.find(key);
      if (other == keys_.end() || name == told) return;
      told = name;
      tell(name + " has the " + text_of(key) + " of " + other->second + " in " + into_.robot,
           "leave one of the files out, or name their buses: --spec can0=FILE");
    });
    const std::vector<std::uint8_t> boards = add_boards(from);
    for (TopicModel& topic : from.topics) {
      claim(topic.name);
      topic.board = boards[topic.board];
      into_.topics.push_back(std::move(topic));
    }
    into_.too_long.insert(into_.too_long.end(), from.too_long.begin(), from.too_long.end());
    for (MessageModel& message : from.messages) {
      claim(message.name);
      if (message.board != protocol::no_board) message.board = boards[message.board];
      into_.messages.push_back(std::move(message));
    }
  }

 private:
  void tell(std::string what, std::string remedy) {
    problems_.push_back({place_, std::move(what), std::move(remedy)});
  }
  void rate(const Model& from) {
    if (into_.bit_rate == 0) into_.bit_rate = from.bit_rate;
    if (from.bit_rate != 0 && from.bit_rate != into_.bit_rate)
      tell("its bus has " + std::to_string(from.bit_rate) + " bit/s, that of " + into_.robot + " " +
               std::to_string(into_.bit_rate),
           "specs of one bus have one bit rate");
    if (into_.data_bit_rate == 0) into_.data_bit_rate = from.data_bit_rate;
    if (from.data_bit_rate != 0 && from.data_bit_rate != into_.data_bit_rate)
      tell("its bus has " + std::to_string(from.data_bit_rate) + " bit/s for data, that of " + into_.robot +
               " " + std::to_string(into_.data_bit_rate),
           "specs of one bus have one data bit rate");
  }
  void claim(const std::string& name) {
    const auto other = names_.find(name);
    if (other == names_.end()) return;
    tell("a second " + name + ": " + into_.robot + " has a " + std::string{other->second} + " of that name",
         "another name for one of them");
  }
  /// Where the boards of `from` are now.
  std::vector<std::uint8_t> add_boards(Model& from) {
    std::vector<std::uint8_t> places;
    for (BoardModel& board : from.boards) {
      const auto same = std::find_if(into_.boards.begin(), into_.boards.end(),
                                     [&](const BoardModel& other) { return other.name == board.name; });
      const auto place = static_cast<std::size_t>(same - into_.boards.begin());
      if (place >= protocol::no_board) {
        tell("more than 255 boards in all", "fewer files");
        places.push_back(protocol::no_board - 1);
        continue;
      }
      if (same == into_.boards.end()) into_.boards.push_back(std::move(board));
      places.push_back(static_cast<std::uint8_t>(place));
    }
    return places;
  }

  Model& into_;
  const std::string& place_;
  std::vector<Problem>& problems_;
  std::map<Key, std::string> keys_;
  std::map<std::string, std::string_view> names_;
};

}  // namespace

void merge(Model& into, Model from, const std::string& place, std::vector<Problem>& problems) {
  Merger{into, place, problems}.add(std::move(from));
}

}  // namespace ocm::spec
