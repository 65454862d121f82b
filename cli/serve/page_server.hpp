/// The page and what it shows: what comes from a bus or a log goes in, samples and states go out to all
/// viewers, and their orders wait here. Where frames come from, and when, is said by who has it:
/// live_bus.hpp, played_log.hpp, robots_alone.hpp.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/client/commanders.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/bus_model/models.hpp"
#include "cli/bus_model/playing.hpp"
#include "cli/serve/bounds.hpp"
#include "cli/serve/channels.hpp"
#include "cli/serve/fleet_watch.hpp"
#include "cli/serve/operator_watch.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/parameters.hpp"
#include "cli/serve/scenes.hpp"
#include "cli/serve/server.hpp"
#include "cli/serve/sessions.hpp"
#include "cli/serve/state.hpp"
#include "cli/serve/viewers.hpp"
#include "cli/serve/web.hpp"

namespace ocm::spec {
struct Model;
}

namespace ocm::cli::serve {

inline constexpr base::Duration bus_interval = std::chrono::milliseconds{250};  // between states of it
inline constexpr base::Duration boards_interval = std::chrono::seconds{1};
inline constexpr base::Duration play_step = std::chrono::milliseconds{20};  // of a log

/// For one thread; that of the web and that of robots behind a central are within.
class PageServer {
 public:
  /// Catalogue and model must outlive it. `bus_bit_rate`: 0, not known.
  PageServer(const protocol::Catalogue& catalogue, const spec::Model& model, ServeOptions options,
             Source source, const std::vector<std::string>& interfaces, std::uint32_t bus_bit_rate);

  /// Opens the page, and prints its address; leaves through `fail` where it cannot.
  void open();
  /// Closes it: viewers first, so that nothing they say comes any more. Reports what they have lost.
  void close();
  /// Who has called `serve` wants its end.
  [[nodiscard]] bool is_over() const { return options_.over && options_.over(); }
  /// There is something for viewers. Cheap.
  void wake() noexcept { web_->wake(); }

  [[nodiscard]] const std::string& name() const noexcept { return source_.name; }
  /// Whether a viewer has subscribed to something of the bus or the log.
  [[nodiscard]] bool is_looked_at() const;
  [[nodiscard]] bool takes_commands() const noexcept { return options_.commands; }
  [[nodiscard]] const protocol::Catalogue& catalogue() const noexcept { return catalogue_; }
  [[nodiscard]] const Channels& channels() const noexcept { return channels_; }
  [[nodiscard]] FleetChannels fleet_channels() const {
    return {channels_.of(State::fleet), channels_.of(State::map)};
  }
  [[nodiscard]] Viewers& viewers() noexcept { return viewers_; }
  /// What viewers have asked; of robots behind a live central their watch takes them.
  [[nodiscard]] Orders& orders() noexcept { return orders_; }

  // --- what comes in ---

  void take(const log::Entry& entry, const log::Interfaces& interfaces);
  /// Frames that the bus has lost so far, as it counts them.
  void lost_so_far(std::string_view interface, std::uint64_t frames);
  /// It is so late by the clock of bus or log.
  void until(base::Time now) { models_.until(now); }
  /// What is neither for the bus nor for the log.
  void answer(const Order& order, base::Time now);

  // --- a log is wound ---

  /// Nothing is published from here to `wound` but, then, the newest of each channel.
  void winds();
  void wound();
  /// It is read from its beginning again.
  void forget();

  // --- what goes out, where a viewer wants it ---

  /// On stderr, and to all viewers.
  void say(const std::string& words);
  void publish_bus(base::Time now);
  void publish_boards(const transport::BusCounters& counters, base::Time now);
  void publish_bounds(base::Time now);
  void publish_parameters(base::Time now);
  void publish_operator(const OperatorWatch& watch);
  void publish_playback(const bus_model::Playing& playing, bool paused, std::uint64_t jumps);

 private:
  /// Of the first bus.
  [[nodiscard]] std::vector<bus_model::Row> rows(base::Time now);
  /// Where the robot is, for panels of others; while a log is wound only what is learnt from it.
  void show(const client::Sample& sample, std::string_view interface);
  void model_interfaces();

  ServeOptions options_;
  const protocol::Catalogue& catalogue_;
  const spec::Model& model_;
  Source source_;
  measure::BitRates rates_;
  Channels channels_;
  Scenes scenes_;
  Viewers viewers_;
  Publisher publisher_;
  bus_model::Models models_;
  Bounds bounds_;  ///< of the first interface
  client::Diagnosis diagnosis_;
  client::StatusRequests status_requests_;
  client::Commanders commanders_;
  Parameters parameters_;
  Orders orders_;
  std::uint64_t lost_ = 0;  ///< frames, of the bus, as it counts them
  Orders fleet_orders_;
  Sessions sessions_;
  bool winds_ = false;                 ///< a log
  std::unique_ptr<Web> web_;           // its thread uses what is above
  std::unique_ptr<FleetWatch> fleet_;  // last: its thread wakes that one
};

}  // namespace ocm::cli::serve
