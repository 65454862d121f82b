#include "ocm/client/sample.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <span>
#include <sys/mman.h>
#include <unistd.h>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_sample_test {

using namespace ocm;
using namespace std::chrono_literals;
using client::Meaning;
using client::Receiver;

client::Reception take(Receiver& receiver, std::string_view text, base::Duration at = {}) {
  const auto frame = can::parse_frame(text);
  REQUIRE(frame.ok());
  return receiver.take({base::Time{at}, *frame});
}

TEST_CASE("what several receivers count is each number's sum") {
  const client::ReceiverCounters one{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  client::ReceiverCounters sum{100, 200, 300, 400, 500, 600, 700, 800, 900, 1000, 1100};
  sum += one;
  sum += one;
  CHECK(sum.frames == 102);
  CHECK(sum.samples == 204);
  CHECK(sum.commands == 306);
  CHECK(sum.unknown == 408);
  CHECK(sum.remote == 510);
  CHECK(sum.fd == 612);
  CHECK(sum.wrong_dlc == 714);
  CHECK(sum.incomplete == 816);
  CHECK(sum.errors == 918);
  CHECK(sum.transport == 1020);
  CHECK(sum.unselected == 1122);
  CHECK(one.faults() == 4 + 5 + 6 + 7 + 8 + 9);
}

TEST_CASE("a sample of one frame is complete at once") {
  Receiver receiver{amiro::catalogue};
  const auto reception = take(receiver, "608#3E001E00FCFF", 110'380ms);
  REQUIRE(reception.meaning == Meaning::sample);
  CHECK(reception.sample.priority == protocol::Priority::medium);
  CHECK(reception.sample.time == base::Time{110'380ms});
  const auto gyroscope = reception.sample.as<amiro::Gyroscope>();
  REQUIRE(gyroscope.ok());
  CHECK(*gyroscope == amiro::Gyroscope{62, 30, -4});  // thesis figure 6.3, which prints -4 as 65532
  CHECK(gyroscope->z_deg_per_s() == Approx(-0.07));
  CHECK(reception.sample.as<amiro::Accelerometer>().error == base::Error::unknown_topic);
}

TEST_CASE("a sample of several frames is complete with its last") {
  Receiver receiver{amiro::catalogue};
  CHECK(take(receiver, "605#00D20000").meaning == Meaning::part);
  CHECK(take(receiver, "606#00AAF1FF").meaning == Meaning::part);
  const auto last = take(receiver, "607#003E1700");
  REQUIRE(last.meaning == Meaning::sample);
  const auto magnetometer = last.sample.as<amiro::Magnetometer>();
  REQUIRE(magnetometer.ok());
  CHECK(magnetometer->encode(1) == can::parse_frame("606#00AAF1FF")->data);
  CHECK(receiver.counters().samples == 1);
}

TEST_CASE("a sample of 64 frames needs each of them") {
  std::array<protocol::FrameLayout, 64> layouts{};
  for (std::size_t i = 0; i < layouts.size(); ++i)
    layouts[i] = {"", protocol::TopicId{static_cast<std::uint8_t>(0x40 + i)}, 1, {}};
  protocol::Topic topic = *amiro::catalogue.find("magnetometer");
  topic.id = layouts[0].id;
  topic.frames = layouts;
  const protocol::Catalogue catalogue{"wide", 500'000, amiro::catalogue.boards, {&topic, 1}};
  Receiver receiver{catalogue};
  const auto samples = [&](std::size_t lost) {
    const std::uint64_t before = receiver.counters().samples;
    for (std::size_t i = 0; i < layouts.size(); ++i) {
      const auto id =
          protocol::Identifier{protocol::Direction::sensor, protocol::Priority::medium, layouts[i].id};
      if (i != lost) static_cast<void>(receiver.take({base::Time{}, can::Frame{id.encode(), 1, {}}}));
    }
    return receiver.counters().samples - before;
  };
  CHECK(samples(64) == 1);
  for (const std::size_t lost : {0U, 1U, 31U, 32U, 62U, 63U}) CHECK(samples(lost) == 0);
  CHECK(samples(64) == 1);
  CHECK(receiver.counters().incomplete == 6);
}

TEST_CASE("a sample that lacks frames is no struct") {
  Receiver receiver{amiro::catalogue};
  static_cast<void>(take(receiver, "605#00D20000"));
  static_cast<void>(take(receiver, "606#00AAF1FF"));
  auto sample = take(receiver, "607#003E1700").sample;
  REQUIRE(sample.as<amiro::Magnetometer>().ok());
  sample.bytes = sample.bytes.first(16);
  CHECK(sample.as<amiro::Magnetometer>().error == base::Error::unknown_topic);
  CHECK(client::Sample{}.as<amiro::Magnetometer>().error == base::Error::unknown_topic);
}

TEST_CASE("a lost frame makes one incomplete sample") {
  for (const int lost : {0, 1, 2}) {
    CAPTURE(lost);
    Receiver receiver{amiro::catalogue};
    const char* frames[] = {"605#01000000", "606#01000000", "607#01000000"};
    for (int sample = 0; sample < 3; ++sample)
      for (int i = 0; i < 3; ++i)
        if (sample != 1 || i != lost) static_cast<void>(take(receiver, frames[i]));
    CHECK(receiver.counters().samples == 2);
    CHECK(receiver.counters().incomplete == 1);
  }
}

TEST_CASE("a listener that joins in the middle of a sample has lost nothing") {
  Receiver receiver{amiro::catalogue};
  static_cast<void>(take(receiver, "607#01000000"));
  for (const char* text : {"605#01000000", "606#01000000", "607#01000000"})
    static_cast<void>(take(receiver, text));
  CHECK(receiver.counters().samples == 1);
  CHECK(receiver.counters().incomplete == 0);
}

TEST_CASE("a listener that joins in the middle of a sample misses what the next one lacks") {
  Receiver receiver{amiro::catalogue};
  for (const char* text : {"606#01000000", "607#01000000",                   // has begun before
                           "605#01000000", "606#01000000",                   // lacks its end
                           "605#01000000", "606#01000000", "607#01000000"})  // is whole
    static_cast<void>(take(receiver, text));
  CHECK(receiver.counters().samples == 1);
  CHECK(receiver.counters().incomplete == 1);
}

TEST_CASE("what a frame is") {
  Receiver receiver{amiro::catalogue};
  CHECK(take(receiver, "208#01F40100").meaning == Meaning::request);
  CHECK(take(receiver, "201#50C3000000000000").meaning == Meaning::set_point);
  CHECK(take(receiver, "23C#FFFFFF").topic->name == "led_1");
  CHECK(take(receiver, "608#3E001E").meaning == Meaning::wrong_dlc);
  CHECK(take(receiver, "6FF#").meaning == Meaning::unknown);
  CHECK(take(receiver, "606#R").meaning == Meaning::remote);
  CHECK(take(receiver, "605#R4").topic->name == "magnetometer");
  CHECK(take(receiver, "6FF#R").meaning == Meaning::unknown);
  CHECK(take(receiver, "00000608#3E001E00FCFF").meaning == Meaning::unknown);
  CHECK(take(receiver, "20000040#0000000000000000").meaning == Meaning::error);
  const auto& counters = receiver.counters();
  CHECK(counters.frames == 10);
  CHECK(counters.commands == 3);
  CHECK(counters.unknown == 3);
  CHECK(counters.remote == 2);
  CHECK(counters.wrong_dlc == 1);
  CHECK(counters.errors == 1);
  CHECK(counters.faults() == 7);
}

TEST_CASE("random loss: every whole sample comes out") {
  std::mt19937 random{7};
  Receiver receiver{amiro::catalogue};
  constexpr std::size_t count = amiro::ProximityRing::frames.size();
  std::uint64_t whole = 0;
  for (std::uint16_t n = 0; n < 2000; ++n) {
    amiro::ProximityRing ring;
    for (std::size_t i = 0; i < count; ++i) ring.sensor[i] = {n};
    bool lost = false;
    for (std::size_t i = 0; i < count; ++i) {
      if (random() % 20 == 0) {
        lost = true;
        continue;
      }
      const auto reception =
          receiver.take({base::Time{}, protocol::sample_frame(ring, protocol::Priority::low, i)});
      if (reception.meaning != Meaning::sample) continue;
      const auto received = reception.sample.as<amiro::ProximityRing>();
      REQUIRE(received.ok());
      CHECK(*received == ring);
    }
    whole += lost ? 0U : 1U;
  }
  CHECK(receiver.counters().samples == whole);
  CHECK(receiver.counters().incomplete > 0);
}

// --- J1939's transport protocol: a broadcast of 17 bytes [SAE J1939-21, figure C3] ---

constexpr protocol::Field byte_at(std::string_view name, std::uint16_t bit) {
  protocol::Field field;
  field.name = name;
  field.position = {bit, 8};
  return field;
}
constexpr protocol::Field group_fields[] = {byte_at("first", 0), byte_at("last", 128),
                                            byte_at("absent", 136)};
constexpr protocol::FrameLayout group_frames[] = {[] {
  protocol::FrameLayout layout;
  layout.length = 20;
  layout.fields = group_fields;
  layout.address = {protocol::Address::By::pgn, true, 0x18FEECFE};
  return layout;
}()};
constexpr protocol::Topic groups[] = {[] {
  protocol::Topic topic;
  topic.name = "VI";
  topic.kind = protocol::Kind::message;
  topic.frames = group_frames;
  return topic;
}()};
constexpr protocol::Catalogue truck{"truck", 250'000, {}, groups};

/// Two pages, of which the second cannot be read.
class LastPage {
 public:
  LastPage()
      : size_(static_cast<std::size_t>(::sysconf(_SC_PAGESIZE))),
        begin_(::mmap(nullptr, 2 * size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {
    REQUIRE(begin_ != MAP_FAILED);
    REQUIRE(::mprotect(static_cast<std::uint8_t*>(begin_) + size_, size_, PROT_NONE) == 0);
  }
  ~LastPage() { ::munmap(begin_, 2 * size_); }
  LastPage(const LastPage&) = delete;
  LastPage& operator=(const LastPage&) = delete;

  /// Its last bytes.
  [[nodiscard]] std::span<std::uint8_t> last(std::size_t count) const {
    return {static_cast<std::uint8_t*>(begin_) + size_ - count, count};
  }

 private:
  std::size_t size_;
  void* begin_;
};

constexpr std::string_view announcement = "1CECFF00#20110003FFECFE00";
constexpr std::string_view packets[] = {"1CEBFF00#0101020304050607", "1CEBFF00#0208090A0B0C0D0E",
                                        "1CEBFF00#030F1011FFFFFFFF"};

TEST_CASE("no more of a message is read than a frame of its size has") {
  const LastPage page;
  for (const std::size_t room : {std::size_t{8}, std::size_t{64}}) {
    const auto bytes = page.last(room);
    bytes[room - 1] = 0x2A;
    protocol::Field last = byte_at("last", static_cast<std::uint16_t>(8 * (room - 1)));
    protocol::FrameLayout layout;
    layout.length = static_cast<std::uint8_t>(room);
    layout.fields = {&last, 1};
    layout.address = {protocol::Address::By::identifier, true, 0x123};
    protocol::Topic topic;
    topic.name = "wide";
    topic.kind = protocol::Kind::message;
    topic.frames = {&layout, 1};
    const protocol::Catalogue catalogue{"car", 500'000, {}, {&topic, 1}};
    Receiver receiver{catalogue};
    const auto reception = receiver.take({0x123, can::Format::extended, room > 8, bytes}, base::Time{1ms});
    REQUIRE(reception.meaning == Meaning::sample);
    CHECK(last.raw(reception.sample.data(0)) == 0x2A);
  }
}

TEST_CASE("the packet that completes a message is the sample") {
  Receiver receiver{truck, client::Transport::together};
  CHECK(take(receiver, announcement).meaning == Meaning::transport);
  CHECK(take(receiver, packets[0], 1ms).meaning == Meaning::transport);
  CHECK(receiver.transports_open() == 1);
  CHECK(take(receiver, packets[1], 2ms).meaning == Meaning::transport);
  const auto last = take(receiver, packets[2], 3ms);
  REQUIRE(last.meaning == Meaning::sample);
  REQUIRE(last.transported != nullptr);
  CHECK(last.transported->id == j1939::Identifier{7, 0xFEEC, 255, 0});
  CHECK(last.topic == &groups[0]);
  CHECK(last.sample.time == base::Time{3ms});
  const auto bytes = last.sample.data(0);
  REQUIRE(bytes.size() == 17);
  CHECK(group_fields[0].raw(bytes) == 0x01);
  CHECK(group_fields[1].raw(bytes) == 0x11);
  CHECK_FALSE(last.frame.layout().has(group_fields[2], bytes));  // byte 17, which did not come
  CHECK(receiver.counters().frames == 4);
  CHECK(receiver.counters().samples == 1);
  CHECK(receiver.counters().transport == 3);
  CHECK(receiver.counters().faults() == 0);
  CHECK(receiver.transports_open() == 0);
  CHECK(receiver.transport_counters(base::Time{3ms}).complete == 1);
}

TEST_CASE("a message in packets whose selector chooses nothing is counted, and a sample all the same") {
  const std::array chosen{protocol::SelectorRange{2, 2}};
  std::array<protocol::Field, 2> fields{byte_at("page", 0), byte_at("of_page_2", 8)};
  fields[1].selector = 0;
  fields[1].selected = chosen;
  protocol::FrameLayout layout = group_frames[0];
  layout.fields = fields;
  protocol::Topic topic = groups[0];
  topic.frames = {&layout, 1};
  const protocol::Catalogue paged{"paged", 250'000, {}, {&topic, 1}};
  Receiver receiver{paged, client::Transport::together};
  // Page 1, which the spec has not, and page 2.
  for (const std::string_view first : {"1CEBFF00#0101020304050607", "1CEBFF00#0102020304050607"}) {
    for (const std::string_view text : {announcement, first, packets[1]})
      static_cast<void>(take(receiver, text));
    CHECK(take(receiver, packets[2]).meaning == Meaning::sample);
    CHECK(receiver.counters().unselected == 1);
  }
  CHECK(receiver.counters().samples == 2);
}

TEST_CASE("a message of an unknown group is whole, and unknown") {
  Receiver receiver{truck, client::Transport::together};
  static_cast<void>(take(receiver, "1CECFF00#20110003FFEDFE00"));
  for (const auto packet : {packets[0], packets[1]}) static_cast<void>(take(receiver, packet));
  const auto last = take(receiver, packets[2]);
  CHECK(last.meaning == Meaning::unknown);
  REQUIRE(last.transported != nullptr);
  CHECK(last.transported->id.pgn == 0xFEED);
  CHECK(last.transported->data.size() == 17);
  CHECK(receiver.counters().unknown == 1);
}

TEST_CASE("what does not come to its end is counted by the time that is handed in") {
  Receiver receiver{truck, client::Transport::together};
  static_cast<void>(take(receiver, announcement));
  CHECK(receiver.transport_counters(base::Time{j1939::timeout::t1}).timed_out == 0);
  CHECK(receiver.transport_counters(base::Time{j1939::timeout::t1 + 1ns}).timed_out == 1);
  CHECK(receiver.transports_open() == 0);
}

TEST_CASE("messages of two buses do not mix") {
  Receiver receiver{truck, client::Transport::together};
  const auto on = [&](std::string_view text, std::uint16_t bus) {
    const auto frame = can::parse_frame(text);
    REQUIRE(frame.ok());
    return receiver.take(can::FrameView{*frame}, base::Time{}, bus).meaning;
  };
  for (const auto text : {announcement, packets[0], packets[1]})
    for (const std::uint16_t bus : {std::uint16_t{1}, std::uint16_t{2}})
      CHECK(on(text, bus) == Meaning::transport);
  CHECK(on(packets[2], 1) == Meaning::sample);
  CHECK(on(packets[2], 2) == Meaning::sample);
}

TEST_CASE("nothing is put together unless asked for, of frames of 11 bits, or without a parameter group") {
  Receiver as_frames{truck};
  Receiver robot{amiro::catalogue, client::Transport::together};
  for (const auto text : {announcement, packets[0], packets[1], packets[2]}) {
    CHECK(take(as_frames, text).meaning == Meaning::unknown);
    CHECK(take(robot, text).meaning == Meaning::unknown);
  }
  CHECK(as_frames.transport_counters({}).announced == 0);
  Receiver receiver{truck, client::Transport::together};
  CHECK(take(receiver, "400#20110003FFECFE00").meaning == Meaning::unknown);
  CHECK(take(receiver, "1CECFF00#R8").meaning == Meaning::unknown);
  CHECK(receiver.transports_open() == 0);
}

TEST_CASE("nothing is put together where no message has a parameter group, and of CAN FD neither") {
  protocol::FrameLayout layout;
  layout.length = 8;
  layout.address = {protocol::Address::By::identifier, true, 0x123};
  protocol::Topic topic;
  topic.name = "plain";
  topic.kind = protocol::Kind::message;
  topic.frames = {&layout, 1};
  const protocol::Catalogue car{"car", 500'000, {}, {&topic, 1}};
  Receiver plain{car, client::Transport::together};
  for (const auto text : {announcement, packets[0], packets[1], packets[2]})
    CHECK(take(plain, text).meaning == Meaning::unknown);
  CHECK(plain.counters().transport == 0);
  CHECK(plain.transports_open() == 0);
  CHECK(plain.transport_counters().announced == 0);

  Receiver receiver{truck, client::Transport::together};
  CHECK(take(receiver, "18FEED00#0102030405060708").meaning == Meaning::unknown);  // another group
  constexpr std::array<std::uint8_t, 64> bytes{32, 17, 0, 3, 0xFF, 0xEC, 0xFE, 0};
  const std::span<const std::uint8_t> all{bytes};
  CHECK(receiver.take({0x1CEC'FF00, can::Format::extended, true, all.first(8)}, base::Time{}).meaning ==
        Meaning::unknown);
  CHECK(receiver.transports_open() == 0);
  CHECK(receiver.counters().transport == 0);
  CHECK(receiver.counters().unknown == 1);
  CHECK(receiver.counters().fd == 1);
}

TEST_CASE("a catalogue may have the frames of the transport protocol themselves") {
  protocol::FrameLayout layout;
  layout.length = 8;
  layout.address = {protocol::Address::By::pgn, true, 0x1CEC'FFFE};
  std::array<protocol::Topic, 2> topics{groups[0], groups[0]};
  topics[1].name = "TPCM";
  topics[1].frames = {&layout, 1};
  const protocol::Catalogue both{"both", 250'000, {}, topics};
  Receiver receiver{both, client::Transport::together};
  const auto announced = take(receiver, announcement);
  CHECK(announced.meaning == Meaning::sample);
  CHECK(announced.topic == &topics[1]);
  CHECK(take(receiver, packets[0]).meaning == Meaning::transport);
  CHECK(take(receiver, packets[1]).meaning == Meaning::transport);
  const auto whole = take(receiver, packets[2]);
  CHECK(whole.meaning == Meaning::sample);
  CHECK(whole.topic == &topics[0]);
  CHECK(receiver.counters().samples == 2);
  CHECK(receiver.counters().transport == 2);
  CHECK(receiver.transport_counters().complete == 1);
}

TEST_CASE("a frame is of the message that is on its interface") {
  std::array<protocol::FrameLayout, 2> layouts{};
  std::array<protocol::Topic, 2> topics{};
  for (std::size_t i = 0; i < topics.size(); ++i) {
    layouts[i].length = 1;
    layouts[i].address = {protocol::Address::By::identifier, false, 0x123};
    topics[i].kind = protocol::Kind::message;
    topics[i].bus = i == 0 ? "can0" : "can1";
    topics[i].frames = {&layouts[i], 1};
  }
  const protocol::Catalogue car{"car", 500'000, {}, topics};
  Receiver receiver{car};
  CHECK(receiver.has_buses());
  receiver.on_interface(4, "can0");
  receiver.on_interface(2, "can1");
  const can::Frame frame{0x123, 1, {}};
  const auto on = [&](std::uint16_t bus) {
    return receiver.take(can::FrameView{frame}, base::Time{}, bus).topic;
  };
  CHECK(on(4) == &topics[0]);
  CHECK(on(2) == &topics[1]);
  receiver.on_interface(0, "can1");
  CHECK(receiver.take({base::Time{}, frame}).topic == &topics[1]);  // of the bus 0, if none is named
  CHECK_FALSE(Receiver{amiro::catalogue}.has_buses());
}

TEST_CASE("a message is no struct of a topic, whatever its number") {
  protocol::FrameLayout layout;
  layout.length = 8;
  layout.address = {protocol::Address::By::identifier, false, 0x123};
  protocol::Topic topic;
  topic.id = amiro::Gyroscope::id;
  topic.kind = protocol::Kind::message;
  topic.frames = {&layout, 1};
  const protocol::Catalogue car{"car", 500'000, {}, {&topic, 1}};
  Receiver receiver{car};
  const auto reception = take(receiver, "123#3E001E00FCFF0000");
  REQUIRE(reception.meaning == Meaning::sample);
  REQUIRE(reception.sample.bytes.size() == 8);
  CHECK(reception.sample.as<amiro::Gyroscope>().error == base::Error::unknown_topic);
}

}  // namespace client_sample_test
