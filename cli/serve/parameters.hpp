/// The periods of sensors as parameters, read back from what the bus shows: what was asked for, else what is
/// measured; 0 where a sensor was heard or asked for, and is not published now; no value where nothing of it
/// came. Viewers that subscribe get each change.
///
/// For the thread that has the bus.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "cli/bus_model/model.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

class Parameters {
 public:
  using Rows = std::span<const bus_model::Row>;

  /// Both must outlive it.
  Parameters(const protocol::Catalogue& catalogue, Viewers& viewers)
      : catalogue_(&catalogue), viewers_(&viewers) {}

  /// Carries out an order to read, to confirm or to subscribe, or that a viewer has gone; others are not for
  /// it.
  void take(const Order& order, Rows rows);
  /// What has changed goes to those that have subscribed; confirmations at the second update after their
  /// order, at least one `bus_interval` later: what was refused has its old value then.
  void update(Rows rows);
  /// Whether `update` has anyone to tell.
  [[nodiscard]] bool wanted() const noexcept { return !subscribers_.empty() || !confirmations_.empty(); }

 private:
  struct Confirmation {
    Order order;
    bool seen = false;  ///< an update has passed
  };

  [[nodiscard]] std::optional<double> value(const protocol::Topic& sensor, Rows rows) const;
  void answer(const Order& order, Rows rows);

  const protocol::Catalogue* catalogue_;
  Viewers* viewers_;
  std::map<ViewerId, std::set<std::string, std::less<>>> subscribers_;  ///< names
  std::map<std::string, std::optional<double>, std::less<>> known_;     ///< values that were said last
  std::vector<Confirmation> confirmations_;                             ///< at most Orders::most
};

/// "/gyroscope/period_ms"
[[nodiscard]] std::string parameter_of(const protocol::Topic& sensor);
/// The sensor of a parameter "/gyroscope/period_ms"; nullptr: there is no such parameter.
[[nodiscard]] const protocol::Topic* sensor_of(const protocol::Catalogue& catalogue,
                                               std::string_view parameter);

}  // namespace ocm::cli::serve
