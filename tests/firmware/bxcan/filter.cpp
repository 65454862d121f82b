// Every identifier there is, in every format, against the banks that were derived from the spec.
#include <catch2/catch.hpp>

#include "ocm/can/frame.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/drivers/bxcan_filter.hpp"
#include "tests/firmware/bxcan/bench.hpp"

namespace ocm::bxcan_tests {

static_assert(bxcan::filter_banks_of<amiro::DiWheelDrive>().size <= bxcan::filter_banks);
static_assert(bxcan::filter_banks_of<amiro::PowerManagement>().size <= bxcan::filter_banks);
static_assert(bxcan::filter_banks_of<amiro::LightRing>().size <= bxcan::filter_banks);

namespace {

/// What the catalogue says: independent of the types that the filters are made from.
bool own_command(std::uint32_t id, std::string_view board) {
  const auto identifier = protocol::Identifier::decode(id);
  if (identifier.direction != protocol::Direction::command) return false;
  const protocol::Topic* const topic = amiro::catalogue.find(identifier.topic);
  return topic != nullptr && amiro::catalogue.boards[topic->board].name == board;
}

template <class Board>
void check_board() {
  Model model;
  bxcan::Bxcan<ModelRegisters> can{ModelRegisters{model}};
  constexpr auto banks = bxcan::filter_banks_of<Board>();
  REQUIRE(can.start(timing, banks).ok());
  for (int i = 0; i < 4; ++i) static_cast<void>(model.read(Register::msr));
  REQUIRE_FALSE(model.initialising());

  unsigned wrong = 0;
  unsigned heard = 0;
  for (std::uint32_t id = 0; id <= can::max_base_id; ++id) {
    const bool accepted = model.deliver({id, 1, {}});
    if (accepted) {
      ++heard;
      const auto received = can.receive();
      wrong += !received || received->id != id;
    }
    wrong += accepted != own_command(id, Board::name);
    wrong += model.deliver({id, 0, {}, can::Format::base_remote});
    wrong += model.deliver({id << 18 | 0x2'AAAA, 1, {}, can::Format::extended});
    wrong += model.deliver({id << 18, 1, {}, can::Format::extended_remote});
    wrong += model.deliver({id, 1, {}, can::Format::extended});
  }
  CHECK(wrong == 0);
  CHECK(heard > 0);
  CHECK(heard % protocol::priority_levels == 0);
  CHECK(model.violations.empty());
  for (std::size_t i = 0; i < bxcan::filter_banks; ++i) CHECK(model.filters_used[i] == (i < banks.size));
}

}  // namespace

TEST_CASE("exact: a board hears all commands to its own topics and nothing else") {
  SECTION("DiWheelDrive") {
    check_board<amiro::DiWheelDrive>();
  }
  SECTION("PowerManagement") {
    check_board<amiro::PowerManagement>();
  }
  SECTION("LightRing") {
    check_board<amiro::LightRing>();
  }
}

TEST_CASE("neighbouring topics share a mask: the eight lights need two filters") {
  constexpr auto set = bxcan::command_filters<amiro::LightRing>();
  std::size_t lights = 0;
  for (std::size_t i = 0; i < set.size; ++i)
    lights += set.filters[i].accepts(0x3C) || set.filters[i].accepts(0x43);
  CHECK(lights == 2);
}

namespace {
template <unsigned number>
struct Scattered {
  static constexpr protocol::TopicId id{static_cast<std::uint8_t>(number)};
  static constexpr std::uint8_t instances = 1;
};
struct Crowded {  // even parity: no two differ in one bit, so nothing merges
  using sensors = protocol::TopicList<Scattered<0x00>, Scattered<0x03>, Scattered<0x05>, Scattered<0x06>>;
  using actuators = protocol::TopicList<>;
};
struct Silent {
  using sensors = protocol::TopicList<>;
  using actuators = protocol::TopicList<>;
};
}  // namespace

TEST_CASE("topics that share no mask have a filter each; a board without topics hears nothing") {
  static_assert(bxcan::command_filters<Crowded>().size == 4);
  static_assert(bxcan::filter_banks_of<Crowded>().size == 2);
  static_assert(bxcan::filter_banks_of<Silent>().size == 0);
  Model model;
  bxcan::Bxcan<ModelRegisters> can{ModelRegisters{model}};
  REQUIRE(can.start(timing, bxcan::filter_banks_of<Silent>()).ok());
  for (int i = 0; i < 4; ++i) static_cast<void>(model.read(Register::msr));
  for (std::uint32_t id = 0; id <= can::max_base_id; ++id) REQUIRE_FALSE(model.deliver({id, 0, {}}));
}

}  // namespace ocm::bxcan_tests
