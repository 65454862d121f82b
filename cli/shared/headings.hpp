/// The headings under which --help lists the verbs.
#pragma once

#include <string_view>

namespace ocm::cli {

inline constexpr std::string_view look_group = "Look at the robot's topics";
inline constexpr std::string_view ask_group = "Ask sensors";
inline constexpr std::string_view act_group = "Command actuators";
inline constexpr std::string_view watch_group = "Watch the bus";
inline constexpr std::string_view log_group = "Record, and work with logs";
inline constexpr std::string_view play_group = "Scripts and simulation";
inline constexpr std::string_view mapper_group = "Mappers";
inline constexpr std::string_view help_group = "For your shell";

}  // namespace ocm::cli
