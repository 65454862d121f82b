/// Robots behind a central on the page: who is there, where, how good its link is, the map that they draw,
/// and what viewers ask of them. A thread of its own has the central's line, or joins the program that has
/// it, and looks for it again when that one ends.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ocm/cognitive/drawing.hpp"

#include "cli/fleet/central_line.hpp"
#include "cli/fleet/keeper.hpp"
#include "cli/fleet/known.hpp"
#include "cli/serve/attendance.hpp"
#include "cli/serve/errands.hpp"
#include "cli/serve/fleet_state.hpp"
#include "cli/serve/orders.hpp"
#include "cli/serve/viewers.hpp"

namespace ocm::cli::serve {

struct FleetOptions {
  fleet::LineOptions line;
  std::vector<std::string> starts;  ///< NAME=X,Y,DEG
  std::string world;
  bool call_back = false;
  bool waits = false;  ///< for a line that this program serves itself, and for no other
};

class FleetWatch {
 public:
  /// Opens the line, or joins it; leaves through cli::fail where there is none. All must outlive it.
  FleetWatch(const FleetOptions& options, Viewers& viewers, FleetChannels channels, Orders& orders);
  /// Robots that viewers have sent are stopped. Where this program has the line, it serves the programs that
  /// have joined until they have ended, or a signal comes.
  ~FleetWatch();
  FleetWatch(const FleetWatch&) = delete;
  FleetWatch& operator=(const FleetWatch&) = delete;

  /// `woken` is called when there is something for viewers; of the watch's thread. Once.
  void run(std::function<void()> woken);

 private:
  void main();
  void open();
  /// The line is there again, as far as can be seen.
  [[nodiscard]] bool is_there() const;
  void begin();
  void place();
  void step();
  void obey(const Order& order);
  [[nodiscard]] fleet::RobotNow robot(unsigned index) const;
  void draw();
  void publish(base::Time now);
  void publish_map(base::Time now);
  /// The owner's map, or empty: it draws none.
  [[nodiscard]] std::string map_of_owner();
  void say(foxglove::Level level, const std::string& words);

  FleetOptions options_;
  fleet::Known known_;
  Viewers* viewers_;
  FleetChannels channels_;
  Orders* orders_;
  Errands errands_;
  Attendance attendance_;
  fleet::Keeper keeper_;
  cognitive::Drawing drawing_;
  std::vector<base::Time> drawn_;  ///< a robot's update of then is in the map
  std::unique_ptr<fleet::CentralLine> line_;
  std::string source_;
  std::string gone_;  ///< why there is no line now
  bool scans_ = false;
  bool owner_draws_ = false;
  std::size_t robots_ = 0;                  ///< on the list
  std::map<unsigned, std::string> placed_;  ///< whose start the fleet has, by index
  std::string map_;                         ///< that was published last
  base::Time next_state_{};
  base::Time next_map_{};
  std::function<void()> woken_;
  std::atomic<bool> stops_{false};
  std::thread thread_;
};

}  // namespace ocm::cli::serve
