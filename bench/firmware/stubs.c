// Parts, bus and port of the two: constant samples, a bus that takes what it is set to, a clock that
// is set. What was sent and applied goes into a sum, by which the two are compared.
#include "stubs.h"

#include <string.h>

int64_t port_time;
int64_t port_armed;
volatile uint32_t port_pended;
volatile enum bus_answer bus_says = bus_took;
volatile uint32_t sent_frames;
volatile uint32_t work_sum;

static void add(uint32_t number) {
  work_sum = (work_sum << 7 | work_sum >> 25) * 31U + number;
}

__attribute__((noinline)) enum bus_answer bus_send(const struct frame* frame) {
  const enum bus_answer answer = bus_says;
  if (answer == bus_took) {
    uint32_t words[2];
    memcpy(words, frame->data, 8);
    ++sent_frames;
    add(frame->id << 4 | frame->dlc);
    add(words[0]);
    add(words[1]);
  }
  return answer;
}

static volatile bool answers = true;
bool part_odometry(int32_t velocity[2], int32_t pose[2], uint16_t* orientation) {
  velocity[0] = 123456, velocity[1] = -654321;
  pose[0] = -0x7FFFFF - 5, pose[1] = 0x123456;  // beyond 24 bits: comes out as the bound
  *orientation = 24543;
  return answers;
}
bool part_floor(uint16_t counts[4]) {
  for (unsigned i = 0; i < 4; ++i) counts[i] = (uint16_t)(2000 + i);
  return answers;
}
bool part_magnetometer(int32_t field[3]) {
  field[0] = 53760, field[1] = -939520, field[2] = 1523200;
  return answers;
}
bool part_gyroscope(int16_t rate[3]) {
  rate[0] = 100, rate[1] = -200, rate[2] = 32767;
  return answers;
}
bool part_accelerometer(int16_t force[3]) {
  force[0] = -64, force[1] = 1600, force[2] = 8192;
  return answers;
}
void part_motors(int32_t x, int32_t z) {
  add((uint32_t)x);
  add((uint32_t)z);
}
void part_calibrate_floor(uint8_t action) {
  add(action);
}
void task(int number) {
  add(1000U + (uint32_t)number);
}
