/// What viewers ask of the thread that has the bus, on its way there: a bounded queue that wakes it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "ocm/host/descriptor.hpp"

#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

struct Order {
  enum class Kind : std::uint8_t {
    publish,                 ///< `payload` on `topic`
    parameter,               ///< `topic` is to be `value`
    playback,                ///< `payload`
    newest,                  ///< it has subscribed to `channels`: what came last on them
    get_parameters,          ///< `names`; `payload` is the request
    subscribe_parameters,    ///< `names`
    unsubscribe_parameters,  ///< `names`
    confirm_parameters,  ///< `names`, as they are once a board could have refused; `payload` is the request
    gone,                ///< the viewer is
  };
  Kind kind = Kind::publish;
  ViewerId viewer = 0;
  std::string topic{};
  std::string payload{};
  double value = 0;
  std::vector<std::uint32_t> channels{};
  std::vector<std::string> names{};
};

class Orders {
 public:
  /// More at a time are refused, but for the first of a viewer: what others ask keeps no stop out. A page
  /// that drives gives ten a second. [decided]
  static constexpr std::size_t most = 256;

  Orders();
  /// Of any thread. false: there are too many already; that a viewer has gone is always taken.
  [[nodiscard]] bool put(Order order);
  [[nodiscard]] std::vector<Order> take();
  /// Readable while there are any; -1 where the system has no descriptor left.
  [[nodiscard]] int descriptor() const noexcept { return event_.get(); }

 private:
  host::Descriptor event_;
  std::mutex mutex_;
  std::vector<Order> orders_;
};

}  // namespace ocm::cli::serve
