#include "cli/bus_model/model.hpp"

#include <cmath>

#include <catch2/catch.hpp>

#include "ocm/protocol/message.hpp"
#include "ocm/topics/amiro.hpp"

#include "tool/bus_model/bus.hpp"

namespace top_model_test {

using namespace ocm::test;
using ocm::cli::bus_model::FieldKey;
using ocm::cli::bus_model::Health;
using ocm::cli::bus_model::Model;
using ocm::cli::bus_model::Row;
using ocm::protocol::Mode;
using ocm::protocol::Period;
using ocm::protocol::PeriodUnit;

constexpr Period every_100ms{100, PeriodUnit::milliseconds};

Row row_of(const Model& model, std::string_view name, ocm::base::Duration now) {
  for (const Row& row : model.rows(morning + now, true))
    if (row.name == name) return row;
  FAIL("no row " << name);
  return {};
}

TEST_CASE("top: a row a topic of which something came, all of them on request") {
  Model model{catalogue, 250'000};
  CHECK(model.rows(morning, false).empty());
  CHECK(model.rows(morning, true).size() == 4);
  CHECK_FALSE(model.newest());
  weigh(model, 0s, {-400, 7});
  const auto rows = model.rows(morning + 20ms, false);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].name == "scale");
  CHECK(rows[0].count == 1);
  CHECK(rows[0].age == 20ms);
  CHECK(rows[0].unchanged == 20ms);
  CHECK(rows[0].newest.as<Scale>().value == Scale{-400, 7});
  CHECK(model.newest() == morning);
}

// --- J1939: a broadcast of 17 bytes in three packets [SAE J1939-21, figure C3] ---

constexpr ocm::protocol::Field group_fields[] = {[] {
  ocm::protocol::Field field;
  field.name = "last";
  field.position = {128, 8};
  return field;
}()};
constexpr ocm::protocol::FrameLayout group_frames[] = {[] {
  ocm::protocol::FrameLayout layout;
  layout.length = 20;
  layout.fields = group_fields;
  layout.address = {ocm::protocol::Address::By::pgn, true, 0x18FEECFE};
  return layout;
}()};
constexpr ocm::protocol::Topic groups[] = {[] {
  ocm::protocol::Topic topic;
  topic.name = "VI";
  topic.kind = ocm::protocol::Kind::message;
  topic.frames = group_frames;
  return topic;
}()};
constexpr ocm::protocol::Catalogue truck{"truck", 250'000, {}, groups};

/// The announcement of a group, given by its middle byte, and its packets of these numbers.
void broadcast(Model& model, ocm::base::Duration at, int group, std::initializer_list<int> packets) {
  const auto extended = ocm::can::Format::extended;
  model.take(entry(at, 0x1CECFF00, {0x20, 17, 0, 3, 0xFF, group, 0xFE, 0}, extended));
  for (const int number : packets)
    model.take(entry(at + number * 50ms, 0x1CEBFF00, {number, 10 * number, 0, 7, 0, 0, 0, 0}, extended));
}

TEST_CASE("top: a message of several frames is one, whatever its frames are") {
  Model model{truck, 250'000};
  broadcast(model, 0ms, 0xEC, {1, 2});
  CHECK(model.rows(morning + 100ms, false).empty());
  broadcast(model, 1s, 0xEC, {1, 2, 3});
  broadcast(model, 2s, 0xEC, {1, 2, 3});
  const auto rows = model.rows(morning + 2200ms, false);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].name == "VI");
  CHECK(rows[0].count == 2);
  CHECK(rows[0].age == 50ms);
  const auto data = rows[0].newest.data(0);
  REQUIRE(data.size() == 17);
  CHECK(group_fields[0].raw(data) == 7);  // byte 16: the third of the third packet
  // Four frames of 8 bytes and 29 bits of identifier, in a second.
  REQUIRE(rows[0].share);
  CHECK(*rows[0].share > 4 * 131 / 250'000.0);
  CHECK(*rows[0].share < 4 * 160 / 250'000.0);
  const auto sum = model.summary(morning + 2200ms);
  CHECK(sum.transport == 2);
  CHECK(sum.transport_lost == 1);  // followed by the next before its end, or timed out
  CHECK(sum.unknown == 0);
}

TEST_CASE("top: a message of several frames that no spec has is a row by its identifier") {
  Model model{truck, 250'000};
  broadcast(model, 0ms, 0xED, {1, 2, 3});
  const auto rows = model.rows(morning + 200ms, false);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].name == "1CFEED00");
  CHECK(rows[0].newest.bytes.size() == 17);
}

TEST_CASE("top: rates are of now, counts of all") {
  Model model{catalogue, 250'000};
  for (int i = 0; i < 50; ++i) weigh(model, i * 100ms, {i, 0});
  for (int i = 0; i < 50; ++i) weigh(model, 5s + i * 20ms, {49, 0});
  const Row row = row_of(model, "scale", 6s);
  CHECK(row.count == 100);
  CHECK(row.recent.rate_hz == Approx(50));
  CHECK(row.recent.jitter_ns == Approx(0).margin(1));
  CHECK(row.age == 20ms);
  CHECK(row.unchanged == 1100ms);  // since 4900 ms
  // 50 samples in a second, of 4 and of 1 byte: about 95 and 65 bits.
  REQUIRE(row.share);
  CHECK(*row.share > 50 * (76 + 52) / 250'000.0);
  CHECK(*row.share < 50 * (95 + 65) / 250'000.0 * 1.1);
  const auto sum = model.summary(morning + 6s);
  CHECK(sum.frames == 200);
  CHECK(sum.rate_hz == Approx(100).epsilon(0.11));
  CHECK(sum.load == Approx(*row.share));
  CHECK(sum.load_known);
}

TEST_CASE("top: CAN FD is in the load at both bit rates, and counted where the second is not known") {
  using namespace ocm;
  using namespace std::chrono_literals;
  can::AnyFrame frame;
  frame.id = 0x7F0;
  frame.length = 64;
  frame.flags = can::frame_flag::fd | can::frame_flag::bit_rate_switch;
  const auto after = [&](std::uint32_t data_bit_rate) {
    Model model{catalogue, 250'000, data_bit_rate};
    for (int i = 0; i < 200; ++i) model.take(log::Entry{morning + i * 10ms, frame});
    return model.summary(morning + 2s);
  };
  const auto unknown = after(0), slow = after(250'000), fast = after(2'000'000);
  CHECK(unknown.not_in_load == 200);
  CHECK(unknown.load == 0.0);
  CHECK(slow.not_in_load == 0);
  const auto bits = can::fd_frame_bits(frame);
  CHECK(slow.load == Approx((bits.nominal + 3 + bits.data) * 100 / 250e3).epsilon(0.11));
  CHECK(fast.load == Approx((bits.nominal + 3 + bits.data / 8.0) * 100 / 250e3).epsilon(0.11));
}

TEST_CASE("top: without a bit rate nothing is said of the load") {
  Model model{catalogue, 0};
  weigh(model, 0s, {1, 0});
  CHECK_FALSE(row_of(model, "scale", 0s).share);
  CHECK_FALSE(model.summary(morning).load_known);
}

TEST_CASE("top: what was asked for and does not come is late, then missing; what was stopped is neither") {
  Model model{catalogue, 250'000};
  ask(model, 0s, Mode::publish, every_100ms);
  CHECK(row_of(model, "scale", 140ms).health == Health::fine);
  CHECK(row_of(model, "scale", 160ms).health == Health::late);
  CHECK(row_of(model, "scale", 310ms).health == Health::missing);
  CHECK(row_of(model, "scale", 310ms).period == 100ms);
  CHECK_FALSE(row_of(model, "scale", 310ms).age);
  for (int i = 1; i < 10; ++i) weigh(model, i * 100ms, {i, 0});
  CHECK(row_of(model, "scale", 1s).health == Health::fine);
  CHECK(row_of(model, "scale", 1060ms).health == Health::late);
  CHECK(row_of(model, "scale", 1960ms).faults == 10);
  ask(model, 1070ms, Mode::stop, every_100ms);
  CHECK(row_of(model, "scale", 9s).health == Health::fine);
  CHECK_FALSE(row_of(model, "scale", 9s).period);
}

TEST_CASE("top: what a board refuses is not due") {
  Model model{amiro::catalogue, 500'000};
  model.take({morning, *ocm::protocol::publish_every(amiro::Magnetometer::id, 1ms)});
  CHECK(row_of(model, "magnetometer", 90ms).health == Health::missing);
  const amiro::DiWheelDriveRefusal refusal{amiro::Magnetometer::id.value,
                                           amiro::DiWheelDriveRefusal::Reason::not_schedulable, 1, 0};
  model.take({morning + 100ms, ocm::protocol::sample_frame(refusal, ocm::protocol::Priority::low, 0)});
  const Row row = row_of(model, "magnetometer", 9s);
  CHECK(row.health == Health::fine);
  CHECK(row.faults == 0);
  CHECK_FALSE(row.period);
}

TEST_CASE("top: a new period is no jitter") {
  Model model{catalogue, 250'000};
  ask(model, 0s, Mode::publish, every_100ms);
  for (int i = 0; i < 5; ++i) weigh(model, i * 100ms, {i, 0});
  ask(model, 450ms, Mode::publish, {20, PeriodUnit::milliseconds});
  for (int i = 0; i < 5; ++i) weigh(model, 460ms + i * 20ms, {i, 0});
  CHECK(row_of(model, "scale", 560ms).recent.rate_hz == Approx(50));
  CHECK(row_of(model, "scale", 560ms).recent.jitter_ns == Approx(0).margin(1));
}

TEST_CASE("top: a set point is a sample of its actuator") {
  Model model{catalogue, 250'000};
  // lamp_2: command, low priority, 0x31.
  const auto id = ocm::protocol::Identifier{ocm::protocol::Direction::command, ocm::protocol::Priority::low,
                                            ocm::protocol::TopicId{0x31}};
  model.take(entry(0s, id.encode(), {42}));
  const Row row = row_of(model, "lamp_2", 0s);
  CHECK(row.count == 1);
  CHECK(row.newest.data(0)[0] == 42);
  CHECK(row.newest.data(0).size() == 1);
}

// --- an actuator of two frames ---

constexpr ocm::protocol::FrameLayout arm_frames[] = {{"upper", ocm::protocol::TopicId{0x40}, 1, lamp_fields},
                                                     {"lower", ocm::protocol::TopicId{0x41}, 2, lamp_fields}};
constexpr ocm::protocol::Topic arms[] = {[] {
  ocm::protocol::Topic topic;
  topic.name = "arm";
  topic.id = ocm::protocol::TopicId{0x40};
  topic.kind = ocm::protocol::Kind::actuator;
  topic.frames = arm_frames;
  return topic;
}()};
constexpr ocm::protocol::Catalogue digger{"digger", 250'000, boards, arms};

TEST_CASE("top: of a set point in two frames each has its place") {
  Model model{digger, 250'000};
  const auto take = [&model](ocm::base::Duration at, std::uint8_t id, std::initializer_list<int> bytes) {
    using namespace ocm::protocol;
    model.take(entry(at, Identifier{Direction::command, Priority::low, TopicId{id}}.encode(), bytes));
  };
  take(0ms, 0x40, {11});
  take(1ms, 0x41, {22, 33});
  Row row = row_of(model, "arm", 2ms);
  CHECK(row.count == 2);
  REQUIRE(row.newest.bytes.size() == 16);
  CHECK(row.newest.data(0)[0] == 11);
  CHECK(row.newest.data(1)[0] == 22);
  CHECK(row.newest.data(1)[1] == 33);
  take(3ms, 0x40, {44});
  row = row_of(model, "arm", 4ms);
  REQUIRE(row.newest.bytes.size() == 16);
  CHECK(row.newest.data(0)[0] == 44);
  CHECK(row.newest.data(1)[1] == 33);
}

TEST_CASE("top: an unknown identifier has a row; of too many the frames are counted") {
  Model model{catalogue, 250'000};
  model.take(entry(0s, 0x7FF, {1, 2}));
  model.take(entry(1ms, 0x7FF, {1, 3}, ocm::can::Format::extended));
  model.take(entry(2ms, 0x7FF, {1, 4}));
  const auto rows = model.rows(morning + 2ms, false);
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].name == "7FF");
  CHECK(rows[0].count == 2);
  CHECK(rows[0].newest.bytes[1] == 4);
  CHECK(rows[0].topic == nullptr);
  CHECK(rows[1].name == "000007FF");
  CHECK(model.summary(morning).unknown == 3);
  for (std::uint32_t id = 0; id < 2000; ++id)
    model.take(entry(3ms, 0x100'0000 + id, {}, ocm::can::Format::extended));
  CHECK(model.rows(morning + 3ms, false).size() == Model::most_unknown);
  CHECK(model.summary(morning).not_shown == 2000 - (Model::most_unknown - 2));
}

TEST_CASE("top: what is wrong is counted") {
  Model model{catalogue, 250'000};
  weigh(model, 0s, {1, 0});
  const auto high = [](int number) {
    return ocm::protocol::Identifier{ocm::protocol::Direction::sensor, ocm::protocol::Priority::high,
                                     ocm::protocol::TopicId{static_cast<std::uint8_t>(number)}}
        .encode();
  };
  model.take(entry(10ms, high(0x10), {1, 2, 3}));     // of three bytes
  model.take(entry(20ms, high(0x10), {0, 0, 0, 1}));  // its second frame does not come
  weigh(model, 30ms, {2, 0});
  model.take(entry(40ms, 0, {0, 0, 0, 0, 0, 0, 0, 0}, ocm::can::Format::error));
  model.lost(5);
  const auto sum = model.summary(morning + 40ms);
  CHECK(sum.errors == 1);
  CHECK(sum.wrong_length == 1);
  CHECK(sum.incomplete == 1);
  CHECK(sum.lost == 5);
  CHECK(row_of(model, "scale", 40ms).faults == 2);
}

TEST_CASE("top: the controller is as its driver says now; counters that it does not say stay") {
  using ocm::can::ControllerState;
  using ocm::can::ErrorCounters;
  Model model{catalogue, 250'000};
  CHECK_FALSE(model.summary(morning).controller);
  model.controller_is(ControllerState::passive, ErrorCounters{130, 5});
  CHECK(model.summary(morning).controller == ControllerState::passive);
  CHECK(model.summary(morning).error_counters == ErrorCounters{130, 5});
  model.controller_is(ControllerState::active, {});
  CHECK(model.summary(morning).controller == ControllerState::active);
  CHECK(model.summary(morning).error_counters == ErrorCounters{130, 5});
  CHECK(model.summary(morning).errors == 0);  // it is no error frame
}

TEST_CASE("top: a field that is followed has a value at each tick") {
  Model model{catalogue, 250'000};
  const FieldKey weight{0, 0, 0};
  CHECK(model.history(weight).empty());
  model.tick();
  CHECK(model.follow(weight));
  CHECK_FALSE(model.follow(weight));
  model.tick();
  weigh(model, 0s, {4, 0});
  model.tick();
  model.tick();
  const auto values = model.history(weight);
  REQUIRE(values.size() == 3);
  CHECK(std::isnan(values[0]));
  CHECK(values[1] == 101.0);  // 100 g and four quarters
  for (std::size_t i = 0; i < 2 * Model::history_size; ++i) model.tick();
  CHECK(model.history(weight).size() == Model::history_size);
}

TEST_CASE("top: a row of no spec has no field to follow") {
  Model model{catalogue, 250'000};
  model.take(entry(0ms, 0x7FF, {1}));
  const FieldKey first{catalogue.topics.size(), 0, 0};
  CHECK(model.follow(first));
  model.tick();
  REQUIRE(model.history(first).size() == 1);
  CHECK(std::isnan(model.history(first)[0]));
}

TEST_CASE("top: a clock that is set back an hour") {
  Model model{catalogue, 250'000};
  for (int i = 0; i < 20; ++i) weigh(model, 3600s + i * 100ms, {i, 0});
  for (int i = 0; i < 20; ++i) weigh(model, i * 100ms, {i, 0});
  const Row row = row_of(model, "scale", 1900ms);
  CHECK(row.age == 0ms);
  CHECK(row.recent.rate_hz == Approx(10));
  CHECK(model.newest() == morning + 1900ms);
}

}  // namespace top_model_test
