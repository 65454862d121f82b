/// What the fuzz targets share: a property that must hold, and a reader that turns arbitrary bytes into
/// numbers and frames.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string_view>

#include "ocm/can/frame.hpp"

/// What libFuzzer, and the replay, call with each input. Always returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace ocm::fuzz {

/// Ends the program, so that the input is kept, when a property of the code under test does not hold.
inline void expect(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "property broken: %s\n", property);
  std::abort();
}

[[nodiscard]] inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return size == 0 ? std::string_view{}
                   : std::string_view{static_cast<const char*>(static_cast<const void*>(data)), size};
}

/// Whether `part` lies within `whole`: views must point into what was parsed.
[[nodiscard]] inline bool within(std::string_view part, std::string_view whole) {
  return part.empty() ||
         (part.data() >= whole.data() && part.data() + part.size() <= whole.data() + whole.size());
}

/// Takes numbers from the front of the input, little endian; zeros when nothing is left.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : bytes_(data, size) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  [[nodiscard]] std::span<const std::uint8_t> bytes(std::size_t count) {
    const auto taken = bytes_.first(std::min(count, bytes_.size()));
    bytes_ = bytes_.subspan(taken.size());
    return taken;
  }
  template <class T>
  [[nodiscard]] T number() {
    T value{};
    const auto taken = bytes(sizeof value);
    if (!taken.empty()) std::memcpy(&value, taken.data(), taken.size());
    return value;
  }
  [[nodiscard]] std::uint8_t byte() { return number<std::uint8_t>(); }

  /// 15 bytes: identifier, DLC, format, data. Any number in any place: not all are frames.
  [[nodiscard]] can::Frame any_frame() {
    can::Frame frame;
    frame.id = number<std::uint32_t>();
    frame.dlc = byte();
    frame.format = static_cast<can::Format>(byte() % 5);
    frame.data = number<can::Payload>();
    return frame;
  }
  /// 3 bytes and the data: a frame as a bus delivers it, mostly base data frames.
  [[nodiscard]] can::Frame frame() {
    const auto head = number<std::uint16_t>();
    const std::uint8_t length = byte();
    can::Frame frame;
    frame.id = head & can::max_base_id;
    if (head >> 11 >= 28) frame.format = static_cast<can::Format>(1 + (head >> 11) % 4);
    frame.dlc = length % (can::max_dlc + 1);
    if (can::is_remote(frame.format)) return frame;
    const auto data = bytes(frame.dlc);
    std::copy(data.begin(), data.end(), frame.data.begin());
    return frame;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace ocm::fuzz
