/// A bus of the example's topics, whose frames a test writes down, for the tests of `top`.
#pragma once

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "ocm/log/entry.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/bus_model/model.hpp"
#include "cli/bus_model/models.hpp"
#include "cli/top/view.hpp"
#include "unit/protocol/example_topics.hpp"

namespace ocm::test {

using namespace std::chrono_literals;

/// A day in 2026: times are far from zero, as on a bus.
inline constexpr base::Time morning{std::chrono::hours{24 * 365 * 56}};

inline log::Entry entry(base::Duration at, std::uint32_t id, std::initializer_list<int> bytes,
                        can::Format format = can::Format::base) {
  can::Frame frame;
  frame.id = id;
  frame.format = format;
  frame.dlc = static_cast<std::uint8_t>(bytes.size());
  std::size_t i = 0;
  for (const int byte : bytes) frame.data[i++] = static_cast<std::uint8_t>(byte);
  return {morning + at, frame};
}

/// Both frames of the scale's sample.
inline void weigh(cli::bus_model::Model& model, base::Duration at, const Scale& scale) {
  using protocol::Direction;
  using protocol::Identifier;
  for (std::size_t i = 0; i < 2; ++i) {
    can::Frame frame;
    frame.id = Identifier{Direction::sensor, protocol::Priority::high, Scale::frames[i].id}.encode();
    frame.dlc = Scale::frames[i].dlc;
    frame.data = scale.encode(i);
    model.take({morning + at, frame});
  }
}

inline void ask(cli::bus_model::Model& model, base::Duration at, protocol::Mode mode,
                protocol::Period period) {
  model.take(
      {morning + at, protocol::encode(protocol::Request{Scale::id, mode, period, protocol::Priority::high})});
}

/// Text without styles.
inline std::string text(const cli::top::Line& line) {
  std::string out;
  for (const auto& piece : line) out += piece.text;
  return out;
}
inline std::vector<std::string> text(const cli::top::Picture& picture) {
  std::vector<std::string> lines;
  for (const auto& line : picture) lines.push_back(text(line));
  return lines;
}

}  // namespace ocm::test
