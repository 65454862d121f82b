#include "ocm/client/selectors.hpp"

#include <array>
#include <cstdint>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/sample.hpp"

namespace client_selectors_test {

using namespace ocm;
using client::Selectors;
using protocol::Field;
using protocol::SelectorRange;

constexpr std::array few{SelectorRange{5, 7}, SelectorRange{1, 1}};
constexpr std::array more{SelectorRange{6, 9}, SelectorRange{250, 255}};
constexpr std::array inner_one{SelectorRange{2, 2}};

/// Byte 0 selects bytes 1 and 2, of which byte 1 selects byte 3.
std::array<Field, 4> fields() {
  std::array<Field, 4> all{};
  for (unsigned i = 0; i < all.size(); ++i) {
    all[i].name = "field";
    all[i].position = {static_cast<std::uint16_t>(8 * i), 8, protocol::ByteOrder::little};
  }
  all[0].is_signed = true;  // the raw bits count, not their sign
  all[1].selector = 0;
  all[1].selected = few;
  all[2].selector = 0;
  all[2].selected = more;
  all[3].selector = 1;
  all[3].selected = inner_one;
  return all;
}

TEST_CASE("a selector chooses nothing exactly with the values that no field names") {
  const auto all = fields();
  protocol::FrameLayout layout;
  layout.length = 4;
  layout.fields = all;
  const Selectors selectors{layout};
  REQUIRE_FALSE(selectors.empty());
  for (unsigned value = 0; value < 256; ++value) {
    const std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(value), 2, 0, 0, 0, 0, 0, 0};
    const bool known = value == 1 || (value >= 5 && value <= 9) || value >= 250;
    INFO(value);
    CHECK(selectors.choose_nothing(bytes) == !known);
  }
}

TEST_CASE("ranges that lie within another one take nothing from it") {
  constexpr std::array wide{SelectorRange{2, 9}};
  constexpr std::array within{SelectorRange{5, 6}, SelectorRange{3, 4}};
  auto all = fields();
  all[1].selected = wide;
  all[2].selected = within;
  protocol::FrameLayout layout;
  layout.length = 4;
  layout.fields = all;
  const Selectors selectors{layout};
  for (unsigned value = 0; value < 256; ++value) {
    const std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(value), 2, 0, 0, 0, 0, 0, 0};
    INFO(value);
    CHECK(selectors.choose_nothing(bytes) == (value < 2 || value > 9));
  }
}

TEST_CASE("a selector that is selected itself counts where it is there") {
  const auto all = fields();
  protocol::FrameLayout layout;
  layout.length = 4;
  layout.fields = all;
  const Selectors selectors{layout};
  const auto choose_nothing = [&](std::uint8_t outer, std::uint8_t inner) {
    return selectors.choose_nothing(std::array<std::uint8_t, 8>{outer, inner});
  };
  CHECK(choose_nothing(1, 3));
  CHECK_FALSE(choose_nothing(1, 2));
  CHECK_FALSE(choose_nothing(9, 3));  // byte 1 is no selector there
}

TEST_CASE("a layout without selectors has nothing to choose, and a frame too short for one has none") {
  protocol::FrameLayout layout;
  CHECK(Selectors{layout}.empty());
  CHECK(Selectors{}.empty());
  CHECK_FALSE(Selectors{}.choose_nothing({}));
  auto all = fields();
  layout.fields = all;
  layout.length = 4;
  CHECK_FALSE(Selectors{layout}.choose_nothing({}));
  for (Field& field : all) field.selector = protocol::no_selector;
  CHECK(Selectors{layout}.empty());
}

TEST_CASE("a receiver counts messages whose selector chooses nothing, and they are samples all the same") {
  const auto all = fields();
  protocol::FrameLayout layout;
  layout.length = 4;
  layout.fields = all;
  layout.address = {protocol::Address::By::identifier, false, 0x123};
  protocol::FrameLayout plain = layout;
  plain.fields = std::span{all}.first(1);
  plain.address.number = 0x124;
  std::array<protocol::Topic, 2> topics{};
  topics[0].name = "plain";
  topics[0].kind = topics[1].kind = protocol::Kind::message;
  topics[0].frames = std::span{&plain, 1};
  topics[1].name = "pages";
  topics[1].frames = std::span{&layout, 1};
  protocol::Catalogue catalogue;
  catalogue.topics = topics;
  client::Receiver receiver{catalogue};
  const auto take = [&](std::uint32_t id, std::uint8_t selector) {
    can::Frame frame{id, 4, {}, can::Format::base};
    frame.data[0] = selector;
    frame.data[1] = 2;
    return receiver.take({base::Time{}, frame}).meaning;
  };
  CHECK(take(0x123, 6) == client::Meaning::sample);
  CHECK(receiver.counters().unselected == 0);
  CHECK(take(0x123, 4) == client::Meaning::sample);
  CHECK(take(0x124, 4) == client::Meaning::sample);
  CHECK(receiver.counters().unselected == 1);
  CHECK(receiver.counters().samples == 3);
  CHECK(receiver.counters().faults() == 0);
}

}  // namespace client_selectors_test
