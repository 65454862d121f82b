/// What --spec takes: FILE, or INTERFACE=FILE.
#pragma once

#include <string>
#include <string_view>

namespace ocm::cli {

struct SpecWord {
  std::string interface;  ///< empty: all
  std::string file;
  std::string bus{};  ///< the interface as it was typed: with the rates of an adapter
};

/// Whether an interface can have this name: that of a network device of Linux (1 to 15 bytes, without blanks,
/// '/' and ':', and neither `.` nor `..` [linux/net/core/dev.c, dev_valid_name]), or a bus of --bus such as
/// sim or slcan:/dev/ttyACM0@500k.
[[nodiscard]] bool can_be_interface(std::string_view name);

/// What frames of a bus of --bus have as their interface: a serial adapter's is its device, whatever its
/// rates, "slcan:/dev/ttyACM0".
[[nodiscard]] std::string interface_of(std::string_view bus);

/// A file whose name has a '=' is a file, if there is one. exit_usage through `fail` where the file is
/// missing or no interface can have the name.
[[nodiscard]] SpecWord parse_spec_word(const std::string& word);

}  // namespace ocm::cli
