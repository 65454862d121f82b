/// The same samples at the same period by this project and by AMiRo-OS 1.0, in virtual time: how far periods
/// are off, how old a sample is when its last frame has come, and how full the bus is. Thesis §7.2 announces
/// that comparison.
///
/// Ours are the boards' own code on a world; theirs is what its sources say of the thread that sends
/// (docs/amiro-os.md has the places), with the frames of examples/amiro-os/messages.json. On both sides
/// programs take no time: what processors add is not in it. Boards begin at random times.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <messages.hpp>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/request.hpp"
#include "ocm/simulation/arbiter.hpp"
#include "ocm/topics/amiro.hpp"

#include "sim/amiro/robot.hpp"

using namespace ocm;
using namespace std::chrono_literals;

namespace {

constexpr base::Duration period = amiro_os::position::period;
constexpr base::Duration rare = amiro_os::power_status::period;
constexpr base::Duration each_run = 20s;
constexpr int runs = 200;
/// Three mailboxes a board. AMiRo-OS sets TXFP: in the order of hand-over.
constexpr std::size_t mailboxes = 3;

/// Of one kind of sample, of all runs.
struct Timing {
  std::string_view name;
  base::Duration nominal{};
  std::int64_t worst_period = 0;  ///< ns, off the nominal one, either way
  std::int64_t longest = INT64_MIN, shortest = INT64_MAX;
  std::int64_t oldest = 0, youngest = INT64_MAX;
  double sum_of_periods = 0;
  std::uint64_t periods = 0;

  void add(base::Time read, base::Time came, std::optional<base::Time>& before) {
    const std::int64_t age = (came - read).count();
    oldest = std::max(oldest, age);
    youngest = std::min(youngest, age);
    if (before) {
      const std::int64_t took = (came - *before).count();
      worst_period = std::max(worst_period, std::abs(took - nominal.count()));
      longest = std::max(longest, took);
      shortest = std::min(shortest, took);
      sum_of_periods += static_cast<double>(took);
      ++periods;
    }
    before = came;
  }
};

enum : std::size_t { odometry, floor_sensors, ring, power, samples };
using Timings = std::array<Timing, samples>;
Timings timings() {
  return {{{"odometry", period}, {"floor sensors", period}, {"ring", period}, {"power", rare}}};
}

struct Result {
  Timings timings = ::timings();
  double load = 0;  ///< of the bus, mean of the runs
};

class Random {
 public:
  explicit Random(std::uint32_t seed) : random_(seed) {}
  base::Time within(base::Duration time) {
    return base::Time{
        base::Duration{std::uniform_int_distribution<std::int64_t>{0, time.count() - 1}(random_)}};
  }

 private:
  std::mt19937 random_;
};

double load_of(const simulation::Arbiter& bus, std::uint32_t bit_rate) {
  return static_cast<double>(bus.totals().busy_bits) /
         (std::chrono::duration<double>(each_run).count() * bit_rate);
}

// --- ours --------------------------------------------------------------------------------------------------

struct Asked {
  std::size_t sample;
  can::Frame request;
  std::uint32_t first;  ///< identifiers of the sample's first and last frame
  std::uint32_t last;
  base::Time at{};
  base::Time released{};
  int skip = 2;  ///< the first one comes at once, the next one on the board's grid
  std::optional<base::Time> before{};
};

Asked ask(std::size_t sample, std::string_view name, base::Duration every) {
  const auto priority = protocol::Priority::medium;
  const protocol::Topic& topic = *amiro::catalogue.find(name);
  const auto id = [&](protocol::TopicId frame) {
    return protocol::Identifier{protocol::Direction::sensor, priority, frame}.encode();
  };
  return {sample, *protocol::publish_every(topic.id, every, priority), id(topic.frames.front().id),
          id(topic.frames.back().id)};
}

/// Sees when a board hands over the first frame of a sample: boards take no time here, so it was read then.
struct Watched {
  base::Result<bool> send(const can::Frame& frame) {
    for (Asked& each : *asked)
      if (frame.id == each.first) each.released = *now;
    return port.send(frame);
  }
  simulation::Port port;
  std::vector<Asked>* asked;
  const base::Time* now;
};

void run_ours(Random& random, Result& result) {
  std::vector<Asked> asked{
      ask(odometry, "odometry", period),
      ask(floor_sensors, "floor", period),
      ask(ring, "ring", period),
      ask(power, "power", rare),
  };
  for (Asked& each : asked) each.at = random.within(period);
  base::Time now{};
  simulation::Arbiter bus{amiro::bit_rate};
  const simulation::NodeOptions options{simulation::QueueOrder::by_identifier, mailboxes};
  Watched bottom{{bus, options}, &asked, &now}, middle{{bus, options}, &asked, &now},
      top{{bus, options}, &asked, &now};
  simulation::Port host{bus, {}};
  sim::SimulatedRobot robot{sim::WorldOptions{}, bottom, middle, top};

  std::vector<Asked*> waiting;
  for (Asked& each : asked) waiting.push_back(&each);
  const auto next_request = [&] {
    base::Time next = base::never;
    for (const Asked* each : waiting) next = std::min(next, each->at);
    return next;
  };
  for (const base::Time end{each_run}; now < end;) {
    now = std::min({robot.next_event(), bus.next_event(), next_request(), end});
    std::erase_if(waiting, [&](Asked* each) { return each->at <= now && host.send(each->request).ok(); });
    bus.advance(now, [&](const simulation::Delivery& delivery) {
      robot.receive(delivery.frame, delivery.time);
      for (Asked& each : asked) {
        if (delivery.frame.id != each.last || --each.skip >= 0) continue;
        result.timings[each.sample].add(each.released, delivery.time, each.before);
      }
    });
    robot.advance(now);
  }
  result.load += load_of(bus, amiro::bit_rate) / runs;
}

// --- theirs ------------------------------------------------------------------------------------------------

/// A tick of the kernel, in whole ones of which threads sleep. [devices/*/chconf.h: CH_FREQUENCY 1000]
constexpr base::Duration tick = 1ms;
/// Before each frame, [components/ControllerAreaNetworkTx.cpp, transmitMessage], and behind each of the
/// ring's, [devices/PowerManagement/PowerManagement.cpp, periodicBroadcast].
constexpr base::Duration before_each = 2 * tick, behind_ring = 10 * tick;
constexpr int tenth = 10;  ///< power status and robot id: each tenth time

struct HandOver {
  base::Time at;
  can::Frame frame;
  std::size_t node;
  std::size_t sample = samples;  ///< of which it is the last frame
  base::Time read{};
};

template <class Message>
can::Frame frame_of() {
  return {.id = Message::address.number, .dlc = Message::length};
}

class Board {
 public:
  Board(std::size_t node, base::Time begin, std::vector<HandOver>& all)
      : node_(node), at_(begin), all_(&all) {}
  void read() { read_ = at_; }
  void send(const can::Frame& frame, std::size_t last_of = samples, base::Duration behind = {}) {
    at_ += before_each;
    all_->push_back({at_, frame, node_, last_of, read_});
    at_ += behind;
  }

 private:
  std::size_t node_;
  base::Time at_;
  base::Time read_{};
  std::vector<HandOver>* all_;
};

template <class... Messages>
void send_ring(Board& board) {
  std::size_t left = sizeof...(Messages);
  (board.send(frame_of<Messages>(), --left == 0 ? ring : samples, behind_ring), ...);
}

std::vector<HandOver> theirs(base::Time wheels, base::Time middle) {
  using namespace amiro_os;
  std::vector<HandOver> all;
  for (int turn = 0; turn < each_run / period; ++turn) {
    Board bottom{0, wheels + turn * period, all};
    bottom.read();
    bottom.send(frame_of<actual_speed>());
    bottom.send(frame_of<position>(), odometry);
    bottom.send(frame_of<amiro_os::floor>(), floor_sensors);
    if (turn % tenth == 0) bottom.send(frame_of<robot_id>());
    Board above{1, middle + turn * period, all};
    above.read();
    if (turn % tenth == 0) above.send(frame_of<power_status>(), power);
    send_ring<ring_1, ring_2, ring_3, ring_4, ring_5, ring_6, ring_7, ring_8>(above);
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
  return all;
}

void run_theirs(Random& random, Result& result) {
  simulation::Arbiter bus{amiro_os::bit_rate};
  const simulation::NodeOptions options{simulation::QueueOrder::fifo, mailboxes};
  std::array<simulation::Port, 2> ports{{{bus, options}, {bus, options}}};
  const auto all = theirs(random.within(period), random.within(period));
  std::array<std::optional<base::Time>, samples> before;
  std::array<base::Time, samples> read{};
  std::array<std::uint32_t, samples> last{};
  std::array<int, samples> skip{2, 2, 2, 2};
  const auto take = [&](const simulation::Delivery& delivery) {
    for (std::size_t s = 0; s < samples; ++s)
      if (last[s] == delivery.frame.id && last[s] != 0 && --skip[s] < 0)
        result.timings[s].add(read[s], delivery.time, before[s]);
  };
  for (const HandOver& each : all) {
    bus.advance(each.at, take);
    if (each.sample != samples) {
      last[each.sample] = each.frame.id;
      read[each.sample] = each.read;
    }
    if (!ports[each.node].send(each.frame).ok()) std::puts("a frame was lost");
  }
  bus.advance(base::Time{each_run}, take);
  result.load += load_of(bus, amiro_os::bit_rate) / runs;
}

// --- the table ---------------------------------------------------------------------------------------------

std::string ms(std::int64_t ns) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f ms", static_cast<double>(ns) / 1e6);
  return text;
}
void row(const std::string& what, const std::string& ours, const std::string& theirs) {
  std::printf("| %s | %s | %s |\n", what.c_str(), ours.c_str(), theirs.c_str());
}
std::string percent(double part) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f %%", 100 * part);
  return text;
}

}  // namespace

int main() {
  Random random{1};
  Result ours, theirs;
  for (int i = 0; i < runs; ++i) run_ours(random, ours);
  for (int i = 0; i < runs; ++i) run_theirs(random, theirs);
  row("of 200 robots, 20 s each", "this project, 500 kbit/s", "AMiRo-OS 1.0, 1 Mbit/s");
  row("---", "---", "---");
  for (std::size_t s = 0; s < samples; ++s) {
    const Timing &a = ours.timings[s], &b = theirs.timings[s];
    const std::string name{a.name};
    const auto mean = [](const Timing& t) {
      return ms(static_cast<std::int64_t>(t.sum_of_periods / static_cast<double>(t.periods)));
    };
    row(name + ": mean period", mean(a), mean(b));
    row(name + ": period off by at most", ms(a.worst_period), ms(b.worst_period));
    row(name + ": jitter (longest less shortest period)", ms(a.longest - a.shortest),
        ms(b.longest - b.shortest));
    row(name + ": age when its last frame has come", ms(a.youngest) + " to " + ms(a.oldest),
        ms(b.youngest) + " to " + ms(b.oldest));
  }
  row("load of the bus", percent(ours.load), percent(theirs.load));
  // Left empty in docs/amiro-os.md: what needs the robot, or an image of AMiRo-OS.
  return 0;
}
