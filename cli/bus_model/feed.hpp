/// Where what shows a bus gets its frames from: a live bus, or a log that is played and can be wound.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/bus_model/models.hpp"
#include "cli/bus_model/playing.hpp"
#include "cli/logs/opened_log.hpp"
#include "cli/shared/clock.hpp"
#include "cli/shared/live.hpp"

namespace ocm::cli::bus_model {

/// All that came from a bus, taken now and then: waking up at every frame would cost more than the frames. Of
/// a CAN interface the controller's state, too, twice a second.
class LiveFeed {
 public:
  explicit LiveFeed(std::unique_ptr<transport::Bus> bus);

  [[nodiscard]] std::string name() const { return std::string{bus_->name()}; }
  [[nodiscard]] const transport::Bus& bus() const noexcept { return *bus_; }
  /// Gives all that is waiting to the models. Over::time: there is more to come.
  [[nodiscard]] Over pump(Models& models);
  /// By the clock of the frames.
  [[nodiscard]] base::Time now() const noexcept { return clock_.now(); }

 private:
  std::unique_ptr<transport::Bus> bus_;
  FrameClock clock_;
  Live live_;
  log::Interfaces interfaces_;
  int index_ = 0;  ///< of a CAN interface of the kernel; 0: it is none
  Clock::time_point next_look_{};
  std::uint64_t told_ = 0;
};

/// A log that is played: its time goes on with the clock, so many times as fast. What is written to it
/// meanwhile is not played; that frames are missing which were there before is reported.
class LogFeed {
 public:
  /// Looks through the whole file for its length. Leaves through `fail` where it cannot be read; a signal
  /// ends the looking.
  LogFeed(std::string path, std::string format, const protocol::Catalogue& catalogue);

  /// Gets each frame that is passed.
  using Take = std::function<void(const log::Entry& entry, const log::Interfaces& interfaces)>;

  /// The clock has gone on by so much.
  void play(base::Duration time, const Take& take);
  /// To this distance from the first frame; backwards only behind `rewind`.
  void go_to(base::Duration at, const Take& take);
  [[nodiscard]] bool is_behind(base::Duration at) const noexcept { return at < playing_.at; }
  /// The next `go_to` reads from the beginning.
  void rewind();
  void faster(double factor) noexcept { playing_.faster(factor); }

  [[nodiscard]] const Playing& playing() const noexcept { return playing_; }
  /// Whether it could be read to its end, and is all there still.
  [[nodiscard]] bool is_whole() const noexcept { return !cut_ && !shrank_; }
  /// Of the whole log.
  [[nodiscard]] const std::vector<std::string>& interfaces() const noexcept { return interfaces_; }
  [[nodiscard]] base::Time now() const noexcept { return first_ + playing_.at; }

 private:
  std::string path_;
  std::string format_;
  const protocol::Catalogue* catalogue_;
  std::unique_ptr<logs::OpenedLog> log_;
  std::vector<log::Entry> batch_;
  std::size_t next_ = 0;  ///< of the batch
  std::size_t size_ = 0;
  std::uint64_t frames_ = 0;  ///< of the whole log, when it was looked through
  std::uint64_t played_ = 0;  ///< since its beginning
  bool cut_ = false;          ///< damaged, so that its end could not be read
  bool shrank_ = false;       ///< which is reported once
  base::Time first_{};
  std::vector<std::string> interfaces_;
  Playing playing_;
};

}  // namespace ocm::cli::bus_model
