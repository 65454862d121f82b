// What a spec says of when a message is sent, and what of it is in a set.
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "cli/analyse/set.hpp"

namespace tool_analyse_sent_messages_test {

using namespace ocm;
using namespace ocm::cli::analyse;
using namespace std::chrono_literals;

constexpr std::int64_t ms = 1'000'000;

/// Every 100 ms, and not sooner than 15 ms behind the one before.
spec::MessageModel message(std::string type = {}) {
  spec::MessageModel model;
  model.name = "Speed";
  model.address = {protocol::Address::By::identifier, false, 0x101};
  model.length = 8;
  model.period = 100ms;
  model.shortest_period = 15ms;
  model.send_type = std::move(type);
  return model;
}

struct Made {
  std::optional<BusEntry> entry;
  std::vector<LeftOut> left_out;
};
Made made(const spec::MessageModel& model, std::int64_t period = 0) {
  Made result;
  result.entry = entry_of(model, "Engine", period, result.left_out);
  return result;
}
std::vector<std::string_view> reasons(const Made& of) {
  std::vector<std::string_view> keys;
  for (const LeftOut& each : of.left_out) keys.push_back(key_of(each.reason));
  return keys;
}
using Reasons = std::vector<std::string_view>;

TEST_CASE("sent messages: names of send types that mean events, however they are written", "[shared]") {
  for (const char* type : {"spontaneous", "Event", "TRIGGERED", "OnChange", "on_change", "OnWrite",
                           "Sporadic", "on request", "OnDemand", "CyclicAndSpontaneous", "CE", "c+e"}) {
    CAPTURE(type);
    const Made of = made(message(type));
    REQUIRE(of.entry);
    CHECK(of.entry->sporadic);
    CHECK(of.entry->period == 15 * ms);
    CHECK(of.left_out.empty());
  }
  for (const char* type : {"", "Cyclic", "NoMsgSendType", "FixedPeriodic", "ace", "C"}) {
    CAPTURE(type);
    const Made of = made(message(type));
    REQUIRE(of.entry);
    CHECK_FALSE(of.entry->sporadic);
    CHECK(of.entry->period == 100 * ms);
    CHECK(of.left_out.empty());
  }
}

TEST_CASE("sent messages: names of send types that mean a fast cycle", "[shared]") {
  for (const char* type : {"CyclicIfActive", "IF_ACTIVE", "WithRepetition", "ca", "Cyclic"}) {
    CAPTURE(type);
    auto model = message(type);
    model.attributes.push_back({"GenMsgCycleTimeFast", "40"});
    const Made of = made(model);
    REQUIRE(of.entry);
    const bool fast = std::string_view{type} != "Cyclic";
    CHECK(of.entry->period == (fast ? 40 : 100) * ms);
    CHECK(of.entry->sporadic == fast);
    CHECK(of.left_out.empty());
  }
}

TEST_CASE("sent messages: what is left out, and why", "[shared]") {
  auto model = message();
  model.period = model.shortest_period = 0ms;
  CHECK(reasons(made(model)) == Reasons{"no_period"});
  model.send_type = "spontaneous";
  CHECK_FALSE(made(model).entry);
  CHECK(reasons(made(model)) == Reasons{"no_distance"});
  model.period = 100ms;
  CHECK(made(model).entry);
  CHECK(reasons(made(model)) == Reasons{"events"});
  // A rate that is given is one for all that it sends.
  REQUIRE(made(model, 7 * ms).entry);
  CHECK(made(model, 7 * ms).entry->period == 7 * ms);
  CHECK(made(model, 7 * ms).left_out.empty());

  model = message();
  model.length = 9;
  CHECK_FALSE(made(model).entry);
  CHECK(reasons(made(model)) == Reasons{"too_long"});
  model.address = {protocol::Address::By::pgn, true, 0x18FEF1FE};
  CHECK(reasons(made(model)) == Reasons{"transport_protocol"});
  model.length = 8;
  CHECK(made(model).entry);
  model.length = 64;
  model.fd = true;
  CHECK(made(model).entry);
}

TEST_CASE(
    "sent messages: what is sent as CAN FD has the next length that there is, and the switch unless it says "
    "no",
    "[shared]") {
  const auto head = [](const spec::MessageModel& model) { return made(model).entry.value().head; };
  const can::AnyFrame classic = head(message());
  CHECK(classic.id == 0x101);
  CHECK(classic.format == can::Format::base);
  CHECK(classic.length == 8);
  CHECK(classic.flags == 0);
  auto model = message();
  model.fd = true;
  model.address = {protocol::Address::By::identifier, true, 0x18FF0102};
  for (const auto& [bytes, length] : {std::pair{7U, 7}, std::pair{8U, 8}, std::pair{9U, 12},
                                      std::pair{33U, 48}, std::pair{49U, 64}, std::pair{64U, 64}}) {
    CAPTURE(bytes);
    model.length = static_cast<std::uint16_t>(bytes);
    CHECK(head(model).length == length);
  }
  CHECK(head(model).format == can::Format::extended);
  CHECK(head(model).flags == can::fd_flags(true));
  model.attributes.push_back({"CANFD_BRS", "1"});
  CHECK(head(model).flags == can::fd_flags(true));
  model.attributes.back().text = "0";
  CHECK(head(model).flags == can::fd_flags(false));
}

TEST_CASE("sent messages: a start delay is an offset of what is on its sender's grid alone", "[shared]") {
  const auto offset = [](const char* delay, const char* type) {
    auto model = message(type);
    model.attributes.push_back({"GenMsgStartDelayTime", delay});
    return made(model).entry.value().offset;
  };
  CHECK(offset("5", "Cyclic") == 5 * ms);
  CHECK(offset("0.5", "Cyclic") == ms / 2);
  CHECK(offset("-5", "Cyclic") == 0);
  CHECK(offset("soon", "Cyclic") == 0);
  CHECK(offset("5", "CyclicAndEvent") == 0);
}

TEST_CASE("sent messages: which bits of a parameter group's identifier are any", "[shared]") {
  const auto any = [](std::uint32_t id) {
    auto model = message();
    model.address = {protocol::Address::By::pgn, true, id};
    return made(model).entry.value().any_id;
  };
  CHECK(any(0x18EF00FE) == 0xFFFF);  // to one address [SAE J1939-21: PDU format below 240]
  CHECK(any(0x18F000FE) == 0xFF);
  CHECK(made(message()).entry.value().any_id == 0);
}

}  // namespace tool_analyse_sent_messages_test
