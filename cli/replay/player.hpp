/// Sends the frames of a log, each at its time, to the buses that their interfaces map to.
///
/// One that is as late as long as motors wait for a set point makes all later: a bus, or a pipe, that is too
/// slow is followed, and what has come late is not made up for at once. One that is so much later than the
/// frame before was held up: this program was stopped, the machine slept, or what is read came too late. What
/// the frames before it have commanded is then out of date, and the play ends, unless they have left nothing
/// in motion.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/playback.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/replay/outlet.hpp"

namespace ocm::cli::replay {

enum class Only : std::uint8_t { all, sensors, commands };

/// Which frames of a log are played.
class Selection {
 public:
  /// Of all frames, or of the topics' ones: sensor data, requests and set points.
  Selection(const protocol::Catalogue& catalogue, std::vector<const protocol::Topic*> topics, Only only);
  /// The interfaces are those of the entry's log: a topic may be on one of them only.
  [[nodiscard]] bool has(const log::Entry& entry, const log::Interfaces& interfaces);

 private:
  client::InterfaceIndexes index_;
  std::vector<const protocol::Topic*> topics_;
  Only only_;
  bool has_packets_;  ///< a topic is a message of J1939 that goes in packets: all packets are meant
};

/// A part of a log, by distances from its first frame. Without a beginning all that comes before belongs to
/// it, too: times that go back.
struct Span {
  base::Duration from{};
  base::Duration until = base::Duration::max();
  [[nodiscard]] bool is_before(base::Duration offset) const noexcept {
    return from > base::Duration::zero() && offset < from;
  }
  [[nodiscard]] bool is_behind(base::Duration offset) const noexcept { return offset > until; }
};

struct PlayerOptions {
  log::PlaybackOptions playback;
  bool at_once = false;  ///< --speed max
  Span span;
  /// Name of an interface in the log, and the bus that replaces it. Empty: all go to the only outlet.
  std::vector<std::pair<std::string, std::size_t>> routes;
};

/// What became of the frames.
struct Played {
  std::uint64_t sent = 0;
  std::uint64_t not_chosen = 0;  ///< another topic, or outside of --from and --until
  std::uint64_t no_route = 0;    ///< of an interface without a bus
  std::uint64_t error_frames = 0;
  std::uint64_t fd_frames = 0;
};

class Player {
 public:
  /// `outlets` empty: frames are printed as a candump log, at the times at which they would be sent.
  Player(PlayerOptions options, Selection selection, std::vector<Outlet> outlets,
         std::unique_ptr<log::Writer> printer);

  /// The whole log, or as far as --until, or until a signal comes (interrupted()).
  void play(log::Reader& log);

  /// Play was ended before the log's end, by --until, a signal, or because it was held up.
  [[nodiscard]] bool cut_short() const noexcept { return cut_short_; }
  /// For so long, while something was in motion: this has ended it.
  [[nodiscard]] std::optional<base::Duration> held_up() const noexcept { return held_up_; }
  /// Sets motors to zero that the frames have left running. false: they have left none so.
  bool rest() {
    bool any = false;
    for (Outlet& outlet : outlets_) any = outlet.rest() || any;
    return any;
  }

  /// Ends what boards do by themselves because of the frames; a remark on each bus where there was something.
  std::vector<std::string> end_behaviours() {
    std::vector<std::string> all;
    for (Outlet& outlet : outlets_)
      if (std::string names = outlet.end_behaviours(); !names.empty()) all.push_back(std::move(names));
    return all;
  }

  /// Ends what the frames have set in motion on all buses, behind a failure of one: a remark on each robot
  /// that may go on.
  std::vector<std::string> end_after_all() {
    std::vector<std::string> all;
    for (Outlet& outlet : outlets_)
      if (std::string otherwise = outlet.end_after_all(); !otherwise.empty())
        all.push_back(std::string{outlet.name()} + ": " + otherwise);
    return all;
  }

  /// Waits until all that was sent has left, or leaves through cli::fail and says how much has not.
  void expect_all_left() {
    for (Outlet& outlet : outlets_) outlet.expect_all_left();
  }

  [[nodiscard]] const Played& played() const noexcept { return played_; }
  [[nodiscard]] const log::Playback& playback() const noexcept { return playback_; }
  /// From the first frame to now.
  [[nodiscard]] base::Duration lasted() const;

 private:
  /// false: no later frame is to be played.
  bool play(const log::Entry& entry, const log::Interfaces& interfaces);
  /// false: it was held up, and ends.
  bool send(const log::Entry& entry, const log::Interfaces& interfaces);
  /// A frame was due at `due` and can go now at the earliest. false: it was held up, and ends.
  bool keep_up(const log::Entry& entry, base::Time due);
  void count(Outlet::Sent sent);
  void print(const log::Entry& entry, const log::Interfaces& interfaces);
  /// Until `time`, or a signal; leaves through cli::fail as soon as a bus is gone.
  void watch_until(base::Time time);
  [[nodiscard]] std::optional<std::size_t> route(std::uint16_t interface, const log::Interfaces& interfaces);

  PlayerOptions options_;
  Selection selection_;
  std::vector<Outlet> outlets_;
  std::unique_ptr<log::Writer> printer_;
  log::Bytes printed_;
  log::Playback playback_;
  Played played_;
  bool cut_short_ = false;
  std::optional<base::Duration> held_up_;
  base::Duration lateness_{};        ///< of the last frame
  base::Time begin_{};               ///< of the first pass
  std::optional<base::Time> first_;  ///< of the log, in this pass
  bool started_ = false;
  std::vector<std::optional<std::size_t>> routes_;  ///< by number of the interface
};

/// CLOCK_MONOTONIC.
[[nodiscard]] base::Time monotonic_now();
/// Until `time`, or until a signal comes, which is seen in at most 200 ms.
void wait_until(base::Time time);

}  // namespace ocm::cli::replay
