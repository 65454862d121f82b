#include "sim/messages/player.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/sample.hpp"

#include "generator/spec/spec.hpp"

namespace sim_messages_player_test {

using namespace ocm;
using namespace std::chrono_literals;

struct Sent {
  std::string name;
  can::AnyFrame frame;
  base::Time due;
  const protocol::Topic* topic;
};

const spec::Spec& bus() {
  static const auto loaded = spec::load(std::filesystem::path{OCM_BUS_DBC});
  REQUIRE(loaded.spec != nullptr);
  return *loaded.spec;
}

std::vector<Sent> played(sim::PlayOptions options, base::Duration lasting = 60s) {
  sim::MessagePlayer player{bus().catalogue(), options};
  std::vector<Sent> sent;
  player.advance(base::Time{lasting}, [&](const auto& message, const can::AnyFrame& frame, base::Time due) {
    sent.push_back({std::string{message.topic->name}, frame, due, message.topic});
  });
  return sent;
}

TEST_CASE("Every message with a period keeps it exactly for a minute") {
  std::map<std::string, base::Time> last;
  std::map<std::string, int> count;
  for (const auto& each : played({.seed = 3})) {
    if (each.name == "Parts" && each.frame.data[0] != 32) continue;  // a packet
    if (count[each.name]++ != 0) CHECK(each.due - last[each.name] == each.topic->cycle);
    last[each.name] = each.due;
  }
  CHECK(count.size() == 6);
  CHECK(std::abs(count["Fast"] - 6000) <= 1);
  CHECK(std::abs(count["Pages"] - 1200) <= 1);
  CHECK(std::abs(count["Group"] - 3000) <= 1);
  CHECK(std::abs(count["Parts"] - 60) <= 1);
}

TEST_CASE("One seed plays the same, two seeds do not") {
  const auto frames = [](std::uint64_t seed) {
    std::vector<can::AnyFrame> all;
    for (const auto& each : played({.seed = seed}, 5s)) all.push_back(each.frame);
    return all;
  };
  CHECK(frames(1) == frames(1));
  CHECK(frames(1) != frames(2));
}

TEST_CASE("What is due is sent, and nothing before it is") {
  sim::MessagePlayer player{bus().catalogue(), {.seed = 3}};
  for (int i = 0; i < 200; ++i) {
    const base::Time next = player.next_event();
    int sent = 0;
    const auto count = [&](const auto&, const can::AnyFrame&, base::Time due) {
      CHECK(due == next);
      ++sent;
    };
    player.advance(next - 1ns, count);
    CHECK(sent == 0);
    player.advance(next, count);
    CHECK(sent > 0);
    CHECK(player.next_event() > next);
  }
}

TEST_CASE("Values stay within their ranges, move, and every page is there") {
  std::map<std::string, std::set<std::int64_t>> seen;
  for (const auto& each : played({.seed = 5}))
    for (const auto& field : each.topic->frames[0].fields) {
      if (each.name == "Parts") continue;  // its frames are no message
      if (!each.topic->frames[0].has(field, each.frame.bytes())) continue;
      const auto raw = field.raw(each.frame.bytes());
      seen[std::string{field.name}].insert(raw);
      if (!sim::has_stated_range(field)) continue;
      CHECK(field.value(raw) >= field.min.as_double());
      CHECK(field.value(raw) <= field.max.as_double());
    }
  CHECK(seen["Page"] == std::set<std::int64_t>{0, 7, 9});
  CHECK(seen["Sub"] == std::set<std::int64_t>{1, 2});
  CHECK(seen["Gear"] == std::set<std::int64_t>{-1, 0, 5});
  CHECK(seen["On"] == std::set<std::int64_t>{0, 1});
  for (const char* name : {"A", "B", "C", "D", "Speed", "Torque", "Free", "Level", "Value", "End"}) {
    CAPTURE(name);
    CHECK(seen[name].size() > 3);
  }
}

TEST_CASE("What is not played is listed by cause; without a period only on request") {
  const sim::MessagePlayer player{bus().catalogue(), {}};
  REQUIRE(player.left_out().without_period.size() == 1);
  CHECK(player.left_out().without_period[0]->name == "Button");
  CHECK(player.left_out().too_long.empty());
  CHECK(player.left_out().no_fd.empty());
  const sim::MessagePlayer classic{bus().catalogue(), {.fd = false}};
  REQUIRE(classic.left_out().no_fd.size() == 2);
  CHECK(classic.left_out().no_fd[0]->name == "Long");
  CHECK(classic.left_out().no_fd[1]->name == "Odd");
  CHECK(classic.size() + 2 == player.size());
  int buttons = 0;
  for (const auto& each : played({.seed = 1, .sporadic = 1s})) buttons += each.name == "Button";
  CHECK(buttons > 50);
  CHECK(buttons < 70);
}

TEST_CASE("What other nodes send is the same without a node") {
  const auto& boards = bus().catalogue().boards;
  for (std::uint8_t node = 0; node < boards.size(); ++node) {
    CAPTURE(boards[node].name);
    std::vector<Sent> others;
    for (auto& each : played({.seed = 4, .sporadic = 1s}, 5s))
      if (each.topic->board != node) others.push_back(std::move(each));
    const auto left = played({.seed = 4, .sporadic = 1s, .without = {node}}, 5s);
    REQUIRE(left.size() == others.size());
    std::size_t same = 0;
    for (std::size_t i = 0; i < left.size(); ++i)
      same += left[i].frame == others[i].frame && left[i].due == others[i].due ? 1U : 0U;
    CHECK(same == left.size());
    const sim::MessagePlayer player{bus().catalogue(), {.sporadic = 1s, .without = {node}}};
    for (const auto* topic : player.left_out().switched_off) CHECK(topic->board == node);
    CHECK(player.size() + player.left_out().switched_off.size() ==
          sim::MessagePlayer{bus().catalogue(), {.sporadic = 1s}}.size());
  }
}

TEST_CASE("Messages of CAN FD are frames of CAN FD, of a length that there is") {
  std::map<std::string, int> count;
  for (const auto& each : played({.seed = 1}, 2s)) {
    CHECK(can::validate(each.frame).ok());
    const bool fd = each.name == "Long" || each.name == "Odd";
    CHECK(each.frame.is_fd() == fd);
    if (!fd) continue;
    ++count[each.name];
    namespace flag = can::frame_flag;
    CHECK(each.frame.flags ==
          (each.name == "Long" ? flag::fd | flag::bit_rate_switch : flag::fd));  // CANFD_BRS
    CHECK(each.frame.length == (each.name == "Long" ? 32 : 12));
    if (each.name == "Odd") CHECK((each.frame.data[10] | each.frame.data[11]) == 0);
  }
  CHECK(count["Long"] == 20);
  CHECK(count["Odd"] == 20);
}

TEST_CASE("A parameter group is sent from an address that a node may have") {
  for (const auto& each : played({.seed = 1}, 1s))
    if (each.name == "Group") CHECK(each.frame.id == 0x0CF00480);
}

TEST_CASE("A message of several frames is broadcast, and is put together again") {
  client::Receiver receiver{bus().catalogue(), client::Transport::together};
  std::vector<base::Time> parts;
  std::vector<base::Duration> distances;
  std::optional<base::Time> last;
  std::set<std::int64_t> values;
  for (const auto& each : played({.seed = 4}, 30s)) {
    if (each.name != "Parts") continue;
    CHECK(each.frame.format == can::Format::extended);
    CHECK(each.frame.length == 8);
    if (each.frame.data[0] != 32) distances.push_back(each.due - *last);
    last = each.due;
    const auto reception = receiver.take(each.frame.view(), each.due);
    if (reception.meaning != client::Meaning::sample) continue;
    parts.push_back(each.due);
    REQUIRE(reception.sample.bytes.size() == 20);
    values.insert(each.topic->frames[0].fields[0].raw(reception.sample.bytes));
  }
  CHECK(parts.size() >= 29);
  CHECK(values.size() > 3);
  CHECK(std::set<base::Duration>(distances.begin(), distances.end()) == std::set<base::Duration>{50ms});
  const auto counters = receiver.transport_counters(*last);
  CHECK(counters.lost() == 0);
  CHECK(counters.complete == parts.size());
}

TEST_CASE("A selector and what it selects may end with the message, and beyond it they make no page") {
  const std::array<protocol::SelectorRange, 1> one{{{1, 1}}}, some{{{3, 5}}};
  struct Found {
    std::size_t pages;
    bool chosen;
    bool operator==(const Found&) const = default;
  };
  const auto found = [&](std::uint16_t selector, std::uint16_t first, std::uint16_t second,
                         std::uint16_t length) {
    std::array<protocol::Field, 3> fields{};
    fields[0].position = {selector, 4};
    fields[1].position = {first, 8};
    fields[2].position = {second, 8};
    fields[1].selector = fields[2].selector = 0;
    fields[1].selected = one;
    fields[2].selected = some;
    protocol::FrameLayout layout;
    layout.length = length;
    layout.fields = fields;
    const sim::Pages pages{layout};
    return Found{pages.size(), pages.chosen(0)};
  };
  CHECK(found(0, 8, 16, 3) == Found{3, true});  // 1, 3, 5
  CHECK(found(0, 8, 16, 2) == Found{1, true});  // 1
  CHECK(found(0, 16, 8, 2) == Found{2, true});  // 3, 5
  CHECK(found(0, 8, 16, 1) == Found{1, false});
  CHECK(found(20, 0, 8, 3) == Found{3, true});
  CHECK(found(20, 0, 8, 2) == Found{1, false});
}

TEST_CASE("Of the values that select a field those make a page that its selector can have") {
  const auto pages = [](protocol::SelectorRange range) {
    const std::array<protocol::SelectorRange, 1> selected{range};
    std::array<protocol::Field, 2> fields{};
    fields[0].position = {0, 4};
    fields[1].position = {8, 8};
    fields[1].selector = 0;
    fields[1].selected = selected;
    protocol::FrameLayout layout;
    layout.length = 2;
    layout.fields = fields;
    const sim::Pages made{layout};
    return made.chosen(0) ? made.size() : 0;
  };
  CHECK(pages({12, 15}) == 2);
  CHECK(pages({12, 20}) == 2);  // 12 and 15
  CHECK(pages({15, 20}) == 1);
  CHECK(pages({16, 20}) == 0);
  CHECK(pages({16, 16}) == 0);
}

TEST_CASE("Each page comes once in a round, the lowest value first, of a range its ends") {
  const std::array<protocol::SelectorRange, 3> first{{{5, 5}, {3, 5}, {14, 14}}};
  const std::array<protocol::SelectorRange, 2> second{{{0, 0}, {14, 20}}};  // no frame holds 20
  std::array<protocol::Field, 3> fields{};
  fields[0].position = {4, 4};
  fields[1].position = fields[2].position = {8, 8};
  fields[1].selector = fields[2].selector = 0;
  fields[1].selected = first;
  fields[2].selected = second;
  protocol::FrameLayout layout;
  layout.length = 2;
  layout.fields = fields;
  const sim::Pages pages{layout};
  const std::vector<unsigned> values{0, 3, 5, 14, 15};
  REQUIRE(pages.size() == values.size());
  for (std::size_t number = 0; number < 2 * values.size(); ++number) {
    std::array<std::uint8_t, 2> data{0x0A, 0xFF};
    pages.put(number, data);
    CHECK(data == std::array<std::uint8_t, 2>{
                      static_cast<std::uint8_t>(values[number % values.size()] << 4 | 0x0A), 0xFF});
  }
}

/// A message without a field, of a catalogue that a test makes.
protocol::Topic message_of(const protocol::FrameLayout& layout, std::string_view name) {
  protocol::Topic topic;
  topic.name = name;
  topic.board = protocol::no_board;
  topic.kind = protocol::Kind::message;
  topic.frames = {&layout, 1};
  return topic;
}

TEST_CASE("Sensors, actuators and what has no frame are no messages, and change none") {
  protocol::FrameLayout layout;
  layout.length = 1;
  layout.address = {protocol::Address::By::identifier, false, 0x100};
  std::vector<protocol::Topic> topics;
  for (const std::string_view name : {"Sensor", "Actuator", "Empty", "Message"}) {
    topics.push_back(message_of(layout, name));
    topics.back().cycle = 1s;
  }
  topics[0].kind = protocol::Kind::sensor;
  topics[1].kind = protocol::Kind::actuator;
  topics[2].frames = {};
  const protocol::Catalogue all{"car", 500'000, {}, topics};
  const protocol::Catalogue alone{"car", 500'000, {}, std::span{topics}.last(1)};
  const sim::MessagePlayer player{all, {.seed = 3}};
  CHECK(player.size() == 1);
  CHECK(player.next_event() == sim::MessagePlayer{alone, {.seed = 3}}.next_event());
}

TEST_CASE("A message without a period comes at half to one and a half of what is asked for, at random") {
  protocol::FrameLayout layout;
  layout.length = 1;
  layout.address = {protocol::Address::By::identifier, false, 0x100};
  const auto distances = [&layout](base::Duration shortest) {
    std::vector<protocol::Topic> topics{message_of(layout, "M")};
    topics[0].shortest_period = shortest;
    const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
    sim::MessagePlayer player{catalogue, {.seed = 3, .sporadic = 101ms}};
    std::vector<base::Duration> all;
    std::optional<base::Time> last;
    CHECK(player.next_event() < base::Time{101ms});
    player.advance(base::Time{100s}, [&](const auto&, const can::AnyFrame&, base::Time due) {
      if (last) all.push_back(due - *last);
      last = due;
    });
    CHECK(player.next_event() > base::Time{100s});
    std::sort(all.begin(), all.end());
    return all;
  };
  const auto free = distances({});
  CHECK(free.size() > 900);
  CHECK(free.front() >= 50'500us);
  CHECK(free.front() < 51ms);
  CHECK(free[free.size() / 2] > 97ms);
  CHECK(free[free.size() / 2] < 105ms);
  CHECK(free.back() > 151ms);
  CHECK(free.back() < 151'500us);
  const auto held = distances(120ms);
  CHECK(held.front() == 120ms);
  CHECK(held.back() > 151ms);
  CHECK(sim::MessagePlayer{protocol::Catalogue{"none", 500'000, {}, {}}}.next_event() == base::Time::max());
}

TEST_CASE("What is longer than a frame, or than a broadcast, is not played") {
  struct Case {
    protocol::Address::By by;
    bool fd;
    std::uint16_t most;
  };
  for (const Case& each :
       {Case{protocol::Address::By::identifier, false, 8}, Case{protocol::Address::By::identifier, true, 64},
        Case{protocol::Address::By::pgn, false, 1785}}) {
    CAPTURE(each.most);
    const bool pgn = each.by == protocol::Address::By::pgn;
    for (const int more : {0, 1}) {
      protocol::FrameLayout layout;
      layout.length = static_cast<decltype(layout.length)>(each.most + more);
      layout.fd = each.fd;
      layout.address = {each.by, pgn, pgn ? 0x18FEEC01U : 0x100U};
      std::vector<protocol::Topic> topics{message_of(layout, "M")};
      topics[0].cycle = 1s;
      const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
      const sim::MessagePlayer player{catalogue};
      CHECK(player.size() == (more == 0 ? 1U : 0U));
      CHECK(player.left_out().too_long.size() == (more == 0 ? 0U : 1U));
      CHECK(player.sent_by(protocol::no_board) == player.size());
      CHECK(player.sent_by(0) == 0);
    }
  }
}

TEST_CASE("A J1939 message of no address has one of 128 to 247, another one for each node") {
  const auto source_of = [](std::uint8_t board, std::uint32_t id) {
    protocol::FrameLayout layout;
    layout.length = 8;
    layout.address = {protocol::Address::By::pgn, true, id};
    protocol::Topic topic = message_of(layout, "M");
    topic.board = board;
    return sim::played_identifier(topic);
  };
  CHECK(source_of(0, 0x0CF004FE) == 0x0CF00480);
  CHECK(source_of(119, 0x0CF004FE) == 0x0CF004F7);
  CHECK(source_of(120, 0x0CF004FE) == 0x0CF00480);
  CHECK(source_of(3, 0x0CF00421) == 0x0CF00421);
}

TEST_CASE("Every machine sends the same bits, whatever the build and however often it is asked") {
  // FNV-1a of all that is sent; to be changed only where something else is to be sent.
  const auto fingerprint = [](base::Duration step) {
    std::uint64_t hash = 14'695'981'039'346'656'037U;
    const auto add = [&hash](std::uint64_t number) {
      for (int i = 0; i < 8; ++i) hash = (hash ^ (number >> 8 * i & 0xFF)) * 1'099'511'628'211U;
    };
    sim::MessagePlayer player{bus().catalogue(), {.seed = 7, .sporadic = 1s}};
    for (base::Duration at = step; at <= 60s; at += step)
      player.advance(base::Time{at}, [&](const auto&, const can::AnyFrame& frame, base::Time due) {
        add(frame.id);
        add(static_cast<std::uint64_t>(due.time_since_epoch().count()));
        for (const std::uint8_t byte : frame.bytes()) add(byte);
      });
    return hash;
  };
  const std::uint64_t all = fingerprint(60s);
  CHECK(all == 0x536B0898EEDD08E1);
  CHECK(fingerprint(100ms) == all);
}

TEST_CASE("A source broadcasts one message at a time, however short their periods are") {
  // Of one node: 31 packets and 3 packets, each every 100 ms.
  const auto loaded = spec::parse(
      "BU_: A\nBO_ 2566834176 Long: 217 A\n SG_ L : 1728|8@1+ (1,0) [0|0] \"\" A\n"
      "BO_ 2566834432 Short: 20 A\n SG_ S : 152|8@1+ (1,0) [0|0] \"\" A\n"
      "BA_DEF_ \"ProtocolType\" STRING ;\nBA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 1000;\n"
      "BA_DEF_DEF_ \"GenMsgCycleTime\" 100;\nBA_ \"ProtocolType\" \"J1939\";\n",
      "x.dbc");
  REQUIRE(loaded.spec != nullptr);
  sim::MessagePlayer player{loaded.spec->catalogue(), {.seed = 2}};
  client::Receiver receiver{loaded.spec->catalogue(), client::Transport::together};
  std::map<std::string_view, int> whole;
  player.advance(base::Time{20s}, [&](const auto&, const can::AnyFrame& frame, base::Time due) {
    const auto reception = receiver.take(frame.view(), due);
    if (reception.meaning == client::Meaning::sample) ++whole[reception.topic->name];
  });
  CHECK(receiver.transport_counters(base::Time{20s}).lost() == 0);
  CHECK(whole["Long"] >= 10);
  CHECK(whole["Short"] >= 10);
}

}  // namespace sim_messages_player_test
