/// Orders of viewers, carried out on the bus: set points go out, are repeated while their viewer drives, and
/// rest behind it; what the bus or a board refuses is answered to the viewer that asked. For the thread that
/// has the bus.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ocm/can/any_frame.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/refusals.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/serve/driver.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/viewers.hpp"
#include "cli/shared/behaviour_sensor.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::serve {

class Control {
 public:
  /// Gets each frame that was sent: a bus never hands a program its own.
  using Sent = std::function<void(const can::AnyFrame& frame)>;
  /// Why nothing may be commanded now; empty: it may.
  using Obstacle = std::function<std::string()>;

  /// All must outlive it.
  Control(transport::Bus& bus, const protocol::Catalogue& catalogue, Viewers& viewers, Sent sent,
          Obstacle obstacle);

  void carry_out(const Order& order);
  /// A frame from the bus.
  void heard(const can::Received& received);
  /// Does what is due.
  void advance();
  /// When something is due next.
  [[nodiscard]] std::optional<Clock::time_point> next() const;
  /// At the end: the motors rest. false: that has not left, and the robot may still move.
  [[nodiscard]] bool rest();

 private:
  void command(ViewerId viewer, const client::Command& command);
  void drive(ViewerId viewer, const client::Hold& hold);
  /// Drives for a viewer that did not, once it is known that no board does anything by itself.
  void begin(ViewerId viewer, const client::Hold& hold);
  void begin_waiting();
  /// Of the driver; rest waits until the bus takes it, all else is given up.
  void send_all(ViewerId viewer, const Driver::Frames& frames);
  /// A set point that is given up since an earlier frame has not left; the viewer hears it once.
  void withhold(ViewerId viewer);
  [[nodiscard]] bool send(const can::AnyFrame& frame);
  void refuse(ViewerId viewer, std::string_view why);
  [[nodiscard]] std::string why_not_taken();

  transport::Bus* bus_;
  const protocol::Catalogue* catalogue_;
  Viewers* viewers_;
  Sent sent_;
  Obstacle obstacle_;
  client::FrameIndex index_;
  client::Refusals refusals_;
  Driver driver_;
  std::deque<can::Frame> rests_;  ///< that the bus has not taken yet
  struct Withheld {
    Clock::time_point since;
    bool is_said = false;
  };
  std::optional<Withheld> withheld_;  ///< set points, since an earlier frame has not left
  BehaviourSensor behaviour_;
  bool is_behaving_ = false;               ///< as its last sample said, however long ago,
  std::optional<Clock::time_point> said_;  ///< which came then
  /// What a viewer wants, until the sensor has answered or could have.
  struct Waiting {
    ViewerId viewer;
    client::Hold hold;
    Clock::time_point until;
  };
  std::optional<Waiting> waiting_;
  Clock::time_point other_{};  ///< when another program's set point of motors came last
  bool other_heard_ = false;
};

}  // namespace ocm::cli::serve
