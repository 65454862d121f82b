// A gamepad as libevdev hands it on, which is played here: what is pressed, where the stick is, what the
// kernel had no room for, and what is no gamepad.
#ifdef OCM_HAS_EVDEV

#include "cli/command/gamepad.hpp"

#include <cerrno>
#include <deque>
#include <libevdev/libevdev.h>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

using EventCode = std::pair<unsigned, unsigned>;  // its type and its number

/// A device that does what a test says.
struct libevdev {
  struct Next {
    int result = 0;
    unsigned type = 0, code = 0;
    int value = 0;
  };
  std::string name = "played";
  std::set<EventCode> codes{{EV_ABS, ABS_X}, {EV_ABS, ABS_Y}, {EV_KEY, BTN_TL}, {EV_KEY, BTN_TR}};
  std::map<EventCode, int> values{};
  std::map<unsigned, std::pair<int, int>> ranges{{ABS_X, {-100, 100}}, {ABS_Y, {0, 255}}};
  std::deque<Next> events{};
  std::vector<unsigned> flags{};  ///< with which it was asked for events
};

namespace tool_clock_gamepad_test {

namespace {

/// What is opened next; null: no input device.
libevdev* opened = nullptr;
int freed = 0;

}  // namespace

}  // namespace tool_clock_gamepad_test

extern "C" {

int libevdev_new_from_fd(int, libevdev** device) {
  if (tool_clock_gamepad_test::opened == nullptr) return -ENOTTY;
  *device = tool_clock_gamepad_test::opened;
  return 0;
}
void libevdev_free(libevdev* device) {
  if (device != nullptr) ++tool_clock_gamepad_test::freed;
}
int libevdev_has_event_code(const libevdev* device, unsigned type, unsigned code) {
  return device->codes.contains({type, code}) ? 1 : 0;
}
const char* libevdev_get_name(const libevdev* device) {
  return device->name == "none" ? nullptr : device->name.c_str();
}
int libevdev_next_event(libevdev* device, unsigned flags, input_event* event) {
  device->flags.push_back(flags);
  if (device->events.empty()) return -EAGAIN;
  const auto next = device->events.front();
  device->events.pop_front();
  event->type = static_cast<unsigned short>(next.type);
  event->code = static_cast<unsigned short>(next.code);
  event->value = next.value;
  return next.result;
}
int libevdev_get_event_value(const libevdev* device, unsigned type, unsigned code) {
  const auto at = device->values.find({type, code});
  return at == device->values.end() ? 0 : at->second;
}
int libevdev_get_abs_minimum(const libevdev* device, unsigned code) {
  return device->ranges.at(code).first;
}
int libevdev_get_abs_maximum(const libevdev* device, unsigned code) {
  return device->ranges.at(code).second;
}

}  // extern "C"

namespace tool_clock_gamepad_test {

using namespace ocm;
using cli::open_gamepad;
using cli::PadState;

/// A pad that was opened.
struct Bench {
  libevdev device{};
  std::unique_ptr<cli::Gamepad> pad{};

  Bench() {
    freed = 0;
    opened = &device;
    auto made = open_gamepad("/dev/null");
    opened = nullptr;
    REQUIRE(made.ok());
    pad = std::move(*made);
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  PadState read() {
    const auto state = pad->read();
    REQUIRE(state);
    return *state;
  }
  void happens(unsigned type, unsigned code, int value, int result = LIBEVDEV_READ_STATUS_SUCCESS) {
    device.events.push_back({result, type, code, value});
  }
  /// What was pressed since the last look: s stop, q quit.
  std::string pressed() {
    const PadState state = read();
    return std::string{state.stop ? "s" : ""} + (state.quit ? "q" : "");
  }
};

TEST_CASE("gamepad: ahead is away from the person, and either shoulder button is one to hold") {
  Bench bench;
  CHECK(bench.pad->name() == "played");
  bench.device.values[{EV_ABS, ABS_X}] = 50;
  bench.device.values[{EV_ABS, ABS_Y}] = 0;
  const PadState state = bench.read();
  CHECK(state.forward == 1);
  CHECK(state.left == Approx(-0.45));
  CHECK_FALSE(state.dead_man);
  for (const bool left : {true, false}) {
    bench.device.values[{EV_KEY, BTN_TL}] = left ? 1 : 0;
    bench.device.values[{EV_KEY, BTN_TR}] = left ? 0 : 1;
    CHECK(bench.read().dead_man);
  }
  bench.device.values[{EV_KEY, BTN_TR}] = 0;
  CHECK_FALSE(bench.read().dead_man);
  CHECK(freed == 0);
  bench.pad.reset();
  CHECK(freed == 1);
}

TEST_CASE("gamepad: what is pressed counts once, if only for a moment; let go, or held, it does not") {
  Bench bench;
  CHECK(bench.pressed().empty());
  bench.happens(EV_KEY, BTN_EAST, 1);
  bench.happens(EV_KEY, BTN_EAST, 0);
  CHECK(bench.pressed() == "s");
  CHECK(bench.pressed().empty());
  bench.happens(EV_KEY, BTN_START, 1);
  CHECK(bench.pressed() == "q");
  for (const unsigned code : {unsigned{BTN_EAST}, unsigned{BTN_START}}) {
    bench.happens(EV_KEY, code, 0);
    bench.happens(EV_KEY, code, 2);
    bench.happens(EV_MSC, code, 1);
  }
  bench.happens(EV_KEY, BTN_SOUTH, 1);
  CHECK(bench.pressed().empty());
  bench.happens(EV_KEY, BTN_START, 1);
  bench.happens(EV_KEY, BTN_EAST, 1);
  bench.happens(EV_KEY, BTN_SOUTH, 1);
  CHECK(bench.pressed() == "sq");
}

TEST_CASE("gamepad: what the kernel had no room for is asked for, and then what comes") {
  Bench bench;
  bench.happens(EV_SYN, SYN_DROPPED, 0, LIBEVDEV_READ_STATUS_SYNC);
  bench.happens(EV_KEY, BTN_EAST, 1, LIBEVDEV_READ_STATUS_SYNC);
  bench.happens(EV_SYN, SYN_REPORT, 0, -EAGAIN);
  bench.happens(EV_KEY, BTN_START, 1);
  CHECK(bench.pressed() == "sq");
  CHECK(bench.device.flags == std::vector<unsigned>{LIBEVDEV_READ_FLAG_NORMAL, LIBEVDEV_READ_FLAG_SYNC,
                                                    LIBEVDEV_READ_FLAG_SYNC, LIBEVDEV_READ_FLAG_NORMAL,
                                                    LIBEVDEV_READ_FLAG_NORMAL});
}

TEST_CASE("gamepad: one that is unplugged is gone") {
  Bench bench;
  bench.happens(EV_KEY, BTN_EAST, 1);
  bench.happens(EV_SYN, SYN_REPORT, 0, -ENODEV);
  CHECK_FALSE(bench.pad->read());
}

TEST_CASE("gamepad: what is none is said, and one without a name is one") {
  const auto refused = [](const std::string& path, libevdev* device) {
    opened = device;
    const auto pad = open_gamepad(path);
    opened = nullptr;
    return pad.ok() ? (*pad)->name() : pad.error.what;
  };
  libevdev device;
  CHECK(refused("/dev/null", &device) == "played");
  CHECK(refused("/nowhere/event5", &device) == "gamepad /nowhere/event5: No such file or directory");
  CHECK(refused("/dev/null", nullptr) == "/dev/null is no input device");
  for (const char* const name : {"", "none"}) {
    device.name = name;
    CHECK(refused("/dev/null", &device) == "a gamepad without a name");
  }
  device.name = "played";
  const std::string lacks = "/dev/null (played) has no stick or no shoulder buttons, so it is no gamepad";
  const auto all = device.codes;
  for (const EventCode& without : {EventCode{EV_ABS, ABS_X}, EventCode{EV_ABS, ABS_Y}}) {
    device.codes.erase(without);
    CHECK(refused("/dev/null", &device) == lacks);
    device.codes = all;
  }
  for (const unsigned button : {unsigned{BTN_TL}, unsigned{BTN_TR}}) {
    device.codes = all;
    device.codes.erase({EV_KEY, button});
    CHECK(refused("/dev/null", &device) == "played");
  }
  device.codes.erase({EV_KEY, BTN_TL});
  CHECK(refused("/dev/null", &device) == lacks);
}

}  // namespace tool_clock_gamepad_test

#endif
