// replay: a log of any format and any bytes is played on buses and a clock that are played too. Each entry
// has one outcome; frames go out in the order of the log, none before it is due and none long after; a signal
// ends it soon, with motors at rest. When each is due, the target works out by itself, a step at a time.
#include "cli/replay/player.hpp"

#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "ocm/log/asc.hpp"
#include "ocm/log/blf.hpp"
#include "ocm/log/candump.hpp"
#include "ocm/log/csv.hpp"
#include "ocm/log/pcap.hpp"
#include "ocm/log/pcapng.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/set_points.hpp"
#include "tests/robustness/fuzz/log_entries.hpp"
#include "tests/tool/clock/played_bus.hpp"

using namespace ocm;
using namespace std::chrono_literals;
namespace replay = cli::replay;
using test::Duration;
using test::PlayedBus;
using test::World;

namespace {

/// Holds the distance of any two times.
__extension__ using Wide = __int128;

/// Packed containers of a BLF file stay closed: log_blf opens them.
std::size_t open_nothing(std::string_view, std::span<char>) {
  return 0;
}

/// Input, reader and what they read, which live as long as this.
class Log {
 public:
  Log(std::string_view bytes, unsigned format) : source_(bytes), input_(source_, fuzz::small_room) {
    switch (format % 6) {
      case 0:
        reader_ = std::make_unique<log::CandumpReader>(input_);
        break;
      case 1:
        reader_ = std::make_unique<log::AscReader>(input_);
        break;
      case 2:
        reader_ = std::make_unique<log::CsvReader>(input_);
        break;
      case 3:
        reader_ = std::make_unique<log::PcapReader>(input_);
        break;
      case 4:
        reader_ = std::make_unique<log::PcapngReader>(input_);
        break;
      default:
        reader_ = std::make_unique<log::BlfReader>(input_, open_nothing);
    }
  }
  [[nodiscard]] log::Reader& reader() { return *reader_; }

 private:
  log::MemorySource source_;
  log::Input input_;
  std::unique_ptr<log::Reader> reader_;
};

/// When frames are due by the rules of ocm/log/playback.hpp, in seconds from the first.
class Due {
 public:
  Due(double speed, Duration longest) : speed_(speed), longest_(longest) {}
  /// A pass begins with this.
  void begin(base::Time time, Duration from) {
    newest_ = static_cast<Wide>(time.time_since_epoch().count()) + from.count();
  }
  [[nodiscard]] double of(base::Time time) {
    const Wide at = time.time_since_epoch().count();
    const Wide step = at - newest_;
    if (step < 0 && step > -1'000'000'000) return due_;
    newest_ = at;
    if (step > 0) due_ += static_cast<double>(std::min<Wide>(step, longest_.count())) / 1e9 / speed_;
    return due_;
  }

 private:
  double speed_;
  Duration longest_;
  Wide newest_ = 0;
  double due_ = 0;
};

/// What should become of a log.
struct Expected {
  struct Frame {
    can::Frame frame;
    std::size_t bus;
    double due;
  };
  std::vector<Frame> frames;
  replay::Played counts;
  std::uint64_t entries = 0;
  bool cut = false;  ///< by --until
};

class Scene {
 public:
  explicit Scene(fuzz::Input& input) : world_(1) {
    const std::uint8_t how = input.byte();
    format_ = input.byte();
    buses_ = 1 + how % 2;
    passes_ = 1 + (how >> 1) % 2;
    options_.at_once = (how & 4) != 0;
    prints_ = (how & 8) != 0;
    only_ = static_cast<replay::Only>((how >> 4) % 3);
    options_.playback.speed = (1 + input.byte()) / 16.0;
    const Duration gap = input.byte() * 10ms, from = input.byte() * 50ms, until = input.byte() * 100ms;
    if (gap != 0ms) options_.playback.longest_gap = gap;
    options_.span.from = from;
    if (until != 0ms) options_.span.until = until;
    for (std::size_t i = 0; i < buses_ && buses_ > 1; ++i)
      options_.routes.emplace_back("can" + std::to_string(i), i);
    if ((how & 64) != 0 && buses_ > 1) options_.routes.pop_back();
    signal_at_ = World::start + (1 + input.byte()) * 40ms;  // so that no log lasts for years
    world_.interrupt(signal_at_, SIGTERM);
    conditions_.room = 1 + input.byte() % 50U;
    conditions_.frame_time = (1 + input.byte()) * 1us;
    conditions_.listens_to = 0;
    gone_ = (how & 128) != 0;
    if (gone_) conditions_.gone = World::start + input.byte() * 10ms;
  }

  void run(std::string_view bytes) {
    expect_of(bytes);
    std::vector<PlayedBus*> buses;
    std::vector<replay::Outlet> outlets;
    for (std::size_t i = 0; i < buses_ && !prints_; ++i) {
      auto bus = std::make_unique<PlayedBus>(world_, conditions_, "can" + std::to_string(i),
                                             static_cast<int>(500 + i));
      buses.push_back(bus.get());
      outlets.emplace_back(std::move(bus), amiro::catalogue);
    }
    world_.disk = [this](int, std::string_view text) {
      printed_ += text;
      return cli::Written{0, 0};
    };
    replay::Player player{options_, replay::Selection{amiro::catalogue, {}, only_}, std::move(outlets),
                          prints_ ? std::make_unique<log::CandumpNanoWriter>() : nullptr};
    begun_ = world_.now();
    const bool left = play(player, bytes);
    if (prints_)
      judge_text(player);
    else
      judge(player, buses, left);
  }

 private:
  /// Whether it was left in the middle, which is said.
  bool play(replay::Player& player, std::string_view bytes) {
    std::optional<test::Silence> silence;
    if (gone_) silence.emplace();
    try {
      for (int pass = 0; pass < passes_ && !player.cut_short(); ++pass) {
        Log log{bytes, format_};
        player.play(log.reader());
      }
      ended_ = world_.now();
      if (player.cut_short()) static_cast<void>(player.rest());
      player.expect_all_left();
    } catch (const cli::Exit&) {
      return true;
    }
    return false;
  }

  void expect_of(std::string_view bytes) {
    Due due{options_.playback.speed, options_.playback.longest_gap};
    for (int pass = 0; pass < passes_ && !expected_.cut; ++pass) {
      Log log{bytes, format_};
      const auto entries = fuzz::read_all(log.reader());
      if (!entries.empty()) due.begin(entries.front().time, options_.span.from);
      for (const auto& entry : entries) {
        const Wide offset =
            Wide{entry.time.time_since_epoch().count()} - entries.front().time.time_since_epoch().count();
        if (offset > options_.span.until.count()) {
          expected_.cut = options_.span.until != Duration::max();
          if (expected_.cut) break;
        }
        ++expected_.entries;
        const bool before = options_.span.from > 0ms && offset < options_.span.from.count();
        if (before || !is_chosen(entry)) {
          ++expected_.counts.not_chosen;
          continue;
        }
        take(entry, log.reader().interfaces(), due);
      }
    }
  }

  void take(const log::Entry& entry, const log::Interfaces& interfaces, Due& due) {
    std::size_t bus = 0;
    if (!options_.routes.empty()) {
      const auto name = interfaces.name(entry.interface);
      while (bus < options_.routes.size() && options_.routes[bus].first != name) ++bus;
      if (bus == options_.routes.size()) {
        ++expected_.counts.no_route;
        return;
      }
    }
    const bool error = entry.format == can::Format::error;
    if (prints_ && error) {
      ++expected_.counts.error_frames;
      return;
    }
    const double at = due.of(entry.time);
    if (error) {
      ++expected_.counts.error_frames;
    } else if (!prints_ && entry.is_fd()) {
      ++expected_.counts.fd_frames;
    } else {
      ++expected_.counts.sent;
      expected_.frames.push_back({entry.classic().value_or(can::Frame{}), bus, at});
    }
  }

  /// Frames of the robot have identifiers of 11 bits, of which the highest says who speaks.
  [[nodiscard]] bool is_chosen(const log::Entry& entry) const {
    if (only_ == replay::Only::all) return true;
    if (entry.is_fd() || entry.format != can::Format::base) return false;
    return ((entry.id & 0x400) == 0) == (only_ == replay::Only::commands);
  }

  void judge(const replay::Player& player, const std::vector<PlayedBus*>& buses, bool left) {
    fuzz::expect(!left || gone_, "it is left only when a bus is gone");
    const auto& played = player.played();
    const std::uint64_t counted =
        played.sent + played.not_chosen + played.no_route + played.error_frames + played.fd_frames;
    fuzz::expect(counted <= expected_.entries, "an entry has one outcome at most");
    const bool whole = !left && world_.signal() == 0;
    if (whole) {
      fuzz::expect(counted == expected_.entries && played.sent == expected_.counts.sent &&
                       played.not_chosen == expected_.counts.not_chosen &&
                       played.no_route == expected_.counts.no_route &&
                       played.error_frames == expected_.counts.error_frames,
                   "an entry has the outcome that it should have");
      fuzz::expect(player.cut_short() == expected_.cut, "it is cut short by --until, and else not");
    }
    if (!left && !whole && ended_ >= signal_at_)
      fuzz::expect(ended_ - std::max(signal_at_, begun_) < 250ms + busy(), "a signal ends it soon");
    judge_frames(buses, played.sent, left);
    if (!left && player.cut_short())
      for (auto* const bus : buses) judge_rest(*bus);
  }

  void judge_frames(const std::vector<PlayedBus*>& buses, std::uint64_t counted, bool left) const {
    std::vector<std::size_t> next(buses.size());
    std::uint64_t sent = 0;
    for (const auto& each : expected_.frames) {
      if (sent == counted) break;
      auto& bus = *buses[each.bus];
      fuzz::expect(next[each.bus] < bus.sent().size(), "what is counted was sent");
      const auto& found = bus.sent()[next[each.bus]++];
      ++sent;
      fuzz::expect(found.frame == each.frame, "frames go out in the order of the log");
      if (options_.at_once) continue;
      const double taken = std::chrono::duration<double>(found.taken - begun_).count();
      fuzz::expect(taken >= each.due - 1e-5, "no frame goes out before it is due");
      fuzz::expect(taken <= each.due + 0.02 + std::chrono::duration<double>(busy()).count(),
                   "no frame goes out long after it is due");
    }
    fuzz::expect(sent == counted, "no more is counted than there is");
    std::size_t on_buses = 0;
    for (auto* const bus : buses) on_buses += bus->sent().size();
    fuzz::expect(on_buses >= counted && on_buses <= counted + buses.size() + (left ? 1 : 0),
                 "nothing else goes out but motors at rest");
  }
  /// How long the frames take on a bus, each of which may wait for the one before, which is looked at each
  /// millisecond.
  [[nodiscard]] Duration busy() const {
    return static_cast<std::int64_t>(expected_.entries + 2) * (conditions_.frame_time + 5us + 1100us);
  }

  static void judge_rest(PlayedBus& bus) {
    static const client::FrameIndex index{amiro::catalogue};
    const can::Frame* last = nullptr;
    for (const auto& each : bus.sent())
      if (cli::commanded_motors(index, each.frame) != nullptr) last = &each.frame;
    fuzz::expect(last == nullptr || cli::is_rest(*last), "motors rest after a replay that was cut short");
  }

  /// Printed instead of sent: the frames of the routes, at the times at which they would be sent.
  void judge_text(const replay::Player& player) const {
    const auto& played = player.played();
    fuzz::expect(played.sent == expected_.counts.sent && played.not_chosen == expected_.counts.not_chosen &&
                     played.error_frames == expected_.counts.error_frames &&
                     played.no_route == expected_.counts.no_route,
                 "an entry is printed as it should be");
    log::MemorySource source{printed_};
    log::Input input{source};
    log::CandumpReader reader{input};
    const auto entries = fuzz::read_all(reader);
    fuzz::expect(entries.size() == expected_.frames.size(), "every frame is printed");
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const auto frame = entries[i].classic();
      fuzz::expect(!frame || *frame == expected_.frames[i].frame, "frames are printed in order");
      const double time = std::chrono::duration<double>(entries[i].time.time_since_epoch()).count();
      const double due = options_.at_once ? 0 : expected_.frames[i].due;
      // Beyond what a time can be it stays at the end; a double has 53 bits.
      fuzz::expect(due > 9e9 || std::abs(time - due) <= 1e-5 + 1e-12 * due, "it is printed at its time");
    }
  }

  World world_;
  unsigned format_ = 0;
  std::size_t buses_ = 1;
  int passes_ = 1;
  bool prints_ = false;
  bool gone_ = false;
  replay::Only only_ = replay::Only::all;
  replay::PlayerOptions options_;
  PlayedBus::Conditions conditions_;
  test::Moment signal_at_{}, begun_{}, ended_{};
  Expected expected_;
  std::string printed_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  Scene scene{input};
  const auto rest = input.bytes(size);
  scene.run(fuzz::text_of(rest.data(), rest.size()));
  return 0;
}
