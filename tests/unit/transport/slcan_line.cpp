// What Slcan says, when, and what it makes of answers that come late, wrong or not at all. The line and the
// time are played: an adapter that is silent for an hour takes no time.
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"
#include "ocm/transport/slcan.hpp"

#include "unit/can/frame_of.hpp"
#include "unit/transport/played_line.hpp"

namespace transport_slcan_line_test {

using namespace ocm;
using namespace std::chrono_literals;
using base::Error;
using test::frame;
using test::PlayedLine;
using transport::BusState;
using transport::Failure;
using transport::Slcan;
using transport::SlcanOptions;
using Times = std::vector<base::Duration>;
using Texts = std::vector<std::string>;
using Waits = std::vector<test::PlayedKernel::Wait>;

/// By the manual: CR, or BEL for what is not known; frames by z and Z.
const std::map<char, std::string> by_the_manual = {{'-', "\r"},  {'C', "\r"}, {'V', "V1013\r"}, {'S', "\r"},
                                                   {'Z', "\r"},  {'O', "\r"}, {'F', "F00\r"},   {'t', "z\r"},
                                                   {'T', "Z\r"}, {'r', "z\r"}};

struct Scene {
  explicit Scene(std::map<char, std::string> answers = by_the_manual) { line.answers = std::move(answers); }
  void open(const SlcanOptions& options = {}) {
    auto opened = Slcan::open(line.path, options);
    INFO(opened.error.what);
    REQUIRE(opened);
    bus = std::move(opened.value);
  }
  Failure failure(const SlcanOptions& options = {}) {
    const auto opened = Slcan::open(line.path, options);
    CHECK_FALSE(opened);
    return opened.error;
  }
  /// Opens, and begins to count what is said and waited for.
  void begin(const SlcanOptions& options = {}) {
    open(options);
    line.begin = line.kernel.steady;
    line.heard.clear();
    line.lines.clear();
    line.kernel.waits.clear();
  }
  Texts received() {
    Texts all;
    while (const auto one = bus->receive(0ns)) all.emplace_back(can::to_text(one->frame).view());
    return all;
  }
  [[nodiscard]] std::string gone() const {
    return "the adapter on '" + line.path + "' is gone: unplugged, or its other end closed";
  }

  PlayedLine line;
  std::unique_ptr<Slcan> bus;
};

std::map<char, std::string> without(std::string_view letters) {
  auto answers = by_the_manual;
  for (const char letter : letters) answers.erase(letter);
  return answers;
}
std::map<char, std::string> with(char letter, const char* answer) {
  auto answers = by_the_manual;
  answers[letter] = answer;
  return answers;
}
/// An hour between two questions for the status: nothing but what a test is about.
SlcanOptions quiet() {
  SlcanOptions options;
  options.status_period = 1h;
  return options;
}

// --- opening ---

TEST_CASE("slcan line: an adapter that answers is open as soon as it has answered") {
  Scene scene;
  scene.open();
  CHECK(scene.line.heard == "\rC\rV\rS6\rZ1\rO\rF\r");
  CHECK(scene.line.passed() == 0ns);
  CHECK(scene.bus->answers());
  CHECK(scene.bus->version() == "1013");
  CHECK(scene.bus->name() == "slcan:" + scene.line.path);
  CHECK(scene.bus->descriptor() == scene.line.file);
  CHECK(scene.bus->state() == BusState::up);
}

TEST_CASE("slcan line: each bit rate has its digit") {
  const auto [rate, digit] = GENERATE(std::pair{10'000U, "S0\r"}, std::pair{20'000U, "S1\r"},
                                      std::pair{250'000U, "S5\r"}, std::pair{1'000'000U, "S8\r"});
  Scene scene;
  SlcanOptions options;
  options.bit_rate = rate;
  scene.open(options);
  CHECK_THAT(scene.line.heard, Catch::Contains(digit));
}

TEST_CASE("slcan line: an adapter that is silent is waited for once, and opened without its answers") {
  Scene scene{{}};
  scene.open();
  CHECK(scene.line.heard == "\rC\rV\rS6\rO\r");
  CHECK(scene.line.passed() == 1s);
  CHECK(scene.line.kernel.waits == Waits(100, {POLLIN, 10ms}));
  CHECK_FALSE(scene.bus->answers());
  CHECK(scene.bus->version().empty());
  CHECK(scene.bus->state() == BusState::up);
}

TEST_CASE("slcan line: an adapter is waited for as long as chosen") {
  Scene scene{{}};
  SlcanOptions options;
  options.first_answer = 70ms;
  scene.open(options);
  CHECK(scene.line.passed() == 70ms);
}

TEST_CASE("slcan line: of an adapter that answers the version is waited for 100 ms") {
  Scene scene{without("V")};
  scene.open();
  CHECK(scene.line.times_of("S6") == Times{100ms});
  CHECK(scene.bus->answers());
  CHECK(scene.bus->version().empty());
}

TEST_CASE("slcan line: of an adapter that answers the version is waited for no less than 100 ms") {
  Scene scene{without("V")};
  scene.line.kernel.later(99ms, [&] { scene.line.kernel.interrupt(); });
  scene.open();
  CHECK(scene.line.times_of("S6") == Times{109ms});  // it looks again after 10 ms
}

TEST_CASE("slcan line: an adapter that begins to answer once it is open never answers") {
  Scene scene{{}};
  scene.open();
  scene.line.say("\r");
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK_FALSE(scene.bus->answers());
  CHECK(scene.bus->adapter_counters().strays == 0);
}

TEST_CASE("slcan line: a status that was said unasked does not make an adapter one that has it") {
  Scene scene{with('F', "\a")};
  scene.line.answers['C'] = "F00\r\r";
  scene.begin();
  CHECK(scene.bus->receive(5s).error == Error::timed_out);
  CHECK(scene.line.heard.empty());
}

TEST_CASE("slcan line: each answer starts the wait for the next one again") {
  Scene scene{without("V")};
  scene.line.say_later(50ms, "\r");
  scene.open();
  CHECK(scene.line.times_of("S6") == Times{150ms});
}

TEST_CASE("slcan line: the version may come late") {
  Scene scene{without("V")};
  scene.line.say_later(90ms, "V2\r");
  scene.open();
  CHECK(scene.line.times_of("S6") == Times{90ms});
  CHECK(scene.bus->version() == "2");
}

TEST_CASE("slcan line: an adapter that talks on and on is opened after a second") {
  Scene scene{without("V")};
  for (int i = 1; i < 40; ++i) scene.line.say_later(i * 50ms, "\r");
  scene.open();
  CHECK(scene.line.times_of("S6") == Times{1s});
}

TEST_CASE("slcan line: an adapter that talks on and on has three times its patience where that is longer") {
  Scene scene{without("V")};
  SlcanOptions options;
  options.patience = 400ms;
  for (int i = 1; i < 40; ++i) scene.line.say_later(i * 50ms, "\r");
  scene.open(options);
  CHECK(scene.line.times_of("S6") == Times{1200ms});
}

TEST_CASE("slcan line: a version without a text is a version") {
  Scene scene{with('V', "V\r")};
  scene.open();
  CHECK(scene.bus->version() == "?");
  CHECK(scene.line.passed() == 0ns);
}

TEST_CASE("slcan line: a serial number is no answer to a command") {
  Scene scene{{{'C', "N1234\r"}}};
  scene.open();
  CHECK_FALSE(scene.bus->answers());
}

TEST_CASE("slcan line: an adapter that says its version, and nothing else, never answers") {
  Scene scene{{{'V', "V1013\r"}}};
  scene.open();
  CHECK(scene.line.heard == "\rC\rV\rS6\rO\r");
  CHECK_FALSE(scene.bus->answers());
  CHECK(scene.line.passed() == 0ns);
}

TEST_CASE("slcan line: lines of something else alone are no adapter") {
  Scene scene{{{'-', "login:\r"}, {'C', "password:\rno\r"}}};
  const Failure told = scene.failure();
  CHECK(told.what == "what comes from '" + scene.line.path + "' is not SLCAN (3 lines of something else)");
  CHECK(told.remedy == "is this the adapter? Another speed of the serial line is written slcan:" +
                           scene.line.path + "@500k,57600");
}

TEST_CASE("slcan line: lines of something else beside a version, or beside answers, are one") {
  SECTION("a version") {
    Scene scene{{{'-', "hello\r"}, {'V', "V1013\r"}}};
    scene.open();
    CHECK(scene.bus->line_faults().total() == 1);
  }
  SECTION("answers") {
    Scene scene{with('-', "hello\r")};
    scene.open();
    CHECK(scene.bus->line_faults().total() == 1);
  }
}

TEST_CASE("slcan line: an adapter that refuses says what") {
  SECTION("the bit rate") {
    Scene scene{with('S', "\a")};
    CHECK(scene.failure() ==
          Failure{"the adapter on '" + scene.line.path + "' refuses the bit rate 500k (command S6)",
                  "it may serve others only, or be in use: unplug it and plug it in again"});
    CHECK(scene.line.heard == "\rC\rV\rS6\r");  // and no channel is closed
  }
  SECTION("the channel") {
    Scene scene{with('O', "\a")};
    CHECK(scene.failure() ==
          Failure{"the adapter on '" + scene.line.path + "' refuses to open the channel (command O)",
                  "unplug it and plug it in again; is its firmware one for SLCAN?"});
  }
}

TEST_CASE("slcan line: an adapter that stops to answer is given its patience") {
  Scene scene{without("S")};
  CHECK(scene.failure() ==
        Failure{"the adapter on '" + scene.line.path +
                    "' has stopped to answer when asked for the bit rate 500k (command S6)",
                "unplug it and plug it in again"});
  CHECK(scene.line.passed() == 300ms);
  CHECK(scene.line.kernel.waits[1] == test::PlayedKernel::Wait{POLLIN, 10ms});
}

TEST_CASE("slcan line: times and status that are not answered are done without") {
  Scene scene{without("ZF")};
  scene.begin();
  CHECK(scene.line.passed() == 0ns);
  CHECK(scene.bus->receive(5s).error == Error::timed_out);
  CHECK(scene.line.heard.empty());
}

TEST_CASE("slcan line: times and status that are not answered take their patience each") {
  Scene scene{without("ZF")};
  scene.open();
  CHECK(scene.line.times_of("O") == Times{300ms});
  CHECK(scene.line.passed() == 600ms);
}

TEST_CASE("slcan line: an adapter that refuses its status is not asked again") {
  Scene scene{with('F', "\a")};
  scene.begin();
  CHECK(scene.bus->receive(5s).error == Error::timed_out);
  CHECK(scene.line.heard.empty());
}

TEST_CASE("slcan line: frames of the channel as another program left it are thrown away") {
  Scene scene{with('C', "t6050\r\r")};
  scene.open();
  CHECK(scene.received().empty());
}

TEST_CASE("slcan line: frames that come once the channel is open are received") {
  Scene scene{with('O', "\rt6050\r")};
  scene.open();
  CHECK(scene.received() == Texts{"605#"});
}

TEST_CASE("slcan line: an adapter that goes while it is opened is gone") {
  const char letter = GENERATE('V', 'S', 'Z', 'O', 'F');
  CAPTURE(letter);
  Scene scene{without(std::string(1, letter))};
  scene.line.kernel.later(letter == 'V' ? 20ms : 0ms, [&] {});
  scene.line.kernel.later(50ms, [&] { scene.line.hung_up = true; });
  CHECK(scene.failure() == Failure{scene.gone(), "plug it in again and restart"});
  CHECK(scene.line.passed() == 50ms);
}

TEST_CASE("slcan line: a line without room is waited for while it is opened") {
  Scene scene;
  scene.line.room = 2;
  scene.line.kernel.later(35ms, [&] { scene.line.room = SIZE_MAX; });
  scene.open();
  CHECK(scene.line.heard == "\rC\rV\rS6\rZ1\rO\rF\r");
  CHECK(scene.line.passed() == 35ms);
  CHECK(scene.line.kernel.waits[0] == test::PlayedKernel::Wait{POLLOUT, 10ms});
}

TEST_CASE("slcan line: a line that never has room is given up, each command after its patience") {
  Scene scene{{}};
  scene.line.room = 1;
  scene.open();
  CHECK(scene.line.heard == "\r");
  CHECK_FALSE(scene.bus->answers());
  CHECK(scene.line.passed() == 1900ms);  // three commands, and the answer
}

TEST_CASE("slcan line: a socket that is connected already is in use") {
  Scene scene;
  scene.line.connect_error = EAGAIN;
  CHECK(scene.failure().what == "'" + scene.line.path + "' is in use by another program");
  scene.line.connect_error = EACCES;
  CHECK(scene.failure().what ==
        "not allowed to open '" + scene.line.path + "' (" + std::strerror(EACCES) + ")");
}

TEST_CASE("slcan line: the path of a socket has at most 107 characters") {
  Scene scene;
  const std::string stem = scene.line.folder.path() + "/";
  const std::string longest = stem + std::string(107 - stem.size(), 'x');
  REQUIRE(::mknod(longest.c_str(), S_IFSOCK | 0600, 0) == 0);
  CHECK(Slcan::open(longest, SlcanOptions{}));
  const std::string beyond = longest + "x";
  REQUIRE(::mknod(beyond.c_str(), S_IFSOCK | 0600, 0) == 0);
  const auto refused = Slcan::open(beyond, SlcanOptions{});
  REQUIRE_FALSE(refused);
  CHECK(refused.error ==
        Failure{"the path '" + beyond + "' is too long for a socket", "use one of at most 107 characters"});
}

TEST_CASE("slcan line: a bit rate that no adapter has is refused with the nearest") {
  Scene scene;
  SlcanOptions options;
  options.bit_rate = 83'333;
  CHECK(scene.failure(options).what ==
        "an SLCAN adapter has no bit rate 83333: only 10k, 20k, 50k, 100k, 125k, 250k, 500k, 800k, 1M");
  CHECK(scene.line.file == -1);
}

TEST_CASE("slcan line: an address is a path and its options") {
  Scene scene;
  const auto opened = Slcan::open(scene.line.path + "@125k");
  REQUIRE(opened);
  CHECK_THAT(scene.line.heard, Catch::Contains("S4\r"));
  CHECK(Slcan::open("@125k").error.what == "'slcan:@125k' names no device");
}

// --- receiving ---

TEST_CASE("slcan line: receive waits as long as it has to, and for input") {
  Scene scene{without("F")};
  scene.begin();
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.line.passed() == 20ms);
  CHECK(scene.line.kernel.waits == Waits{{POLLIN, 20ms}});
}

TEST_CASE("slcan line: receive does not wait for a time of zero, nor for one that has passed") {
  Scene scene;
  scene.begin();
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->receive(-1ms).error == Error::timed_out);
  CHECK(scene.line.kernel.waits.empty());
}

TEST_CASE("slcan line: half a line is no frame, and does not prolong the wait") {
  Scene scene{without("F")};
  scene.begin();
  scene.line.say_later(5ms, "t605");
  scene.line.say_later(30ms, "0\r");
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.line.passed() == 20ms);
  const auto received = scene.bus->receive(1h);
  REQUIRE(received);
  CHECK(received->frame == frame("605#"));
  CHECK(scene.line.passed() == 30ms);
  CHECK(scene.bus->counters().received == 1);
}

TEST_CASE("slcan line: a signal ends the wait") {
  Scene scene;
  scene.begin();
  scene.line.kernel.later(5ms, [&] { scene.line.kernel.interrupt(); });
  CHECK(scene.bus->receive(1h).error == Error::timed_out);
  CHECK(scene.line.passed() == 5ms);
  CHECK(scene.bus->state() == BusState::up);
}

TEST_CASE("slcan line: a frame without a stamp has the time at which it was read") {
  Scene scene{without("F")};
  scene.begin();
  scene.line.say_later(30ms, "t6050\r");
  const base::Time then = scene.line.kernel.unix_time + 30ms;
  const auto received = scene.bus->receive(1h);
  REQUIRE(received);
  CHECK(received->time == then);
}

TEST_CASE("slcan line: a frame with a stamp has the adapter's distance from the one before") {
  Scene scene{without("F")};
  scene.begin();
  scene.line.say("t605003E8\r");
  const base::Time first = scene.line.kernel.unix_time;
  CHECK(scene.bus->receive(0ns)->time == first);
  scene.line.say_later(50ms, "t605003ED\r");
  CHECK(scene.bus->receive(1h)->time == first + 5ms + 10us);  // the clocks may differ by 200 ppm
}

TEST_CASE("slcan line: an error line of the adapter is a frame at the time of reading") {
  Scene scene{without("F")};
  scene.begin();
  scene.line.say_later(30ms, "e1a\r");
  const base::Time then = scene.line.kernel.unix_time + 30ms;
  const auto received = scene.bus->receive(1h);
  REQUIRE(received);
  CHECK(received->time == then);
  CHECK(scene.bus->counters().error_frames == 1);
  CHECK(scene.bus->counters().received == 1);
}

TEST_CASE("slcan line: more than one read holds is read at once") {
  Scene scene{without("F")};
  scene.begin();
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "t6050\r";
  scene.line.say(text);
  CHECK(scene.bus->receive(0ns));
  CHECK(scene.line.input.empty());
  CHECK(scene.line.asked_for == 4096);
}

TEST_CASE("slcan line: 65536 frames are kept of a program that only sends, and those beyond are counted") {
  Scene scene{without("F")};
  scene.begin();
  std::string text;
  for (int i = 0; i < 65'000; ++i) text += "t6050\r";
  scene.line.say(text);
  CHECK(*scene.bus->send(frame("100#")));
  CHECK(scene.bus->counters().lost == 0);
  text.clear();
  for (int i = 0; i < 546; ++i) text += "t6050\r";
  scene.line.say(text);
  CHECK(*scene.bus->send(frame("101#")));
  CHECK(scene.bus->counters().lost == 10);
  CHECK(scene.received().size() == 65'536);
  scene.line.say("t6050\r");
  CHECK(scene.received().size() == 1);
  CHECK(scene.bus->counters().lost == 10);
}

TEST_CASE("slcan line: a full inbox stops the reading") {
  Scene scene{without("F")};
  scene.begin();
  std::string text;
  for (int i = 0; i < 70'000; ++i) text += "t6050\r";
  scene.line.say(text);
  CHECK(*scene.bus->send(frame("100#")));
  CHECK_FALSE(scene.line.input.empty());
  CHECK(scene.bus->counters().lost < 4096);
}

TEST_CASE("slcan line: a signal while it reads or writes changes nothing") {
  Scene scene{without("F")};
  scene.begin();
  scene.line.read_errors = {EINTR, EINTR};
  scene.line.say("t6050\r");
  CHECK(scene.received() == Texts{"605#"});
  scene.line.send_errors = {EINTR};
  CHECK(*scene.bus->send(frame("100#")));
  CHECK(scene.line.heard == "t1000\r");
}

// --- the end of the line ---

TEST_CASE("slcan line: what was complete comes before the end, and half a line is named in it") {
  Scene scene;
  scene.begin();
  scene.line.say("t6050\rt60");
  scene.line.hung_up = true;
  const auto last = scene.bus->receive(1h);
  REQUIRE(last);
  CHECK(last->frame == frame("605#"));
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->failure().what == scene.gone() + ", in the middle of a line");
}

TEST_CASE("slcan line: the end of a line is none of the errors of before") {
  Scene scene;
  scene.begin();
  scene.line.stale_error = GENERATE(EAGAIN, EINTR, ENXIO);
  scene.line.hung_up = true;
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->failure().what == scene.gone());
}

TEST_CASE("slcan line: an error of the line is named unless it is the usual one") {
  SECTION("the usual one") {
    Scene scene;
    scene.begin();
    scene.line.read_errors = {EIO};
    CHECK(scene.bus->receive(1h).error == Error::closed);
    CHECK(scene.bus->failure().what == scene.gone());
  }
  SECTION("another while it reads") {
    Scene scene;
    scene.begin();
    scene.line.read_errors = {ECONNRESET};
    CHECK(scene.bus->receive(1h).error == Error::closed);
    CHECK(scene.bus->failure().what == scene.gone() + " (" + std::strerror(ECONNRESET) + ")");
  }
  SECTION("another while it writes") {
    Scene scene;
    scene.begin();
    scene.line.send_errors = {EPIPE};
    CHECK(scene.bus->send(frame("100#")).error == Error::closed);
    CHECK(scene.bus->failure().what == scene.gone() + " (" + std::strerror(EPIPE) + ")");
    CHECK(scene.bus->counters().refused == 0);
    CHECK(scene.bus->counters().sent == 0);
  }
}

TEST_CASE("slcan line: after the end nothing is said, waited for or known") {
  Scene scene;
  scene.begin();
  scene.line.hung_up = true;
  CHECK(scene.bus->send(frame("100#")).error == Error::closed);
  CHECK(scene.bus->receive(1h).error == Error::closed);
  CHECK(scene.bus->state() == BusState::closed);
  scene.bus.reset();
  CHECK(scene.line.heard.empty());
  CHECK(scene.line.kernel.waits.empty());
}

// --- sending ---

TEST_CASE("slcan line: a frame is pending until it is answered") {
  Scene scene{without("t")};
  scene.begin(quiet());
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.line.heard == "t100101\r");
  CHECK(scene.bus->delivery().known);
  CHECK(scene.bus->delivery().pending == 1);
  scene.line.say("z\r");
  CHECK(scene.bus->delivery().known);
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->counters().sent == 1);
}

TEST_CASE("slcan line: a bare CR answers a frame, too") {
  Scene scene{with('t', "\r")};
  scene.begin(quiet());
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->adapter_counters().strays == 0);
}

TEST_CASE("slcan line: a frame that the line has taken in part is pending once") {
  Scene scene{without("t")};
  scene.begin(quiet());
  scene.line.room = 3;
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 1);
  scene.line.room = SIZE_MAX;
  CHECK(scene.bus->delivery().pending == 1);
  CHECK(scene.line.heard == "t100101\r");
  scene.line.say("z\r");
  CHECK(scene.bus->delivery().pending == 0);
}

TEST_CASE("slcan line: of an adapter that never answers what the line has not taken is pending") {
  Scene scene{{}};
  scene.begin();
  scene.line.room = 3;
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().known);
  CHECK(scene.bus->delivery().pending == 1);
  scene.line.room = SIZE_MAX;
  CHECK_FALSE(scene.bus->delivery().known);
}

TEST_CASE("slcan line: the rest of a line goes first, and the next frame waits for it") {
  Scene scene;
  scene.begin(quiet());
  scene.line.room = 3;
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK_FALSE(*scene.bus->send(frame("101#02")));
  CHECK(scene.bus->counters().refused == 1);
  scene.line.kernel.later(7ms, [&] { scene.line.room = SIZE_MAX; });
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.line.kernel.waits[0] == test::PlayedKernel::Wait{POLLIN | POLLOUT, 20ms});
  CHECK(scene.line.kernel.waits[1].events == POLLIN);
  CHECK(scene.line.lines[0] == PlayedLine::Line{7ms, "t100101"});
  CHECK(*scene.bus->send(frame("101#02")));
  CHECK(scene.line.heard == "t100101\rt101102\r");
}

TEST_CASE("slcan line: a frame of which the line takes nothing is refused, and not said later") {
  Scene scene;
  scene.begin(quiet());
  scene.line.room = 0;
  CHECK_FALSE(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->counters().refused == 1);
  CHECK(scene.bus->counters().sent == 0);
  CHECK(scene.bus->delivery().pending == 0);
  scene.line.room = SIZE_MAX;
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.line.heard.empty());
}

TEST_CASE("slcan line: of one identifier one frame is under way, and at most as many as the window has") {
  Scene scene{without("trT")};
  SlcanOptions options = quiet();
  options.window = 3;
  scene.begin(options);
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK_FALSE(*scene.bus->send(frame("100#02")));
  CHECK_FALSE(*scene.bus->send(frame("100#R")));
  CHECK(*scene.bus->send(frame("00000100#02")));
  CHECK_FALSE(*scene.bus->send(frame("00000100#03")));
  CHECK(*scene.bus->send(frame("101#")));
  CHECK_FALSE(*scene.bus->send(frame("102#")));
  CHECK(scene.bus->counters().sent == 3);
  CHECK(scene.bus->counters().refused == 4);
}

TEST_CASE("slcan line: an answer is waited for as long as chosen, then the adapter answers no frames") {
  Scene scene{without("tF")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(*scene.bus->send(frame("101#01")));
  CHECK(scene.bus->receive(499ms).error == Error::timed_out);
  CHECK(scene.bus->delivery().pending == 2);
  CHECK(scene.bus->adapter_counters().unanswered == 0);
  CHECK(scene.bus->receive(1ms).error == Error::timed_out);
  CHECK_FALSE(scene.bus->delivery().known);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
  for (int i = 0; i < 20; ++i) CHECK(*scene.bus->send(frame("100#01")));
  CHECK_FALSE(scene.bus->delivery().known);
  CHECK(scene.bus->receive(2s).error == Error::timed_out);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
  scene.line.room = 3;
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 1);
}

TEST_CASE("slcan line: of an adapter that has answered frames an answer that is lost costs one frame") {
  Scene scene{with('F', "\a")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 0);
  scene.line.answers.erase('t');
  CHECK(*scene.bus->send(frame("100#02")));
  CHECK(scene.bus->receive(600ms).error == Error::timed_out);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
  CHECK(scene.bus->delivery().known);
  CHECK(scene.bus->delivery().pending == 1);
  scene.line.answers['t'] = "z\r";
  CHECK(*scene.bus->send(frame("100#03")));
  CHECK(scene.bus->delivery().pending == 1);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
}

TEST_CASE("slcan line: while it waits it looks again when the next answer is due") {
  Scene scene{without("tF")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->receive(2s).error == Error::timed_out);
  CHECK(scene.line.kernel.waits == Waits{{POLLIN, 500ms}, {POLLIN, 1500ms}});
}

TEST_CASE("slcan line: what is refused is said again after 2 ms, before anything else") {
  Scene scene{with('t', "\a")};
  scene.begin(quiet());
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 1);
  CHECK_FALSE(*scene.bus->send(frame("101#02")));
  scene.line.answers['t'] = "z\r";
  CHECK(scene.bus->receive(20ms).error == Error::timed_out);
  CHECK(scene.line.lines == std::vector<PlayedLine::Line>{{0ns, "t100101"}, {2ms, "t100101"}});
  CHECK(scene.bus->adapter_counters().sent_again == 1);
  CHECK(scene.bus->counters().sent == 1);
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(*scene.bus->send(frame("101#02")));
}

TEST_CASE("slcan line: what was refused goes again within the window") {
  Scene scene{without("t")};
  SlcanOptions options = quiet();
  options.window = 2;
  scene.begin(options);
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(*scene.bus->send(frame("101#02")));
  scene.line.say("\a\a");
  CHECK(scene.bus->delivery().pending == 2);
  CHECK(scene.bus->receive(2ms).error == Error::timed_out);
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.line.heard == "t100101\rt101102\rt100101\rt101102\r");
  CHECK(scene.bus->delivery().pending == 2);
  CHECK(scene.bus->adapter_counters().sent_again == 2);
}

TEST_CASE("slcan line: what was refused waits for a place in the window, in which a status has one, too") {
  Scene scene;
  SlcanOptions options;
  options.window = 1;
  scene.begin(options);
  scene.line.answers.erase('t');
  scene.line.answers.erase('F');
  scene.line.kernel.pass(900ms);
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->receive(100ms).error == Error::timed_out);
  CHECK(scene.line.heard == "t100101\rF\r");
  scene.line.say("\a");
  CHECK(scene.bus->receive(10ms).error == Error::timed_out);
  CHECK(scene.line.heard == "t100101\rF\r");
  scene.line.say("F00\r");
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.line.heard == "t100101\rF\rt100101\r");
  CHECK(scene.bus->adapter_counters().sent_again == 1);
}

TEST_CASE("slcan line: what was refused waits for room in the line") {
  Scene scene{with('t', "\a")};
  scene.begin(quiet());
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 1);
  scene.line.room = 0;
  scene.line.kernel.pass(2ms);
  CHECK(scene.bus->delivery().pending == 1);
  CHECK(scene.bus->adapter_counters().sent_again == 0);
  scene.line.room = SIZE_MAX;
  scene.line.answers['t'] = "z\r";
  CHECK(scene.bus->delivery().pending == 1);
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->adapter_counters().sent_again == 1);
}

TEST_CASE("slcan line: an answer to nothing is a stray") {
  Scene scene;
  scene.begin(quiet());
  scene.line.say("z\r\a\r");
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->adapter_counters().strays == 3);
  CHECK(scene.bus->adapter_counters().unanswered == 0);
}

TEST_CASE("slcan line: a version or a serial number that comes unasked is no stray") {
  Scene scene;
  scene.begin(quiet());
  scene.line.say("V1\rN1\r");
  CHECK(scene.bus->receive(0ns).error == Error::timed_out);
  CHECK(scene.bus->adapter_counters().strays == 0);
}

// --- the status ---

TEST_CASE("slcan line: the status is asked for once a second, while the program waits") {
  Scene scene;
  scene.begin();
  CHECK(scene.bus->receive(3500ms).error == Error::timed_out);
  CHECK(scene.line.times_of("F") == Times{1s, 2s, 3s});
  CHECK(scene.bus->adapter_counters().strays == 0);
  CHECK(scene.bus->adapter_counters().unanswered == 0);
}

TEST_CASE("slcan line: a signal while the status is asked for does not end the wait") {
  Scene scene;
  scene.begin();
  scene.line.answers.erase('F');
  scene.line.kernel.later(1s, [&] { scene.line.send_errors = {EINTR}; });
  CHECK(scene.bus->receive(1900ms).error == Error::timed_out);
  CHECK(scene.line.passed() == 1900ms);
  CHECK(scene.line.times_of("F") == Times{1s});
}

TEST_CASE("slcan line: a status that is asked for is no pending frame") {
  Scene scene;
  scene.begin();
  scene.line.answers.erase('F');
  scene.line.kernel.pass(1s);
  CHECK(scene.bus->delivery().known);
  CHECK(scene.line.heard == "F\r");
  CHECK(scene.bus->delivery().pending == 0);
}

TEST_CASE("slcan line: a status that is not answered counts as unanswered, and frames go on") {
  Scene scene;
  scene.begin();
  scene.line.answers.erase('F');
  CHECK(scene.bus->receive(1600ms).error == Error::timed_out);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
  CHECK(scene.bus->delivery().known);
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 0);
}

TEST_CASE("slcan line: the answer to a frame passes over a status that was not answered") {
  Scene scene{without("t")};
  scene.begin();
  scene.line.answers.erase('F');
  scene.line.kernel.pass(1s);
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.line.heard == "F\rt100101\r");
  scene.line.say("z\r");
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
  CHECK(scene.bus->adapter_counters().strays == 0);
}

TEST_CASE("slcan line: a refusal answers the status that was asked for first") {
  Scene scene{without("t")};
  scene.begin();
  scene.line.answers['F'] = "\a";
  scene.line.kernel.pass(1s);
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 1);
  CHECK(scene.bus->adapter_counters().unanswered == 0);
  scene.line.say("z\r");
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->adapter_counters().sent_again == 0);
}

TEST_CASE("slcan line: a status passes over a frame that was not answered") {
  Scene scene{without("t")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  scene.line.say("F00\r");
  CHECK(scene.bus->delivery().pending == 0);
  CHECK(scene.bus->adapter_counters().unanswered == 1);
  CHECK(scene.bus->adapter_counters().strays == 1);
}

TEST_CASE("slcan line: a status that changes is an error frame at the time of reading, once") {
  Scene scene;
  scene.begin();
  scene.line.answers['F'] = "F04\r";
  const base::Time then = scene.line.kernel.unix_time + 1s;
  const auto received = scene.bus->receive(1h);
  REQUIRE(received);
  CHECK(can::to_text(received->frame).view() == "20000004#000C000000000000");
  CHECK(received->time == then);
  CHECK(scene.bus->receive(3s).error == Error::timed_out);
}

TEST_CASE("slcan line: a full transmit queue is reported of an adapter that has answered no frame") {
  Scene scene;
  scene.begin();
  scene.line.answers['F'] = "F02\r";
  const auto received = scene.bus->receive(1500ms);
  REQUIRE(received);
  CHECK(can::to_text(received->frame).view() == "20000004#0002000000000000");
}

TEST_CASE("slcan line: a full transmit queue is no error of an adapter that answers frames") {
  Scene scene;
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  CHECK(scene.bus->delivery().pending == 0);
  scene.line.answers['F'] = "F02\r";
  CHECK(scene.bus->receive(3s).error == Error::timed_out);
}

TEST_CASE("slcan line: the status waits for room in the line") {
  Scene scene;
  scene.begin();
  scene.line.room = 0;
  scene.line.kernel.later(1700ms, [&] { scene.line.room = SIZE_MAX; });
  CHECK(scene.bus->receive(1500ms).error == Error::timed_out);
  CHECK(scene.bus->adapter_counters().unanswered == 0);
  CHECK(scene.line.kernel.waits[0] == test::PlayedKernel::Wait{POLLIN, 1s});
  CHECK(scene.line.kernel.waits[1] == test::PlayedKernel::Wait{POLLIN, 1ms});
  CHECK(scene.bus->receive(500ms).error == Error::timed_out);
  REQUIRE(scene.line.times_of("F").size() == 1);
}

// --- closing ---

TEST_CASE("slcan line: a bus that ends closes the channel, and goes when the adapter has answered") {
  Scene scene;
  scene.begin();
  scene.bus.reset();
  CHECK(scene.line.heard == "C\r");
  CHECK(scene.line.passed() == 0ns);
}

TEST_CASE("slcan line: at its end an adapter that does not answer is waited for 50 ms") {
  Scene scene;
  scene.begin();
  scene.line.answers.clear();
  scene.bus.reset();
  CHECK(scene.line.heard == "C\r");
  CHECK(scene.line.passed() == 50ms);
}

TEST_CASE("slcan line: at its end an adapter that does not answer is waited for no less than 50 ms") {
  Scene scene;
  scene.begin();
  scene.line.answers.clear();
  scene.line.kernel.later(49ms, [&] { scene.line.kernel.interrupt(); });
  scene.bus.reset();
  CHECK(scene.line.passed() == 51ms);  // it looks again after 2 ms
}

TEST_CASE("slcan line: at its end an adapter that never answers is not waited for") {
  Scene scene{{}};
  scene.begin();
  scene.bus.reset();
  CHECK(scene.line.heard == "C\r");
  CHECK(scene.line.passed() == 2ms);
}

TEST_CASE("slcan line: at its end frames that are not answered are waited for as long as chosen") {
  Scene scene{without("t")};
  SlcanOptions options;
  options.farewell = 130ms;
  scene.begin(options);
  CHECK(*scene.bus->send(frame("100#01")));
  scene.bus.reset();
  CHECK(scene.line.times_of("C") == Times{130ms});
  CHECK(scene.line.kernel.waits[0] == test::PlayedKernel::Wait{POLLIN, 2ms});
}

TEST_CASE("slcan line: at its end it goes as soon as the frame is answered") {
  Scene scene{without("t")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  scene.line.say_later(31ms, "z\r");
  scene.bus.reset();
  CHECK(scene.line.times_of("C") == Times{31ms});
}

TEST_CASE("slcan line: at its end what was refused is said again") {
  Scene scene{with('t', "\a")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  scene.line.kernel.later(10ms, [&] { scene.line.answers['t'] = "z\r"; });
  scene.bus.reset();
  CHECK(scene.line.times_of("t100101").size() >= 2);
  CHECK(scene.line.times_of("C").size() == 1);
  CHECK(scene.line.passed() < 20ms);
}

TEST_CASE("slcan line: at its end the rest of a line is said first") {
  Scene scene{{}};
  scene.begin();
  scene.line.room = 3;
  CHECK(*scene.bus->send(frame("100#01")));
  scene.line.kernel.later(11ms, [&] { scene.line.room = SIZE_MAX; });
  scene.bus.reset();
  CHECK(scene.line.heard == "t100101\rC\r");
  CHECK(scene.line.times_of("C") == Times{11ms});
}

TEST_CASE("slcan line: at its end no status is asked for any more") {
  Scene scene{without("t")};
  SlcanOptions options;
  options.farewell = 5s;
  options.answer_limit = 3s;
  scene.begin(options);
  CHECK(*scene.bus->send(frame("100#01")));
  scene.bus.reset();
  CHECK(scene.line.times_of("F").empty());
  CHECK(scene.line.times_of("C") == Times{3s});
}

TEST_CASE("slcan line: an adapter that goes at the end is not waited for") {
  Scene scene{without("t")};
  scene.begin();
  CHECK(*scene.bus->send(frame("100#01")));
  scene.line.kernel.later(10ms, [&] { scene.line.hung_up = true; });
  scene.bus.reset();
  CHECK(scene.line.times_of("C").empty());
  CHECK(scene.line.passed() == 10ms);
}

// --- a device ---

TEST_CASE("slcan line: of a device what it has not sent is waited for at the end") {
  Scene scene{{}};
  scene.line.path = scene.line.device;
  scene.begin();
  scene.line.unsent = 100;
  scene.line.kernel.later(40ms, [&] { scene.line.unsent = 0; });
  scene.bus.reset();
  CHECK(scene.line.times_of("C") == Times{40ms});
}

TEST_CASE("slcan line: of a device that never sends the goodbye takes no longer than chosen, and 50 ms") {
  Scene scene{{}};
  scene.line.path = scene.line.device;
  scene.begin();
  scene.line.unsent = 100;
  scene.bus.reset();
  CHECK(scene.line.passed() == 350ms);
}

TEST_CASE("slcan line: a device that cannot be opened says why") {
  Scene scene;
  scene.line.path = scene.line.device;
  scene.line.open_error = EACCES;
  CHECK(scene.failure().what ==
        std::string("not allowed to open '/dev/null' (") + std::strerror(EACCES) + ")");
}

}  // namespace transport_slcan_line_test
