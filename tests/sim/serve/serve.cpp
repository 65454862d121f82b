#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/host/descriptor.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/simulation/virtual_bus_server.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/bus.hpp"
#include "ocm/transport/virtual_bus.hpp"

#include "sim/serve/amiro.hpp"
#include "sim/serve/bus_report.hpp"
#include "sim/serve/mappers.hpp"
#include "sim/serve/messages.hpp"
#include "sim/serve/round.hpp"

namespace sim_serve_serve_test {

using namespace ocm;
using sim::Ending;

/// A folder of this test, in which the simulators' sockets and lines are.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "ocm-serve-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path_ = name;
    ::setenv("XDG_RUNTIME_DIR", name.c_str(), 1);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] std::string operator/(std::string_view name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

/// Ends a simulation after so many turns of its loop, and keeps what it reports.
struct Watched {
  int turns = 3;
  std::vector<std::string> reports{};
  [[nodiscard]] sim::Shell shell() {
    return {[this] { return turns-- <= 0; }, [this](std::string_view text) { reports.emplace_back(text); }};
  }
};

TEST_CASE("An AMiRo on a virtual bus says where it is, and at its end what each board received") {
  const Folder folder;
  Watched watched;
  sim::AmiroOptions options;
  options.without = {"light_ring"};
  const std::string bus = folder / "bus";
  const Ending ending = sim::serve_amiro(bus, options, watched.shell());
  CHECK(ending.well());
  REQUIRE(watched.reports.size() == 5);
  CHECK(watched.reports[0] == "simulated AMiRo on --bus sim:" + bus + " (" + bus + "), " +
                                  std::to_string(amiro::bit_rate) + " bit/s; Ctrl-C ends it");
  CHECK(watched.reports[1] == "di_wheel_drive    nothing came");
  CHECK(watched.reports[3] == "light_ring        switched off");
  CHECK(watched.reports[4].starts_with("bus               0 frames, 0 clients"));
}

/// What a simulation says that has far more to do than a machine does, and is ended after a while.
std::vector<std::string> overloaded(const std::function<Ending(const sim::Shell& shell)>& serve) {
  using Clock = std::chrono::steady_clock;
  const auto late = Clock::now() + sim::Lateness::worth_a_line;
  unsigned rounds = 0;  // when it is late
  Clock::time_point end;
  Watched watched;
  sim::Shell shell = watched.shell();
  shell.stop = [&] {
    if (Clock::now() < late || ++rounds <= 2 * sim::Lateness::enough_rounds) return false;
    end = Clock::now();
    return true;
  };
  CHECK(serve(shell).well());
  CHECK(Clock::now() - end < std::chrono::seconds{20});  // a round and the summary, on a busy machine
  return watched.reports;
}
bool any_begins(const std::vector<std::string>& lines, std::string_view text) {
  return std::any_of(lines.begin(), lines.end(),
                     [text](const std::string& line) { return line.starts_with(text); });
}

/// The spec of a car with one message of eight bytes, which is sent each `cycle`.
struct OneMessage {
  explicit OneMessage(base::Duration cycle) {
    layout.length = 8;
    layout.address = {protocol::Address::By::identifier, false, 0x100};
    message.name = "M";
    message.kind = protocol::Kind::message;
    message.frames = {&layout, 1};
    message.cycle = cycle;
  }
  OneMessage(const OneMessage&) = delete;
  OneMessage& operator=(const OneMessage&) = delete;

  protocol::FrameLayout layout;
  protocol::Topic message;
  protocol::Catalogue catalogue{"car", 500'000, {}, {&message, 1}};
};

TEST_CASE("Messages on a virtual bus say first which of them are not sent, then where they are") {
  const Folder folder;
  const std::string bus = folder / "bus";
  const OneMessage seldom{std::chrono::hours{1}};
  std::vector<protocol::Topic> topics{seldom.message, seldom.message};
  topics[1].name = "Rare";
  topics[1].cycle = {};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  Watched watched{.turns = 0};
  CHECK(sim::serve_messages(bus, catalogue, {}, watched.shell()).well());
  CHECK(
      watched.reports ==
      std::vector<std::string>{
          "not sent, since the spec states no period: Rare (--sporadic 1s sends them too)",
          "simulated 1 message of car on --bus sim:" + bus + " (" + bus + "), 500000 bit/s; Ctrl-C ends it",
          "bus               0 frames, 0 clients, 0 turned away, 0 misbehaved, 0 frames lost by slow ones"});
}

TEST_CASE(
    "What a virtual bus counted is said: clashes where there were some, errors where they are asked for") {
  const Folder folder;
  const auto reports = [&folder](std::size_t nodes, bool disturbed) {
    const auto opened = simulation::VirtualBusServer::open({.path = folder / "bus"});
    REQUIRE(static_cast<bool>(opened));
    auto& server = **opened;
    auto& wire = server.arbiter();
    for (std::size_t i = 0; i < nodes; ++i)
      CHECK(wire.send(wire.attach(), can::Frame{0x100, 1, {}}, base::Time{}).ok());
    if (disturbed) wire.disturb({.boundary = 20});
    server.advance(base::Time{std::chrono::seconds{1}}, [](const simulation::Delivery&) {});
    Watched watched;
    sim::report_bus(server, disturbed, watched.shell());
    return watched.reports;
  };
  const std::string rest = ", 0 clients, 0 turned away, 0 misbehaved, 0 frames lost by slow ones";
  CHECK(reports(1, false) == std::vector<std::string>{"bus               1 frame" + rest});
  CHECK(reports(1, true) == std::vector<std::string>{"bus               1 frame" + rest,
                                                     "                  1 error frame, 1 frame repeated"});
  CHECK(reports(2, false) ==
        std::vector<std::string>{"bus               2 frames" + rest,
                                 "                  1 time two senders at once with the same identifier"});
}

TEST_CASE("A simulation with more to do than the machine does ends when it is asked to, and says so") {
  const Folder folder;
  const std::string_view late = "the simulation is late: more is due than this machine can do";
  {
    const OneMessage sent{base::Duration{2}};  // a period in another unit than milliseconds: 0.000002
    const auto reports = overloaded([&](const sim::Shell& shell) {
      return sim::serve_messages(folder / "bus", sent.catalogue, {}, shell);
    });
    CHECK(reports.at(0).starts_with("simulated 1 message of car"));
    CHECK(any_begins(reports, late));
    CHECK(any_begins(reports, "unknown sender    sent "));
    CHECK(any_begins(reports, "late              by "));
  }
  sim::AmiroOptions options;
  options.speed = 1e6;
  const auto reports =
      overloaded([&](const sim::Shell& shell) { return sim::serve_amiro(folder / "bus", options, shell); });
  CHECK(any_begins(reports, late));
  CHECK(any_begins(reports, "di_wheel_drive"));
  options.speed = 1000;
  options.bus_errors = 100'000;  // that lie ahead of the clock would fill the memory
  CHECK(any_begins(
      overloaded([&](const sim::Shell& shell) { return sim::serve_amiro(folder / "bus", options, shell); }),
      late));
  for (const bool lines : {false, true}) {
    sim::MapperOptions mappers;
    mappers.robots = 20;
    mappers.speed = 1e6;
    mappers.lines = lines;
    const auto said = overloaded([&](const sim::Shell& shell) { return sim::serve_mappers(mappers, shell); });
    CHECK(any_begins(said, late));
    CHECK(any_begins(said, "late              by "));
  }
}

/// A bus that, as a CAN interface does, gives no program back what it sent itself.
class Interface final : public transport::Bus {
 public:
  explicit Interface(std::vector<can::Frame> from_others) : from_others_(std::move(from_others)) {}
  std::string_view name() const override { return "can9"; }
  base::Result<bool> send(const can::Frame& frame) override {
    if (full) {
      ++refused;
      return false;
    }
    sent.push_back(frame);
    return true;
  }
  base::Result<can::Received> receive(base::Duration) override {
    if (next_ == from_others_.size()) return base::Error::timed_out;
    return can::Received{{}, from_others_[next_++]};
  }
  transport::Outcome<void> subscribe(std::span<const can::Filter>) override { return {}; }
  int descriptor() const override { return -1; }
  const transport::BusCounters& counters() const override { return counters_; }
  const transport::Failure& failure() const override { return failure_; }

  std::vector<can::Frame> sent;
  bool full = false;
  int refused = 0;

 private:
  std::vector<can::Frame> from_others_;
  std::size_t next_ = 0;
  transport::BusCounters counters_{};
  transport::Failure failure_{};
};

/// Whether the wheels turn within that time.
bool drives(Interface& bus, const sim::AmiroOptions& options, std::chrono::milliseconds time) {
  bool turns = false;
  const auto end = std::chrono::steady_clock::now() + time;
  sim::Shell shell{[&] { return turns || std::chrono::steady_clock::now() > end; }, [](std::string_view) {}};
  shell.watch = [&turns](const std::function<sim::SeenWorld()>& look) {
    turns = turns || look().robots.at(0).wheels.left != 0;
  };
  CHECK(sim::serve_amiro(bus, options, shell).well());
  return turns;
}

TEST_CASE(
    "The boards of an AMiRo on a CAN interface hear each other, and those that are switched off hear "
    "nothing") {
  using namespace std::chrono_literals;
  amiro::Avoid avoid;
  avoid.set_speed_m_per_s(0.1);
  Interface obstacles{{protocol::command(avoid)}};
  CHECK(drives(obstacles, {}, 20s));

  const std::vector<can::Frame> ahead{protocol::command(amiro::Motors{50'000, 0})};
  Interface on{ahead};
  CHECK(drives(on, {}, 20s));
  Interface off{ahead};
  sim::AmiroOptions without;
  without.without = {"di_wheel_drive"};
  CHECK_FALSE(drives(off, without, 300ms));
}

TEST_CASE(
    "Boards whose frames find a CAN interface full offer them again each millisecond, and no more often") {
  using namespace std::chrono_literals;
  using Clock = std::chrono::steady_clock;
  Interface bus{{protocol::once(amiro::Gyroscope::id, amiro::Gyroscope::priority)}};
  bus.full = true;
  const auto give_up = Clock::now() + 20s;
  int turns = 0;
  Clock::time_point begin, end;
  const sim::Shell shell{[&] {
                           end = Clock::now();
                           if (bus.refused == 0) return end > give_up;
                           if (turns++ == 0) begin = end;
                           return turns > 100;
                         },
                         [](std::string_view) {}};
  CHECK(sim::serve_amiro(bus, {}, shell).well());
  CHECK(turns == 101);
  CHECK(bus.refused >= 100);
  CHECK(end - begin >= 90ms);
}

/// How often a simulation's loop goes round in this time.
int turns_of(const std::function<Ending(const sim::Shell& shell)>& serve,
             std::chrono::milliseconds time = std::chrono::milliseconds{200}) {
  const auto end = std::chrono::steady_clock::now() + time;
  int turns = 0;
  const sim::Shell shell{[&] {
                           ++turns;
                           return std::chrono::steady_clock::now() > end;
                         },
                         [](std::string_view) {}};
  CHECK(serve(shell).well());
  return turns;
}

TEST_CASE("A simulation with little to do waits until there is something") {
  const Folder folder;
  Interface bus{std::vector<can::Frame>{}};
  const OneMessage sent{std::chrono::milliseconds{50}};
  CHECK(turns_of([&](const sim::Shell& shell) {
          return sim::serve_messages(folder / "bus", sent.catalogue, {}, shell);
        }) < 100);
  CHECK(turns_of([&](const sim::Shell& shell) {
          return sim::serve_messages(bus, sent.catalogue, {}, shell);
        }) < 100);
  CHECK(turns_of([&](const sim::Shell& shell) { return sim::serve_amiro(folder / "bus", {}, shell); }) <
        2000);
  CHECK(turns_of([&](const sim::Shell& shell) { return sim::serve_amiro(bus, {}, shell); }) < 2000);
  for (const bool lines : {false, true}) {
    CAPTURE(lines);
    sim::MapperOptions mappers;
    mappers.robots = 2;
    mappers.lines = lines;
    CHECK(turns_of([&](const sim::Shell& shell) { return sim::serve_mappers(mappers, shell); }) < 2000);
  }
}

TEST_CASE("Two programs that drive an AMiRo in turns are named at its end") {
  const Folder folder;
  Watched watched;
  sim::Shell shell = watched.shell();
  std::atomic<bool> over{false};
  shell.stop = [&over] { return over.load(); };
  bool heard = true;
  std::thread drivers{[&] {
    auto one = transport::VirtualBus::open(folder / "bus");
    for (; !one && !over; one = transport::VirtualBus::open(folder / "bus")) std::this_thread::yield();
    auto other = transport::VirtualBus::open(folder / "bus");
    heard = one && other;
    const can::Frame frame = protocol::command(amiro::Motors{1, 0});
    for (int i = 0; heard && i < 20; ++i) {
      heard = (*one)->send(frame).value && (*other)->receive(std::chrono::seconds{20}).ok() &&
              (*other)->send(frame).value && (*one)->receive(std::chrono::seconds{20}).ok();
    }
    over = true;
  }};
  CHECK(sim::serve_amiro(folder / "bus", {}, shell).well());
  drivers.join();
  CHECK(heard);
  CHECK(any_begins(watched.reports, "motors            was commanded by two senders, in turns: "));
}

TEST_CASE("A round takes what is due, and leaves nothing out") {
  const auto at = [](int ns) { return base::Time{base::Duration{ns}}; };
  sim::Round round{at(10)};
  CHECK(round.takes(at(3)));
  CHECK(round.takes(at(10)));
  CHECK_FALSE(round.takes(at(11)));
  CHECK(round.reached() == at(10));
  sim::Round idle{at(10)};
  CHECK_FALSE(idle.takes(at(11)));
  CHECK(idle.reached() == at(10));
  int taken = 0;
  for (int tries = 0; tries < 100 && taken < 1000; ++tries) {  // one may be held up
    sim::Round endless{at(2'000'000'000)};
    taken = 0;
    while (endless.takes(at(taken))) ++taken;
    CHECK(taken > 0);
    CHECK(endless.reached() == at(taken - 1));  // the next round goes on behind it
  }
  CHECK(taken >= 1000);
}

TEST_CASE("A board that does not exist is the options' fault") {
  const Folder folder;
  Watched watched;
  sim::AmiroOptions options;
  options.without = {"di_wheel_drive", "flux_capacitor"};
  const Ending ending = sim::serve_amiro(folder / "bus", options, watched.shell());
  CHECK(ending.misuse);
  REQUIRE(ending.failures.size() == 1);
  CHECK(ending.failures[0].what == "sim: no board 'flux_capacitor'");
  CHECK(ending.failures[0].remedy == "one of: di_wheel_drive, power_management, light_ring");
  Interface bus{std::vector<can::Frame>{}};
  const Ending on_interface = sim::serve_amiro(bus, options, watched.shell());
  CHECK(on_interface.misuse);
  CHECK(on_interface.failures == ending.failures);
  CHECK(watched.reports.empty());
}

TEST_CASE("A second AMiRo on the same bus fails, and the options are not to blame") {
  const Folder folder;
  const std::string bus = (folder / "bus");
  Watched inner;
  Ending second;
  Watched watched;
  sim::Shell shell = watched.shell();
  shell.stop = [&] {
    second = sim::serve_amiro(bus, {}, inner.shell());
    return true;
  };
  CHECK(sim::serve_amiro(bus, {}, shell).well());
  CHECK_FALSE(second.well());
  CHECK_FALSE(second.misuse);
}

TEST_CASE("Mappers behind a central, or each on a line, report what each of them did") {
  CHECK(sim::MapperOptions{}.speed == 1);  // in real time, unless they are asked for more
  const Folder folder;
  for (const bool lines : {false, true}) {
    CAPTURE(lines);
    Watched watched;
    sim::MapperOptions options;
    options.robots = 2;
    options.lines = lines;
    const Ending ending = sim::serve_mappers(options, watched.shell());
    for (const auto& failure : ending.failures) UNSCOPED_INFO(failure.what);
    CHECK(ending.well());
    REQUIRE_FALSE(watched.reports.empty());
    CHECK(watched.reports[0].starts_with("simulated 2 mappers in 'square', "));
    // Nothing happened yet, and nothing that was lost is named.
    const std::string done = " links 0, handshakes 0, updates 0, idles 0, set points 0, arrived 0, stops 0";
    const std::string carried = "           packets to it 0; from it 0";
    const std::vector<std::string> reports(watched.reports.begin() + 1, watched.reports.end());
    if (lines)
      CHECK(reports == std::vector<std::string>{"AVR       " + done, "robot_2   " + done});
    else
      CHECK(reports == std::vector<std::string>{"AVR       " + done, carried, "robot_2   " + done, carried,
                                                "central    nothing was lost"});
  }
}

TEST_CASE("Each mapper has a line of its own, whatever its name") {
  const Folder folder;
  const std::string file = folder / "names.json";
  std::ofstream{file} << R"({"name": "names", "walls": [[[0, 0], [9, 0], [9, 3], [0, 3], [0, 0]]], "robots": [
    {"name": "A/B", "model": "avr", "at": [1, 1], "heading": 0}, {"name": "A_B", "model": "avr", "at": [3, 1], "heading": 0},
    {"name": "A%2FB", "model": "avr", "at": [5, 1], "heading": 0}, {"name": "..", "model": "avr", "at": [7, 1], "heading": 0},
    {"name": "A_B.lock", "model": "avr", "at": [7, 2], "heading": 0}]})";
  std::set<std::string> names;
  sim::Shell shell{[&] {
                     for (const auto& entry : std::filesystem::directory_iterator{folder / "ocm/line"})
                       names.insert(entry.path().filename().string());
                     return true;
                   },
                   [](std::string_view) {}};
  sim::MapperOptions options;
  options.world = file;
  options.lines = true;
  const Ending ending = sim::serve_mappers(options, shell);
  for (const auto& failure : ending.failures) UNSCOPED_INFO(failure.what);
  CHECK(ending.well());
  for (const char* name : {"A%2FB", "A_B", "A%252FB", "%2E.", "A_B%2Elock"}) CHECK(names.count(name) == 1);
}

TEST_CASE("Whatever is simulated can be watched at each turn") {
  const Folder folder;
  for (const std::string_view what : {"AMiRo", "central", "lines"}) {
    CAPTURE(what);
    Watched watched;
    sim::Shell shell = watched.shell();
    std::size_t looks = 0, robots = 0;
    shell.watch = [&](const std::function<sim::SeenWorld()>& look) {
      ++looks;
      robots = look().robots.size();
    };
    if (what == "AMiRo") {
      CHECK(sim::serve_amiro(folder / "bus", {}, shell).well());
    } else {
      sim::MapperOptions options;
      options.robots = 3;
      options.lines = what == "lines";
      CHECK(sim::serve_mappers(options, shell).well());
    }
    CHECK(looks == 3);
    CHECK(robots == (what == "AMiRo" ? 1 : 3));
  }
}

TEST_CASE("A world that cannot be had is said with all that is wrong with it") {
  const Folder folder;
  Watched watched;
  sim::MapperOptions options;
  SECTION("no such world") {
    options.world = "atlantis";
    const Ending ending = sim::serve_mappers(options, watched.shell());
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0].what == "sim: there is no world 'atlantis'");
    CHECK(ending.failures[0].remedy == "give a file, or one of those built in: labyrinth, range, square");
  }
  SECTION("more robots than there is room for") {
    options.robots = 100'000;
    const Ending ending = sim::serve_mappers(options, watched.shell());
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0].what == "sim: no room for 100000 robots in 'square'");
    CHECK(ending.failures[0].remedy == "take fewer, or a larger world with --world");
    CHECK_FALSE(ending.misuse);
  }
  SECTION("more robots than a fleet has") {
    options.world = folder / "many.json";
    std::string robots;
    for (int i = 0; i < 129; ++i)
      robots += (i == 0 ? R"({"name": ")" : R"(, {"name": ")") + std::to_string(i) +
                R"(", "model": "avr", "at": [)" + std::to_string(i) + ", 0]}";
    std::ofstream{options.world} << R"({"name": "many", "walls": [], "robots": [)" << robots << "]}";
    const Ending ending = sim::serve_mappers(options, watched.shell());
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0].what == "sim: 129 robots");
    CHECK(ending.failures[0].remedy == "at most 128");
    CHECK(ending.misuse);
  }
  CHECK(watched.reports.empty());
}

TEST_CASE("Mappers whose loop has nothing to do look for programs fifty times a second, and no more often") {
  const Folder folder;
  for (const bool lines : {false, true}) {
    CAPTURE(lines);
    sim::MapperOptions mappers;
    mappers.robots = 2;
    mappers.lines = lines;
    mappers.speed = 0.001;  // what comes next is seconds away
    CHECK(turns_of([&](const sim::Shell& shell) { return sim::serve_mappers(mappers, shell); },
                   std::chrono::milliseconds{60}) < 50);
  }
}

/// What a simulation reports that is ended a round after it has run for a tenth of a second.
std::vector<std::string> reports_of(const std::function<Ending(const sim::Shell& shell)>& serve) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds{100};
  bool is_over = false;  // one more round has what was due until then
  Watched watched;
  sim::Shell shell = watched.shell();
  shell.stop = [&] { return std::exchange(is_over, std::chrono::steady_clock::now() > end); };
  CHECK(serve(shell).well());
  return watched.reports;
}
/// The number behind these words in the line that begins with them; 0: there is no such line.
unsigned long number_behind(const std::vector<std::string>& lines, const std::string& words) {
  for (const std::string& line : lines)
    if (line.starts_with(words)) return std::stoul(line.substr(words.size()));
  return 0;
}

TEST_CASE(
    "A round on a virtual bus has all messages that are due in it, also beside the boards of an AMiRo") {
  const Folder folder;
  const OneMessage often{std::chrono::milliseconds{1}};
  const std::string sent = "unknown sender    sent 0, ";  // no program acknowledges them: the bus is full
  const auto alone = reports_of([&](const sim::Shell& shell) {
    return sim::serve_messages(folder / "bus", often.catalogue, {}, shell);
  });
  CHECK(number_behind(alone, sent) >= 20U);
  sim::AmiroOptions options;
  options.messages = &often.catalogue;
  const auto beside =
      reports_of([&](const sim::Shell& shell) { return sim::serve_amiro(folder / "bus", options, shell); });
  CHECK(number_behind(beside, sent) >= 20U);
}

TEST_CASE("Interference on a virtual bus comes as often as it is asked for, and is counted at the end") {
  const Folder folder;
  const OneMessage seldom{std::chrono::hours{1}};
  const std::string indent(18, ' ');
  sim::MessagesOptions messages;
  messages.bus_errors = 5000;
  const auto of_messages = reports_of([&](const sim::Shell& shell) {
    return sim::serve_messages(folder / "bus", seldom.catalogue, messages, shell);
  });
  CHECK(number_behind(of_messages, indent) >= 20U);
  sim::AmiroOptions amiro;
  amiro.bus_errors = 5000;
  const auto of_boards =
      reports_of([&](const sim::Shell& shell) { return sim::serve_amiro(folder / "bus", amiro, shell); });
  CHECK(number_behind(of_boards, indent) >= 20U);
}

TEST_CASE(
    "Interference that was asked for is counted at the end also where it is rare, and else is not named") {
  const Folder folder;
  const OneMessage seldom{std::chrono::hours{1}};
  const auto counted = [](const Watched& watched) {
    return std::count(watched.reports.begin(), watched.reports.end(),
                      std::string(18, ' ') + "0 error frames, 0 frames repeated");
  };
  for (const double rate : {0.0, 0.5, 1.0}) {
    CAPTURE(rate);
    sim::MessagesOptions messages;
    messages.bus_errors = rate;
    Watched of_messages{.turns = 0};
    CHECK(sim::serve_messages(folder / "bus", seldom.catalogue, messages, of_messages.shell()).well());
    CHECK(counted(of_messages) == (rate > 0 ? 1 : 0));
    sim::AmiroOptions amiro;
    amiro.bus_errors = rate;
    Watched of_boards{.turns = 0};
    CHECK(sim::serve_amiro(folder / "bus", amiro, of_boards.shell()).well());
    CHECK(counted(of_boards) == (rate > 0 ? 1 : 0));
  }
}

TEST_CASE("A virtual bus gets the bit rates that are asked for, and what says no to them is passed on") {
  const Folder folder;
  const OneMessage seldom{std::chrono::hours{1}};
  Watched watched{.turns = 0};
  sim::MessagesOptions messages;
  messages.bit_rate = 250'000;
  messages.data_bit_rate = 300'000;
  sim::AmiroOptions amiro;
  amiro.bit_rate = 250'000;
  amiro.data_bit_rate = 300'000;
  for (const Ending& ending :
       {sim::serve_messages(folder / "bus", seldom.catalogue, messages, watched.shell()),
        sim::serve_amiro(folder / "bus", amiro, watched.shell())}) {
    REQUIRE(ending.failures.size() == 1);
    CHECK(ending.failures[0].what == "no data of CAN FD runs at 300000 bit/s on a bus of 250000");
    CHECK_FALSE(ending.misuse);
  }
  CHECK(watched.reports.empty());
}

TEST_CASE("A virtual bus tells each program whose it is, and its bit rates") {
  using namespace std::chrono_literals;
  const Folder folder;
  const OneMessage often{5ms};
  sim::MessagesOptions messages;
  messages.bit_rate = 250'000;
  messages.data_bit_rate = 1'000'000;
  sim::AmiroOptions amiro;
  amiro.bit_rate = 250'000;
  amiro.data_bit_rate = 1'000'000;
  amiro.messages = &often.catalogue;
  for (const bool beside_boards : {false, true}) {
    CAPTURE(beside_boards);
    std::atomic<bool> over{false};
    std::string name;
    std::uint32_t bit_rate = 0, data_bit_rate = 0;
    std::thread program{[&] {
      auto bus = transport::VirtualBus::open(folder / "bus");
      for (; !bus && !over; bus = transport::VirtualBus::open(folder / "bus")) std::this_thread::yield();
      if (bus) {
        name = (*bus)->bus_name();
        bit_rate = (*bus)->bit_rate();
        data_bit_rate = (*bus)->data_bit_rate();
      }
      over = true;
    }};
    Watched watched;
    sim::Shell shell = watched.shell();
    shell.stop = [&over] { return over.load(); };
    const Ending ending = beside_boards
                              ? sim::serve_amiro(folder / "bus", amiro, shell)
                              : sim::serve_messages(folder / "bus", often.catalogue, messages, shell);
    over = true;
    program.join();
    CHECK(ending.well());
    CHECK(name == (beside_boards ? "AMiRo" : "car"));
    CHECK(bit_rate == 250'000U);
    CHECK(data_bit_rate == 1'000'000U);
  }
}

TEST_CASE("Messages beside the boards of an AMiRo: which of them are not sent is said first") {
  const Folder folder;
  const OneMessage often{std::chrono::milliseconds{1}};
  std::vector<protocol::Topic> topics{often.message, often.message};
  topics[1].name = "Rare";
  topics[1].cycle = {};
  const protocol::Catalogue catalogue{"car", 500'000, {}, topics};
  sim::AmiroOptions options;
  options.messages = &catalogue;
  for (const bool sporadic : {false, true}) {
    CAPTURE(sporadic);
    options.sporadic = std::chrono::seconds{sporadic ? 1 : 0};
    Watched watched{.turns = 0};
    CHECK(sim::serve_amiro(folder / "bus", options, watched.shell()).well());
    REQUIRE(watched.reports.size() == (sporadic ? 5U : 6U));
    const std::string& first = watched.reports.front();
    if (sporadic)
      CHECK(first.starts_with("simulated AMiRo on --bus sim:"));
    else
      CHECK(first == "not sent, since the spec states no period: Rare (--sporadic 1s sends them too)");
  }
}

TEST_CASE("A fleet has as many robots as a central tells apart") {
  const Folder folder;
  Watched watched{.turns = 0};
  sim::MapperOptions options;
  options.world = folder / "many.json";
  std::string robots;
  for (int i = 0; i < 128; ++i)
    robots += (i == 0 ? R"({"name": ")" : R"(, {"name": ")") + std::to_string(i) +
              R"(", "model": "avr", "at": [)" + std::to_string(i) + ", 0]}";
  std::ofstream{options.world} << R"({"name": "many", "walls": [], "robots": [)" << robots << "]}";
  const Ending ending = sim::serve_mappers(options, watched.shell());
  for (const auto& failure : ending.failures) UNSCOPED_INFO(failure.what);
  CHECK(ending.well());
  REQUIRE(watched.reports.size() == 2 + 2 * 128);
  CHECK(watched.reports.front().starts_with("simulated 128 mappers in 'many', "));
  CHECK(watched.reports.back() == "central    nothing was lost");
}

TEST_CASE("A second simulation of mappers on the same lines fails, and the options are not to blame") {
  const Folder folder;
  for (const bool lines : {false, true}) {
    CAPTURE(lines);
    sim::MapperOptions options;
    options.robots = 1;
    options.lines = lines;
    Watched inner{.turns = 0}, watched;
    Ending second;
    sim::Shell shell = watched.shell();
    shell.stop = [&] {
      second = sim::serve_mappers(options, inner.shell());
      return true;
    };
    CHECK(sim::serve_mappers(options, shell).well());
    REQUIRE(second.failures.size() == 1);
    CHECK(second.failures[0].what ==
          "another program serves '" + (folder / (lines ? "ocm/line/AVR" : "ocm/central")) + "'");
    CHECK_FALSE(second.misuse);
    CHECK(inner.reports.empty());
  }
}

/// What the central of these mappers answers to a program that lets it scan for half a minute of its time and
/// then stops it.
std::string found(const Folder& folder, sim::MapperOptions options) {
  using namespace std::chrono_literals;
  using Clock = std::chrono::steady_clock;
  options.speed = 1000;
  const auto give_up = Clock::now() + 20s;
  host::Descriptor line;
  std::string heard;
  Clock::time_point stop_it = Clock::time_point::max();
  bool is_stopped = false;
  const sim::Shell shell{[&] {
                           if (!line) {
                             line = host::Descriptor{::open((folder / "ocm/central").c_str(),
                                                            O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
                             return !line || ::write(line.get(), "start\n", 6) != 6;
                           }
                           char text[256];
                           const ssize_t size = ::read(line.get(), text, sizeof text);
                           if (size > 0) heard.append(text, static_cast<std::size_t>(size));
                           const auto now = Clock::now();
                           if (stop_it == Clock::time_point::max() && heard == "scanning\n")
                             stop_it = now + 30ms;
                           if (!is_stopped && now >= stop_it)
                             is_stopped = ::write(line.get(), "stop\n", 5) == 5;
                           return (is_stopped && heard.size() > 9 && heard.back() == '\n') || now > give_up;
                         },
                         [](std::string_view) {}};
  CHECK(sim::serve_mappers(options, shell).well());
  return heard;
}

TEST_CASE("A fleet's radio reaches as far as it is asked to, and loses what it is asked to lose") {
  const Folder folder;
  sim::MapperOptions options;
  CHECK(found(folder, options) == "scanning\nfound 1\n");
  options.radio_range = 0.4;  // the robot is half a metre away
  CHECK(found(folder, options) == "scanning\nfound 0\n");
  options.radio_range = 0.6;
  CHECK(found(folder, options) == "scanning\nfound 1\n");
  options.radio_loss = 1;
  CHECK(found(folder, options) == "scanning\nfound 0\n");
}

TEST_CASE("What a central says while no program has its line open is counted") {
  using namespace std::chrono_literals;
  using Clock = std::chrono::steady_clock;
  const Folder folder;
  sim::MapperOptions options;
  options.robots = 1;
  options.speed = 1000;
  const auto give_up = Clock::now() + 20s;
  host::Descriptor line;
  std::string heard;
  bool connects = false;
  std::optional<Clock::time_point> gone;
  int turns = 0;  // since then
  const auto say = [&line](std::string_view text) {
    return ::write(line.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
  };
  Watched watched;
  sim::Shell shell = watched.shell();
  shell.stop = [&] {
    const auto now = Clock::now();
    if (now > give_up) return true;
    // The robot says who it is each second of its time.
    if (gone) return ++turns > 20 && now > *gone + 50ms;
    if (!line) {
      line = host::Descriptor{
          ::open((folder / "ocm/central").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)};
      return !line || !say("start\nlist\n");
    }
    char text[256];
    const ssize_t size = ::read(line.get(), text, sizeof text);
    if (size > 0) heard.append(text, static_cast<std::size_t>(size));
    if (!connects && heard.ends_with("end of list\n")) {
      connects = heard.find(":AVR\n") != std::string::npos;
      heard.clear();
      return !say(connects ? "stop\nconn 0\n" : "list\n");
    }
    if (connects && heard.find("connected 0\n") != std::string::npos) {
      line.reset();
      gone = now;
    }
    return false;
  };
  CHECK(sim::serve_mappers(options, shell).well());
  REQUIRE(gone.has_value());
  const auto central =
      std::find_if(watched.reports.begin(), watched.reports.end(),
                   [](const std::string& report) { return report.starts_with("central    "); });
  REQUIRE(central != watched.reports.end());
  const std::size_t end = central->find(" bytes sent with no server connected");
  REQUIRE(end != std::string::npos);
  const std::size_t begin = central->rfind(' ', end - 1) + 1;
  const auto bytes = std::stoull(central->substr(begin, end - begin));
  CHECK(bytes >= 20U);          // who it is, once
  CHECK(bytes <= 10'000'000U);  // no more than a few hundred thousand times
}

}  // namespace sim_serve_serve_test
