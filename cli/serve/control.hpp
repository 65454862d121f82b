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
  /// Gets each frame that has left, as far as the bus tells: a bus never hands a program its own.
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
  /// At the end: the motors rest. Says what has not left by then; empty: all has.
  [[nodiscard]] std::string rest();

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
  /// Hands a frame to the bus; false: it takes none.
  [[nodiscard]] bool send(ViewerId viewer, const can::AnyFrame& frame);
  /// Reports what has left by now, and, once, to whose orders it belongs what has not for too long.
  void look_what_left();
  [[nodiscard]] bool is_stuck() const;
  [[nodiscard]] std::string what_is_stuck() const;
  /// A drive is over of which nothing was looked after for too long: this program did not run, and what
  /// viewers have said waits and is old.
  void look_whether_it_ran();
  /// The drive that waits does not begin. Unless its viewer has let go itself, it must say rest first.
  void end_waiting(ViewerId by);
  /// Why a behaviour of a board may not begin now; empty: it may, or the command begins none.
  [[nodiscard]] std::string why_not_begun(ViewerId viewer, const client::Command& command) const;
  /// What ends each behaviour that a viewer (0: any) has commanded and that has not left.
  void rest_what_waits(ViewerId viewer, Driver::Frames& out) const;
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
  struct Handed {
    ViewerId viewer;
    can::AnyFrame frame;
  };
  std::deque<Handed> handed_;  ///< that it has taken, and that have not left
  Clock::time_point left_{};   ///< when one of them left last, or the first was handed over
  bool stuck_is_said_ = false;
  Clock::time_point looked_ = Clock::now();
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
