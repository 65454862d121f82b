// Samples as one JSON object each, and what such an object looks like.
#include "cli/output/sample_text.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/frame.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/topic.hpp"

#include "unit/protocol/example_topics.hpp"

namespace tool_output_sample_text_test {

using namespace ocm;
using cli::SampleText;
using protocol::Field;

/// What is printed, into no more room than it asks for.
template <class... What>
std::string printed(const SampleText& text, const What&... what) {
  std::vector<char> room(text.room());
  const char* const end = text.print(room.data(), what...);
  const auto size = static_cast<std::size_t>(end - room.data());
  REQUIRE(size <= room.size());
  return {room.data(), size};
}

/// Both frames of the scale's sample.
std::vector<std::uint8_t> bytes_of(const test::Scale& scale) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < 2; ++i)
    for (const std::uint8_t byte : scale.encode(i)) bytes.push_back(byte);
  return bytes;
}

TEST_CASE("sample text: an object, and where a topic has several frames one in it for each", "[output]") {
  const protocol::Topic& scale = test::catalogue.topics[0];
  const SampleText of_scale{scale};
  const std::vector<std::uint8_t> bytes = bytes_of({76, 7});
  client::Sample sample;
  sample.topic = &scale;
  sample.bytes = bytes;
  CHECK(printed(of_scale, sample) == R"({"weight":{"weight":119},"state":{"state":7}})");
  CHECK(printed(of_scale, std::size_t{0}, sample.data(0)) == R"({"weight":{"weight":119}})");
  CHECK(printed(of_scale, std::size_t{1}, sample.data(1)) == R"({"state":{"state":7}})");
  const can::Payload level{42};
  CHECK(printed(SampleText{test::catalogue.topics[1]}, std::size_t{0}, std::span{level}.first(1)) ==
        R"({"level":42})");
}

Field field(std::string_view name, unsigned first_bit) {
  Field made;
  made.name = name;
  made.position = {static_cast<std::uint16_t>(first_bit), 8, protocol::ByteOrder::little};
  made.raw_max = 255;
  return made;
}

TEST_CASE("sample text: a field that is not in the frame has no key", "[output]") {
  static constexpr std::array<protocol::SelectorRange, 1> zero{{{0, 0}}}, one{{{1, 1}}};
  std::array<Field, 3> fields{field("volts", 8), field("page", 0), field("amps", 8)};
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}}) {
    fields[i].selector = 1;
    fields[i].selected = i == 0 ? zero : one;
  }
  protocol::FrameLayout layout;
  layout.length = 2;
  layout.fields = fields;
  layout.address = {protocol::Address::By::identifier, false, 0x123};
  protocol::Topic topic;
  topic.name = "cells";
  topic.kind = protocol::Kind::message;
  topic.frames = {&layout, 1};
  const SampleText text{topic};
  const auto of_page = [&](std::uint8_t page) {
    const can::Payload data{page, 12};
    return printed(text, std::size_t{0}, std::span{data}.first(2));
  };
  CHECK(of_page(0) == R"({"volts":12,"page":0})");
  CHECK(of_page(1) == R"({"page":1,"amps":12})");
  CHECK(of_page(2) == R"({"page":2})");
}

TEST_CASE("sample text: it asks for the room of its names, however long they are", "[output]") {
  const std::string name(600, 'n'), first(600, 'a'), second(600, 'b');
  const std::array<Field, 1> fields{field(name, 0)};
  std::array<protocol::FrameLayout, 2> layouts;
  for (protocol::FrameLayout& layout : layouts) {
    layout.length = 1;
    layout.fields = fields;
  }
  layouts[0].name = first;
  layouts[1].name = second;
  protocol::Topic topic;
  topic.name = "t";
  topic.frames = layouts;
  const std::array<std::uint8_t, 16> bytes{200, 0, 0, 0, 0, 0, 0, 0, 100};
  client::Sample sample;
  sample.topic = &topic;
  sample.bytes = bytes;
  const std::string key = R"({")" + name + R"(":)";
  CHECK((printed(SampleText{topic}, sample) ==
         R"({")" + first + R"(":)" + key + R"(200},")" + second + R"(":)" + key + "100}}"));
}

TEST_CASE("sample text: the schema has each frame and field, with units and the names of values",
          "[output]") {
  const std::string head = R"({"$schema":"https://json-schema.org/draft/2020-12/schema",)";
  CHECK(cli::sample_schema(test::catalogue.topics[0]) ==
        head + R"("title":"scale","description":"a data sheet","type":"object","properties":{)"
               R"("weight":{"type":"object","properties":{"weight":{"type":"number","description":"g"}}},)"
               R"("state":{"type":"object","properties":{"state":{"type":"number",)"
               R"("description":"bit 0 stable, bit 7 overload"}}}}})");
  CHECK(cli::sample_schema(test::catalogue.topics[1]) ==
        head +
            R"("title":"lamp_1","description":"","type":"object","properties":{"level":{"type":"number"}}})");
  static constexpr std::array<protocol::NamedValue, 2> names{{{0, "off"}, {1, "on"}}};
  std::array<Field, 2> fields{field("a", 0), field("b", 8)};
  for (Field& each : fields) each.values = names;
  fields[1].unit = "V";
  protocol::FrameLayout layout;
  layout.length = 2;
  layout.fields = fields;
  protocol::Topic topic;
  topic.name = "t";
  topic.frames = {&layout, 1};
  CHECK(cli::sample_schema(topic) == head + R"("title":"t","description":"","type":"object","properties":{)"
                                            R"("a":{"type":"number","description":"0 off, 1 on"},)"
                                            R"("b":{"type":"number","description":"V, 0 off, 1 on"}}})");
}

}  // namespace tool_output_sample_text_test
