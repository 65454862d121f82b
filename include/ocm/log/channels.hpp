/// What the logs of Vector's tools (ASC, BLF) have in place of names of interfaces and of SocketCAN's error
/// frames: channels 1, 2, 3..., and that there was an error. Channel 1 is `can0`, as for can-utils and
/// python-can; a name that is not of this kind takes the lowest free channel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"

namespace ocm::log {

/// An error frame that says no more than "bus error", as asc2log makes it. Time and interface stay.
inline void set_bus_error(Entry& entry) noexcept {
  entry.id = can::error_class::bus_error;
  entry.format = can::Format::error;
  entry.length = can::max_dlc;
  entry.flags = entry.raw_dlc = 0;
  entry.direction = Direction::unknown;
  std::fill_n(entry.data.begin(), can::max_dlc, std::uint8_t{0});
}
/// Whether an error frame says no more than that.
[[nodiscard]] inline bool is_bus_error(const Entry& entry) noexcept {
  return entry.id == can::error_class::bus_error && entry.length == can::max_dlc &&
         std::all_of(entry.data.begin(), entry.data.begin() + can::max_dlc,
                     [](auto byte) { return byte == 0; });
}

/// Reading: interfaces by channel. O(1) but for the first time.
class ChannelsRead {
 public:
  static constexpr std::uint32_t most = 255;

  /// `channel` 0..most. Channel 0, which no tool counts from, is `canX`, again as for can-utils.
  [[nodiscard]] std::uint16_t interface(std::uint32_t channel, Interfaces& interfaces) {
    if (channel >= numbers_.size()) numbers_.resize(channel + 1, unknown);
    if (numbers_[channel] == unknown)
      numbers_[channel] =
          interfaces.number(channel == 0 ? std::string{"canX"} : "can" + std::to_string(channel - 1));
    return numbers_[channel];
  }

 private:
  static constexpr std::uint16_t unknown = 0xFFFF;
  std::vector<std::uint16_t> numbers_;
};

/// Writing: channels by interface.
class ChannelsWritten {
 public:
  struct Channel {
    std::uint16_t number = 0;
    bool names_it = false;  ///< whether a reader finds the interface's name again
  };

  [[nodiscard]] Channel of(std::uint16_t interface, const Interfaces& interfaces) {
    while (interface >= channels_.size()) assign(interfaces);
    return channels_[interface];
  }

 private:
  void assign(const Interfaces& interfaces) {
    const std::string_view name = interfaces.name(static_cast<std::uint16_t>(channels_.size()));
    const std::uint16_t own = own_channel(name);
    if (own != 0 && is_free(own)) {
      channels_.push_back({own, true});
      return;
    }
    std::uint16_t lowest = 1;
    while (!is_free(lowest)) ++lowest;
    channels_.push_back({lowest, false});
  }

  /// 3 of "can2"; 0 of any other name.
  static std::uint16_t own_channel(std::string_view name) noexcept {
    if (!name.starts_with("can")) return 0;
    const auto number = base::parse_unsigned(name.substr(3));
    if (!number || *number >= ChannelsRead::most || (name[3] == '0' && name.size() > 4)) return 0;
    return static_cast<std::uint16_t>(*number + 1);
  }

  [[nodiscard]] bool is_free(std::uint16_t number) const noexcept {
    for (const Channel& channel : channels_)
      if (channel.number == number) return false;
    return true;
  }

  std::vector<Channel> channels_;
};

}  // namespace ocm::log
