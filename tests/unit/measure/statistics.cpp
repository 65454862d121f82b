#include "ocm/measure/statistics.hpp"

#include <chrono>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

namespace measure_statistics_test {

using namespace std::chrono_literals;
using namespace ocm::measure;
using ocm::base::Time;

/// A bus of 500 kbit/s to put frames on, in candump's notation.
struct Recorded {
  BusStatistics statistics{amiro::catalogue, {500'000}};
  void put(ocm::base::Duration time, std::string_view frame) {
    const auto parsed = ocm::can::parse_frame(frame);
    REQUIRE(parsed);
    statistics.take({Time{time}, *parsed});
  }
  [[nodiscard]] static const TopicFigures* find(const BusFigures& figures, std::string_view name) {
    for (const auto& topic : figures.topics)
      if (topic.topic->name == name) return &topic;
    return nullptr;
  }
};

TEST_CASE("statistics: a topic asked for, by what it was sent at") {
  Recorded log;
  log.put(0ms, "108#01F40100");  // publish the gyroscope every 500 ms, priority high
  for (int i = 0; i < 5; ++i) log.put(1ms + i * 500ms, "508#3E001E00FCFF");
  log.put(2010ms, "208#00");  // stop
  log.put(9s, "205#02");      // once the magnetometer, which lets the log go on
  const auto figures = log.statistics.figures();
  const auto* gyroscope = Recorded::find(figures, "gyroscope");
  REQUIRE(gyroscope != nullptr);
  CHECK(gyroscope->timing.count == 5);
  CHECK(gyroscope->timing.rate_hz == 2.0);
  CHECK(gyroscope->timing.missing == 0);
  CHECK(gyroscope->by_priority == std::array<std::uint64_t, 4>{0, 5, 0, 0});
  CHECK(gyroscope->requests == 2);
  CHECK(gyroscope->bad_requests == 0);
  CHECK(figures.topics.size() == 2);
  CHECK(figures.counters.commands == 3);
  CHECK(figures.counters.frames == 8);
}

TEST_CASE("statistics: a request without a period asks for the topic's own") {
  auto topic = *amiro::catalogue.find("gyroscope");
  topic.period = {20, ocm::protocol::PeriodUnit::milliseconds};
  auto catalogue = amiro::catalogue;
  catalogue.topics = {&topic, 1};
  BusStatistics statistics{catalogue, {500'000}};
  statistics.take({Time{0ms}, {0x208, 1, {1}}});
  statistics.take({Time{1ms}, {0x608, 6, {}}});
  const auto figures = statistics.figures(Time{1001ms});
  REQUIRE(figures.topics.size() == 1);
  CHECK(figures.topics[0].timing.period_ns == 20'000'000);
  CHECK(figures.topics[0].timing.period_from == PeriodFrom::request);
  CHECK(figures.topics[0].timing.missing == 49);
}

TEST_CASE("statistics: faults by topic") {
  Recorded log;
  log.put(0ms, "608#00");        // wrong length
  log.put(1ms, "208#03");        // no such mode
  log.put(2ms, "605#01000000");  // magnetometer x, y, z
  log.put(3ms, "655#01000000");  // of no topic
  log.put(4ms, "1F334455#01");   // nor is this
  log.put(5ms, "655#");          // the same stranger
  log.put(6ms, "608#R");         // a remote frame
  log.put(6500us, "00000655#");  // as wide as it is, another stranger
  log.put(7ms, "20000040#0000000000000000");
  log.put(8ms, "20000004#0001000000000000");  // lost in the controller
  const auto figures = log.statistics.figures();
  const auto* gyroscope = Recorded::find(figures, "gyroscope");
  REQUIRE(gyroscope != nullptr);
  CHECK(gyroscope->wrong_dlc == 1);
  CHECK(gyroscope->requests == 1);
  CHECK(gyroscope->bad_requests == 1);
  CHECK(gyroscope->timing.count == 0);
  CHECK(figures.counters.unknown == 4);
  CHECK(figures.counters.remote == 1);
  CHECK(figures.counters.errors == 2);
  CHECK(figures.overflows == 1);
  REQUIRE(figures.strangers.size() == 3);
  CHECK(figures.strangers[0].id == 0x655);
  CHECK(figures.strangers[0].count == 2);
  CHECK(figures.strangers[1].format == ocm::can::Format::extended);
}

/// What a board says of its last refusal: of `topic`, its `count`-th.
void refuse(Recorded& log, ocm::base::Duration time, std::uint8_t topic, std::uint16_t count) {
  const amiro::DiWheelDriveRefusal refusal{topic, amiro::DiWheelDriveRefusal::Reason::not_schedulable, count,
                                           0};
  log.statistics.take({Time{time}, ocm::protocol::sample_frame(refusal, ocm::protocol::Priority::low, 0)});
}

TEST_CASE("statistics: what a board refuses was never asked") {
  Recorded log;
  log.put(0ms, "205#01010000");  // the magnetometer every ms, which its board refuses
  refuse(log, 3ms, 0x05, 1);
  const auto never = log.statistics.figures(Time{9s});
  const auto* magnetometer = Recorded::find(never, "magnetometer");
  REQUIRE(magnetometer != nullptr);
  CHECK(magnetometer->timing.missing == 0);
  CHECK(magnetometer->timing.period_ns == 0);
  CHECK_FALSE(magnetometer->timing.due);
  CHECK(magnetometer->requests == 1);
  CHECK(magnetometer->refused == 1);
}

TEST_CASE("statistics: a stream goes on as it was before a refused request") {
  Recorded log, undisturbed;
  for (Recorded* each : {&log, &undisturbed}) {
    refuse(*each, 0ms, 0x05, 5);     // long ago
    each->put(0ms, "208#01640000");  // publish the gyroscope every 100 ms
    for (int i = 1; i <= 20; ++i) {
      each->put(i * 100ms, "608#3E001E00FCFF");
      if (each == &log && i == 10) {
        log.put(1050ms, "208#01010000");  // every ms, which is refused
        log.put(1060ms, "208#07");        // no such mode, which asks for nothing
      }
      // The refusal of both comes with the next sample of its topic: the stream has gone on meanwhile.
      if (each == &log && i == 12) refuse(log, 1250ms, 0x08, 7);
      if (each == &undisturbed && i == 12) refuse(undisturbed, 1250ms, 0x05, 6);
    }
  }
  const auto figures = log.statistics.figures(Time{2100ms});
  const auto as_before = undisturbed.statistics.figures(Time{2100ms});
  const Timing& timing = Recorded::find(figures, "gyroscope")->timing;
  CHECK(timing.period_ns == 100'000'000);
  CHECK(timing.count == 20);
  CHECK(timing.distances == Recorded::find(as_before, "gyroscope")->timing.distances);
  CHECK(timing.missing == Recorded::find(as_before, "gyroscope")->timing.missing);
  CHECK(timing.missing == 0);
  CHECK(timing.due);
  CHECK(Recorded::find(figures, "gyroscope")->refused == 2);
  CHECK(Recorded::find(figures, "gyroscope")->bad_requests == 1);
}

TEST_CASE("statistics: other refusals undo no request") {
  Recorded log;
  refuse(log, 0ms, 0x05, 7);
  log.put(10ms, "208#01640000");
  log.put(11ms, "205#01640000");
  refuse(log, 20ms, 0x05, 7);  // published again: it is old
  log.put(30ms, "602#00000000");
  refuse(log, 40ms, 0x01, 8);  // of the motors
  log.put(6s, "608#3E001E00FCFF");
  refuse(log, 6010ms, 0x08, 9);  // far behind the request
  const auto figures = log.statistics.figures(Time{6010ms});
  CHECK(Recorded::find(figures, "magnetometer")->timing.due);
  CHECK(Recorded::find(figures, "gyroscope")->timing.period_ns == 100'000'000);
  for (const auto& topic : figures.topics) CHECK(topic.refused == 0);
  // A refusal that was asked for may be of the time before the log.
  Recorded asked;
  asked.put(0ms, "208#01640000");
  asked.put(1ms, "219#02");  // no refusal topic
  ocm::can::Frame once = ocm::protocol::once(amiro::DiWheelDriveRefusal::id);
  asked.statistics.take({Time{2ms}, once});
  refuse(asked, 3ms, 0x08, 3);
  CHECK(Recorded::find(asked.statistics.figures(Time{1s}), "gyroscope")->timing.due);
}

TEST_CASE("statistics: of frames with a wrong length the first is named") {
  Recorded log;
  log.put(0ms, "608#0001");
  log.put(1ms, "605#00");
  const auto first = log.statistics.figures().wrong_length;
  REQUIRE(first);
  CHECK(first->id == 0x608);
  CHECK(first->length == 2);
  CHECK(first->right == 6);
}

TEST_CASE("statistics: incomplete samples are their topic's") {
  Recorded log;
  // The spec's magnetometer has three frames.
  const auto* topic = amiro::catalogue.find("magnetometer");
  REQUIRE(topic->frames.size() == 3);
  const auto put = [&](int ms, std::size_t frame) {
    ocm::can::Frame part;
    part.id = ocm::protocol::Identifier{ocm::protocol::Direction::sensor, ocm::protocol::Priority::low,
                                        topic->frames[frame].id}
                  .encode();
    part.dlc = topic->frames[frame].dlc();
    log.statistics.take({Time{ms * 1ms}, part});
  };
  for (std::size_t frame = 0; frame < 3; ++frame) put(static_cast<int>(frame), frame);
  put(100, 0);
  put(102, 2);  // 1 was lost
  for (std::size_t frame = 0; frame < 3; ++frame) put(200 + static_cast<int>(frame), frame);
  const auto figures = log.statistics.figures();
  REQUIRE(figures.topics.size() == 1);
  CHECK(figures.topics[0].incomplete == 1);
  CHECK(figures.topics[0].timing.count == 2);
  CHECK(figures.topics[0].timing.mean_ns == 200e6);  // from last frame to last frame
  CHECK(figures.topics[0].by_priority[3] == 2);
}

TEST_CASE("statistics: the load is of exact bits, and its parts make the whole") {
  Recorded log;
  const std::string_view frames[] = {"508#3E001E00FCFF", "208#01F40100",         "655#FF",
                                     "508#000000000000", "201#0000000000000000", "608#00"};
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < std::size(frames); ++i) {
    log.put(static_cast<int>(i) * 1ms, frames[i]);
    if (i != 0) bits += ocm::can::frame_bits(*ocm::can::parse_frame(frames[i])) + 3;
  }
  const auto figures = log.statistics.figures();
  CHECK(figures.load == Approx(static_cast<double>(bits) / 500'000 / 0.005));
  CHECK(figures.rate_hz == Approx(1000.0));
  double parts = figures.request_load + figures.stranger_load;
  for (const auto& topic : figures.topics) parts += topic.load;
  CHECK(parts == Approx(figures.load));
  CHECK(Recorded::find(figures, "motors")->timing.count == 1);
  CHECK(figures.worst_load > 0);
  CHECK(figures.worst_until == Time{5ms});
}

TEST_CASE("statistics: the bits of each frame are in one part of the load, that of what it is") {
  struct Row {
    std::string_view frame;
    enum Part { request, stranger, topic, none } part;
  };
  const Row rows[] = {{"208#01F40100", Row::request},
                      {"208#07", Row::request},
                      {"655#FF", Row::stranger},
                      {"1F334455#0102", Row::stranger},
                      {"608#R", Row::stranger},
                      {"608#00", Row::stranger},
                      {"201#00", Row::stranger},
                      {"508#000000000000", Row::topic},
                      {"201#0000000000000000", Row::topic},
                      {"605#00000000", Row::topic},
                      {"20000004#0001000000000000", Row::none}};
  for (const Row& row : rows) {
    CAPTURE(row.frame);
    Recorded log;
    log.put(0ms, "655#");  // the first is in no load
    log.put(1ms, row.frame);
    const auto figures = log.statistics.figures(Time{10ms});
    const auto frame = *ocm::can::parse_frame(row.frame);
    const double load =
        row.part == Row::none ? 0 : static_cast<double>(ocm::can::frame_bits(frame) + 3) / 500'000 / 0.010;
    CHECK(figures.load == Approx(load));
    CHECK(figures.request_load == Approx(row.part == Row::request ? load : 0));
    CHECK(figures.stranger_load == Approx(row.part == Row::stranger ? load : 0));
    double topics = 0;
    for (const auto& topic : figures.topics) topics += topic.load;
    CHECK(topics == Approx(row.part == Row::topic ? load : 0));
  }
}

TEST_CASE("statistics: first and last are the earliest and the latest, in whatever order frames come") {
  Recorded log;
  for (const auto time : {5s, 9s, 2s, 7s}) log.put(time, "655#");
  CHECK(log.statistics.any());
  CHECK(log.statistics.figures().first == Time{2s});
  CHECK(log.statistics.figures().last == Time{9s});
  CHECK(log.statistics.figures().rate_hz == Approx(3.0 / 7));
  CHECK(log.statistics.figures().bit_rates.nominal == 500'000);
  CHECK(log.statistics.figures().bit_rates.data == 0);
  CHECK(log.statistics.counters().frames == 4);
  // The worst 100 ms as a share of them, and the frame with which they ended.
  Recorded burst;
  std::uint64_t bits = 0;
  for (int i = 0; i < 10; ++i) {
    burst.put(1s + i * 1ms, "655#FF");
    bits += ocm::can::frame_bits(*ocm::can::parse_frame("655#FF")) + 3;
  }
  CHECK(burst.statistics.figures().worst_load == Approx(static_cast<double>(bits) / 500'000 / 0.1));
  CHECK(burst.statistics.figures().worst_until == Time{1s + 9ms});
}

TEST_CASE("statistics: nothing came") {
  const BusStatistics statistics{amiro::catalogue, {500'000}};
  CHECK_FALSE(statistics.any());
  const auto figures = statistics.figures();
  CHECK(figures.topics.empty());
  CHECK(figures.load == 0.0);
  CHECK(figures.rate_hz == 0.0);
}

TEST_CASE("statistics: figures that nothing was put into are zero") {
  const Stranger stranger{};
  CHECK(stranger.id == 0);
  CHECK(stranger.count == 0);
  const WrongLength wrong{};
  CHECK(wrong.id == 0);
  CHECK(wrong.length == 0);
  CHECK(wrong.right == 0);
  const TopicFigures topic{};
  for (const std::uint64_t number :
       {topic.incomplete, topic.wrong_dlc, topic.requests, topic.bad_requests, topic.refused})
    CHECK(number == 0);
  CHECK(topic.load == 0.0);
  const BusFigures bus{};
  for (const std::uint64_t number : {bus.fd_frames, bus.not_in_load, bus.overflows}) CHECK(number == 0);
  for (const double number : {bus.rate_hz, bus.load, bus.request_load, bus.stranger_load, bus.worst_load})
    CHECK(number == 0.0);
  CHECK(bus.span() == 0s);
}

TEST_CASE("statistics: reports of the controller have no rate, and a single frame has none") {
  Recorded errors;
  for (const auto time : {5s, 6s}) errors.put(time, "20000040#0000000000000000");
  CHECK(errors.statistics.figures().span() == 1s);
  CHECK(errors.statistics.figures().rate_hz == 0.0);
  CHECK(errors.statistics.figures().worst_load == 0.0);
  CHECK(errors.statistics.figures().worst_until == Time{5s});  // no frame is in the load
  Recorded log;
  log.put(5s, "608#3E001E00FCFF");
  const auto one = log.statistics.figures();
  CHECK(one.rate_hz == 0.0);
  CHECK(one.load == 0.0);
  REQUIRE(one.topics.size() == 1);
  CHECK(one.topics[0].timing.count == 1);
  log.put(5s + 1ns, "655#");
  CHECK(log.statistics.figures().rate_hz == 1e9);
}

TEST_CASE("statistics: they are as of the last frame, or of later, never of before") {
  BusStatistics statistics{amiro::catalogue, {500'000}};
  for (const auto time : {1s, 2s, 3s})
    statistics.take({Time{time}, *ocm::can::parse_frame("608#3E001E00FCFF")});
  CHECK(statistics.figures().last == Time{3s});
  CHECK(statistics.figures(Time{2s}).last == Time{3s});
  CHECK(statistics.figures(Time{2s}).span() == 2s);
  CHECK(statistics.figures(Time{5s}).last == Time{5s});
  CHECK(statistics.figures(Time{5s}).rate_hz == 0.5);  // two distances in 4 s
}

ocm::can::AnyFrame fd_frame(std::uint32_t id, std::size_t length, bool switches) {
  ocm::can::AnyFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(length);
  frame.flags = ocm::can::frame_flag::fd;
  if (switches) frame.flags |= ocm::can::frame_flag::bit_rate_switch;
  return frame;
}

TEST_CASE("statistics: CAN FD is in the load by both bit rates, if they are known") {
  const auto frame = fd_frame(0x123, 64, true);
  const auto bits = ocm::can::fd_frame_bits(frame);
  for (const std::uint32_t data_rate : {0U, 500'000U, 2'000'000U}) {
    BusStatistics statistics{amiro::catalogue, {500'000, data_rate}};
    for (int i = 0; i <= 100; ++i) statistics.take_fd(frame, Time{1s + i * 10ms});
    const auto figures = statistics.figures();
    CHECK(figures.fd_frames == 101);
    CHECK(figures.not_in_load == (data_rate == 0 ? 101 : 0));
    CHECK(figures.rate_hz == Approx(100));
    const double seconds =
        data_rate == 0 ? 0 : (bits.nominal + 3) / 500e3 + bits.data / static_cast<double>(data_rate);
    CHECK(figures.load == Approx(100 * seconds).epsilon(1e-3));
    CHECK(figures.stranger_load == figures.load);
    CHECK((figures.worst_until == figures.first) == (data_rate == 0));
    REQUIRE(figures.strangers.size() == 1);
    CHECK(figures.strangers[0].count == 101);
  }
  BusStatistics statistics{amiro::catalogue, {500'000}};
  for (int i = 0; i <= 1; ++i) statistics.take_fd(fd_frame(0x123, 64, false), Time{i * 10ms});
  CHECK(statistics.figures().not_in_load == 0);  // at one bit rate from end to end
  CHECK(statistics.figures().load == Approx((bits.nominal + bits.data + 3) / 5000.0).epsilon(5e-3));
}

TEST_CASE("statistics: CAN FD is counted apart, strangers only so many") {
  BusStatistics statistics{amiro::catalogue, {500'000}};
  statistics.take_fd(fd_frame(0, 0, true), Time{1s});
  for (std::uint32_t id = 0; id < 100; ++id)
    statistics.take({Time{2s}, {id, 0, {}, ocm::can::Format::extended}});
  const auto figures = statistics.figures();
  CHECK(figures.fd_frames == 1);
  CHECK(figures.span() == 1s);
  CHECK(figures.strangers.size() == BusStatistics::most_strangers);
  CHECK(figures.strangers.size() == 32);
  CHECK(figures.counters.unknown == 100);
}

/// A message of CAN FD, one of eight bytes, and one of J1939 that goes in packets.
ocm::protocol::FrameLayout layout_of(std::uint16_t length, ocm::protocol::Address address, bool fd) {
  ocm::protocol::FrameLayout layout;
  layout.length = length;
  layout.address = address;
  layout.fd = fd;
  return layout;
}
struct Messages {
  using By = ocm::protocol::Address::By;
  const ocm::protocol::FrameLayout frames[3] = {layout_of(16, {By::identifier, false, 0x123}, true),
                                                layout_of(8, {By::identifier, false, 0x124}, false),
                                                layout_of(20, {By::pgn, true, 0x18FEECFE}, false)};
  ocm::protocol::Topic topics[3];
  ocm::protocol::Catalogue catalogue{"truck", 500'000, {}, topics};
  Messages() {
    constexpr std::string_view names[] = {"fast", "plain", "VI"};
    for (std::size_t i = 0; i < 3; ++i) {
      topics[i].name = names[i];
      topics[i].kind = ocm::protocol::Kind::message;
      topics[i].board = ocm::protocol::no_board;
      topics[i].frames = {&frames[i], 1};
    }
    topics[1].cycle = 100ms;
    topics[1].bus = "can1";
  }
};

TEST_CASE("statistics: messages of CAN FD are samples, and those of another length are not") {
  const Messages messages;
  BusStatistics statistics{messages.catalogue, {500'000, 2'000'000}};
  CHECK(statistics.take_fd(fd_frame(0x124, 8, true), Time{0ms}).topic != nullptr);
  for (int i = 1; i <= 4; ++i) statistics.take_fd(fd_frame(0x123, 16, true), Time{i * 10ms});
  statistics.take_fd(fd_frame(0x123, 12, true), Time{50ms});
  statistics.take_fd(fd_frame(0x125, 12, true), Time{60ms});
  const auto figures = statistics.figures(Time{100ms});
  REQUIRE(figures.topics.size() == 2);
  const TopicFigures& fast = figures.topics[0];
  CHECK(fast.topic->name == "fast");
  CHECK(fast.timing.count == 4);
  CHECK(fast.timing.mean_ns == 10e6);
  CHECK(fast.wrong_dlc == 1);
  CHECK(fast.by_priority == std::array<std::uint64_t, 4>{});  // a message has none of a topic's
  const auto load = [](std::size_t length) {
    const auto bits = ocm::measure::bits_on_bus(fd_frame(0x123, length, true), {500'000, 2'000'000});
    return static_cast<double>(*bits) / 500'000 / 0.1;
  };
  CHECK(fast.load == Approx(4 * load(16)));
  CHECK(figures.stranger_load == Approx(2 * load(12)).epsilon(0.02));
  REQUIRE(figures.wrong_length);
  CHECK(figures.wrong_length->id == 0x123);
  CHECK(figures.wrong_length->length == 12);
  CHECK(figures.wrong_length->right == 16);
  REQUIRE(figures.strangers.size() == 1);
  CHECK(figures.strangers[0].id == 0x125);
  CHECK(figures.fd_frames == 7);
}

TEST_CASE("statistics: a message has the period that is stated, on the bus that it is on") {
  const Messages messages;
  for (const std::string_view interface : {"", "can1", "can0"}) {
    BusStatistics statistics{messages.catalogue, {500'000}, ocm::client::Transport::as_frames, interface};
    for (int i = 0; i < 3; ++i)
      statistics.take({Time{i * 500ms}, *ocm::can::parse_frame("124#0000000000000000")});
    const auto figures = statistics.figures();
    if (interface == "can0") {
      CHECK(figures.topics.empty());
      REQUIRE(figures.strangers.size() == 1);
      CHECK(figures.strangers[0].count == 3);
      continue;
    }
    REQUIRE(figures.topics.size() == 1);
    CHECK(figures.topics[0].timing.period_ns == 100'000'000);
    CHECK(figures.topics[0].timing.period_from == PeriodFrom::spec);
    CHECK(figures.topics[0].timing.missing == 8);
    CHECK(figures.strangers.empty());
  }
}

TEST_CASE("statistics: a message in packets is one sample, and only its last packet is in its load") {
  const Messages messages;
  const std::string_view packets[] = {"1CECFF00#20110003FFECFE00", "1CEBFF00#0101020304050607",
                                      "1CEBFF00#0208090A0B0C0D0E", "1CEBFF00#030F1011FFFFFFFF"};
  BusStatistics together{messages.catalogue, {500'000}, ocm::client::Transport::together};
  BusStatistics apart{messages.catalogue, {500'000}};
  for (std::size_t i = 0; i < 4; ++i) {
    const ocm::can::Received received{Time{static_cast<int>(i) * 1ms}, *ocm::can::parse_frame(packets[i])};
    together.take(received);
    apart.take(received);
  }
  const auto figures = together.figures();
  REQUIRE(figures.topics.size() == 1);
  CHECK(figures.topics[0].timing.count == 1);
  CHECK(figures.transport.complete == 1);
  CHECK(figures.strangers.empty());
  CHECK(figures.stranger_load == 0.0);
  const auto bits = ocm::can::frame_bits(*ocm::can::parse_frame(packets[3])) + 3;
  CHECK(figures.topics[0].load == Approx(bits / 500'000.0 / 0.003));
  CHECK(apart.figures().topics.empty());
  CHECK(apart.figures().transport.complete == 0);
  CHECK(apart.figures().strangers.size() == 2);
  // Of an unknown group: named by the group's identifier.
  BusStatistics unknown{messages.catalogue, {500'000}, ocm::client::Transport::together};
  unknown.take({Time{0ms}, *ocm::can::parse_frame("1CECFF00#20110003FFEDFE00")});
  for (std::size_t i = 1; i < 4; ++i)
    unknown.take({Time{static_cast<int>(i) * 1ms}, *ocm::can::parse_frame(packets[i])});
  REQUIRE(unknown.figures().strangers.size() == 1);
  CHECK(unknown.figures().strangers[0].id == 0x1CFEED00);
  CHECK(unknown.figures().strangers[0].format == ocm::can::Format::extended);
}

}  // namespace measure_statistics_test
