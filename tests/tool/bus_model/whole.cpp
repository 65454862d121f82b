// All that a model says of a bus, word for word, while each kind of frame comes.
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/bus_model/models.hpp"
#include "cli/bus_model/playing.hpp"
#include "tool/bus_model/bus.hpp"
#include "tool/golden.hpp"

namespace top_model_whole_test {

using namespace ocm;
using namespace ocm::test;
using cli::bus_model::FieldKey;
using cli::bus_model::Model;
using cli::bus_model::Models;

std::string shown(std::optional<base::Duration> time) {
  return time ? fmt::format("{}ms", *time / 1ms) : std::string{"-"};
}

std::string text_of(const Model& model, base::Duration at, bool all) {
  std::string text = fmt::format("--- at {} ms\n", at / 1ms);
  for (const auto& row : model.rows(morning + at, all)) {
    text += fmt::format(
        "{} {}{}: count {}, frames {}, incomplete {}, wrong length {}, faults {}, rate {:.2f} Hz, jitter "
        "{:.0f} ns",
        row.number, row.name, row.topic == nullptr ? " (unknown)" : "", row.count, row.frames, row.incomplete,
        row.wrong_length, row.faults, row.recent.rate_hz, row.recent.jitter_ns);
    text += fmt::format(", share {}, age {}, unchanged {}, period {}, health {}, bytes",
                        row.share ? fmt::format("{:.5f}", *row.share) : "-", shown(row.age),
                        shown(row.unchanged), shown(row.period), static_cast<int>(row.health));
    for (const auto byte : row.newest.bytes) text += fmt::format(" {:02X}", byte);
    text += row.has_bytes() ? "\n" : ", none to be shown\n";
  }
  const auto sum = model.summary(morning + at);
  text += fmt::format(
      "load {} {:.5f}, worst {:.5f}, {:.2f} Hz, {} frames, {} errors, {} overflows, {} lost, {} incomplete, "
      "{} of wrong length, {} unknown, ",
      sum.load_known ? "known" : "not known", sum.load, sum.worst_load, sum.rate_hz, sum.frames, sum.errors,
      sum.overflows, sum.lost, sum.incomplete, sum.wrong_length, sum.unknown);
  text += fmt::format("{} not in the load, {} transported, {} not, {} not shown, controller {}",
                      sum.not_in_load, sum.transport, sum.transport_lost, sum.not_shown,
                      sum.controller ? std::string{can::name(*sum.controller)} : "-");
  if (sum.error_counters)
    text += fmt::format(", counters {} {}", sum.error_counters->transmit, sum.error_counters->receive);
  return text + "\n";
}

TEST_CASE("bus model: all that is said of a bus is as it was") {
  Model model{amiro::catalogue, 500'000};
  std::string text = text_of(model, 0ms, false);
  const FieldKey z{3, 0, 2}, velocity{0, 0, 0}, pose_y{0, 1, 1};
  for (const auto& key : {z, velocity, pose_y}) CHECK(model.follow(key));
  const auto tick = [&](base::Duration at) {
    model.tick();
    text += text_of(model, at, false);
  };
  model.take(entry(0ms, 0x208, {0x01, 0x64, 0, 0}));  // every 100 ms
  model.take(entry(1ms, 0x203, {0x01, 0x0A, 0, 0}));  // every 10 ms
  for (int i = 0; i < 12; ++i) {
    const auto at = 10ms + i * 100ms;
    if (i != 7) model.take(entry(at + i * 1ms, 0x608, {i, 0, 0, 1, 2 * i, 0}));
    model.take(entry(at + 20ms, 0x602, {i, i, 0, 0, 0, 0, 0, 0}));
    if (i % 3 != 2) model.take(entry(at + 21ms, 0x603, {0, 0, 0, 9, i, 0, 0, 0}));
    if (i % 4 == 0) tick(at + 50ms);
  }
  model.take(entry(1300ms, 0x201, {0x10, 0x27, 0, 0, 0, 0, 0, 0}));
  model.take(entry(1310ms, 0x201, {0x10, 0x27, 0, 0, 0, 0, 0, 0}));
  model.take(entry(1320ms, 0x201, {0x10, 0x27, 0}));
  model.take(entry(1330ms, 0x204, {0x07, 0x64, 0, 0}));  // no such mode
  model.take(entry(1340ms, 0x605, {1, 2, 3, 4}));
  model.take(entry(1350ms, 0x605, {1, 2, 3}));
  model.take(entry(1360ms, 0x7F0, {1}));
  model.take(entry(1370ms, 0x7F0, {1}));
  model.take(entry(1380ms, 0x7F0, {1, 2}));
  model.take(entry(1390ms, 0x18FF0102, {9, 9}, can::Format::extended));
  model.take(entry(1400ms, 0x605, {}, can::Format::base_remote));
  can::AnyFrame fd;
  fd.id = 0x123;
  fd.length = 12;
  fd.flags = can::frame_flag::fd | can::frame_flag::bit_rate_switch;
  model.take(log::Entry{morning + 1410ms, fd});
  tick(1450ms);
  namespace classes = can::error_class;
  namespace controller = can::controller_error;
  model.take(entry(1500ms, classes::controller | classes::counters,
                   {0, controller::tx_passive, 0, 0, 0, 0, 130, 7}, can::Format::error));
  model.take(
      entry(1510ms, classes::controller, {0, controller::rx_overflow, 0, 0, 0, 0, 0, 0}, can::Format::error));
  tick(1520ms);
  model.lost(3);
  model.controller_is(can::ControllerState::warning, {});
  model.take(entry(1530ms, 0x208, {0x02}));  // is stopped
  tick(2300ms);
  text += text_of(model, 5s, true);
  // The clock is set back by some, then by more than a second.
  model.take(entry(1400ms, 0x602, {1, 0, 0, 0, 0, 0, 0, 0}));
  CHECK(model.newest() == morning + 1530ms);
  model.take(entry(200ms, 0x603, {1, 0, 0, 0, 0, 0, 0, 0}));
  CHECK(model.newest() == morning + 200ms);
  tick(300ms);
  for (const auto& key : {z, velocity, pose_y}) {
    text += "history";
    for (const double value : model.history(key)) text += fmt::format(" {:.6g}", value);
    text += "\n";
  }
  const auto newest = model.newest_of(3);
  REQUIRE(newest);
  text += fmt::format("newest {} at {}\n", newest->topic->name, shown(newest->time - morning));
  CHECK_FALSE(model.newest_of(2));
  is_as_in("tests/tool/bus_model/golden/model.txt", text);
}

TEST_CASE("bus model: a period that was only seen is no reason to be late; one that is asked for is") {
  // Of 5 ms: late only once 20 ms would be.
  Model fast{amiro::catalogue, 500'000};
  fast.take(entry(0ms, 0x208, {0x01, 0x05, 0, 0}));
  fast.take(entry(5ms, 0x608, {0, 0, 0, 0, 0, 0}));
  const auto health = [](const Model& model, base::Duration at) {
    return static_cast<int>(model.rows(morning + at, false)[0].health);
  };
  CHECK(health(fast, 35ms) == 0);
  CHECK(health(fast, 36ms) == 1);
  CHECK(health(fast, 65ms) == 1);
  CHECK(health(fast, 66ms) == 2);
}

TEST_CASE("bus model: a period that was only seen is missed when it is ten times over") {
  Model model{amiro::catalogue, 500'000};
  for (int i = 0; i < 20; ++i) model.take(entry(i * 70ms, 0x608, {i, 0, 0, 0, 0, 0}));
  const auto health = [&](base::Duration behind) {
    return model.rows(morning + 1330ms + behind, false)[0].health;
  };
  CHECK(model.rows(morning + 1330ms, false)[0].period == 70ms);
  CHECK(health(700ms) == cli::bus_model::Health::fine);
  CHECK(health(701ms) == cli::bus_model::Health::missing);
}

TEST_CASE("bus models: one a bus, each of which has a value a quarter of a second") {
  Models models{amiro::catalogue, 250'000, 2'000'000};
  log::Interfaces interfaces;
  const auto left = interfaces.number("left"), right = interfaces.number("right");
  const auto take = [&](base::Duration at, std::uint16_t interface, int value) {
    auto one = entry(at, 0x608, {value, 0, 0, 0, 0, 0});
    one.interface = interface;
    models.take(one, interfaces);
  };
  take(0ms, left, 4);
  take(0ms, right, 8);
  models.lost("right", 7);
  const auto buses = models.buses();
  REQUIRE(buses.size() == 2);
  CHECK(buses[0].name == "left");
  CHECK(buses[1].name == "right");
  CHECK(buses[0].model->summary(morning).lost == 0);
  CHECK(buses[1].model->summary(morning).lost == 7);
  CHECK(&models.of("left") == buses[0].model);
  CHECK(&models.of("right") == buses[1].model);
  CHECK(models.of("left").summary(morning).load_known);
  Model same{amiro::catalogue, 250'000, 2'000'000};  // at these bit rates
  same.take(entry(0ms, 0x608, {4, 0, 0, 0, 0, 0}));
  CHECK(same.summary(morning + 100ms).load > 0);
  CHECK(models.of("left").summary(morning + 100ms).load == same.summary(morning + 100ms).load);
  const FieldKey x{3, 0, 0};
  CHECK(models.follow(0, {x}));
  CHECK_FALSE(models.follow(0, {x}));
  CHECK(models.follow(1, {x, {3, 0, 1}}));
  const auto values = [&](std::size_t bus) { return models.buses()[bus].model->history(x); };
  models.until(morning + 249ms);
  CHECK(values(0).empty());
  models.until(morning + 250ms);
  REQUIRE(values(0).size() == 1);
  CHECK(values(0)[0] == Approx(4 * 0.0175));
  CHECK(values(1)[0] == Approx(8 * 0.0175));
  take(800ms, left, 12);  // what came before the ticks up to it is in them
  CHECK(values(0).size() == 3);
  CHECK(values(0)[2] == Approx(4 * 0.0175));
  models.until(morning + 1s);
  CHECK(values(0).size() == 4);
  CHECK(values(0)[3] == Approx(12 * 0.0175));
  // The clock is set back, then a minute ahead, then by more: one value, all, and one again.
  models.until(morning + 200ms);
  CHECK(values(0).size() == 5);
  models.until(morning + 60'200ms);
  CHECK(values(0).size() == Model::history_size);
  Models other{amiro::catalogue, 250'000};
  CHECK(other.of("a").follow(x));
  other.until(morning);
  other.until(morning + 60'001ms + 250ms);
  CHECK(other.of("a").history(x).size() == 2);
  Models third{amiro::catalogue, 250'000};
  CHECK(third.of("a").follow(x));
  third.until(morning);
  third.until(morning + 60s + 250ms);  // as much as a graph holds
  CHECK(third.of("a").history(x).size() == Model::history_size);
}

TEST_CASE("playing: as fast as is asked for, within bounds") {
  cli::bus_model::Playing playing;
  playing.at = 2s;
  CHECK(playing.after(100ms) == 2100ms);
  playing.faster(4);
  CHECK(playing.after(100ms) == 2400ms);
  playing.faster(0.125);
  CHECK(playing.after(100ms) == 2050ms);
  for (int i = 0; i < 20; ++i) playing.faster(2);
  CHECK(playing.speed == 1024);
  for (int i = 0; i < 40; ++i) playing.faster(0.5);
  CHECK(playing.speed == 1.0 / 64);
}

}  // namespace top_model_whole_test
