/// Records: one thread takes frames from the buses, another writes them, so that a disk that takes its time
/// costs no frames. What does get lost is counted where it is lost.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/record/bus_load.hpp"
#include "cli/record/capture.hpp"
#include "cli/record/files.hpp"
#include "cli/record/merge.hpp"
#include "cli/record/queue.hpp"
#include "cli/record/writing.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::record {

/// One of the buses that are recorded, and all that is counted of it.
struct Port {
  std::string name;  ///< as the user chose it
  std::unique_ptr<Capture> capture;
  std::uint16_t number = 0;  ///< in the log
  transport::BusState state = transport::BusState::up;
  std::uint64_t received = 0;
  std::uint64_t errors = 0;
  std::uint64_t overflows = 0;    ///< times that the controller said it had no room
  std::uint64_t lost_before = 0;  ///< by captures that were closed
  std::uint64_t lost_here = 0;    ///< because the queue to the disk was full
  BusLoad load;

  [[nodiscard]] std::uint64_t lost() const { return lost_before + capture->lost() + lost_here; }
};

struct Limits {
  std::uint64_t count = 0;                   ///< end after this many frames; 0: never
  base::Duration duration{};                 ///< end after this time; 0: never
  std::uint32_t bit_rate = 0;                ///< of buses that do not say theirs
  std::size_t blocks = Queue::default_most;  ///< that wait for the disk at most
};

/// Opens a bus again that was closed and is back.
using Reopen = std::function<transport::Outcome<std::unique_ptr<Capture>>(std::string_view name)>;

class Recorder {
 public:
  /// `files` is open. `live`: its reader waits for each frame (a pipe).
  Recorder(std::vector<Port> ports, Reopen reopen, Files& files, Limits limits, bool live);
  ~Recorder();

  /// Until a limit, a signal, the end of the bus or of the disk; all that was received is then written.
  void run();
  /// The half of it that receives, for a caller that steps the other half, `writing`, itself.
  void receive();
  [[nodiscard]] Writing& writing() noexcept { return writing_; }

  [[nodiscard]] const std::vector<Port>& ports() const noexcept { return ports_; }
  [[nodiscard]] std::uint64_t received() const noexcept { return received_; }
  [[nodiscard]] base::Duration lasted() const noexcept { return lasted_; }
  /// Why a bus that does not come back has ended; empty: it has not.
  [[nodiscard]] const transport::Failure& ended() const noexcept { return ended_; }

 private:
  [[nodiscard]] std::size_t drain();
  void drain_to_the_end();
  [[nodiscard]] std::size_t drain_into_blocks(Port& port);
  [[nodiscard]] std::size_t drain_into_merge(Port& port);
  void emit(std::span<const log::Entry> entries);
  [[nodiscard]] std::span<log::Entry> room_in_block();
  void keep(Port& port, std::size_t count);
  void account(Port& port, std::span<const log::Entry> entries);
  void hand_over();
  void look();
  void look(Port& port);
  void reopen(Port& port);
  void wait(base::Duration left);
  void show_progress();

  std::vector<Port> ports_;
  Reopen reopen_;
  Files* files_;
  Limits limits_;
  bool live_;
  bool patient_ = true;  ///< frames may be fetched some milliseconds late
  bool on_terminal_;
  log::Interfaces interfaces_;
  Queue queue_;
  Merge merge_;
  int held_back_ = 0;  ///< looks at several buses since the merge was asked
  std::unique_ptr<Block> block_;
  Block unwanted_;              ///< what is put here is lost: the queue is full
  std::uint64_t received_ = 0;  ///< frames that are recorded
  base::Duration lasted_{};
  transport::Failure ended_;
  Clock::time_point begin_;
  Clock::time_point handed_over_;
  Clock::time_point looked_;
  Clock::time_point fetched_;
  Clock::time_point shown_;
  std::uint64_t shown_received_ = 0;
  Writing writing_;
  std::thread writer_;
};

}  // namespace ocm::cli::record
