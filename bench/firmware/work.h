/// What is measured twice, in C by hand and with the library: DiWheelDrive's side of the protocol, with two
/// tasks of its own, status and refusals; behind it parts, bus and port that cost as good as nothing. One
/// interface.
#ifndef OCM_BENCH_FIRMWARE_WORK_H
#define OCM_BENCH_FIRMWARE_WORK_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// As ocm::can::Frame lies in memory.
struct frame {
  uint32_t id;
  uint8_t dlc;
  uint8_t data[8];
  uint8_t format;  ///< 0: base data frame
};

// What both stand on: stubs.c
extern int64_t port_time;              ///< ns
extern int64_t port_armed;             ///< when the timer shall go off
extern volatile uint32_t port_pended;  ///< the level that shall run
enum bus_answer { bus_full, bus_took, bus_failed };
enum bus_answer bus_send(const struct frame* frame);
bool part_odometry(int32_t velocity[2], int32_t pose[2], uint16_t* orientation);
bool part_floor(uint16_t counts[4]);
bool part_magnetometer(int32_t field[3]);
bool part_gyroscope(int16_t rate[3]);
bool part_accelerometer(int16_t force[3]);
void part_motors(int32_t x, int32_t z);
void part_calibrate_floor(uint8_t action);
void task(int number);
extern const uint32_t wire_hash;  ///< of the spec, for the status

/// Interrupts off; returns what `unlock` takes.
static inline uint32_t port_lock(void) {
  uint32_t mask;
  __asm volatile("mrs %0, primask\n\tcpsid i" : "=r"(mask)::"memory");
  return mask;
}
static inline void port_unlock(uint32_t mask) {
  __asm volatile("msr primask, %0" ::"r"(mask) : "memory");
}

/// How one of the two does it.
struct board {
  void (*set_up)(void);
  void (*receive)(const struct frame* frame, int64_t now);
  void (*expire)(void);
  void (*run)(unsigned level);
  void (*writable)(void);
  void (*bus_lost)(void);
};
extern const struct board board_by_hand;
extern const struct board board_by_library;

/// Single steps of it, and a frame that this board does not have.
struct codec {
  bool (*decode_request)(const struct frame* frame, uint8_t* mode, uint32_t* count_and_unit);
  void (*encode_gyroscope)(uint8_t data[8], int16_t x, int16_t y, int16_t z);
  void (*encode_odometry)(uint8_t data[16], int32_t vx, int32_t vz, int32_t x, int32_t y,
                          uint16_t orientation);
  void (*encode_ring)(uint8_t data[64], const uint16_t sensor[8]);
};
extern const struct codec codec_by_hand;
extern const struct codec codec_by_library;

#ifdef __cplusplus
}
#endif
#endif
