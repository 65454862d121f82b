/// The verbs, one file each. main.cpp lists them; this is all it knows of them.
#pragma once

#include <string>
#include <string_view>

#include <CLI/CLI.hpp>

#include "cli/session.hpp"

namespace ocm::cli {

/// `exit_code` is what the verb leaves behind when it ran to its end.
using AddVerb = void (*)(CLI::App& app, Session& session, int& exit_code);

void add_list(CLI::App& app, Session& session, int& exit_code);
void add_info(CLI::App& app, Session& session, int& exit_code);
void add_publish(CLI::App& app, Session& session, int& exit_code);
void add_once(CLI::App& app, Session& session, int& exit_code);
void add_stop(CLI::App& app, Session& session, int& exit_code);
void add_drive(CLI::App& app, Session& session, int& exit_code);
void add_led(CLI::App& app, Session& session, int& exit_code);
void add_set(CLI::App& app, Session& session, int& exit_code);
void add_send(CLI::App& app, Session& session, int& exit_code);
void add_listen(CLI::App& app, Session& session, int& exit_code);
void add_record(CLI::App& app, Session& session, int& exit_code);
void add_replay(CLI::App& app, Session& session, int& exit_code);
void add_stats(CLI::App& app, Session& session, int& exit_code);
void add_plot(CLI::App& app, Session& session, int& exit_code);
void add_doctor(CLI::App& app, Session& session, int& exit_code);
void add_run(CLI::App& app, Session& session, int& exit_code);
void add_sim(CLI::App& app, Session& session, int& exit_code);
void add_analyse(CLI::App& app, Session& session, int& exit_code);
void add_decode(CLI::App& app, Session& session, int& exit_code);
void add_encode(CLI::App& app, Session& session, int& exit_code);
void add_convert(CLI::App& app, Session& session, int& exit_code);
void add_generate(CLI::App& app, Session& session, int& exit_code);
void add_central(CLI::App& app, Session& session, int& exit_code);
void add_robots(CLI::App& app, Session& session, int& exit_code);
void add_goto(CLI::App& app, Session& session, int& exit_code);
void add_pause(CLI::App& app, Session& session, int& exit_code);
void add_unpause(CLI::App& app, Session& session, int& exit_code);
void add_map(CLI::App& app, Session& session, int& exit_code);
void add_line(CLI::App& app, Session& session, int& exit_code);
void add_completion(CLI::App& app, Session& session, int& exit_code);
void add_man(CLI::App& app, Session& session, int& exit_code);

/// Headings under which --help lists the verbs.
inline constexpr std::string_view look_group = "Look at the robot's topics";
inline constexpr std::string_view ask_group = "Ask sensors";
inline constexpr std::string_view act_group = "Command actuators";
inline constexpr std::string_view watch_group = "Watch the bus";
inline constexpr std::string_view log_group = "Record, and work with logs";
inline constexpr std::string_view play_group = "Scripts and simulation";
inline constexpr std::string_view mapper_group = "Mappers";
inline constexpr std::string_view help_group = "For your shell";

/// A subcommand with its heading and its examples below the options.
CLI::App* add_verb(CLI::App& app, std::string_view name, std::string_view description, std::string_view group,
                   std::string_view examples);

}  // namespace ocm::cli
