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

/// Whether what is on one is on the other; an empty name is any.
bool meet(std::string_view a, std::string_view b) noexcept {
  return a.empty() || b.empty() || a == b;
}

/// What has a name or a key, and where it is.
struct Owner {
  std::string name;
  std::string_view kind;  ///< "topic", "message"
  std::string bus;
};

/// Calls take(key, name, bus) for all that a model says on the bus.
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
             topic.name, topic.bus);
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
         message.name, message.bus);
  }
}

class Merger {
 public:
  Merger(Model& into, const std::string& place, std::vector<Problem>& problems)
      : into_(into), place_(place), problems_(problems) {
    each_key(into, [&](const Key& key, const std::string& name, const std::string& bus) {
      keys_.emplace(key, Owner{name, {}, bus});
    });
    for (const TopicModel& topic : into.topics)
      names_.emplace(topic.name, Owner{topic.name, "topic", topic.bus});
    for (const MessageModel& message : into.messages)
      names_.emplace(message.name, Owner{message.name, "message", message.bus});
  }

  void add(Model from) {
    rates(from);
    std::string_view told;  // a topic has many identifiers: one conflict is enough
    std::size_t conflicts = 0;
    each_key(from, [&](const Key& key, const std::string& name, const std::string& bus) {
      const Owner* const other = find(keys_, key, bus);
      if (other == nullptr || name == told) return;
      told = name;
      if (++conflicts > most_told) return;
      tell(name + " has the " + text_of(key) + " of " + other->name + " in " + into_.robot,
           "leave one of the files out, or name their interfaces: --spec can0=FILE");
    });
    add_attributes(from);
    const std::vector<std::uint8_t> boards = add_boards(from);
    std::size_t names = 0;
    for (TopicModel& topic : from.topics) {
      names += is_free(topic.name, topic.bus, names < most_told) ? 0 : 1;
      topic.board = boards[topic.board];
      into_.topics.push_back(std::move(topic));
    }
    into_.too_long.insert(into_.too_long.end(), from.too_long.begin(), from.too_long.end());
    for (MessageModel& message : from.messages) {
      names += is_free(message.name, message.bus, names < most_told) ? 0 : 1;
      if (message.board != protocol::no_board) message.board = boards[message.board];
      into_.messages.push_back(std::move(message));
    }
    const std::size_t more = conflicts + names - std::min(conflicts, most_told) - std::min(names, most_told);
    if (more != 0)
      tell(std::to_string(more) + " more conflicts with " + into_.robot,
           "is it the same file, or another version of it?");
  }

 private:
  /// So many of a kind are reported one by one.
  static constexpr std::size_t most_told = 3;

  void tell(std::string what, std::string remedy) {
    problems_.push_back({place_, std::move(what), std::move(remedy)});
  }
  /// Of one name the first counts.
  void add_attributes(Model& from) {
    const auto add = [](auto& to, auto& all, auto same) {
      for (auto& each : all)
        if (std::none_of(to.begin(), to.end(), [&](const auto& other) { return same(each, other); }))
          to.push_back(std::move(each));
    };
    add(into_.attributes, from.attributes, [](const auto& a, const auto& b) { return a.name == b.name; });
    add(into_.definitions, from.definitions,
        [](const auto& a, const auto& b) { return a.of == b.of && a.name == b.name; });
    into_.not_kept.insert(into_.not_kept.end(), from.not_kept.begin(), from.not_kept.end());
  }
  template <class Known>
  [[nodiscard]] static const Owner* find(const Known& known, const typename Known::key_type& key,
                                         std::string_view bus) {
    const auto [begin, end] = known.equal_range(key);
    for (auto at = begin; at != end; ++at)
      if (meet(at->second.bus, bus)) return &at->second;
    return nullptr;
  }
  void rates(Model& from) {
    for (BusModel& bus : from.buses) {
      const auto known = std::find_if(into_.buses.begin(), into_.buses.end(),
                                      [&](const BusModel& other) { return other.name == bus.name; });
      if (known == into_.buses.end()) {
        into_.buses.push_back(std::move(bus));
        continue;
      }
      rate(known->bit_rate, bus.bit_rate, "");
      rate(known->data_bit_rate, bus.data_bit_rate, " for data");
    }
    rate(into_.bit_rate, from.bit_rate, "");
    rate(into_.data_bit_rate, from.data_bit_rate, " for data");
  }
  void rate(std::uint32_t& into, std::uint32_t from, const std::string& what) {
    if (into == 0) into = from;
    if (from != 0 && from != into)
      tell("its bus has " + std::to_string(from) + " bit/s" + what + ", that of " + into_.robot + " " +
               std::to_string(into),
           "specs of one bus have one" + (what.empty() ? std::string{} : std::string{" data"}) + " bit rate");
  }
  bool is_free(const std::string& name, const std::string& bus, bool is_told) {
    const Owner* const other = find(names_, name, bus);
    if (other != nullptr && is_told)
      tell("a second " + name + ": " + into_.robot + " has a " + std::string{other->kind} + " of that name",
           "another name for one of them, or interfaces: --spec can0=FILE");
    return other == nullptr;
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
  std::multimap<Key, Owner> keys_;
  std::multimap<std::string, Owner> names_;
};

}  // namespace

void merge(Model& into, Model from, const std::string& place, std::vector<Problem>& problems) {
  Merger{into, place, problems}.add(std::move(from));
}

}  // namespace ocm::spec
