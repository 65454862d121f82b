/// What every board is on its bus, whatever it has: a controller and the ways into it. For a board's
/// board.hpp to derive from.
#pragma once

#include <concepts>
#include <cstddef>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/controller/controller.hpp"
#include "ocm/protocol/counters.hpp"
#include "ocm/scheduling/admission.hpp"
#include "ocm/scheduling/cooperative.hpp"
#include "ocm/scheduling/port.hpp"

namespace ocm::firmware::boards {

/// `Type`: the board in the generated header. `Tasks`: how many periodic tasks of its own it has. `A`: who
/// decides whether it takes one stream more.
template <class Type, can::Sender Bus, scheduling::Port P = scheduling::Cooperative, std::size_t Tasks = 0,
          scheduling::Admission A = scheduling::AdmitAll>
class Node {
 public:
  using Controller = controller::Controller<Type, Bus, P, Tasks, A>;

  Node(const Node&) = delete;  // the controller holds the board's address
  Node& operator=(const Node&) = delete;

  void receive(const can::Frame& frame, base::Time now) noexcept { controller_.receive(frame, now); }
  void poll(base::Time now) noexcept requires std::same_as<P, scheduling::Cooperative> {
    controller_.poll(now);
  }
  [[nodiscard]] base::Time next_event() const noexcept requires std::same_as<P, scheduling::Cooperative> {
    return controller_.next_event();
  }
  [[nodiscard]] bool waiting() const noexcept { return controller_.waiting(); }
  [[nodiscard]] protocol::Counters counters() const noexcept { return controller_.counters(); }
  /// For a port's contexts, and for what the status frames say.
  [[nodiscard]] Controller& controller() noexcept { return controller_; }
  [[nodiscard]] const Controller& controller() const noexcept { return controller_; }

 protected:
  /// Both must outlive the node.
  explicit Node(Bus& bus, controller::PortArgument<P> port) noexcept : controller_(bus, port) {}
  ~Node() = default;

  Controller controller_;
};

}  // namespace ocm::firmware::boards
