/// What each viewer says, understood: subscriptions are carried out at once, what needs the bus becomes an
/// order. Knows no socket. For one thread, that of the web.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "cli/serve/channels.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/viewers.hpp"
#include "cli/serve/web.hpp"

namespace ocm::cli::serve {

struct SessionsOptions {
  std::string name;         ///< of the server, "AMiRo, sim"
  std::string id;           ///< another one at each start
  bool commands = false;    ///< with the token
  bool playback = false;    ///< a log: all viewers may wind it
  Orders* fleet = nullptr;  ///< of robots behind a central; null: there are none
};

class Sessions final : public Listener {
 public:
  /// All must outlive it.
  Sessions(SessionsOptions options, const protocol::Catalogue& catalogue, const Channels& channels,
           Viewers& viewers, Orders& orders);

  void opened(ViewerId viewer, bool commands) override;
  void gone(ViewerId viewer) override;
  void text(ViewerId viewer, std::string_view message) override;
  void binary(ViewerId viewer, std::string_view message) override;

 private:
  /// Channels that one viewer may publish on. [decided]
  static constexpr std::size_t most_channels = 64;

  struct Viewer {
    bool commands = false;
    std::map<std::uint32_t, std::string> publishes;  ///< topics by the client's channel
  };

  void refuse(ViewerId viewer, std::string_view why);
  void subscribe(ViewerId viewer, const foxglove::Request& request);
  void advertise(ViewerId id, Viewer& viewer, const foxglove::Request& request);
  void parameters(ViewerId viewer, Order::Kind kind, const foxglove::Request& request);
  void set_parameters(ViewerId id, const Viewer& viewer, const foxglove::Request& request);
  void put(Order order);
  void put(Orders& orders, Order order);

  SessionsOptions options_;
  const protocol::Catalogue* catalogue_;
  const Channels* channels_;
  Viewers* viewers_;
  Orders* orders_;
  std::map<ViewerId, Viewer> open_;
};

}  // namespace ocm::cli::serve
