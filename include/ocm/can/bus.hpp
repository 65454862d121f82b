/// What the library asks of a CAN controller or of anything that stands for one.
#pragma once

#include <concepts>

#include "ocm/base/result.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/frame.hpp"

namespace ocm::can {

/// A frame and the moment at which it was complete on the bus, by the clock that stamped it.
struct Received {
  base::Time time{};
  Frame frame{};
  friend constexpr bool operator==(const Received&, const Received&) = default;
};

/// Somewhere to send a frame to. `send` never waits: true is taken, false is "no mailbox free, try again
/// later", an error is for good.
template <class B>
concept Sender = requires(B& bus, const Frame& frame) {
  { bus.send(frame) } -> std::same_as<base::Result<bool>>;
};

/// A bus that a host can also listen to. `receive` waits at most `timeout` (zero: not at all) and returns a
/// frame, or Error::timed_out, or Error::closed.
template <class B>
concept Bus = Sender<B> && requires(B& bus, base::Duration timeout) {
  { bus.receive(timeout) } -> std::same_as<base::Result<Received>>;
};

}  // namespace ocm::can
