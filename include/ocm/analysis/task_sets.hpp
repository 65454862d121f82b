// Made by ocm-generate from tasks.json. Do not edit: change that, and generate again.

/// Task sets of processors: the boards', and those of the robots that theses analysed. A task is a type,
/// so that a set that misses a deadline names it. Times are nanoseconds. No heap; everything is constexpr.
#pragma once

#include <cstdint>
#include <string_view>

#include "ocm/analysis/task_list.hpp"
#include "ocm/analysis/task_set.hpp"

// clang-format off
namespace ocm::analysis::task_sets {

/// DiWheelDrive, each topic at its default period and priority. [docs/boards/figures.md, what a job takes]
namespace di_wheel_drive {

struct Control {
  static constexpr std::string_view name = "control";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 112'000, .period = 10'000'000, .blocking = 10'000, .level = 0};
};

struct DeadReckoning {
  static constexpr std::string_view name = "dead_reckoning";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 279'000, .period = 50'000'000, .blocking = 10'000, .level = 1};
};

/// [docs/boards/figures.md, what boards do by themselves: follow]
struct Behaviours {
  static constexpr std::string_view name = "behaviours";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 1'152'000, .period = 20'000'000, .blocking = 10'000, .level = 3};
};

/// [docs/boards/figures.md, what a job takes: one step of it can be in the way]
struct Upkeep {
  static constexpr std::string_view name = "upkeep";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 882'000, .period = 1'000'000'000, .blocking = 10'000, .level = 3};
};

struct Odometry {
  static constexpr std::string_view name = "odometry";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 338'000, .period = 50'000'000, .blocking = 10'000, .level = 2};
};

struct FloorProximity {
  static constexpr std::string_view name = "floor_proximity";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 1'767'000, .period = 50'000'000, .blocking = 10'000, .level = 2};
};

struct Magnetometer {
  static constexpr std::string_view name = "magnetometer";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 399'000, .period = 50'000'000, .blocking = 10'000, .level = 2};
};

struct Gyroscope {
  static constexpr std::string_view name = "gyroscope";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 227'000, .period = 50'000'000, .blocking = 10'000, .level = 2};
};

struct Accelerometer {
  static constexpr std::string_view name = "accelerometer";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 222'000, .period = 50'000'000, .blocking = 10'000, .level = 2};
};

struct Behaviour {
  static constexpr std::string_view name = "behaviour";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 182'000, .period = 100'000'000, .blocking = 10'000, .level = 2};
};

/// [decided: it reads nothing]
struct DiWheelDriveStatus {
  static constexpr std::string_view name = "di_wheel_drive_status";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 100'000, .period = 1'000'000'000, .blocking = 10'000, .level = 3};
};

/// [decided: it reads nothing]
struct DiWheelDriveRefusal {
  static constexpr std::string_view name = "di_wheel_drive_refusal";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 100'000, .period = 1'000'000'000, .blocking = 10'000, .level = 3};
};

struct Facts {
  using Tasks = TaskList<Control, DeadReckoning, Behaviours, Upkeep, Odometry, FloorProximity, Magnetometer, Gyroscope, Accelerometer, Behaviour, DiWheelDriveStatus, DiWheelDriveRefusal>;
  static constexpr std::int64_t blocking = 10'000;
  static constexpr std::uint32_t bus_percent = 80;
};

}  // namespace di_wheel_drive

/// PowerManagement, each topic at its default period and priority. [docs/boards/figures.md, what a job takes]
namespace power_management {

/// [docs/boards/figures.md, what boards do by themselves: avoid under load]
struct Avoidance {
  static constexpr std::string_view name = "avoidance";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 13'126'000, .period = 50'000'000, .blocking = 1'000'000, .level = 1, .waits = 4'525'000};
};

/// [docs/boards/figures.md, what a job takes: one step of it can be in the way]
struct Upkeep {
  static constexpr std::string_view name = "upkeep";
  static constexpr bool own = true;
  static constexpr Task task{.cost = 3'822'000, .period = 1'000'000'000, .blocking = 1'000'000, .level = 3};
};

struct ProximityRing {
  static constexpr std::string_view name = "proximity_ring";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 12'446'000, .period = 50'000'000, .blocking = 1'000'000, .level = 2, .waits = 6'922'000};
};

struct PowerStatus {
  static constexpr std::string_view name = "power_status";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 7'772'000, .period = 50'000'000, .blocking = 1'000'000, .level = 2, .waits = 3'549'000};
};

struct Batteries {
  static constexpr std::string_view name = "batteries";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 8'594'000, .period = 1'000'000'000, .blocking = 1'000'000, .level = 3, .waits = 3'578'000};
};

struct RingLight {
  static constexpr std::string_view name = "ring_light";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 14'481'000, .period = 500'000'000, .blocking = 1'000'000, .level = 3, .waits = 6'756'000};
};

/// [decided: it reads nothing]
struct PowerManagementStatus {
  static constexpr std::string_view name = "power_management_status";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 100'000, .period = 1'000'000'000, .blocking = 1'000'000, .level = 3};
};

/// [decided: it reads nothing]
struct PowerManagementRefusal {
  static constexpr std::string_view name = "power_management_refusal";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 100'000, .period = 1'000'000'000, .blocking = 1'000'000, .level = 3};
};

struct Facts {
  using Tasks = TaskList<Avoidance, Upkeep, ProximityRing, PowerStatus, Batteries, RingLight, PowerManagementStatus, PowerManagementRefusal>;
  static constexpr std::int64_t blocking = 1'000'000;
  static constexpr std::uint32_t bus_percent = 80;
};

}  // namespace power_management

/// LightRing, which has no sensor of its own. [decided: it reads nothing]
namespace light_ring {

struct LightRingStatus {
  static constexpr std::string_view name = "light_ring_status";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 100'000, .period = 1'000'000'000, .blocking = 10'000, .level = 3};
};

struct LightRingRefusal {
  static constexpr std::string_view name = "light_ring_refusal";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 100'000, .period = 1'000'000'000, .blocking = 10'000, .level = 3};
};

struct Facts {
  using Tasks = TaskList<LightRingStatus, LightRingRefusal>;
  static constexpr std::int64_t blocking = 10'000;
  static constexpr std::uint32_t bus_percent = 80;
};

}  // namespace light_ring

/// the AVR robot of the second thesis, a level a task. [second thesis, table 9.2]
namespace thesis_avr {

struct EncoderLeft {
  static constexpr std::string_view name = "encoder_left";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 1'700, .period = 15'000'000, .level = 0};
};

struct EncoderRight {
  static constexpr std::string_view name = "encoder_right";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 1'640, .period = 15'000'000, .level = 1};
};

struct UartReceive {
  static constexpr std::string_view name = "uart_receive";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 2'960, .period = 103'000'000, .level = 2};
};

struct Estimator {
  static constexpr std::string_view name = "estimator";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 1'700'000, .period = 30'000'000, .level = 3};
};

struct Movement {
  static constexpr std::string_view name = "movement";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 43'000, .period = 20'000'000, .level = 4};
};

struct Communication {
  static constexpr std::string_view name = "communication";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 140'000, .period = 103'000'000, .level = 5};
};

struct PoseController {
  static constexpr std::string_view name = "pose_controller";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 255'000, .period = 30'000'000, .level = 6};
};

struct Tower {
  static constexpr std::string_view name = "tower";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 7'300'000, .period = 200'000'000, .level = 7};
};

struct Facts {
  using Tasks = TaskList<EncoderLeft, EncoderRight, UartReceive, Estimator, Movement, Communication, PoseController, Tower>;
  static constexpr std::int64_t blocking = 0;
  static constexpr std::uint32_t bus_percent = 100;
};

}  // namespace thesis_avr

/// the Arduino robot of the second thesis, a level a task. [second thesis, table 9.3]
namespace thesis_arduino {

struct EncoderLeft {
  static constexpr std::string_view name = "encoder_left";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 610, .period = 800'000, .level = 0};
};

struct EncoderRight {
  static constexpr std::string_view name = "encoder_right";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 610, .period = 800'000, .level = 1};
};

struct UartReceive {
  static constexpr std::string_view name = "uart_receive";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 3'400, .period = 103'000'000, .level = 2};
};

struct Estimator {
  static constexpr std::string_view name = "estimator";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 1'660'000, .period = 30'000'000, .level = 3};
};

struct Movement {
  static constexpr std::string_view name = "movement";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 41'000, .period = 20'000'000, .level = 4};
};

struct Communication {
  static constexpr std::string_view name = "communication";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 130'000, .period = 103'000'000, .level = 5};
};

struct PoseController {
  static constexpr std::string_view name = "pose_controller";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 187'000, .period = 30'000'000, .level = 6};
};

struct Tower {
  static constexpr std::string_view name = "tower";
  static constexpr bool own = false;
  static constexpr Task task{.cost = 5'880'000, .period = 200'000'000, .level = 7};
};

struct Facts {
  using Tasks = TaskList<EncoderLeft, EncoderRight, UartReceive, Estimator, Movement, Communication, PoseController, Tower>;
  static constexpr std::int64_t blocking = 0;
  static constexpr std::uint32_t bus_percent = 100;
};

}  // namespace thesis_arduino

/// Calls f(name, its TaskList) for every set.
template <class F>
constexpr void for_each_set(F&& f) {
  f(std::string_view{"di_wheel_drive"}, di_wheel_drive::Facts::Tasks{});
  f(std::string_view{"power_management"}, power_management::Facts::Tasks{});
  f(std::string_view{"light_ring"}, light_ring::Facts::Tasks{});
  f(std::string_view{"thesis_avr"}, thesis_avr::Facts::Tasks{});
  f(std::string_view{"thesis_arduino"}, thesis_arduino::Facts::Tasks{});
}

}  // namespace ocm::analysis::task_sets
