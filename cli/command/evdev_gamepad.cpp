#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/command/gamepad.hpp"

#ifdef OCM_HAS_EVDEV
#include <libevdev/libevdev.h>
#endif

namespace ocm::cli {

#ifndef OCM_HAS_EVDEV

transport::Outcome<std::unique_ptr<Gamepad>> open_gamepad(const std::string&) {
  return transport::Failure{"this amiroctl was built without libevdev, which reads gamepads",
                            "install libevdev-dev and build again, or drive by keys: amiroctl drive --keys"};
}

#else

namespace {

/// The device's file, and what libevdev knows of it.
struct Device {
  host::Descriptor file;
  std::unique_ptr<libevdev, decltype(&libevdev_free)> events{nullptr, &libevdev_free};
  int error = 0;

  explicit Device(const std::string& path) : file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
    if (file.get() < 0) {
      error = errno;
      return;
    }
    libevdev* made = nullptr;
    error = -libevdev_new_from_fd(file.get(), &made);
    events.reset(error == 0 ? made : nullptr);
  }
  [[nodiscard]] bool has(unsigned type, unsigned code) const {
    return libevdev_has_event_code(events.get(), type, code) == 1;
  }
  /// A stick, and a button to hold. [Linux, Documentation/input/gamepad.rst]
  [[nodiscard]] bool is_gamepad() const {
    return has(EV_ABS, ABS_X) && has(EV_ABS, ABS_Y) && (has(EV_KEY, BTN_TL) || has(EV_KEY, BTN_TR));
  }
  [[nodiscard]] std::string name() const {
    const char* const text = libevdev_get_name(events.get());
    return text != nullptr && *text != '\0' ? text : "a gamepad without a name";
  }
};

class EvdevGamepad final : public Gamepad {
 public:
  explicit EvdevGamepad(Device device) : device_(std::move(device)) {}

  [[nodiscard]] std::optional<PadState> read() override {
    PadState state;
    int flag = LIBEVDEV_READ_FLAG_NORMAL;
    for (;;) {
      input_event event{};
      const int result = libevdev_next_event(device_.events.get(), static_cast<unsigned>(flag), &event);
      if (result == -EAGAIN && flag == LIBEVDEV_READ_FLAG_NORMAL) break;
      if (result == -EAGAIN) {
        flag = LIBEVDEV_READ_FLAG_NORMAL;  // what the kernel had no room for is made up for
        continue;
      }
      if (result == LIBEVDEV_READ_STATUS_SYNC) {
        flag = LIBEVDEV_READ_FLAG_SYNC;
      } else if (result < 0) {
        return std::nullopt;
      }
      if (event.type == EV_KEY && event.value == 1) {
        state.stop = state.stop || event.code == BTN_EAST;
        state.quit = state.quit || event.code == BTN_START;
      }
    }
    state.forward = 0 - at(ABS_Y);  // away from the person is towards the least value
    state.left = 0 - at(ABS_X);
    state.dead_man = held(BTN_TL) || held(BTN_TR);
    return state;
  }
  [[nodiscard]] std::string name() const override { return device_.name(); }

 private:
  [[nodiscard]] double at(unsigned axis) const {
    const libevdev* const events = device_.events.get();
    return deflection(libevdev_get_event_value(events, EV_ABS, axis),
                      {libevdev_get_abs_minimum(events, axis), libevdev_get_abs_maximum(events, axis)});
  }
  [[nodiscard]] bool held(unsigned button) const {
    return libevdev_get_event_value(device_.events.get(), EV_KEY, button) != 0;
  }

  Device device_;
};

/// "/dev/input/event5 (Xbox Wireless Controller)", those that can be read.
std::string gamepads_here() {
  std::string text;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{"/dev/input", error}) {
    if (!entry.path().filename().string().starts_with("event")) continue;
    const Device device{entry.path().string()};
    if (device.error == 0 && device.is_gamepad())
      text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", entry.path().string(), device.name());
  }
  return text;
}

std::string which_ones() {
  const std::string here = gamepads_here();
  return here.empty() ? "no gamepad can be read here: is it plugged in, and are you in the group input?"
                      : "gamepads here: " + here;
}

}  // namespace

transport::Outcome<std::unique_ptr<Gamepad>> open_gamepad(const std::string& path) {
  Device device{path};
  if (device.file.get() < 0)
    return transport::Failure{fmt::format("gamepad {}: {}", path, std::strerror(device.error)), which_ones()};
  if (device.error != 0) return transport::Failure{fmt::format("{} is no input device", path), which_ones()};
  if (!device.is_gamepad())
    return transport::Failure{
        fmt::format("{} ({}) has no stick or no shoulder buttons, so it is no gamepad", path, device.name()),
        which_ones()};
  return std::unique_ptr<Gamepad>{std::make_unique<EvdevGamepad>(std::move(device))};
}

#endif

}  // namespace ocm::cli
