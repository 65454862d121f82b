/// Runs an operator on a bus: frames and time go into its supervisor, what comes out goes to the bus, and
/// what happens is printed. The loop that receives never waits for a disk or for the reader of its output.
///
/// Of what the bus does not take at once, the newest frame of each identifier is kept, so that nothing that
/// is out of date is sent late. Each cause of a lost frame has a counter, and they are printed at the end.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/refusals.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/reflective/supervisor.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/operate/answers.hpp"
#include "cli/operate/background.hpp"
#include "cli/operate/black_box.hpp"
#include "cli/operate/control.hpp"
#include "cli/operate/counted.hpp"
#include "cli/operate/operator_file.hpp"
#include "cli/operate/service.hpp"
#include "cli/shared/json.hpp"
#include "cli/shared/live.hpp"

namespace ocm::cli::operate {

struct RunOptions {
  bool json = false;
  std::uint32_t bit_rate = 0;  ///< for the load of the bus
  BlackBoxOptions black_box;
};

struct RunCounters {
  std::uint64_t sent = 0;
  std::uint64_t replaced =
      0;                    ///< frames that the bus had not taken when a newer one of their identifier came
  std::uint64_t late = 0;   ///< steps that took longer than `reaction`
  std::int64_t latest = 0;  ///< ns, the latest of those
  std::uint64_t refusals = 0;
  std::uint64_t recordings = 0;
  std::uint64_t recordings_lost = 0;
  std::uint64_t not_kept = 0;  ///< frames that are in the black box, and not on the disk at the same time
};

class Runner {
 public:
  /// All must outlive it.
  Runner(transport::Bus& bus, Control& control, const protocol::Catalogue& catalogue,
         const OperatorFile& file, const RunOptions& options);

  /// Until a signal comes, or the bus is gone.
  [[nodiscard]] Over run();
  /// Everything that it commands goes to rest, and what it asked for is stopped. Leaves through cli::fail,
  /// loudly, if that cannot be sent.
  void rest();
  /// Prints what was counted, once all else was printed.
  void sum_up();

 private:
  using Event = reflective::Event;
  using Actions = reflective::Supervisor<room>::Actions;

  /// By the clock that supervisors and bounds have: it goes on at its own pace.
  [[nodiscard]] static base::Time now() noexcept { return base::Time{Clock::now().time_since_epoch()}; }

  void step(const Event& event, base::Time at);
  void carry_out(Actions actions, base::Time at);
  void take(const transport::ReceivedAny& received);
  void take_error(const can::AnyFrame& frame);
  void look_at_bus();
  /// Other programs command past an operator that they do not find.
  void look_at_socket(base::Time at);
  void set_bus_state(reflective::BusState state);
  void end_window(base::Time at);
  void queue(const can::Frame& frame);
  void flush();
  void none_waits();
  /// How long a frame with this stamp has waited: by the wall clock, which stamps it. Where that was set
  /// since none waited, as long as it may have: an old sample is not taken for a new one.
  [[nodiscard]] base::Duration waited(base::Time stamp) const;
  /// How late a step was.
  void judge(base::Duration late);
  void record();
  /// What a run that was killed has left; the robot is guarded whatever becomes of that.
  void recover();
  /// What has come since the last time goes to the disk.
  void keep_up(base::Time at);

  /// What another program asks for; the answer.
  [[nodiscard]] std::string answer(Caller& caller, std::string_view request);
  [[nodiscard]] std::string switch_to(const Caller& caller, std::string_view name);
  [[nodiscard]] std::string hold(const Caller& caller, bool held);
  [[nodiscard]] std::string pass_on(Caller& caller, std::string_view text);
  [[nodiscard]] bool may_command(const Caller& caller) const;
  /// What it commands itself where it is; null: not that actuator.
  [[nodiscard]] const reflective::SetPoint* own_set_point(std::uint16_t topic) const;
  [[nodiscard]] std::string commands(std::string_view text) const;
  /// What of a set point was held within the limits.
  struct Limited {
    std::vector<std::string> fields;  ///< "motors.x"
    std::vector<std::string> texts;   ///< of each: "motors.x to at most 0.02 m/s"
  };
  /// Tells once a program and topic.
  void tell_command(Caller& caller, std::uint16_t topic, const Limited& limited, bool beyond);
  [[nodiscard]] Answers answers() const { return {*file_, supervisor_, changes_, commands_, lines_lost_}; }

  void tell_switch(const reflective::Action& action);
  void tell(std::string_view event, std::initializer_list<Json::Member> facts, const std::string& text);
  [[nodiscard]] std::string event_line(std::string_view event, std::initializer_list<Json::Member> facts,
                                       const std::string& text) const;
  /// In the background.
  void print(const std::string& line);

  transport::Bus* bus_;
  Control* control_;
  const protocol::Catalogue* catalogue_;
  const OperatorFile* file_;
  const RunOptions* options_;
  BlackBox box_;
  Live live_;
  client::Receiver receiver_;
  client::FrameIndex index_;
  client::Refusals refusals_;
  reflective::Supervisor<room> supervisor_;
  std::deque<can::Frame> queue_;
  base::Time nothing_waited_{};  ///< when the last frame that waited had been taken
  base::Duration wall_clock_{};  ///< how far it was ahead of `now` then
  reflective::BusState controller_ = reflective::BusState::active;  ///< as error frames say
  std::optional<reflective::BusState> bus_state_;                   ///< as the supervisor knows it
  base::Duration window_{};  ///< of the load; 0: no condition looks at it
  base::Time window_end_ = base::never;
  base::Time keep_up_at_ = base::never;
  base::Time look_at_socket_at_{};
  bool is_found_ = true;
  std::uint64_t bits_ = 0;
  std::uint64_t handed_over_ = 0;  ///< frames that the bus took, its own and those of others
  RunCounters counters_;
  CommandCounters commands_;
  Counted counted_;
  std::deque<Change> changes_;
  Service service_;
  std::atomic<std::uint64_t> lines_lost_ = 0;  ///< no reader, a full disk, or a reader that took too long
  RunCounters written_;                        ///< what the background counts
  Background background_{1000};                // last, so that it ends first
};

}  // namespace ocm::cli::operate
