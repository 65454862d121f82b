/// Loaded before amiroctl (LD_PRELOAD), goes in the place of libevdev: the device is a file with one word of
/// what a person does, which a test writes over: rest, drive, quit or gone.
#include <array>
#include <cerrno>
#include <cstddef>
#include <libevdev/libevdev.h>
#include <string_view>
#include <unistd.h>

struct libevdev {
  int file = -1;
  bool told = false;  ///< that it quits: a button is pressed once
};

namespace {

libevdev pad;

bool says(std::string_view word) {
  std::array<char, 8> text{};
  const auto size = ::pread(pad.file, text.data(), text.size(), 0);
  return size > 0 && std::string_view{text.data(), static_cast<std::size_t>(size)}.starts_with(word);
}

}  // namespace

extern "C" {

int libevdev_new_from_fd(int file, libevdev** device) {
  pad.file = file;
  *device = &pad;
  return 0;
}
void libevdev_free(libevdev*) {}
int libevdev_has_event_code(const libevdev*, unsigned type, unsigned code) {
  return (type == EV_ABS && (code == ABS_X || code == ABS_Y)) || (type == EV_KEY && code == BTN_TL) ? 1 : 0;
}
const char* libevdev_get_name(const libevdev*) {
  return "played";
}
int libevdev_next_event(libevdev*, unsigned, input_event* event) {
  if (says("gone")) return -ENODEV;
  if (pad.told || !says("quit")) return -EAGAIN;
  pad.told = true;
  event->type = EV_KEY;
  event->code = BTN_START;
  event->value = 1;
  return LIBEVDEV_READ_STATUS_SUCCESS;
}
/// The stick is in the middle, or ahead, which is towards the least value.
int libevdev_get_event_value(const libevdev*, unsigned type, unsigned code) {
  const bool drives = says("drive");
  if (type == EV_KEY) return code == BTN_TL && drives ? 1 : 0;
  return code == ABS_Y && drives ? 0 : 128;
}
int libevdev_get_abs_minimum(const libevdev*, unsigned) {
  return 0;
}
int libevdev_get_abs_maximum(const libevdev*, unsigned) {
  return 256;
}

}  // extern "C"
