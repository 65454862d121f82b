// What `publish` says of a bus before it asks a board, word for word, and what becomes of a behaviour that a
// board was asked for.
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <fcntl.h>
#include <sstream>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"
#include "ocm/topics/amiro.hpp"

#include "cli/command/behaviour_watch.hpp"
#include "cli/command/bus_admission.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/command.hpp"
#include "tests/tool/captured.hpp"
#include "tests/tool/clock/played_bus.hpp"
#include "tests/tool/golden.hpp"
#include "tests/tool/pseudo_terminal.hpp"

namespace tool_clock_admission_test {

using namespace ocm;
using namespace ocm::test;

struct Comes {
  can::Frame frame;
  Duration first;
  Duration every;
};

can::Frame frame(std::uint32_t id, std::initializer_list<int> bytes, can::Format format = can::Format::base) {
  can::Frame made;
  made.id = id;
  made.format = format;
  made.dlc = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), made.data.begin());
  return made;
}

struct Row {
  std::vector<std::string_view> words;
  cli::AdmissionOptions options;
  std::vector<Comes> comes;
  bool silent = false;  ///< no board says that it publishes nothing
};

/// What is said, sent and refused.
std::string said(const Row& row) {
  World world{1};
  PlayedBus::Conditions conditions;
  auto comes = row.comes;
  if (!row.silent)  // boards that report that none of their topics runs
    for (const std::uint32_t id : {0x71BU, 0x739U, 0x757U})
      comes.push_back({frame(id, {0, 0, 0, 0, 0, 0, 0, 0}), 3ms, 50ms});
  for (const Comes& each : comes)
    for (Moment at = World::start + each.first; at < World::start + row.options.listen + 5ms;
         at += each.every)
      conditions.incoming.push_back({at, each.frame});
  std::stable_sort(conditions.incoming.begin(), conditions.incoming.end(),
                   [](const auto& a, const auto& b) { return a.at < b.at; });
  PlayedBus bus{world, conditions};
  const cli::words::CommandParser parser{amiro::catalogue};
  const auto command = parser.parse_line(row.words);
  REQUIRE(command.ok());
  cli::RefusalWatch refusals{amiro::catalogue, "publish", cli::Confirm::yes};
  std::string text = "---";
  for (const auto word : row.words) text += fmt::format(" {}", word);
  text += fmt::format("{}{}, {}\n", row.options.force ? ", forced" : "",
                      row.options.explain ? ", explained" : "", row.options.listen / 1ms);
  Captured out{STDOUT_FILENO}, err{STDERR_FILENO};
  std::string end;
  try {
    cli::admit(amiro::catalogue, bus, *command, row.options, refusals);
    // Its board refuses it: what is offered then?
    refusals.sent(command->frames);
    const std::uint32_t board =
        command->answers != nullptr && command->answers->id.value >= 0x1E ? 0x73B : 0x71D;
    const auto topic = static_cast<int>(command->frames[0].id & 0xFF);
    for (const int count : {1, 2})
      refusals.take({world.wall_at(world.now()), frame(board, {topic, 15, count, 0, 0, 0, 0, 0})});
    refusals.tell();
  } catch (const cli::Exit& exit) {
    end = fmt::format("exit {}\n", exit.code);
  }
  text += out.text() + "- said\n" + err.text() + end;
  CHECK(bus.sent().empty());
  const bool looks = row.words[0] == "publish" && (!row.options.force || row.options.explain);
  CHECK((world.now() - World::start >= row.options.listen) == looks);
  return text;
}

TEST_CASE("admission: what is said of a bus before a board is asked is as it was") {
  const cli::AdmissionOptions plain{}, explained{.force = false, .explain = true, .listen = 100ms},
      forced{.force = true, .explain = false, .listen = 100ms},
      both{.force = true, .explain = true, .listen = 250ms},
      longer{.force = false, .explain = true, .listen = 500ms};
  const can::Frame gyro = frame(0x608, {0, 0, 0, 0, 0, 0}), low = frame(0x708, {0, 0, 0, 0, 0, 0}),
                   velocity = frame(0x602, {0, 0, 0, 0, 0, 0, 0, 0}),
                   pose = frame(0x603, {0, 0, 0, 0, 0, 0, 0, 0}), stranger = frame(0x111, {1, 2, 3}),
                   wide = frame(0x18FF0102, {1, 2, 3, 4, 5, 6, 7, 8}, can::Format::extended),
                   motors = frame(0x201, {0, 0, 0, 0, 0, 0, 0, 0});
  const Row rows[] = {
      {{"publish", "gyro", "50ms"}, explained, {}},
      {{"publish", "gyro", "50ms"}, explained, {}, true},
      {{"publish", "gyro"},
       explained,
       {{velocity, 1ms, 50ms},
        {pose, 2ms, 50ms},
        {stranger, 7ms, 33ms},
        {wide, 9ms, 500ms},
        {motors, 11ms, 100ms}}},
      {{"publish", "ring", "1ms", "--priority", "urgent"},
       explained,
       {{velocity, 1ms, 50ms}, {pose, 2ms, 50ms}, {gyro, 4ms, 50ms}}},
      {{"publish", "ring", "1ms", "--priority", "urgent"}, plain, {{velocity, 1ms, 50ms}, {pose, 2ms, 50ms}}},
      {{"publish", "ring", "2ms", "--priority", "urgent"}, plain, {{low, 1ms, 500us}}},
      {{"publish", "mag", "300us"}, plain, {}},
      {{"publish", "mag", "300us", "--priority", "low"},
       plain,
       {{stranger, 0ms, 200us}, {velocity, 50us, 400us}}},
      {{"publish", "mag", "1ms"}, explained, {{stranger, 0ms, 160us}, {velocity, 50us, 400us}}},
      {{"publish", "mag", "900us"},
       longer,
       {{gyro, 1ms, 120ms},
        {frame(0x608, {1}), 7ms, 400ms},
        {stranger, 8ms, 400ms},
        {frame(0x111, {1, 2, 3, 4, 5}), 9ms, 400ms}}},
      {{"publish", "mag", "1ms"}, explained, {}, true},
      {{"publish", "mag", "900us"}, explained, {{gyro, 1ms, 50ms}}, true},
      {{"publish", "mag", "900us"}, both, {{gyro, 1ms, 50ms}}, true},
      {{"publish", "ring", "1ms"}, forced, {{gyro, 1ms, 50ms}}},
      {{"publish", "ring", "12ms"}, plain, {}},
      {{"once", "gyro"}, explained, {{velocity, 1ms, 50ms}}},
      {{"stop", "gyro"}, explained, {}},
      {{"publish", "power", "60s"},
       explained,
       {{gyro, 1ms, 10ms}, {frame(0x204, {0x01, 0x32, 0, 0}), 2ms, 20ms}}},
  };
  std::string text;
  for (const Row& row : rows) text += said(row);
  is_as_in("tests/tool/clock/golden/admission.txt", text);
}

TEST_CASE(
    "admission: what a status names and was not heard may be of any priority, so that no bound is known") {
  // power_status in the table, where the status of its board has these bits for what it publishes.
  const auto row_of = [](int publishing) {
    const Row row{{"publish", "gyro", "50ms"},
                  {.force = false, .explain = true, .listen = 100ms},
                  {{frame(0x739, {0, 0, 0, 0, 0, 0, 0, 0}), 3ms, 50ms},
                   {frame(0x73A, {0, 0, publishing, 0, 0, 0, 0, 0}), 4ms, 50ms}},
                  true};
    std::istringstream lines{said(row)};
    for (std::string line; std::getline(lines, line);)
      if (line.find("  power_status ") != std::string::npos) return line;
    return std::string{};
  };
  CHECK(row_of(0).empty());
  CHECK_THAT(row_of(0xFF), Catch::EndsWith("  not known"));
}

TEST_CASE("admission: more identifiers than the load is computed of are refused") {
  const auto heard = [](int count) {
    Row row{{"publish", "gyro", "50ms"}, {}, {}};
    for (int i = 0; i < count; ++i)
      row.comes.push_back(
          {frame(0x10000U + static_cast<std::uint32_t>(i), {}, can::Format::extended), i * 100us, 1s});
    return said(row);
  };
  constexpr std::string_view words = "more than 512 identifiers on the bus: its load cannot be computed";
  constexpr int others = 38;  // frames of the AMiRo: asked for, heard, or of what may run unheard
  CHECK(heard(512 - others).find(words) == std::string::npos);
  CHECK(heard(513 - others).find(words) != std::string::npos);
}

TEST_CASE("admission: what is heard may leave hardly any time, and is computed to its end") {
  // 110 us of each 111: a frame of the gyroscope waits for some 30 ms, behind hundreds of others.
  const std::string text = said({{"publish", "gyro", "50ms"}, {}, {{frame(0x111, {}), 0ms, 111us}}, true});
  CAPTURE(text);
  CHECK(text.find("does not fit") == std::string::npos);
  CHECK(text.find("exit") == std::string::npos);
}

/// What is said, with the table, of a gyroscope with a short name and without a deadline, on a bus of another
/// bit rate.
std::string explained_at(std::uint32_t bit_rate, std::string_view period,
                         const std::vector<PlayedBus::Incoming>& incoming = {}) {
  std::vector<protocol::Topic> topics{amiro::catalogue.topics.begin(), amiro::catalogue.topics.end()};
  const auto gyroscope = std::find_if(topics.begin(), topics.end(),
                                      [](const protocol::Topic& topic) { return topic.name == "gyroscope"; });
  REQUIRE(gyroscope != topics.end());
  gyroscope->name = "gyro";
  gyroscope->aliases = {};
  gyroscope->deadline = {};
  const protocol::Catalogue catalogue{amiro::catalogue.robot, bit_rate, amiro::catalogue.boards, topics};
  World world{1};
  PlayedBus::Conditions conditions;
  conditions.incoming = incoming;
  PlayedBus bus{world, conditions};
  const std::vector<std::string_view> words{"publish", "gyro", period};
  const auto command = cli::words::CommandParser{catalogue}.parse_line(words);
  REQUIRE(command.ok());
  cli::RefusalWatch refusals{catalogue, "publish", cli::Confirm::yes};
  const cli::AdmissionOptions explained{.force = false, .explain = true, .listen = 100ms};
  Captured out{STDOUT_FILENO};
  const Leaving left = leaving([&] { cli::admit(catalogue, bus, *command, explained, refusals); });
  return out.text() + left.text;
}

TEST_CASE(
    "admission: on a slow bus a frame of anything else is hardly any load; short names have a narrow "
    "column") {
  const std::string text = explained_at(10'000, "1s");
  CAPTURE(text);
  CHECK(text.find("amiroctl: ") == std::string::npos);
  CHECK_THAT(text, Catch::StartsWith("ID        MESSAGE     PERIOD   DEADLINE  BITS "));
  // 111 bits of 10,000 a second, and 135 bits once an hour.
  CHECK_THAT(text, Catch::Contains("\nload 1.1 % of 10000 bit/s at worst; 0 identifiers heard within "));
}

TEST_CASE("admission: the shortest period is of whole microseconds, and where none passes of milliseconds") {
  // 111 bits behind the 135 of any other frame; a request has 16 bits for a count of microseconds.
  const std::string shortest = "the shortest period that passes beside what was heard is ";
  CHECK_THAT(explained_at(500'000, "1s"), Catch::Contains(shortest + "492us\n"));
  CHECK_THAT(explained_at(1'000, "1s"), Catch::Contains(shortest + "246ms\n"));
  const std::string refused = explained_at(1'000, "100ms");
  CHECK_THAT(refused, Catch::Contains("publish: gyro every 100ms at medium does not fit on the bus"));
  CHECK_THAT(refused, Catch::Contains(" is 246ms (--listen hears more)"));
  // And behind 85 of a frame that was heard: 413.75 us.
  std::vector<PlayedBus::Incoming> incoming;
  for (const Duration at : {7ms, 40ms, 73ms})
    incoming.push_back({World::start + at, frame(0x111, {1, 2, 3})});
  CHECK_THAT(explained_at(800'000, "1s", incoming), Catch::Contains(shortest + "414us\n"));
}

TEST_CASE("admission: a stream that is asked for without a period has that of its topic") {
  std::istringstream lines{
      said({{"publish", "di_wheel_drive_status"}, {.force = false, .explain = true, .listen = 100ms}, {}})};
  std::string row;
  while (row.find(", asked for") == std::string::npos && std::getline(lines, row)) continue;
  CHECK_THAT(row, Catch::Matches("71B +di_wheel_drive_status/identity +1s +1s .*, asked for"));
}

TEST_CASE(
    "admission: what comes in a wrong length only is not in the spec, and what has its length once is") {
  const auto row_of_608 = [](std::vector<Comes> comes) {
    const Row row{
        {"publish", "mag", "50ms"}, {.force = false, .explain = true, .listen = 100ms}, std::move(comes)};
    std::istringstream lines{said(row)};
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with("608 ")) return line;
    return std::string{};
  };
  const Comes wrong{frame(0x608, {1}), 1ms, 33ms}, right{frame(0x608, {0, 0, 0, 0, 0, 0}), 40ms, 1s};
  CHECK_THAT(row_of_608({wrong}), Catch::StartsWith("608       not in the spec  "));
  CHECK_THAT(row_of_608({wrong, right}), Catch::StartsWith("608       gyroscope  "));
  CHECK_THAT(row_of_608({right}), Catch::StartsWith("608       gyroscope  "));
}

TEST_CASE("admission: on a narrow terminal each line is broken, and goes on behind four blanks") {
  constexpr std::size_t columns = 40;
  const PseudoTerminal terminal;
  winsize size{};
  size.ws_row = 24;
  size.ws_col = columns;
  REQUIRE(::ioctl(terminal.descriptor(), TIOCSWINSZ, &size) == 0);
  const cli::AdmissionOptions explained{.force = false, .explain = true, .listen = 100ms};
  const std::vector<std::string_view> words{"publish", "mag", "1ms"};
  const auto command = cli::words::CommandParser{amiro::catalogue}.parse_line(words);
  REQUIRE(command.ok());
  cli::RefusalWatch refusals{amiro::catalogue, "publish", cli::Confirm::yes};
  World world{1};
  PlayedBus bus{world, {}};
  std::fflush(stdout);
  const host::Descriptor before{::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3)};
  ::dup2(terminal.descriptor(), STDOUT_FILENO);
  const Leaving left = leaving([&] { cli::admit(amiro::catalogue, bus, *command, explained, refusals); });
  std::fputs("the end\n", stdout);
  std::fflush(stdout);
  ::dup2(before.get(), STDOUT_FILENO);
  CHECK_FALSE(left.code);
  const std::string text = terminal.shown("the end\r\n");
  CAPTURE(text);
  // The head, three frames that are asked for, what is not known, the shortest period, and the load.
  std::size_t whole = 0, broken = 0;
  bool goes_on = false;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find("\r\n", at);
    REQUIRE(end != std::string::npos);
    const std::string line = text.substr(at, end - at);
    at = end + 2;
    CHECK(line.size() <= columns);
    const std::size_t blanks = line.find_first_not_of(' ');
    if (blanks == 0) {
      ++whole;
      goes_on = false;
      continue;
    }
    CHECK(blanks == 4);
    if (!goes_on) ++broken;
    goes_on = true;
  }
  CHECK(whole == 8);  // with the end
  CHECK(broken == 7);
  CHECK_THAT(text, Catch::Contains("\r\nthe shortest period that passes beside\r\n    what was heard is "));
}

// --- what becomes of a behaviour ---

can::Frame behaviour(int active, int ended, int more = 0) {
  const auto& topic = *amiro::catalogue.find("behaviour");
  can::Frame made{protocol::identifier_of({&topic, 0}, topic.priority), topic.frames[0].dlc(), {}};
  for (const auto& field : topic.frames[0].fields)
    protocol::put(made.data, field.position,
                  field.name == "active"  ? active
                  : field.name == "ended" ? ended
                                          : more);
  return made;
}

TEST_CASE("behaviour watch: how a behaviour ended, what is left of it, and who else commanded one") {
  World world{1};
  const auto& topic = *amiro::catalogue.find("behaviour");
  const auto named = [&](std::string_view field, std::string_view name) {
    for (const auto& each : topic.frames[0].fields)
      if (each.name == field)
        for (const auto& value : each.values)
          if (value.name == name) return static_cast<int>(value.raw);
    FAIL(field << " " << name);
    return 0;
  };
  const int travel = named("active", "travel"), follow = named("active", "follow");
  std::string text;
  const auto show = [&](const char* what, const cli::BehaviourWatch& watch) {
    text += fmt::format(
        "{}: heard {}, over {}, replaced {}, commanded '{}', was active {}, ended '{}', left '{}', {} ms "
        "ago\n",
        what, watch.heard(), watch.over(), watch.is_replaced(), watch.commanded(), watch.was_active(),
        watch.ended(), watch.left(), watch.heard() ? (world.now() - watch.last()) / 1ms : -1);
  };
  const auto take = [&](cli::BehaviourWatch& watch, const can::Frame& each) {
    world.pass(10ms);
    watch.take({world.wall_at(world.now()), each});
  };
  cli::BehaviourWatch watch{amiro::catalogue, "travel", "travel"};
  CHECK(watch.sensor().name == "behaviour");
  show("nothing yet", watch);
  take(watch, frame(0x608, {0, 0, 0, 0, 0, 0}));
  show("another topic", watch);
  take(watch, behaviour(travel, 0, 40));
  take(watch, behaviour(0, 1, 7));
  show("one before", watch);
  watch.begin();
  show("begun", watch);
  for (int i = 0; i < 3; ++i) {
    take(watch, behaviour(0, 2, 7));
    show("not active", watch);
  }
  watch.begin();
  take(watch, behaviour(0, 2, 7));
  take(watch, behaviour(travel, 2, 300));
  show("active", watch);
  for (int i = 0; i < 4; ++i) take(watch, behaviour(travel, 2, 100));
  show("still active", watch);
  world.pass(50ms);
  for (const auto& value : topic.frames[0].fields[1].values) {
    auto ends = watch;
    take(ends, behaviour(0, static_cast<int>(value.raw), 3));
    show("ended", ends);
  }
  auto other = watch;
  take(other, behaviour(follow, 0, 5));
  show("another is active", other);
  other = watch;
  take(other, frame(0x20B, {0xA0, 0x86, 1, 0, 0, 0, 0xE8, 3}));
  show("it is commanded again", other);
  take(other, behaviour(0, 1, 9));
  show("and what is said is of that", other);
  other = watch;
  take(other, frame(0x20B, {0, 0, 0, 0, 0, 0, 0, 0}));
  take(other, frame(0x201, {1, 0, 0, 0, 0, 0, 0, 0}));
  show("it is ended by another program", other);
  other = watch;
  take(other, frame(0x20C, {0, 0}));
  show("the rest of another behaviour", other);
  take(other, frame(0x201, {1, 0, 0, 0, 0, 0, 0, 0}));
  show("the motors are commanded", other);
  take(other, frame(0x20C, {1, 0}));
  show("another behaviour is commanded", other);
  is_as_in("tests/tool/clock/golden/behaviour.txt", text);
  CHECK(&cli::behaviour_topic(amiro::catalogue, "travel", "travel") == amiro::catalogue.find("travel"));
  const Silence silence;
  CHECK_THROWS_AS(cli::behaviour_topic(amiro::catalogue, "behave", "odometry"), cli::Exit);
  CHECK_THROWS_AS(cli::behaviour_topic(amiro::catalogue, "behave", "dance"), cli::Exit);
  CHECK_THROWS_AS((cli::BehaviourWatch{amiro::catalogue, "behave", "dance"}), cli::Exit);
}

}  // namespace tool_clock_admission_test
