/// Which channels a bus has, and its samples on them: one a topic or message, of a log with several
/// interfaces one a topic and interface; behind them the server's own, which are states.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/client/sample.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/output/sample_text.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

/// What the server itself says, each on a channel /ocm/NAME; the last two where it has a central's line;
/// the map is a Grid of Foxglove's schemas.
enum class State : std::uint8_t { robot, bus, boards, bounds, operator_, playback, fleet, map };
inline constexpr std::array<std::string_view, 6> state_names{"robot",  "bus",      "boards",
                                                             "bounds", "operator", "playback"};

class Channels {
 public:
  /// More make the list of them too long for a page. [decided]
  static constexpr std::size_t most = 20'000;

  /// The catalogue must outlive it. Interfaces for which there would be more than `most` have none. `fleet`:
  /// there are robots behind a central.
  Channels(const protocol::Catalogue& catalogue, std::span<const std::string> interfaces, bool fleet = false);

  /// Behind all others; their numbers are those that come next. Before anything is published.
  void add(const std::vector<foxglove::Channel>& channels) {
    all_.insert(all_.end(), channels.begin(), channels.end());
  }

  [[nodiscard]] const std::vector<foxglove::Channel>& all() const noexcept { return all_; }
  /// Of a topic on an interface, by their numbers; `interface` < interfaces().
  [[nodiscard]] std::uint32_t of(std::size_t interface, std::size_t topic) const noexcept {
    return static_cast<std::uint32_t>(interface * topics_ + topic);
  }
  /// The topic's number on its interface; channel < of(State::robot).
  [[nodiscard]] std::size_t topic_of(std::uint32_t channel) const noexcept { return channel % topics_; }
  [[nodiscard]] const std::string& interface_of(std::uint32_t channel) const {
    return interfaces_[channel / topics_];
  }
  [[nodiscard]] std::uint32_t of(State state) const noexcept {
    return static_cast<std::uint32_t>(interfaces_.size() * topics_ + static_cast<std::size_t>(state));
  }
  /// Whether it is one of the server's own, of which who subscribes gets the newest at once.
  [[nodiscard]] bool is_state(std::uint32_t channel) const noexcept {
    return channel >= of(State::robot) && channel < states_end_;
  }
  /// Those that have channels.
  [[nodiscard]] std::span<const std::string> interfaces() const noexcept { return interfaces_; }
  [[nodiscard]] const std::string& topic(std::uint32_t channel) const { return all_[channel].topic; }

 private:
  std::vector<std::string> interfaces_;
  std::size_t topics_;
  std::vector<foxglove::Channel> all_;
  std::size_t states_end_ = 0;
};

/// Frames in, samples out: encoded once, and only where a viewer has subscribed.
class Publisher {
 public:
  /// All must outlive it.
  Publisher(const protocol::Catalogue& catalogue, const Channels& channels, Viewers& viewers);

  /// What the frame turned out to be. `interface`: its name; one without channels is counted only.
  client::Reception take(const log::Entry& entry, std::string_view interface);
  /// A sample as the channel of its topic has it.
  [[nodiscard]] std::string text_of(const client::Sample& sample) const;
  /// While a log is wound nothing is published but the newest sample of each channel, when that ends.
  void hold_back();
  void go_on();
  /// A log is read from its beginning again.
  void forget();

  /// Of all interfaces.
  [[nodiscard]] client::ReceiverCounters counters() const;

 private:
  struct Kept {
    std::uint64_t time_ns = 0;
    std::string payload;
  };

  const protocol::Catalogue* catalogue_;
  const Channels* channels_;
  Viewers* viewers_;
  std::vector<SampleText> texts_;
  std::vector<client::Receiver> receivers_;  ///< one an interface
  std::size_t last_ = 0;                     ///< interface
  bool holds_back_ = false;
  std::vector<Kept> kept_;  ///< by channel
};

}  // namespace ocm::cli::serve
