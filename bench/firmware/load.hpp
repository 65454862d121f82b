/// A board under load, all of it inside one image: real drivers, board, controller, scheduler and kernel;
/// parts whose transfers take as long as their wires, and a bus that takes as long as CAN. What it asks of
/// itself comes as an interrupt brings it. It measures in the machine's own time: with -icount nothing of the
/// host is in it.
///
/// On semihosting's output, one line a topic: how late its first frame was handed to the bus after the
/// request had arrived a whole number of periods before (least, greatest), and the longest after a request
/// under load; then the share of time in which no thread ran, under load and at rest. `measure_costs` has one
/// line a topic and one for the board's own tasks: what spec/tasks.json counts.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ocm/base/fixed_vector.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/can/length.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"

#include "firmware/chibios/port.hpp"
#include "firmware/drivers/bus.hpp"
#include "firmware/qemu/machine.hpp"

namespace ocm::bench {

using namespace std::chrono_literals;
namespace chibios = firmware::chibios;

/// One topic that is asked for.
struct Asked {
  protocol::TopicId topic;  ///< of the request
  protocol::TopicId first;  ///< of its first frame
  std::uint8_t frames;
  protocol::Priority priority;
  base::Duration period = 50ms;
};

/// Text to the host. [Semihosting for AArch32 and AArch64, 2.1: SYS_WRITE0]
inline void say(const char* text) noexcept {
  register std::uint32_t r0 asm("r0") = 0x04;
  register const void* r1 asm("r1") = text;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}
inline void say(std::int64_t number) noexcept {
  std::array<char, 24> text{};
  std::size_t at = text.size() - 1;
  const bool negative = number < 0;
  auto rest = static_cast<std::uint32_t>(negative ? -number : number);
  do text[--at] = static_cast<char>('0' + rest % 10);
  while ((rest /= 10) != 0);
  if (negative) text[--at] = '-';
  say(text.data() + at);
}

/// What became of one topic.
struct Seen {
  base::Time requested{};
  bool awaited = false;    ///< no frame since the request
  base::Duration reply{};  ///< the longest from a request to the first frame
  std::uint32_t replies = 0;
  base::Duration least = base::Duration::max();
  base::Duration greatest{};
  std::uint32_t samples = 0;
  std::uint32_t frames = 0;
};

/// The port, which notes how long after its planned release the last job of a level was done: the alarm, the
/// switches and all in it. It holds for levels at which only a board's own tasks run, which the timer starts.
class TimedPort : public chibios::Port {
 public:
  void arm(base::Time when) noexcept {
    planned_ = when;
    Port::arm(when);
  }
  void pend(chibios::Level level) noexcept {
    Job& job = jobs_[static_cast<std::size_t>(level)];
    if (job.looks == 0) job.released = planned_, job.looks = 2;
    Port::pend(level);
  }
  /// Before a job it looks for one, and once more when it is done.
  void ran(chibios::Level level) noexcept {
    Port::ran(level);
    Job& job = jobs_[static_cast<std::size_t>(level)];
    if (job.looks == 0 || --job.looks != 0) return;
    job.longest = std::max(job.longest, now() - job.released);
    ++job.count;
  }
  void forget() noexcept {
    const chibios::Lock lock;
    for (Job& job : jobs_) job.longest = {}, job.count = 0;
  }
  [[nodiscard]] base::Duration longest(chibios::Level level) const noexcept {
    return jobs_[static_cast<std::size_t>(level)].longest;
  }
  [[nodiscard]] std::uint32_t count(chibios::Level level) const noexcept {
    return jobs_[static_cast<std::size_t>(level)].count;
  }

 private:
  struct Job {
    base::Time released{};
    unsigned looks = 0;  ///< that are still to come
    base::Duration longest{};
    std::uint32_t count = 0;
  };
  std::array<Job, scheduling::level_count> jobs_{};
  base::Time planned_{};
};

/// CAN as qemu::SlcanBus has it, without a line to the host: a frame takes its bits at 500 kbit/s, the most
/// urgent one is next, three places a level.
template <std::size_t Topics>
class LoadBus {
 public:
  LoadBus(const std::array<Asked, Topics>& asked, chibios::Port& port) noexcept
      : asked_(&asked), port_(&port) {}

  base::Result<bool> send(const can::Frame& frame) noexcept {
    const auto level = [](const can::Frame& f) { return protocol::Identifier::decode(f.id).priority; };
    if (std::ranges::count_if(waiting_, [&](const can::Frame& f) { return level(f) == level(frame); }) >= 3)
      return false;
    note(frame);
    static_cast<void>(waiting_.push_back(frame));
    begin_frame();
    return true;
  }
  chibios::BusEvent wait(can::Frame& frame) noexcept {
    for (;;) {
      {
        const chibios::Lock lock;
        if (arrived_) {
          arrived_ = false;
          frame = inbox_;
          return chibios::BusEvent::frame;
        }
        if (writable_) {
          writable_ = false;
          return chibios::BusEvent::writable;
        }
      }
      signal_.wait();
    }
  }
  /// As the controller's interrupt does. With the lock held.
  void arrive(const can::Frame& frame) noexcept {
    inbox_ = frame;
    arrived_ = true;
    signal_.raise_locked();
  }
  /// Asks for a topic: again, when it is published already.
  void ask(std::size_t topic) noexcept { ask(topic, (*asked_)[topic].priority, (*asked_)[topic].period); }
  void ask(std::size_t topic, protocol::Priority priority, base::Duration period) noexcept {
    const chibios::Lock lock;
    seen_[topic].requested = port_->now();
    seen_[topic].awaited = true;
    arrive(*protocol::publish_every((*asked_)[topic].topic, period, priority));
  }
  void stop(std::size_t topic) noexcept {
    const chibios::Lock lock;
    arrive(protocol::stop((*asked_)[topic].topic));
  }
  [[nodiscard]] const std::array<Seen, Topics>& seen() const noexcept { return seen_; }
  void forget() noexcept {
    const chibios::Lock lock;
    for (Seen& s : seen_) s = {.requested = s.requested};
    bits_ = 0;
  }
  [[nodiscard]] std::uint32_t bits() const noexcept { return bits_; }

 private:
  void note(const can::Frame& frame) noexcept {
    const auto id = protocol::Identifier::decode(frame.id).topic;
    for (std::size_t i = 0; i < Topics; ++i) {
      const unsigned index = static_cast<unsigned>(id.value) - (*asked_)[i].first.value;
      if (index >= (*asked_)[i].frames) continue;
      Seen& s = seen_[i];
      ++s.frames;
      if (index != 0) return;
      const base::Time now = port_->now();
      if (s.awaited) s.reply = std::max(s.reply, now - s.requested), ++s.replies;
      s.awaited = false;
      const base::Duration late = (now - s.requested) % (*asked_)[i].period;
      s.least = std::min(s.least, late);
      s.greatest = std::max(s.greatest, late);
      ++s.samples;
      return;
    }
  }
  void begin_frame() noexcept {
    if (busy_ || waiting_.empty()) return;
    const auto first = std::ranges::min_element(waiting_, {}, can::arbitration_key);
    const auto bits = can::frame_bits(*first);
    bits_ += static_cast<std::uint32_t>(bits);
    waiting_.erase(static_cast<std::size_t>(first - waiting_.begin()));
    busy_ = true;
    writable_ = true;
    signal_.raise_locked();
    chVTSetI(&timer_, static_cast<systime_t>(bits * 2), &sent, this);  // 2 us a bit
  }
  static void sent(void* self) {
    auto& bus = *static_cast<LoadBus*>(self);
    const chibios::Lock lock;
    bus.busy_ = false;
    bus.begin_frame();
  }

  const std::array<Asked, Topics>* asked_;
  chibios::Port* port_;
  std::array<Seen, Topics> seen_{};
  base::FixedVector<can::Frame, 12> waiting_;
  can::Frame inbox_{};
  bool arrived_ = false, busy_ = false, writable_ = false;
  std::uint32_t bits_ = 0;
  chibios::Signal signal_;
  virtual_timer_t timer_{};
};

/// The thread sleeps while the wires work, as with the DMA of the real chips.
inline void wires(std::uint32_t us) noexcept {
  if (us != 0) chThdSleep(static_cast<systime_t>(us));
}

/// No part answers, as one without power.
inline bool away = false;

/// Parts on an I2C bus: registers that keep what is written, each part the same set.
class LoadI2c {
 public:
  explicit LoadI2c(std::uint32_t bit_rate) noexcept : us_a_byte_x16_(9 * 16'000'000 / bit_rate) {}
  /// A part at this address answers. `first`: what its first two registers say, whatever is written to them.
  std::array<std::uint8_t, 256>& part(std::size_t slot, std::uint8_t address,
                                      const std::uint8_t* first = nullptr) noexcept {
    parts_[slot].address = address;
    parts_[slot].answers_first = first;
    return parts_[slot].registers;
  }
  /// Of this register the part sets these bits, whatever is written to it.
  void set_always(std::size_t slot, std::uint8_t where, std::uint8_t bits) noexcept {
    parts_[slot].set_where = where;
    parts_[slot].set_bits = bits;
  }
  base::Status transfer(std::uint8_t address, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) noexcept {
    mutex_.lock();
    const std::size_t bytes = 1 + write.size() + (read.empty() ? 0 : 1 + read.size());
    wires(static_cast<std::uint32_t>(bytes) * us_a_byte_x16_ / 16);
    base::Status answer = base::Error::no_answer;
    for (Part& part : parts_) {
      if (away || part.address != address) continue;
      if (!write.empty()) part.pointer = write[0];
      for (std::size_t i = 1; i < write.size(); ++i) part.registers[part.pointer + i - 1] = write[i];
      if (part.answers_first)
        part.registers[0] = part.answers_first[0], part.registers[1] = part.answers_first[1];
      part.registers[part.set_where] |= part.set_bits;
      for (std::size_t i = 0; i < read.size(); ++i) read[i] = part.registers[part.pointer + i];
      answer = {};
    }
    mutex_.unlock();
    return answer;
  }

 private:
  struct Part {
    std::uint8_t address = 0xFF;
    std::uint8_t pointer = 0;
    const std::uint8_t* answers_first = nullptr;
    std::uint8_t set_where = 0;
    std::uint8_t set_bits = 0;
    std::array<std::uint8_t, 256> registers{};
  };
  std::uint32_t us_a_byte_x16_;
  std::array<Part, 3> parts_{};
  chibios::Mutex mutex_;
};
static_assert(firmware::drivers::I2c<LoadI2c>);

/// A motion sensor on SPI: bit 7 reads, bit 6 counts up.
class LoadSpi {
 public:
  explicit LoadSpi(std::uint8_t identity) noexcept { registers_[0x0F] = identity; }
  base::Status transfer(const firmware::drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in) noexcept {
    mutex_.lock();
    wires(static_cast<std::uint32_t>(out.size() * 8'000'000 / settings.highest_clock_hz) + 1);
    std::uint8_t at = out[0] & 0x3F;
    for (std::size_t i = 1; i < out.size(); ++i) {
      if ((out[0] & 0x80) == 0) registers_[at] = out[i];
      in[i] = away ? std::uint8_t{0xFF} : registers_[at];
      at = static_cast<std::uint8_t>((at + (out[0] >> 6 & 1)) & 0x3F);
    }
    mutex_.unlock();
    return {};
  }

 private:
  std::array<std::uint8_t, 64> registers_{};
  chibios::Mutex mutex_;
};
static_assert(firmware::drivers::Spi<LoadSpi>);

/// Wheels on a curve, so that the odometry's heading takes all values.
struct LoadMotors {
  std::array<std::uint16_t, 2> counts{};
  std::array<std::uint16_t, 2> encoders() noexcept {
    counts[0] = static_cast<std::uint16_t>(counts[0] + 20);
    counts[1] = static_cast<std::uint16_t>(counts[1] + 80);
    return counts;
  }
  void set_duty(std::int16_t /*left*/, std::int16_t /*right*/) noexcept {}
};
struct LoadPins {
  std::uint8_t read() noexcept { return 0; }
  void write(std::uint8_t /*levels*/) noexcept {}
};

template <std::size_t Fast, std::size_t Slow>
[[nodiscard]] constexpr std::array<Asked, Fast + Slow> join(const std::array<Asked, Fast>& fast,
                                                            const std::array<Asked, Slow>& slow) noexcept {
  std::array<Asked, Fast + Slow> all{};
  std::ranges::copy(slow, std::ranges::copy(fast, all.begin()).out);
  return all;
}

/// From start_machine() to the end of the measurement: a second for the parts to turn on, one of rest; the
/// requests for the fast topics OCM_LOAD_SPREAD_US apart, ten seconds under load, and a hundred requests more
/// for each; ten seconds with the slow ones, too.
template <template <class, class, class> class Board, class Parts, std::size_t Topics, std::size_t Slow>
[[noreturn]] void measure(const char* name, const std::array<Asked, Topics>& asked,
                          const std::array<Asked, Slow>& slow, Parts& parts) noexcept {
  using Bus = LoadBus<Topics + Slow>;
  static chibios::Port port;
  static const std::array<Asked, Topics + Slow> all = join(asked, slow);
  static Bus bus{all, port};
  parts.start(port.now());
  static Board<Parts, Bus, chibios::Port> board{parts, bus, port};
  static chibios::Runtime runtime{port, board.controller(), bus};
  static const char* title = name;
  static THD_WORKING_AREA(area, 1024);
  // Above all levels, and awake for a moment a millisecond at most: what an interrupt would be.
  chThdCreateStatic(
      area, sizeof area, HIGHPRIO,
      [](void*) {
        chThdSleepMilliseconds(1000);  // parts turn on, and are looked for
        const base::Duration idle_before = port.idle();
        const base::Time quiet_begin = port.now();
        chThdSleepMilliseconds(1000);
        const base::Duration quiet = port.idle() - idle_before;
        const base::Duration quiet_time = port.now() - quiet_begin;
        const auto ask_all = [] {
          for (std::size_t i = 0; i < Topics; ++i) {
            bus.ask(i);
            chThdSleep(OCM_LOAD_SPREAD_US);
          }
        };
        ask_all();
        chThdSleepMilliseconds(500);
        bus.forget();
        const base::Duration idle_begin = port.idle();
        const base::Time begin = port.now();
        for (int second = 0; second < 10; ++second)
          chThdSleepMilliseconds(1000);  // more the kernel's macro does not hold
        const base::Duration idle = port.idle() - idle_begin;
        const base::Duration time = port.now() - begin;
        const std::array<Seen, Topics + Slow> regular = bus.seen();
        const std::uint32_t bits = bus.bits();
        // And now requests under that load, at times that have nothing to do with it.
        bus.forget();
        for (int round = 0; round < 100; ++round) {
          ask_all();
          chThdSleep(73'013);
        }
        const auto counters = board.controller().counters();
        const std::array<Seen, Topics + Slow> asked_again = bus.seen();
        for (std::size_t i = Topics; i < Topics + Slow; ++i) {
          bus.ask(i);
          chThdSleep(OCM_LOAD_SPREAD_US);
        }
        chThdSleepMilliseconds(500);
        const base::Duration all_idle_begin = port.idle();
        const base::Time all_begin = port.now();
        for (int second = 0; second < 10; ++second) chThdSleepMilliseconds(1000);
        const base::Duration all_idle = port.idle() - all_idle_begin;
        const base::Duration all_time = port.now() - all_begin;
        for (std::size_t i = 0; i < Topics; ++i) {
          const Seen& s = regular[i];
          const Asked& a = all[i];
          say(title), say(" topic "), say(a.topic.value), say(" level "), say(static_cast<int>(a.priority));
          say(" samples "), say(s.samples), say(" frames "), say(s.frames);
          say(" reply_us "), say(asked_again[i].reply / 1us), say(" least_us "), say(s.least / 1us);
          say(" greatest_us "), say(s.greatest / 1us), say("\n");
        }
        say(title), say(" idle_permille "), say(idle * 1000 / time), say(" all_permille ");
        say(all_idle * 1000 / all_time), say(" quiet_permille ");
        say(quiet * 1000 / quiet_time), say(" bus_permille "), say(std::int64_t{bits} * 2'000 / (time / 1us));
        say(" late "), say(counters.late), say(" missed "), say(counters.missed), say(" overrun ");
        say(counters.overrun), say(" not_sampled "), say(counters.not_sampled);
        say("\n");
        firmware::qemu::leave("", 0);
      },
      nullptr);
  runtime.run([](base::Time now) { board.maintain(now); });
}

/// What a job takes where nothing more urgent is in its way, topic by topic and for the board's own tasks.
///
/// The own tasks in ten seconds of rest: from the planned release to the end of the latest one, at `urgent`
/// and at `high`. The longest step of looking after the parts in that time, and while all come back that were
/// away. A topic from its request, which its first sample follows at once, to that sample's first frame,
/// at `urgent`: first with nothing else asked for, then beside all others at the three levels below, whose
/// periods differ, so that they meet it at all times. What it waits for there are transfers that less urgent
/// ones have begun; each level may have one under way.
/// `command` is repeated: so a board does by itself what it can at `low`. All must outlive the board.
template <template <class, class, class> class Board, class Parts, std::size_t Topics>
[[noreturn]] void measure_costs(const char* name, const std::array<Asked, Topics>& topics, Parts& parts,
                                const can::Frame* command = nullptr) noexcept {
  using Bus = LoadBus<Topics>;
  static TimedPort port;
  static Bus bus{topics, port};
  if constexpr (requires { parts.look; }) parts.look.port = &port;
  parts.start(port.now());
  static Board<Parts, Bus, TimedPort> board{parts, bus, port};
  static chibios::Runtime runtime{port, board.controller(), bus};
  static const char* title = name;
  static const can::Frame* repeated = command;
  static const std::array<Asked, Topics>* asked = &topics;
  static base::Duration upkeep{};  // the longest step
  static THD_WORKING_AREA(area, 1024);
  chThdCreateStatic(
      area, sizeof area, HIGHPRIO,
      [](void*) {
        chThdSleepMilliseconds(1000);  // parts turn on, and are looked for
        port.forget();
        upkeep = {};
        const base::Duration idle = port.idle();
        const base::Time begin = port.now();
        chThdSleep(10'000'000);  // in one piece: to wake up takes time, too
        const base::Duration busy = port.now() - begin - (port.idle() - idle);
        say(title), say(" busy_in_50_ms_us "), say(busy / 200us);
        for (const auto level : {chibios::Level::urgent, chibios::Level::high}) {
          say(level == chibios::Level::urgent ? " urgent_us " : " high_us "), say(port.longest(level) / 1us);
          say(level == chibios::Level::urgent ? " urgent_jobs " : " high_jobs "), say(port.count(level));
        }
        say(" checks_us "), say(upkeep / 1us);
        away = true;
        chThdSleepMilliseconds(1500);  // longer than a part is not looked at
        away = false;
        chThdSleepMilliseconds(2500);
        say(" starts_us "), say(upkeep / 1us), say("\n");
#ifdef OCM_LOAD_OWN_TASKS
        firmware::qemu::leave("", 0);
#endif
        constexpr base::Duration once_only = 1s;
        // A round is 50.25 ms. The longest of them.
        const auto rounds = [](std::size_t topic, int count) {
          bus.forget();
          for (int round = 0; round < count; ++round) {
            bus.ask(topic, protocol::Priority::urgent, once_only);
            chThdSleep(30'125);
            if (repeated) {
              const chibios::Lock lock;
              bus.arrive(*repeated);
            }
            chThdSleep(20'125);
          }
          return bus.seen()[topic];
        };
        const auto stop = [](std::size_t topic) {
          bus.stop(topic);
          chThdSleepMilliseconds(20);
        };
        for (std::size_t i = 0; i < Topics; ++i) {
          const base::Duration first = rounds(i, 1).reply;
          const Seen alone = rounds(i, 20);
          stop(i);
          unsigned level = 0;
          for (std::size_t k = 0; k < Topics; ++k) {
            if (k == i) continue;
            const auto below = static_cast<protocol::Priority>(1 + level++ % 3);
            bus.ask(k, below, 43ms + 3ms * static_cast<int>(k));
            chThdSleepMilliseconds(3);
          }
          chThdSleepMilliseconds(200);
          const Seen beside = rounds(i, 600);
          for (std::size_t k = 0; k < Topics; ++k) stop(k);
          say(title), say(" topic "), say((*asked)[i].topic.value), say(" first_us "), say(first / 1us);
          say(" alone_us "), say(alone.reply / 1us), say(" beside_us "), say(beside.reply / 1us);
          say(" replies "), say(alone.replies + beside.replies), say("\n");
        }
        firmware::qemu::leave("", 0);
      },
      nullptr);
  runtime.run([](base::Time now) {
    board.maintain(now);
    upkeep = std::max(upkeep, port.now() - now);
  });
}

/// How long one look at parts has taken at most: what a step of a behaviour waits for.
struct Longest {
  template <class Read>
  auto of(Read read) noexcept {
    const base::Time begin = port->now();
    auto result = read();
    time = std::max(time, port->now() - begin);
    ++count;
    return result;
  }
  chibios::Port* port = nullptr;  ///< set before the board runs
  base::Duration time{};
  std::uint32_t count = 0;
};

/// A board that does something by itself: `command`, repeated every 100 ms, for five seconds without
/// requests; then under those of `measure`, at times that have nothing to do with its steps. Says how long
/// its `look` at parts takes at most, alone and under load, how much processor a step takes, that look
/// included, and how many there were in the five seconds.
template <template <class, class, class> class Board, class Parts, std::size_t Topics>
[[noreturn]] void measure_behaviour(const char* name, const std::array<Asked, Topics>& asked,
                                    const can::Frame& command, Parts& parts) noexcept {
  using Bus = LoadBus<Topics>;
  static chibios::Port port;
  static Bus bus{asked, port};
  parts.start(port.now());
  static Board<Parts, Bus, chibios::Port> board{parts, bus, port};
  static chibios::Runtime runtime{port, board.controller(), bus};
  static const char* title = name;
  static const can::Frame* again = &command;
  static Longest* looked = &parts.look;
  looked->port = &port;
  static THD_WORKING_AREA(area, 1024);
  chThdCreateStatic(
      area, sizeof area, HIGHPRIO,
      [](void*) {
        const auto busy = [](bool commanded) {
          const base::Duration idle = port.idle();
          const base::Time begin = port.now();
          for (int tenth = 0; tenth < 50; ++tenth) {
            if (commanded) {
              const chibios::Lock lock;
              bus.arrive(*again);
            }
            chThdSleepMilliseconds(100);
          }
          return port.now() - begin - (port.idle() - idle);
        };
        chThdSleepMilliseconds(1000);  // parts turn on, and are looked for
        const base::Duration at_rest = busy(false);
        static_cast<void>(busy(true));  // set points and motors settle
        *looked = {.port = &port};
        const base::Duration active = busy(true);
        const Longest alone = *looked;
        *looked = {.port = &port};
        for (int round = 0; round < 200; ++round) {
          for (std::size_t i = 0; i < Topics; ++i) {
            bus.ask(i);
            chThdSleep(3000);
          }
          {
            const chibios::Lock lock;
            bus.arrive(*again);
          }
          chThdSleep(73'013);
        }
        say(title), say(" behaviour_look_us "), say(alone.time / 1us), say(" loaded_us ");
        say(looked->time / 1us), say(" steps "), say(static_cast<std::int64_t>(alone.count));
        say(" busy_us "), say((active - at_rest) / 1us);
        say("\n");
        firmware::qemu::leave("", 0);
      },
      nullptr);
  runtime.run([](base::Time now) { board.maintain(now); });
}

}  // namespace ocm::bench
