#include "ocm/transport/slcan.hpp"

#include <atomic>
#include <functional>
#include <mutex>
#include <pty.h>
#include <string>
#include <thread>

#include <catch2/catch.hpp>

#include "ocm/can/slcan_adapter.hpp"
#include "ocm/can/text.hpp"

#include "unit/can/frame_of.hpp"

namespace transport_slcan_test {

using namespace ocm;
using namespace std::chrono_literals;
using test::frame;
using transport::BusState;
using transport::Slcan;
using transport::SlcanOptions;

std::string text(const can::Frame& f) {
  return std::string(can::to_text(f).view());
}

/// What the adapter puts on its bus.
struct Wire {
  std::size_t room = SIZE_MAX;
  std::size_t refused = 0;
  std::vector<can::Frame> sent;
  base::Result<bool> send(const can::Frame& f) {
    if (sent.size() >= room) {
      ++refused;
      return false;
    }
    sent.push_back(f);
    return true;
  }
};

/// An adapter on the far end of a pty. A thread of its own answers what comes by `answer`; what it needs is
/// guarded by `with`.
class Device {
 public:
  /// By default an adapter by the manual.
  explicit Device(std::function<std::string(Device&, char)> answer = by_the_manual)
      : answer_(std::move(answer)) {
    int master = -1;
    int slave = -1;
    char name[64] = {};
    REQUIRE(::openpty(&master, &slave, name, nullptr, nullptr) == 0);
    termios raw{};
    REQUIRE(::tcgetattr(slave, &raw) == 0);
    ::cfmakeraw(&raw);
    raw.c_lflag |= ECHO;  // something that the host must switch off, and on again
    REQUIRE(::tcsetattr(slave, TCSANOW, &raw) == 0);
    line_ = host::Descriptor{master};
    slave_ = host::Descriptor{slave};
    path_ = name;
    start();
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() { unplug(); }

  static std::string by_the_manual(Device& device, char c) {
    return std::string(device.adapter.feed(c, device.wire).view());
  }

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] int slave() const { return slave_.get(); }
  template <class F>
  auto with(F&& what) {
    const std::lock_guard guard{mutex_};
    return what();
  }
  void say(std::string_view words) const {
    REQUIRE(::write(line_.get(), words.data(), words.size()) == static_cast<ssize_t>(words.size()));
  }
  void hear(const can::Frame& f, base::Time now) {
    say(with([&] { return std::string(adapter.hear(f, now).view()); }));
  }
  [[nodiscard]] std::string heard() {
    return with([&] { return heard_; });
  }
  /// No more characters are read, as with a device that is busy.
  void stall(bool on) {
    with([&] { stalled_ = on; });
  }
  void unplug() {
    ended_ = true;
    if (thread_.joinable()) thread_.join();
    line_.reset();
    slave_.reset();
  }

  can::slcan::Adapter adapter;
  Wire wire;

 private:
  void start() {
    thread_ = std::thread([this] {
      while (!ended_) {
        pollfd line{line_.get(), POLLIN, 0};
        const bool ready = ::poll(&line, 1, 2) > 0 && (line.revents & POLLIN) != 0;
        std::unique_lock guard{mutex_};
        if (!ready || stalled_) {
          guard.unlock();
          std::this_thread::sleep_for(1ms);
          continue;
        }
        char some[64];
        const ssize_t size = ::read(line_.get(), some, sizeof some);
        if (size <= 0) return;
        std::string answers;
        for (const char c : std::string_view{some, static_cast<std::size_t>(size)}) {
          heard_ += c;
          answers += answer_(*this, c);
        }
        if (!answers.empty() && ::write(line_.get(), answers.data(), answers.size()) < 0) return;
      }
    });
  }

  std::function<std::string(Device&, char)> answer_;
  host::Descriptor line_;
  host::Descriptor slave_;
  std::string path_;
  std::string heard_;
  std::mutex mutex_;
  bool stalled_ = false;
  std::atomic<bool> ended_ = false;
  std::thread thread_;
};

/// Whole lines, each answered from its first letter; BEL for those not in the table.
std::function<std::string(Device&, char)> by_letter(std::vector<std::pair<char, std::string>> table) {
  return [table = std::move(table), line = std::string{}](Device&, char c) mutable -> std::string {
    if (c != '\r') {
      line += c;
      return {};
    }
    const char letter = line.empty() ? '\r' : line[0];
    line.clear();
    for (const auto& [first, answer] : table)
      if (first == letter) return answer;
    return "\a";
  };
}

/// An adapter answers in time, however busy this machine is.
SlcanOptions patient() {
  SlcanOptions options;
  options.first_answer = options.patience = options.answer_limit = 20s;
  return options;
}
/// Is not waited for while it is opened: it may be one that never answers, or talks of something else.
SlcanOptions patient_for(base::Duration first_answer) {
  SlcanOptions options = patient();
  options.first_answer = first_answer;
  return options;
}

std::unique_ptr<Slcan> open(const std::string& path, const SlcanOptions& options = patient()) {
  auto bus = Slcan::open(path, options);
  INFO(bus.error.what << "; " << bus.error.remedy);
  REQUIRE(bus);
  return std::move(bus.value);
}

transport::Failure failure(const std::string& path, SlcanOptions options = {}) {
  const auto bus = Slcan::open(path, options);
  REQUIRE_FALSE(bus);
  CHECK_FALSE(bus.error.what.empty());
  CHECK_FALSE(bus.error.remedy.empty());
  return bus.error;
}

template <class F>
void eventually(F&& holds) {
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (!holds()) {
    REQUIRE(std::chrono::steady_clock::now() < end);
    std::this_thread::sleep_for(1ms);
  }
}

/// Sends, and tries again while there is no room.
void send(Slcan& bus, const can::Frame& f) {
  eventually([&] {
    const auto taken = bus.send(f);
    REQUIRE(taken);
    if (!*taken) (void)bus.receive(1ms);
    return *taken;
  });
}

std::vector<std::string> receive(Slcan& bus, std::size_t count) {
  std::vector<std::string> all;
  while (all.size() < count) {
    const auto received = bus.receive(60s);
    INFO(base::describe(received.error));
    REQUIRE(received);
    all.push_back(text(received->frame));
  }
  return all;
}

using Catch::Matchers::Contains;

TEST_CASE("slcan: what cannot be opened is reported with what to do") {
  CHECK_THAT(failure("/dev/no-such-adapter").what, Contains("no serial device '/dev/no-such-adapter'"));
  CHECK_THAT(failure("/dev/null").what, Contains("'/dev/null' is no serial device"));
  CHECK_THAT(failure("/etc/passwd").what, Contains("neither a serial device nor a socket"));
  Device device;
  SlcanOptions odd;
  odd.bit_rate = 83'333;
  CHECK_THAT(failure(device.path(), odd).remedy, Contains("100k"));
  const auto first = open(device.path());
  CHECK_THAT(failure(device.path()).what, Contains("in use by another program"));
}

TEST_CASE("slcan: an adapter is opened in order, and left as it was") {
  Device device;
  // As a program left it that did not close: open at another bit rate, in the middle of a line.
  device.with([&] {
    for (const char c : std::string_view{"S4\rO\rt10"}) (void)device.adapter.feed(c, device.wire);
  });
  {
    const auto bus = open(device.path());
    CHECK(bus->name() == "slcan:" + device.path());
    CHECK(bus->answers());
    CHECK(bus->version() == "1010");
    CHECK(bus->state() == BusState::up);
    device.with([&] {
      CHECK(device.adapter.channel() == can::slcan::Adapter::Channel::open);
      CHECK(device.adapter.bit_rate() == 500'000);
      CHECK(device.adapter.stamps());
    });
    termios now{};
    REQUIRE(::tcgetattr(device.slave(), &now) == 0);
    CHECK((now.c_lflag & (ECHO | ICANON)) == 0);
  }
  CHECK_THAT(device.heard(), Contains("C\rV\rS6\rZ1\rO\rF\r"));
  termios after{};
  REQUIRE(::tcgetattr(device.slave(), &after) == 0);
  CHECK((after.c_lflag & ECHO) != 0);
  eventually([&] {
    return device.with([&] { return device.adapter.channel() == can::slcan::Adapter::Channel::closed; });
  });
  CHECK(open(device.path())->answers());  // and again
}

TEST_CASE("slcan: frames of every kind go both ways") {
  Device device;
  const auto bus = open(device.path());
  const std::vector<std::string> all = {"000#",        "205#01840302", "7FF#0011223344556677",
                                        "605#R",       "605#R8",       "1F334455#1122334455667788",
                                        "00000005#DE", "1F334455#R3",  "1FFFFFFF#"};
  for (const std::string& one : all) send(*bus, frame(one));
  eventually([&] {
    (void)bus->receive(1ms);
    return device.with([&] { return device.wire.sent.size() == all.size(); });
  });
  device.with([&] {
    for (std::size_t i = 0; i < all.size(); ++i) CHECK(text(device.wire.sent[i]) == all[i]);
  });
  for (const std::string& one : all) device.hear(frame(one), base::Time{});
  CHECK(receive(*bus, all.size()) == all);
  CHECK(bus->receive(0ms).error == base::Error::timed_out);
  CHECK(bus->counters().sent == all.size());
  CHECK(bus->counters().received == all.size());
  CHECK(bus->line_faults().total() == 0);
  CHECK(bus->adapter_counters().unanswered == 0);
  CHECK(bus->adapter_counters().strays == 0);
  CHECK(bus->delivery().known);
  CHECK(bus->delivery().pending == 0);
  device.say("z\r");  // an answer to nothing
  eventually([&] {
    (void)bus->receive(1ms);
    return bus->adapter_counters().strays == 1;
  });

  CHECK(bus->send({0x800, 0, {}}).error == base::Error::bad_identifier);
  CHECK(bus->send({0x100, 9, {}}).error == base::Error::bad_length);
  CHECK(bus->send({4, 8, {}, can::Format::error}).error == base::Error::bad_identifier);
}

TEST_CASE("slcan: filters hold for what comes and for what waits; error frames pass") {
  Device device;
  const auto bus = open(device.path());
  device.say("t6050\rt6080\r");
  std::this_thread::sleep_for(20ms);
  CHECK(receive(*bus, 1) == std::vector<std::string>{"605#"});  // 608 waits inside
  const can::Filter filter{0x605, 0x7FF};
  REQUIRE(bus->subscribe({&filter, 1}));
  device.say("t6081AA\rT000006050\re1a\rt6051BB\r");
  CHECK(receive(*bus, 2) == std::vector<std::string>{"200000A8#0000001900000000", "605#BB"});
  CHECK(bus->counters().error_frames == 1);
  REQUIRE(bus->subscribe({}));
  device.say("t6081AA\r");
  CHECK(receive(*bus, 1) == std::vector<std::string>{"608#AA"});
}

TEST_CASE("slcan: an adapter that refuses is distinguished by what it refuses") {
  SECTION("the bit rate") {
    Device device(by_letter({{'\r', "\r"}, {'C', "\r"}, {'V', "V1013\r"}}));
    const auto told = failure(device.path(), patient());
    CHECK_THAT(told.what, Contains("refuses the bit rate 500k (command S6)") && Contains(device.path()));
  }
  SECTION("the channel") {
    Device device(by_letter({{'\r', "\r"}, {'C', "\r"}, {'V', "V1013\r"}, {'S', "\r"}, {'Z', "\r"}}));
    CHECK_THAT(failure(device.path(), patient()).what, Contains("refuses to open the channel (command O)"));
  }
  SECTION("it falls silent on the way") {
    Device device(by_letter({{'\r', "\r"}, {'C', "\r"}, {'V', "V1013\r"}, {'S', ""}}));
    CHECK_THAT(failure(device.path(), patient_for(5s)).what,
               Contains("has stopped to answer") && Contains("(command S6)"));
  }
  SECTION("what it does not have, it need not have: V, Z, F") {
    Device device(by_letter({{'\r', "\a"}, {'C', "\a"}, {'S', "\r"}, {'O', "\r"}, {'t', "\r"}}));
    const auto bus = open(device.path());
    CHECK(bus->answers());
    send(*bus, frame("100#"));
    CHECK(bus->receive(30ms).error == base::Error::timed_out);
    CHECK(bus->adapter_counters().unanswered == 0);
  }
  SECTION("something that is no adapter talks") {
    Device device([](Device&, char c) { return c == '\r' ? std::string{"login: \r\n"} : std::string{}; });
    const auto told = failure(device.path(), patient_for(2s));
    CHECK_THAT(told.what, Contains("is not SLCAN"));
    CHECK_THAT(told.remedy, Contains("57600"));
  }
  SECTION("the wrong speed of the line") {
    Device device([](Device&, char c) { return c == '\r' ? std::string{"\xF8\x80\x80\r"} : std::string{}; });
    CHECK_THAT(failure(device.path(), patient_for(2s)).what, Contains("is not SLCAN"));
  }
  SECTION("it goes while it is opened") {
    Device device(by_letter({{'\r', "\r"}}));
    std::thread hand([&] {
      std::this_thread::sleep_for(50ms);
      device.unplug();
    });
    CHECK_THAT(failure(device.path(), patient()).what, Contains("is gone"));
    hand.join();
  }
}

TEST_CASE("slcan: adapters that never answer work") {
  SECTION("not at all") {
    Device device([](Device& d, char c) {
      (void)Device::by_the_manual(d, c);
      return std::string{};
    });
    const auto bus = open(device.path(), patient_for(300ms));
    CHECK_FALSE(bus->answers());
    CHECK_FALSE(bus->delivery().known);
    for (int i = 0; i < 100; ++i) send(*bus, {0x205, 1, {static_cast<std::uint8_t>(i)}});
    eventually([&] { return device.with([&] { return device.wire.sent.size() == 100; }); });
    device.with([&] {
      for (std::size_t i = 0; i < 100; ++i) CHECK(device.wire.sent[i].data[0] == i);
    });
    device.hear(frame("605#01"), base::Time{});
    CHECK(receive(*bus, 1) == std::vector<std::string>{"605#01"});
  }
  SECTION("but with its version") {
    Device device([](Device& d, char c) {
      const std::string answer = Device::by_the_manual(d, c);
      return answer.starts_with('V') ? "VL2K0 1a2b3c4 github.com/example\r" : std::string{};
    });
    const auto bus = open(device.path());
    CHECK_FALSE(bus->answers());
    CHECK_THAT(bus->version(), Contains("github"));
    eventually([&] {
      return device.with([&] { return device.adapter.channel() == can::slcan::Adapter::Channel::open; });
    });
  }
  SECTION("to commands, but not to frames") {
    Device device([](Device& d, char c) {
      const std::string answer = Device::by_the_manual(d, c);
      return answer == "z\r" ? std::string{} : answer;
    });
    SlcanOptions options = patient();
    options.answer_limit = 50ms;
    options.status_period = 1h;
    const auto bus = open(device.path(), options);
    for (int i = 0; i < 200; ++i) send(*bus, {static_cast<std::uint32_t>(i), 0, {}});
    eventually([&] { return device.with([&] { return device.wire.sent.size() == 200; }); });
    CHECK(bus->adapter_counters().sent_again == 0);
    CHECK(bus->adapter_counters().unanswered == 1);
  }
}

TEST_CASE("slcan: no more than the window is unanswered, and of one identifier only one") {
  Device device([](Device& d, char c) {
    const std::string answer = Device::by_the_manual(d, c);
    return answer == "z\r" || answer == "Z\r" ? std::string{} : answer;
  });
  SlcanOptions options = patient();
  options.answer_limit = 60s;
  const auto bus = open(device.path(), options);
  CHECK(*bus->send(frame("100#01")));
  CHECK_FALSE(*bus->send(frame("100#02")));
  CHECK(*bus->send(frame("00000100#02")));  // extended: another identifier
  for (std::uint32_t id = 0x101; id <= 0x106; ++id) CHECK(*bus->send({id, 0, {}}));
  CHECK_FALSE(*bus->send(frame("107#")));
  CHECK(bus->counters().refused == 2);
  CHECK(bus->delivery().known);
  CHECK(bus->delivery().pending == 8);
  device.say("z\r");
  eventually([&] { return bus->delivery().pending == 7; });
  eventually([&] { return *bus->send(frame("100#02")); });
  CHECK(bus->delivery().pending == 8);
  CHECK(bus->delivery().obstruction == transport::Failure{});
  CHECK_FALSE(*bus->send(frame("107#")));
}

TEST_CASE("slcan: what a full adapter refuses is sent again, in the order of each identifier") {
  Device device;
  const auto bus = open(device.path());
  device.with([&] { device.wire.room = 3; });
  std::atomic<bool> done = false;
  std::thread drain([&] {  // the CAN bus takes one now and then, once the adapter is full
    while (!done) {
      std::this_thread::sleep_for(1ms);
      device.with([&] { device.wire.room += device.wire.refused != 0 ? 1 : 0; });
    }
  });
  for (std::uint8_t i = 0; i < 60; ++i) send(*bus, {0x100U + i % 5U, 1, {i}});
  eventually([&] {
    (void)bus->receive(1ms);
    return device.with([&] { return device.wire.sent.size() == 60; });
  });
  done = true;
  drain.join();
  CHECK(bus->adapter_counters().sent_again > 0);
  CHECK(bus->adapter_counters().unanswered == 0);
  device.with([&] {
    std::array<int, 5> last{-1, -1, -1, -1, -1};
    for (const can::Frame& f : device.wire.sent) {
      CHECK(f.data[0] > last[f.id - 0x100]);
      last[f.id - 0x100] = f.data[0];
    }
  });
}

TEST_CASE("slcan: what was refused is sent again while the program only waits") {
  int tried = 0;
  Device device([&tried](Device& d, char c) {
    const std::string answer = Device::by_the_manual(d, c);
    if (answer != "z\r") return answer;
    return ++tried == 1 ? std::string{"\a"} : "z\rt60511F\r";
  });
  SlcanOptions options = patient();
  options.status_period = 1h;  // nothing else to do
  const auto bus = open(device.path(), options);
  CHECK(*bus->send(frame("100#01")));
  CHECK(receive(*bus, 1) == std::vector<std::string>{"605#1F"});
  CHECK(bus->adapter_counters().sent_again == 1);
  CHECK(bus->adapter_counters().unanswered == 0);
}

TEST_CASE("slcan: a program that ends at once has still sent, also what was refused first") {
  Device device;
  std::thread later;
  {
    SlcanOptions options = patient();
    options.farewell = options.answer_limit;
    auto opened = transport::Slcan::open(device.path(), options);
    REQUIRE(opened);
    const auto bus = std::move(*opened);
    device.stall(true);
    device.with([&] { device.wire.room = 0; });
    for (std::uint32_t id = 1; id <= 5; ++id) CHECK(*bus->send({id, 0, {}}));
    later = std::thread([&] {
      device.stall(false);
      eventually([&] {  // at least one has been refused
        return device.with([&] { return device.adapter.flags() != 0; });
      });
      device.with([&] { device.wire.room = 10; });
    });
  }
  later.join();
  eventually([&] {  // its last word needs no answer
    return device.with([&] { return device.adapter.channel() == can::slcan::Adapter::Channel::closed; });
  });
  device.with([&] { CHECK(device.wire.sent.size() == 5); });
}

TEST_CASE("slcan: a line that no adapter reads is full, and not one frame is torn") {
  Device device([](Device& d, char c) {
    (void)Device::by_the_manual(d, c);
    return std::string{};
  });
  const auto bus = open(device.path(), patient_for(300ms));
  device.stall(true);
  std::size_t taken = 0;
  for (int i = 0; i < 100'000 && bus->counters().refused == 0; ++i) {
    const auto sent =
        bus->send({0x100, 8, {static_cast<std::uint8_t>(taken), static_cast<std::uint8_t>(taken >> 8)}});
    REQUIRE(sent);
    taken += *sent ? 1 : 0;
  }
  CHECK(taken > 10);
  CHECK(taken < 100'000);
  CHECK(bus->counters().refused > 0);
  device.stall(false);
  for (int i = 0; i < 10; ++i, ++taken)
    send(*bus, {0x100, 8, {static_cast<std::uint8_t>(taken), static_cast<std::uint8_t>(taken >> 8)}});
  eventually([&] { return device.with([&] { return device.wire.sent.size() == taken; }); });
  device.with([&] {
    for (std::size_t i = 0; i < taken; ++i)
      REQUIRE(device.wire.sent[i].data[0] + 256 * device.wire.sent[i].data[1] == static_cast<int>(i));
    CHECK(device.adapter.faults().total() == 0);
  });
  CHECK(bus->counters().sent == taken);
}

TEST_CASE("slcan: garbage between lines is counted, and costs no frame") {
  Device device;
  const auto bus = open(device.path());
  std::vector<std::string> wanted;
  for (int i = 0; i < 100; ++i) {
    const can::Frame f{0x600, 1, {static_cast<std::uint8_t>(i)}};
    wanted.push_back(text(f));
    device.say("\xFF\xFEnoise\r" + std::string(can::slcan::encode(f)->view()) + "t60081122\r");
    if (i % 10 == 9) {  // a pty holds 4 KiB
      const auto got = receive(*bus, 10);
      CHECK(got == std::vector<std::string>(wanted.end() - 10, wanted.end()));
    }
  }
  CHECK(bus->receive(10ms).error == base::Error::timed_out);
  CHECK(bus->line_faults().noise == 100);
  CHECK(bus->line_faults().bad_syntax == 100);
  CHECK(bus->line_faults().total() == 200);
}

TEST_CASE("slcan: unplugged in the middle of a line") {
  Device device;
  const auto bus = open(device.path());
  device.say("t6051AA\rt6051BB\rt6051C");
  std::this_thread::sleep_for(20ms);
  CHECK(receive(*bus, 1) == std::vector<std::string>{"605#AA"});
  device.unplug();
  CHECK(receive(*bus, 1) == std::vector<std::string>{"605#BB"});
  CHECK(bus->receive(5s).error == base::Error::closed);
  CHECK(bus->state() == BusState::closed);
  CHECK_THAT(bus->failure().what,
             Contains(device.path()) && Contains("is gone") && Contains("in the middle of a line"));
  CHECK_FALSE(bus->failure().remedy.empty());
  CHECK(bus->send(frame("100#")).error == base::Error::closed);
  CHECK(bus->receive(0ms).error == base::Error::closed);
}

TEST_CASE("slcan: unplugged while waiting, and before sending") {
  Device device;
  const auto bus = open(device.path());
  std::thread hand([&] {
    std::this_thread::sleep_for(30ms);
    device.unplug();
  });
  CHECK(bus->receive(10s).error == base::Error::closed);
  hand.join();

  Device other;
  const auto second = open(other.path());
  other.unplug();
  CHECK(second->send(frame("100#")).error == base::Error::closed);
}

TEST_CASE("slcan: an answer that never comes does not stop the others") {
  int number = 0;
  Device device([&number](Device& d, char c) {
    const std::string answer = Device::by_the_manual(d, c);
    return answer == "z\r" && ++number == 2 ? std::string{"\xFF\r"} : answer;
  });
  SlcanOptions options = patient();
  options.answer_limit = 2s;  // longer than a busy machine keeps an adapter from answering
  const auto bus = open(device.path(), options);
  for (std::uint32_t id = 1; id <= 30; ++id) send(*bus, {id, 0, {}});
  eventually([&] {
    (void)bus->receive(1ms);
    return device.with([&] { return device.wire.sent.size() == 30; });
  });
  eventually([&] {
    (void)bus->receive(1ms);
    return bus->adapter_counters().unanswered == 1;
  });
  CHECK(bus->adapter_counters().sent_again == 0);  // it is not known: better once than twice
  CHECK(bus->line_faults().noise == 1);
}

TEST_CASE("slcan: an answer that comes too late is none, also while the program only waits") {
  bool mute = false;
  Device device([&mute](Device& d, char c) {
    const std::string answer = Device::by_the_manual(d, c);
    return mute && answer == "z\r" ? std::string{} : answer;
  });
  SlcanOptions options = patient();
  options.answer_limit = 300ms;
  options.status_period = 1h;
  const auto bus = open(device.path(), options);
  send(*bus, {1, 0, {}});
  eventually([&] {
    (void)bus->receive(1ms);
    return device.with([&] { return device.wire.sent.size() == 1; });
  });
  (void)bus->receive(100ms);
  device.with([&] { mute = true; });
  send(*bus, {2, 0, {}});
  std::thread late{[&] {
    std::this_thread::sleep_for(1200ms);  // after the answer was given up
    device.say("z\r");
  }};
  (void)bus->receive(1500ms);
  late.join();
  CHECK(bus->adapter_counters().unanswered == 1);
  CHECK(bus->delivery().pending == 1);
}

TEST_CASE("slcan: the status flags become error frames") {
  Device device;
  SlcanOptions options = patient();
  options.status_period = 10ms;
  const auto bus = open(device.path(), options);
  CHECK(bus->receive(50ms).error == base::Error::timed_out);
  device.with([&] { device.adapter.report(can::slcan::status::warning | can::slcan::status::overrun); });
  const auto received = bus->receive(5s);
  REQUIRE(received);
  CHECK(text(received->frame) == "20000004#000D000000000000");
  CHECK(can::lost_in_controller(received->frame));
  CHECK(bus->receive(50ms).error == base::Error::timed_out);  // the state is reported once
  device.with([&] { device.adapter.report(0); });
  CHECK(receive(*bus, 1) == std::vector<std::string>{"20000004#0040000000000000"});
  CHECK(bus->adapter_counters().strays == 0);
}

TEST_CASE("slcan: the adapter's milliseconds become Unix time") {
  Device device;
  const auto bus = open(device.path());
  const auto unix_time = [] {
    return base::Time{
        std::chrono::duration_cast<base::Duration>(std::chrono::system_clock::now().time_since_epoch())};
  };
  const base::Time before = unix_time();
  device.say("t6050EA47\r");  // 59975 ms: the two clocks meet
  REQUIRE(bus->receive(5s));
  std::this_thread::sleep_for(100ms);
  // In one batch, across the end of the adapter's minute: 5 ms apart by its clock, whatever ours says.
  std::string batch;
  for (int i = 0; i < 10; ++i)
    batch += can::slcan::encode({0x605, 0, {}}, static_cast<std::uint32_t>(59'980 + 5 * i))->view();
  device.say(batch);
  std::vector<base::Time> times;
  for (int i = 0; i < 10; ++i) {
    const auto received = bus->receive(5s);
    REQUIRE(received);
    times.push_back(received->time);
  }
  const base::Time after = unix_time();
  CHECK(times.back() <= after + 1ms);
  CHECK(times.back() >= before - 1ms);
  for (std::size_t i = 1; i < times.size(); ++i) CHECK(std::chrono::abs(times[i] - times[i - 1] - 5ms) < 1ms);
}

TEST_CASE("slcan: a local socket, as a board in QEMU has it") {
  std::string folder = (std::filesystem::temp_directory_path() / "ocm-slcan-XXXXXX").string();
  REQUIRE(::mkdtemp(folder.data()) != nullptr);
  const std::string path = folder + "/uart";
  {
    const host::Descriptor listener{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), std::begin(address.sun_path));
    REQUIRE(::bind(listener.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    CHECK_THAT(failure(path).what, Contains("no program listens on the socket"));
    REQUIRE(::listen(listener.get(), 1) == 0);
    can::slcan::Adapter adapter;
    Wire wire;
    std::thread board([&] {
      const host::Descriptor peer{::accept(listener.get(), nullptr, nullptr)};
      char c = 0;
      while (::recv(peer.get(), &c, 1, 0) == 1) {
        const auto reply = adapter.feed(c, wire);
        ::send(peer.get(), reply.view().data(), reply.view().size(), MSG_NOSIGNAL);
        if (wire.sent.size() == 2) {  // answers, and ends
          const auto line = adapter.hear(frame("605#01"), base::Time{});
          ::send(peer.get(), line.view().data(), line.view().size(), MSG_NOSIGNAL);
          return;
        }
      }
    });
    const auto bus = open(path);
    send(*bus, frame("205#02"));
    send(*bus, frame("204#02"));
    CHECK(receive(*bus, 1) == std::vector<std::string>{"605#01"});
    CHECK(bus->receive(5s).error == base::Error::closed);
    CHECK(bus->send(frame("205#02")).error == base::Error::closed);  // and no SIGPIPE
    board.join();
  }
  std::filesystem::remove_all(folder);
}

}  // namespace transport_slcan_test
