// One run of `operate`, from its start to its end, word for word: what other programs ask it and what it
// answers, what it prints, what it sends, what it reports to systemd and what is in its black box. Bus, time
// and the frames of the board are made here, so that all of it is the same each time; times are rounded to a
// millisecond.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <regex>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/operate/runner.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/operator_link.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/golden.hpp"
#include "tests/tool/local_client.hpp"

namespace tool_clock_operate_asked_test {

using namespace ocm;
using namespace ocm::test;
namespace operate = cli::operate;
namespace fs = std::filesystem;

constexpr std::string_view file_text = R"({
  "name": "asked", "initial": "driving", "fall_back": "halted",
  "settle": "60ms", "retry": "500ms", "reaction": "5ms", "handling": "1ms",
  "configurations": [
    {"name": "driving", "streams": [{"topic": "odometry", "period": "50ms", "priority": "high"}],
     "commanders": ["drive", "led", "set"],
     "limits": [{"field": "motors.x", "min": "-0.02m/s", "max": "0.02m/s"}, {"field": "led_1.red", "max": "100"}],
     "entry": [{"topic": "led_2", "values": {"green": "9"}}]},
    {"name": "slow", "streams": [{"topic": "odometry", "period": "50ms", "priority": "high"}, {"topic": "power", "period": "1s"}],
     "limits": [{"field": "motors.x", "min": "0m/s", "max": "0.01m/s", "per_second": "0.1m/s"}]},
    {"name": "halted", "streams": [{"topic": "odometry", "period": "50ms", "priority": "high"}],
     "entry": [{"topic": "motors", "priority": "urgent", "repeat": "200ms"}]}
  ],
  "monitors": [
    {"name": "too_fast", "when": {"any": ["odometry.velocity.x>0.03m/s", {"age": "odometry", "above": "400ms"}]}},
    {"name": "still", "when": {"all": [{"not": "odometry.velocity.x>0.01m/s"}, {"not": {"bus_state": "warning"}}]}, "for": "300ms"},
    {"name": "refused", "when": {"refusals": true, "above": 1}},
    {"name": "loaded", "when": {"bus_load": true, "above": "40%", "window": "500ms"}},
    {"name": "ill", "when": {"bus_state": "off"}}
  ],
  "transitions": [
    {"from": ["driving", "slow"], "to": "halted", "when": "too_fast"},
    {"from": "halted", "to": "driving", "when": "still"},
    {"from": "slow", "to": "halted", "when": "refused", "precedence": 1, "cause": "a board says no"},
    {"from": "slow", "to": "halted", "when": "loaded", "precedence": 2},
    {"to": "halted", "when": "ill"},
    {"from": ["driving", "halted"], "to": "slow", "on_request": true},
    {"from": "slow", "to": "driving", "on_request": true, "cause": "by hand"}
  ]
})";

class Run {
 public:
  explicit Run(bool json) : json_(json) {
    folder_ = fs::temp_directory_path() / fmt::format("ocm-asked-{}", ::getpid());
    fs::create_directories(folder_ / "box");
    std::ofstream{folder_ / "box" / "asked.running-0.log"} << "(1.000000) can0 123#00\n";
    bus_name_ = fmt::format("asked-{}", ::getpid());
    make_robot();
  }
  ~Run() { fs::remove_all(folder_); }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  std::string go() {
    const auto loaded = operate::parse(file_text, "asked.operator.json", amiro::catalogue, 500'000);
    for (const auto& problem : loaded.problems) UNSCOPED_INFO(problem.place << ": " << problem.what);
    REQUIRE(loaded.file);
    std::sort(incoming_.begin(), incoming_.end(), [](const auto& a, const auto& b) { return a.at < b.at; });
    PlayedBus::Conditions conditions;
    conditions.room = 4;
    conditions.incoming = incoming_;
    conditions.stuck = {{at(4.1), at(4.4)}};
    conditions.down = {{at(5.0), at(5.2)}};
    PlayedBus bus{world_, conditions, bus_name_};
    const auto control = operate::Control::open(bus.name());
    REQUIRE(control);
    const LocalClient notified{SOCK_DGRAM, (folder_ / "notify").string()};
    ::setenv("NOTIFY_SOCKET", (folder_ / "notify").c_str(), 1);
    ::setenv("WATCHDOG_USEC", "4000000", 1);
    world_.inputs[(*control)->descriptor()] = [this] {
      if (asked_ != nullptr) return World::start;
      return next_ < steps_.size() ? steps_[next_].at : Moment::max();
    };
    world_.beside = [&] {
      for (auto said = notified.heard(); !said.empty(); said = notified.heard()) log("systemd", said);
      talk();
    };
    world_.stop(at(3.3), 200ms);
    world_.set_wall_clock(at(3.6), -2s);
    world_.interrupt(at(9), SIGINT);
    Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
    {
      operate::Runner runner{bus, **control, amiro::catalogue, *loaded.file,
                             options_ = {json_, 500'000, {(folder_ / "box").string(), 700ms, 3}}};
      CHECK(runner.run() == cli::Over::signal);
      runner.rest();
      runner.sum_up();
    }
    for (auto said = notified.heard(); !said.empty(); said = notified.heard()) log("systemd", said);
    ::unsetenv("WATCHDOG_USEC");
    text_ += "--- printed\n" + out.text() + "--- said\n" + err.text() + "--- sent\n";
    for (const auto& each : bus.sent())
      text_ += shown(each.taken) + " " + std::string{can::to_text(each.frame).view()} + "\n";
    CHECK(next_ == steps_.size());
    std::vector<fs::path> kept;
    for (const auto& each : fs::directory_iterator{folder_ / "box"}) kept.push_back(each.path());
    std::sort(kept.begin(), kept.end());
    for (const auto& file : kept) text_ += "--- " + file.filename().string() + "\n" + content(file);
    return same_each_time(text_);
  }

 private:
  struct Step {
    Moment at;
    std::string who;
    std::string what;
    std::function<void()> act;
  };

  static Moment at(double seconds) {
    return World::start + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
  }
  static std::string shown(Moment time) {
    return fmt::format("{:.3f}", std::chrono::duration<double>(time - World::start).count());
  }
  void log(const std::string& who, const std::string& text) {
    text_ += shown(world_.now()) + " " + who + ": " + text + (text.ends_with('\n') ? "" : "\n");
  }
  /// Of the load that is put on the bus how often it is there.
  static std::string content(const fs::path& file) {
    std::string text;
    std::size_t load = 0;
    std::ifstream lines{file};
    for (std::string line; std::getline(lines, line);)
      if (line.find(" 7F0#") == std::string::npos)
        text += line + "\n";
      else
        ++load;
    return std::regex_replace(text, std::regex{R"((\.[0-9]{3})[0-9]{3}\))"}, "$1)") +
           fmt::format("and {} of 7F0\n", load);
  }
  /// Without what differs from one run of the test to the next, and with times that a look at the clock more
  /// does not change.
  [[nodiscard]] std::string same_each_time(std::string text) const {
    const auto replace = [&](const std::string& from, const std::string& to) {
      for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    };
    replace(folder_.string(), "FOLDER");
    replace(fs::path{cli::operator_path(bus_name_)}.parent_path().string(), "RUNTIME");
    replace(bus_name_, "can0");
    replace(fmt::format("process {}", ::getpid()), "process 1");
    replace(fmt::format("\"process\":{}", ::getpid()), "\"process\":1");
    std::string rounded;
    std::smatch found;
    static const std::regex ns{R"((_ns":"?)([0-9]{7,}))"};
    while (std::regex_search(text, found, ns)) {
      rounded += found.prefix().str() + found[1].str() +
                 std::to_string((std::stoll(found[2].str()) + 500'000) / 1'000'000) + "ms";
      text = found.suffix();
    }
    return rounded + text;
  }

  void talk() {
    if (asked_ != nullptr) {
      const auto answer = asked_->heard();
      if (answer.empty()) return;
      log("answer", answer);
      asked_ = nullptr;
    }
    if (next_ == steps_.size() || world_.now() < steps_[next_].at) return;
    const Step& step = steps_[next_++];
    log(step.who, step.what);
    if (step.act) return step.act();
    auto& socket = sockets_[step.who];
    if (!socket) {
      socket = std::make_unique<LocalClient>(SOCK_SEQPACKET, cli::operator_path(bus_name_));
      socket->say("hello 1 " + step.who);
      --next_;
    } else {
      socket->say(step.what);
    }
    asked_ = socket.get();
  }
  void ask(double seconds, const std::string& who, const std::string& what) {
    steps_.push_back({at(seconds), who, what, {}});
  }

  void sample(double seconds, std::int64_t x) {
    for (const auto& layout : amiro::catalogue.find("odometry")->frames) {
      can::Frame frame{
          protocol::Identifier{protocol::Direction::sensor, protocol::Priority::high, layout.id}.encode(),
          layout.dlc(),
          {}};
      if (layout.name == "velocity") protocol::put(frame.data, layout.fields[0].position, x);
      incoming_.push_back({at(seconds), frame});
      seconds += 0.0003;
    }
  }
  void refuses(double seconds, std::uint8_t topic, std::uint8_t reason, std::uint8_t count) {
    incoming_.push_back({at(seconds), can::Frame{0x71D, 8, {topic, reason, count}}});
  }
  void error(double seconds, std::uint32_t classes, std::uint8_t bits) {
    can::Frame frame{classes, can::max_dlc, {}, can::Format::error};
    frame.data[1] = bits;
    incoming_.push_back({at(seconds), frame});
  }

  void make_robot() {
    namespace controller = can::controller_error;
    for (int i = 0; i < 180; ++i) {
      const double time = 0.02 + 0.05 * i;
      if (time > 6.2 && time < 7.4) continue;  // silent
      sample(time, time > 1.9 && time < 2.05 ? 35'000 : time > 2.05 && time < 2.15 ? 12'000 : 2'000);
    }
    // Of the bus.
    error(3.02, can::error_class::controller, controller::rx_warning);
    error(3.04, can::error_class::controller, controller::tx_warning | controller::tx_passive);
    error(3.06, can::error_class::controller, controller::tx_warning);
    error(3.08, can::error_class::controller, controller::rx_passive);
    // What says nothing of the controller leaves it as it is.
    for (const auto other :
         {can::error_class::tx_timeout, can::error_class::arbitration_lost, can::error_class::protocol,
          can::error_class::transceiver, can::error_class::no_acknowledgement, can::error_class::bus_error})
      error(3.09, other, controller::active);
    error(3.1, can::error_class::controller, controller::rx_overflow);
    error(3.12, can::error_class::controller, controller::active);
    error(3.14, can::error_class::bus_off, controller::active);
    error(3.18, can::error_class::restarted, 0);
    error(5.04, can::error_class::controller, controller::rx_passive);
    // What boards do not take.
    refuses(4.55, 3, 3, 1);
    refuses(4.56, 3, 0, 2);
    refuses(4.57, 200, 3, 3);
    for (int i = 0; i < 2000; ++i)
      incoming_.push_back({at(5.6 + 0.00026 * i), can::Frame{.id = 0x7F0, .dlc = 8}});

    ask(0.10, "operator", "status");
    ask(0.11, "operator", "status json");
    ask(0.12, "operator", "why");
    ask(0.13, "operator", "why json");
    ask(0.14, "operator", "dance");
    ask(0.15, "operator", "switch nowhere");
    ask(0.16, "operator", "switch driving");
    ask(0.17, "operator", "switch halted");
    ask(0.18, "operator", "delivery");
    // Set points, held within limits.
    ask(0.20, "drive", "send 201#50C3000001000000");
    ask(0.305, "drive", "send 201#102700000A000000");
    ask(0.405, "drive", "send 201#50C3000000000000");
    ask(0.41, "drive", "send 201#102700000A000000");  // more often than is counted
    ask(0.42, "drive", "delivery");
    ask(0.61, "drive", "send 001#1027000000000000");  // more urgent
    ask(0.62, "drive", "send 201#0000000000000000");
    ask(0.63, "drive", "send 201#0000");
    ask(0.64, "drive", "send 605#0000");
    ask(0.65, "drive", "send 502#0000000000000000");
    ask(0.66, "drive", "send frame");
    ask(0.67, "led", "send 23C#FF0102");
    ask(0.68, "led", "send 23C#630102");
    ask(0.69, "led", "send 23D#000000");
    ask(0.70, "run", "send 201#1027000000000000");
    ask(0.71, "run", "send 201#0000000000000000");
    ask(0.72, "run", "send 23C#000000");
    ask(0.73, "run", "send 20B#0000000000000000");
    ask(0.74, "set", "commands 201#1027000000000000");
    ask(0.75, "set", "commands 23D#000000");
    ask(0.76, "set", "commands 7F0#00");
    ask(0.77, "set", "commands frame");
    ask(0.80, "operator", "status json");
    // Another configuration.
    ask(1.01, "operator", "switch slow");
    ask(1.02, "operator", "switch driving");
    ask(1.03, "operator", "status");
    ask(1.04, "operator", "status json");
    ask(1.25, "operator", "switch slow");
    ask(1.35, "operator", "switch halted");
    ask(1.36, "drive", "send 201#50C3000000000000");
    ask(1.46, "drive", "send 201#E0B1FFFF00000000");
    ask(1.47, "operator", "hold");
    ask(1.48, "operator", "hold");
    ask(1.49, "operator", "status");
    ask(1.50, "operator", "status json");
    // Then it is too fast: at 1.92 s.
    ask(2.10, "operator", "why");
    ask(2.11, "operator", "why json");
    ask(2.60, "drive", "send 201#1027000000000000");
    ask(2.61, "drive", "send 201#0000000000000000");
    ask(2.62, "set", "commands 201#1027000000000000");
    ask(2.63, "operator", "status");
    ask(2.70, "operator", "resume");
    ask(2.71, "operator", "resume");
    ask(2.90, "operator", "why");
    // The state of the bus, a stop of the program, a clock that is set.
    ask(3.05, "operator", "why");
    ask(3.9, "operator", "switch slow");
    // The bus is stuck: four have room, others wait.
    ask(4.11, "drive", "send 201#1027000000000000");
    ask(4.12, "drive", "send 201#1127000000000000");
    ask(4.13, "drive", "send 201#1227000000000000");
    ask(4.14, "drive", "delivery");
    ask(4.15, "drive", "send 201#1327000000000000");
    ask(4.16, "drive", "send 201#1427000000000000");
    ask(4.17, "operator", "switch driving");
    ask(4.18, "drive", "send 201#1527000000000000");
    ask(4.41, "drive", "delivery");
    ask(4.45, "operator", "switch slow");
    // Refused requests lead to the fall-back, at 4.56 s.
    ask(4.62, "operator", "why json");
    ask(4.95, "operator", "switch slow");
    ask(5.01, "operator", "delivery");
    ask(5.02, "operator", "status");
    ask(5.3, "operator", "switch slow");
    // A load of about half, until 6.1 s.
    ask(6.15, "operator", "why");
    // Then a silent board.
    ask(6.5, "operator", "status");
    ask(7.0, "operator", "why json");
    // Its socket is removed, and comes back.
    steps_.push_back(
        {at(7.9), "user", "removes its socket", [this] { fs::remove(cli::operator_path(bus_name_)); }});
    steps_.push_back({at(8.3), "user", "makes a folder of it", [this] {
                        fs::remove(cli::operator_path(bus_name_));
                        fs::create_directory(cli::operator_path(bus_name_));
                      }});
    steps_.push_back(
        {at(8.7), "user", "removes that", [this] { fs::remove(cli::operator_path(bus_name_)); }});
    ask(8.95, "operator", "status");
  }

  World world_{1};
  bool json_;
  operate::RunOptions options_;
  fs::path folder_;
  std::string bus_name_;
  std::vector<PlayedBus::Incoming> incoming_;
  std::vector<Step> steps_;
  std::size_t next_ = 0;
  std::map<std::string, std::unique_ptr<LocalClient>> sockets_;
  const LocalClient* asked_ = nullptr;
  std::string text_;
};

TEST_CASE("operate: a whole run is as it was, in words and as JSON") {
  ::setenv("TZ", "UTC", 1);
  ::tzset();
  for (const bool json : {false, true}) {
    is_as_in(json ? "tests/tool/clock/golden/operate.jsonl" : "tests/tool/clock/golden/operate.txt",
             Run{json}.go());
  }
  ::unsetenv("TZ");
  ::tzset();
}

}  // namespace tool_clock_operate_asked_test
