// Frames with random bytes, and what the catalogue says of them: what the files that ocm-generate writes for
// other programs are held against. Usage: generate_samples SPEC FRAMES; a JSON object a frame on stdout.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <random>
#include <string>

#include "ocm/can/text.hpp"

#include "generator/spec/spec.hpp"

namespace {

using namespace ocm;

/// First all bytes alike, then only the sign bits of fields of one, two, three, ... bytes, then random bytes.
can::Payload payload(unsigned round, std::mt19937_64& random) {
  constexpr std::uint8_t alike[] = {0x00, 0xFF, 0x80, 0x7F, 0x01};
  constexpr unsigned lengths[] = {2, 3, 4, 8};
  can::Payload data{};
  for (unsigned i = 0; i < data.size(); ++i) {
    if (round < std::size(alike))
      data[i] = alike[round];
    else if (round < std::size(alike) + std::size(lengths))
      data[i] = (i + 1) % lengths[round - std::size(alike)] == 0 ? 0x80 : 0x00;
    else
      data[i] = static_cast<std::uint8_t>(random());
  }
  return data;
}

std::string fields_of(const protocol::FrameLayout& layout, const can::Payload& data) {
  std::string text;
  for (const auto& field : layout.fields) {
    const std::int64_t raw = field.raw(data);
    if (!text.empty()) text += ", ";
    if (field.is_float()) {
      char value[40];
      std::snprintf(value, sizeof value, "%.17g", field.value(raw));
      text += "\"" + std::string{field.name} + "\": {\"raw\": " + std::to_string(raw) + ", \"value\": \"" +
              value + "\", \"float\": " + std::to_string(field.position.width) +
              ", \"width\": " + std::to_string(field.position.width) +
              ", \"low\": " + std::to_string(field.min.as_double()) +
              ", \"high\": " + std::to_string(field.max.as_double()) + ", \"unit\": \"" +
              std::string{field.unit} + "\"}";
      continue;
    }
    const auto value = field.physical(raw);
    if (!value) std::abort();
    text += "\"" + std::string{field.name} + "\": {\"raw\": " + std::to_string(raw) + ", \"value\": \"" +
            std::string{base::to_text(*value).view()} +
            "\", \"width\": " + std::to_string(field.position.width) +
            ", \"low\": " + std::to_string(field.raw_min) + ", \"high\": " + std::to_string(field.raw_max) +
            ", \"unit\": \"" + std::string{field.unit} + "\"}";
  }
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto loaded = spec::load(argv[1]);
  if (!loaded.spec) return 1;
  std::mt19937_64 random{2018};
  for (int round = 0; round < std::atoi(argv[2]); ++round)
    for (const auto& topic : loaded.spec->catalogue().topics)
      for (const auto& layout : topic.frames) {
        const auto direction =
            topic.kind == protocol::Kind::sensor ? protocol::Direction::sensor : protocol::Direction::command;
        const auto priority = static_cast<protocol::Priority>(random() % 4);
        can::Frame frame;
        frame.id = protocol::Identifier{direction, priority, layout.id}.encode();
        frame.dlc = layout.dlc();
        const auto data = payload(static_cast<unsigned>(round), random);
        for (std::size_t i = 0; i < frame.dlc; ++i) frame.data[i] = data[i];
        const std::string text{can::to_text(frame).view()};
        std::printf(
            "{\"topic\": \"%s\", \"frame\": \"%s\", \"id\": %u, \"priority\": \"%s\", \"data\": \"%s\", "
            "\"fields\": {%s}}\n",
            std::string{topic.name}.c_str(), std::string{layout.name}.c_str(), frame.id,
            std::string{name(priority)}.c_str(), text.substr(text.find('#') + 1).c_str(),
            fields_of(layout, frame.data).c_str());
      }
}
