// Made by ocm-generate from whole.json. Do not edit: change the spec, and generate again.
//
// The topics and messages of Whole: a robot and a bus that have everything a spec can say, for tests alone
//
// For C99 and C++11. No other file is needed, nothing is to be linked, and there is no heap.
//
// A struct has raw numbers, as they travel. _x_unit() is the physical value of x, and set_x_unit() takes the
// nearest raw number within the field's range (not a number: the one nearest to zero). _frame() makes the CAN
// frame of a struct, _take() fills the struct from one. _encode() puts the nearest number that the width
// holds.
//
// A struct of a message holds its bytes. _decode() takes those of a frame, if they are enough. _x() is the
// physical value of field x, and _set_x() puts the nearest that the width holds; _x_raw() and _set_x_raw()
// are the number as it travels, where it is another. Where _has_x() is 0 a multiplexed field is not there:
// _x() and _set_x() are 0 then, and change nothing. _init() puts start values.
#ifndef WHOLE_TOPICS_H
#define WHOLE_TOPICS_H

#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

// Bits per second on the bus. [decided: for tests; bit_rate: table 1]
#define WHOLE_BIT_RATE 500000u

// --- identifiers and requests

typedef struct whole_frame {
  uint16_t id;  // 11 bits
  uint8_t dlc;
  uint8_t data[8];
} whole_frame;

typedef enum whole_priority { WHOLE_URGENT = 0, WHOLE_HIGH = 1, WHOLE_MEDIUM = 2, WHOLE_LOW = 3 } whole_priority;
typedef enum whole_mode { WHOLE_STOP = 0, WHOLE_PUBLISH = 1, WHOLE_ONCE = 2 } whole_mode;
typedef enum whole_unit { WHOLE_MILLISECONDS = 0, WHOLE_SECONDS = 1, WHOLE_MICROSECONDS = 2 } whole_unit;

// What _take() and whole_read_request() return in place of a number of 0 or more.
#define WHOLE_FOREIGN (-1)       // a frame of another topic, or no request
#define WHOLE_WRONG_LENGTH (-2)
#define WHOLE_WRONG_MODE (-3)
#define WHOLE_WRONG_UNIT (-4)
#define WHOLE_WRONG_PERIOD (-5)  // zero

// Of a request or a set point, to a board.
static inline uint16_t whole_command_id(uint8_t topic, whole_priority priority) {
  return (uint16_t)((((uint32_t)priority & 3u) << 8) | topic);
}
// Of samples, from a board.
static inline uint16_t whole_sample_id(uint8_t topic, whole_priority priority) {
  return (uint16_t)(0x400u | (((uint32_t)priority & 3u) << 8) | topic);
}
static inline int whole_is_sample(uint16_t id) { return (id & 0x400u) != 0; }
static inline whole_priority whole_priority_of(uint16_t id) { return (whole_priority)(((uint32_t)id >> 8) & 3u); }
static inline uint8_t whole_topic_of(uint16_t id) { return (uint8_t)(id & 0xFFu); }

static inline whole_frame whole_request_of_mode(uint8_t topic, whole_mode mode, whole_priority priority) {
  whole_frame frame = {0, 1, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_command_id(topic, priority);
  frame.data[0] = (uint8_t)mode;
  return frame;
}
static inline whole_frame whole_stop(uint8_t topic, whole_priority priority) {
  return whole_request_of_mode(topic, WHOLE_STOP, priority);
}
static inline whole_frame whole_once(uint8_t topic, whole_priority priority) {
  return whole_request_of_mode(topic, WHOLE_ONCE, priority);
}
// At the topic's own period.
static inline whole_frame whole_publish(uint8_t topic, whole_priority priority) {
  return whole_request_of_mode(topic, WHOLE_PUBLISH, priority);
}
// Every `count` units; a board refuses a count of 0.
static inline whole_frame whole_publish_every(uint8_t topic, uint16_t count, whole_unit unit, whole_priority priority) {
  whole_frame frame = whole_request_of_mode(topic, WHOLE_PUBLISH, priority);
  frame.dlc = 4;
  frame.data[1] = (uint8_t)(count & 0xFFu);
  frame.data[2] = (uint8_t)(count >> 8);
  frame.data[3] = (uint8_t)unit;
  return frame;
}

// For a board: what an operator asks.
typedef struct whole_request {
  uint8_t topic;
  whole_priority priority;  // of the samples that answer
  whole_mode mode;
  uint16_t count;       // of a publish; 0: the topic's own period
  whole_unit unit;
} whole_request;

static inline uint64_t whole_period_us(uint16_t count, whole_unit unit) {
  return (uint64_t)count * (unit == WHOLE_SECONDS ? 1000000u : unit == WHOLE_MILLISECONDS ? 1000u : 1u);
}

// Reads a command frame on a sensor's topic. 0, or why it is none; then *request is as it was.
static inline int whole_read_request(const whole_frame* frame, whole_request* request) {
  const uint32_t count = frame->data[1] | ((uint32_t)frame->data[2] << 8);
  const int has_period = frame->dlc == 4;
  if (frame->id > 0x3FFu) return WHOLE_FOREIGN;
  if (frame->dlc == 0 || frame->dlc > 8) return WHOLE_WRONG_LENGTH;
  if (frame->data[0] > 2) return WHOLE_WRONG_MODE;
  if (frame->dlc != 1 && !(has_period && frame->data[0] == 1)) return WHOLE_WRONG_LENGTH;
  if (has_period && frame->data[3] > 2) return WHOLE_WRONG_UNIT;
  if (has_period && count == 0) return WHOLE_WRONG_PERIOD;
  request->topic = whole_topic_of(frame->id);
  request->priority = whole_priority_of(frame->id);
  request->mode = (whole_mode)frame->data[0];
  request->count = (uint16_t)(has_period ? count : 0u);
  request->unit = has_period ? (whole_unit)frame->data[3] : WHOLE_MILLISECONDS;
  return 0;
}

static inline uint32_t whole_at_most_u32(uint32_t number, uint32_t most) { return number < most ? number : most; }
static inline uint64_t whole_at_most_u64(uint64_t number, uint64_t most) { return number < most ? number : most; }
static inline int32_t whole_held_i32(int32_t number, int32_t least, int32_t most) {
  return number < least ? least : number > most ? most : number;
}
static inline int64_t whole_held_i64(int64_t number, int64_t least, int64_t most) {
  return number < least ? least : number > most ? most : number;
}
// The nearest whole number, halves away from zero, within [least, most].
static inline int64_t whole_nearest(double value, int64_t least, int64_t most) {
  int64_t whole = 0;
  double rest = 0;
  if (value != value) return least > 0 ? least : most < 0 ? most : 0;
  if (value <= (double)least) return least;
  if (value >= (double)most) return most;
  whole = (int64_t)value;
  rest = value - (double)whole;
  return whole + (rest >= 0.5 ? 1 : rest <= -0.5 ? -1 : 0);
}
// The nearest in [least, most]; not a number: the one nearest to zero.
static inline double whole_within(double value, double least, double most) {
  if (value != value) return least > 0 ? least : most < 0 ? most : 0;
  return value < least ? least : value > most ? most : value;
}
static inline uint64_t whole_nearest_u64(double value) {
  if (!(value > 0)) return 0;
  if (value >= 18446744073709551615.0) return UINT64_MAX;
  if (value >= 9007199254740992.0) return (uint64_t)value;
  return (uint64_t)whole_nearest(value, 0, INT64_MAX);
}
static inline float whole_float_of(uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
static inline uint32_t whole_bits_of_float(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}
// Where double has 64 bits.
static inline double whole_double_of(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
static inline uint64_t whole_bits_of_double(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

// --- status

// Status, identity.
typedef struct whole_status_identity_t {
  // [0, 16777215] s
  uint32_t uptime;
  // [0, 255]
  uint8_t reset;
  // [0, 4294967295]
  uint32_t wire_hash;
} whole_status_identity_t;
static inline void whole_status_identity_encode(const whole_status_identity_t* value, uint8_t data[8]) {
  const uint32_t uptime_bits = (uint32_t)whole_at_most_u32(value->uptime, 0x00FFFFFFu);
  const uint32_t reset_bits = (uint32_t)value->reset;
  const uint32_t wire_hash_bits = (uint32_t)value->wire_hash;
  data[0] = (uint8_t)(uptime_bits);
  data[1] = (uint8_t)(uptime_bits >> 8);
  data[2] = (uint8_t)(uptime_bits >> 16);
  data[3] = (uint8_t)(reset_bits);
  data[4] = (uint8_t)(wire_hash_bits);
  data[5] = (uint8_t)(wire_hash_bits >> 8);
  data[6] = (uint8_t)(wire_hash_bits >> 16);
  data[7] = (uint8_t)(wire_hash_bits >> 24);
}
static inline void whole_status_identity_decode(whole_status_identity_t* value, const uint8_t data[8]) {
  const uint32_t uptime_bits = (uint32_t)data[0] | ((uint32_t)data[1] << 8) | ((uint32_t)data[2] << 16);
  value->uptime = (uint32_t)uptime_bits;
  const uint32_t reset_bits = (uint32_t)data[3];
  value->reset = (uint8_t)reset_bits;
  const uint32_t wire_hash_bits =
    (uint32_t)data[4] |
    ((uint32_t)data[5] << 8) |
    ((uint32_t)data[6] << 16) |
    ((uint32_t)data[7] << 24);
  value->wire_hash = (uint32_t)wire_hash_bits;
}
static inline double whole_status_identity_uptime_s(const whole_status_identity_t* value) {
  return (double)value->uptime;
}
static inline void whole_status_identity_set_uptime_s(whole_status_identity_t* value, double s_) {
  value->uptime = (uint32_t)whole_nearest(s_, 0, 16777215);
}

// Status, health.
typedef struct whole_status_health_t {
  // [0, 100] %
  uint8_t load;
  // [0, 255]
  uint8_t bus;
  // [0, 255]
  uint8_t publishing;
  // [0, 255]
  uint8_t faults;
  // [0, 65535]
  uint16_t overload;
  // [0, 65535]
  uint16_t bus_errors;
} whole_status_health_t;
static inline void whole_status_health_encode(const whole_status_health_t* value, uint8_t data[8]) {
  const uint32_t load_bits = (uint32_t)value->load;
  const uint32_t bus_bits = (uint32_t)value->bus;
  const uint32_t publishing_bits = (uint32_t)value->publishing;
  const uint32_t faults_bits = (uint32_t)value->faults;
  const uint32_t overload_bits = (uint32_t)value->overload;
  const uint32_t bus_errors_bits = (uint32_t)value->bus_errors;
  data[0] = (uint8_t)(load_bits);
  data[1] = (uint8_t)(bus_bits);
  data[2] = (uint8_t)(publishing_bits);
  data[3] = (uint8_t)(faults_bits);
  data[4] = (uint8_t)(overload_bits);
  data[5] = (uint8_t)(overload_bits >> 8);
  data[6] = (uint8_t)(bus_errors_bits);
  data[7] = (uint8_t)(bus_errors_bits >> 8);
}
static inline void whole_status_health_decode(whole_status_health_t* value, const uint8_t data[8]) {
  const uint32_t load_bits = (uint32_t)data[0];
  value->load = (uint8_t)load_bits;
  const uint32_t bus_bits = (uint32_t)data[1];
  value->bus = (uint8_t)bus_bits;
  const uint32_t publishing_bits = (uint32_t)data[2];
  value->publishing = (uint8_t)publishing_bits;
  const uint32_t faults_bits = (uint32_t)data[3];
  value->faults = (uint8_t)faults_bits;
  const uint32_t overload_bits = (uint32_t)data[4] | ((uint32_t)data[5] << 8);
  value->overload = (uint16_t)overload_bits;
  const uint32_t bus_errors_bits = (uint32_t)data[6] | ((uint32_t)data[7] << 8);
  value->bus_errors = (uint16_t)bus_errors_bits;
}
static inline double whole_status_health_load_percent(const whole_status_health_t* value) {
  return (double)value->load;
}
static inline void whole_status_health_set_load_percent(whole_status_health_t* value, double percent_) {
  value->load = (uint8_t)whole_nearest(percent_, 0, 100);
}

// Status. Sensor of main_board. [decided: for tests]
#define WHOLE_STATUS_ID 0x70u
#define WHOLE_STATUS_PRIORITY WHOLE_HIGH
#define WHOLE_STATUS_FRAMES 2u
typedef struct whole_status_t {
  whole_status_identity_t identity;
  whole_status_health_t health;
} whole_status_t;
// Frame `index`, from 0 to 1, in the order in which they are sent; any other is the last.
static inline whole_frame whole_status_frame(const whole_status_t* value, uint8_t index,
                                             whole_priority priority) {
  whole_frame frame = {0, 8, {0, 0, 0, 0, 0, 0, 0, 0}};
  switch (index) {
  case 0:
    frame.id = whole_sample_id(0x70, priority);
    whole_status_identity_encode(&value->identity, frame.data);
    break;
  default:
    frame.id = whole_sample_id(0x71, priority);
    whole_status_health_encode(&value->health, frame.data);
    break;
  }
  return frame;
}
// Whatever the priority. Which frame it was, from 0; a sample is complete when its last frame came after all
// others; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_status_take(whole_status_t* value,
                                    const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  switch (whole_topic_of(frame->id)) {
  case 0x70:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_status_identity_decode(&value->identity, frame->data);
    return 0;
  case 0x71:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_status_health_decode(&value->health, frame->data);
    return 1;
  default: return WHOLE_FOREIGN;
  }
}

// --- refusal

// Refusal.
typedef struct whole_refusal_t {
  // [0, 255]
  uint8_t topic;
  // [0, 255]
  uint8_t reason;
  // [0, 65535]
  uint16_t refused;
} whole_refusal_t;
static inline void whole_refusal_encode(const whole_refusal_t* value, uint8_t data[8]) {
  const uint32_t topic_bits = (uint32_t)value->topic;
  const uint32_t reason_bits = (uint32_t)value->reason;
  const uint32_t refused_bits = (uint32_t)value->refused;
  data[0] = (uint8_t)(topic_bits);
  data[1] = (uint8_t)(reason_bits);
  data[2] = (uint8_t)(refused_bits);
  data[3] = (uint8_t)(refused_bits >> 8);
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_refusal_decode(whole_refusal_t* value, const uint8_t data[8]) {
  const uint32_t topic_bits = (uint32_t)data[0];
  value->topic = (uint8_t)topic_bits;
  const uint32_t reason_bits = (uint32_t)data[1];
  value->reason = (uint8_t)reason_bits;
  const uint32_t refused_bits = (uint32_t)data[2] | ((uint32_t)data[3] << 8);
  value->refused = (uint16_t)refused_bits;
}

// Refusal. Sensor of main_board. [decided: for tests]
#define WHOLE_REFUSAL_ID 0x72u
#define WHOLE_REFUSAL_PRIORITY WHOLE_HIGH
#define WHOLE_REFUSAL_FRAMES 1u
static inline whole_frame whole_refusal_frame(const whole_refusal_t* value,
                                              whole_priority priority) {
  whole_frame frame = {0, 4, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_sample_id(0x72, priority);
  whole_refusal_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_refusal_take(whole_refusal_t* value,
                                     const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x72u) return WHOLE_FOREIGN;
  if (frame->dlc != 4) return WHOLE_WRONG_LENGTH;
  whole_refusal_decode(value, frame->data);
  return 0;
}

// --- gyroscope

// Gyroscope: all axes. [table 5]
typedef struct whole_gyroscope_t {
  // around the long axis; 0.0175 deg/s a bit, [-499.9925, 499.9925] deg/s [table 6]
  int16_t x;
  // -0.25 deg/s a bit, from 3 deg/s on, [-508.75, 515] deg/s
  int16_t y;
  // see below
  uint8_t value;
  // 0.5 °C a bit, from -40 °C on, [-40, 87.5] °C; see below
  uint8_t temperature;
  // of the part; see below
  uint16_t state;
  // see below
  int8_t spare;
} whole_gyroscope_t;
#define WHOLE_GYROSCOPE_VALUE_OFF 0
#define WHOLE_GYROSCOPE_VALUE_ON 1
#define WHOLE_GYROSCOPE_TEMPERATURE_UNKNOWN 255
#define WHOLE_GYROSCOPE_STATE_READY 0x01u
#define WHOLE_GYROSCOPE_STATE_DATA 0x80u
#define WHOLE_GYROSCOPE_STATE_LATE 0x0100u
#define WHOLE_GYROSCOPE_STATE_BROKEN 0x8000u
#define WHOLE_GYROSCOPE_SPARE_LEAST (-128)
#define WHOLE_GYROSCOPE_SPARE_NONE 0
static inline void whole_gyroscope_encode(const whole_gyroscope_t* value, uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)value->x;
  const uint32_t y_bits = (uint32_t)whole_held_i32(value->y, -2048, 2047);
  const uint32_t value_bits = (uint32_t)whole_at_most_u32(value->value, 0x0Fu);
  const uint32_t temperature_bits = (uint32_t)value->temperature;
  const uint32_t state_bits = (uint32_t)value->state;
  const uint32_t spare_bits = (uint32_t)value->spare;
  data[0] = (uint8_t)(x_bits);
  data[1] = (uint8_t)(x_bits >> 8);
  data[2] = (uint8_t)(y_bits);
  data[3] = (uint8_t)(((y_bits >> 8) & 0x0Fu) | ((value_bits & 0x0Fu) << 4));
  data[4] = (uint8_t)(temperature_bits);
  data[5] = (uint8_t)(state_bits);
  data[6] = (uint8_t)(state_bits >> 8);
  data[7] = (uint8_t)(spare_bits);
}
static inline void whole_gyroscope_decode(whole_gyroscope_t* value, const uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)data[0] | ((uint32_t)data[1] << 8);
  value->x = (int16_t)((x_bits ^ 0x8000u) - 0x8000u);
  const uint32_t y_bits = (uint32_t)data[2] | (((uint32_t)data[3] & 0x0Fu) << 8);
  value->y = (int16_t)((y_bits ^ 0x0800u) - 0x0800u);
  const uint32_t value_bits = (((uint32_t)data[3] >> 4) & 0x0Fu);
  value->value = (uint8_t)value_bits;
  const uint32_t temperature_bits = (uint32_t)data[4];
  value->temperature = (uint8_t)temperature_bits;
  const uint32_t state_bits = (uint32_t)data[5] | ((uint32_t)data[6] << 8);
  value->state = (uint16_t)state_bits;
  const uint32_t spare_bits = (uint32_t)data[7];
  value->spare = (int8_t)((spare_bits ^ 0x80u) - 0x80u);
}
static inline double whole_gyroscope_x_deg_per_s(const whole_gyroscope_t* value) {
  return (double)value->x * 175.0 / 10000.0;
}
static inline void whole_gyroscope_set_x_deg_per_s(whole_gyroscope_t* value, double deg_per_s_) {
  value->x = (int16_t)whole_nearest(deg_per_s_ * 10000.0 / 175.0, -28571, 28571);
}
static inline double whole_gyroscope_y_deg_per_s(const whole_gyroscope_t* value) {
  return ((double)value->y * -25.0 + 300.0) / 100.0;
}
static inline void whole_gyroscope_set_y_deg_per_s(whole_gyroscope_t* value, double deg_per_s_) {
  value->y = (int16_t)whole_nearest((deg_per_s_ * 100.0 - 300.0) / -25.0, -2048, 2047);
}
static inline double whole_gyroscope_temperature_celsius(const whole_gyroscope_t* value) {
  return ((double)value->temperature * 5.0 - 400.0) / 10.0;
}
static inline void whole_gyroscope_set_temperature_celsius(whole_gyroscope_t* value, double celsius_) {
  value->temperature = (uint8_t)whole_nearest((celsius_ * 10.0 + 400.0) / 5.0, 0, 255);
}

// Gyroscope: how fast it turns | and <where>. Sensor of main_board. [data sheet "A"; id decided: free;
// period: table 2; deadline: table 3; jitter: table 4; priority decided: first]
#define WHOLE_GYROSCOPE_ID 0x08u
#define WHOLE_GYROSCOPE_PRIORITY WHOLE_URGENT
#define WHOLE_GYROSCOPE_FRAMES 1u
static inline whole_frame whole_gyroscope_frame(const whole_gyroscope_t* value,
                                                whole_priority priority) {
  whole_frame frame = {0, 8, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_sample_id(0x08, priority);
  whole_gyroscope_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_gyroscope_take(whole_gyroscope_t* value,
                                       const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x08u) return WHOLE_FOREIGN;
  if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
  whole_gyroscope_decode(value, frame->data);
  return 0;
}

// --- position

// Position, pose.
typedef struct whole_position_pose_t {
  // 0.001 m a bit, [-8388.608, 8388.607] m
  int32_t x;
  // 0.001 m a bit, [-8388.608, 8388.607] m
  int32_t y;
  // 0.0001 rad a bit, [0, 6.5535] rad
  uint16_t orientation;
} whole_position_pose_t;
static inline void whole_position_pose_encode(const whole_position_pose_t* value, uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)whole_held_i32(value->x, -8388608, 8388607);
  const uint32_t y_bits = (uint32_t)whole_held_i32(value->y, -8388608, 8388607);
  const uint32_t orientation_bits = (uint32_t)value->orientation;
  data[0] = (uint8_t)(x_bits >> 16);
  data[1] = (uint8_t)(x_bits >> 8);
  data[2] = (uint8_t)(x_bits);
  data[3] = (uint8_t)(y_bits >> 16);
  data[4] = (uint8_t)(y_bits >> 8);
  data[5] = (uint8_t)(y_bits);
  data[6] = (uint8_t)(orientation_bits >> 8);
  data[7] = (uint8_t)(orientation_bits);
}
static inline void whole_position_pose_decode(whole_position_pose_t* value, const uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)data[2] | ((uint32_t)data[1] << 8) | ((uint32_t)data[0] << 16);
  value->x = (int32_t)((x_bits ^ 0x00800000u) - 0x00800000u);
  const uint32_t y_bits = (uint32_t)data[5] | ((uint32_t)data[4] << 8) | ((uint32_t)data[3] << 16);
  value->y = (int32_t)((y_bits ^ 0x00800000u) - 0x00800000u);
  const uint32_t orientation_bits = (uint32_t)data[7] | ((uint32_t)data[6] << 8);
  value->orientation = (uint16_t)orientation_bits;
}
static inline double whole_position_pose_x_m(const whole_position_pose_t* value) {
  return (double)value->x / 1000.0;
}
static inline void whole_position_pose_set_x_m(whole_position_pose_t* value, double m_) {
  value->x = (int32_t)whole_nearest(m_ * 1000.0, -8388608, 8388607);
}
static inline double whole_position_pose_y_m(const whole_position_pose_t* value) {
  return (double)value->y / 1000.0;
}
static inline void whole_position_pose_set_y_m(whole_position_pose_t* value, double m_) {
  value->y = (int32_t)whole_nearest(m_ * 1000.0, -8388608, 8388607);
}
static inline double whole_position_pose_orientation_rad(const whole_position_pose_t* value) {
  return (double)value->orientation / 10000.0;
}
static inline void whole_position_pose_set_orientation_rad(whole_position_pose_t* value, double rad_) {
  value->orientation = (uint16_t)whole_nearest(rad_ * 10000.0, 0, 65535);
}

// Position, cell: each cell's own. [table 7]
typedef struct whole_position_cell_t {
  // 0.5 V a unit, [-2.5, 40] V
  float data;
  // [0, 4000] mA
  uint16_t on;
  // see below
  uint32_t restrict_;
} whole_position_cell_t;
#define WHOLE_POSITION_CELL_RESTRICT_LOW 0x01u
#define WHOLE_POSITION_CELL_RESTRICT_HIGH 0x00040000u
static inline void whole_position_cell_encode(const whole_position_cell_t* value, uint8_t data[8]) {
  const uint32_t data_bits = whole_bits_of_float(value->data);
  const uint32_t on_bits = (uint32_t)whole_at_most_u32(value->on, 0x0FFFu);
  const uint32_t restrict_bits = (uint32_t)whole_at_most_u32(value->restrict_, 0x0007FFFFu);
  data[0] = (uint8_t)(data_bits);
  data[1] = (uint8_t)(data_bits >> 8);
  data[2] = (uint8_t)(data_bits >> 16);
  data[3] = (uint8_t)(data_bits >> 24);
  data[4] = (uint8_t)((on_bits & 0x7Fu) << 1);
  data[5] = (uint8_t)(((on_bits >> 7) & 0x1Fu) | ((restrict_bits & 0x07u) << 5));
  data[6] = (uint8_t)(restrict_bits >> 3);
  data[7] = (uint8_t)(restrict_bits >> 11);
}
static inline void whole_position_cell_decode(whole_position_cell_t* value, const uint8_t data[8]) {
  const uint32_t data_bits =
    (uint32_t)data[0] |
    ((uint32_t)data[1] << 8) |
    ((uint32_t)data[2] << 16) |
    ((uint32_t)data[3] << 24);
  value->data = whole_float_of(data_bits);
  const uint32_t on_bits = (((uint32_t)data[4] >> 1) & 0x7Fu) | (((uint32_t)data[5] & 0x1Fu) << 7);
  value->on = (uint16_t)on_bits;
  const uint32_t restrict_bits =
    (((uint32_t)data[5] >> 5) & 0x07u) |
    ((uint32_t)data[6] << 3) |
    ((uint32_t)data[7] << 11);
  value->restrict_ = (uint32_t)restrict_bits;
}
static inline double whole_position_cell_data_V(const whole_position_cell_t* value) {
  return (double)value->data / 2.0;
}
static inline void whole_position_cell_set_data_V(whole_position_cell_t* value, double V_) {
  value->data = (float)(whole_within(V_, -2.5, 40.0) * 2.0);
}
static inline double whole_position_cell_on_mA(const whole_position_cell_t* value) {
  return (double)value->on;
}
static inline void whole_position_cell_set_on_mA(whole_position_cell_t* value, double mA_) {
  value->on = (uint16_t)whole_nearest(mA_, 0, 4000);
}

// Position, value.
typedef struct whole_position_value_t {
  // 0.001 km a unit, from -2 km on
  double all;
} whole_position_value_t;
static inline void whole_position_value_encode(const whole_position_value_t* value, uint8_t data[8]) {
  const uint64_t all_bits = whole_bits_of_double(value->all);
  data[0] = (uint8_t)(all_bits);
  data[1] = (uint8_t)(all_bits >> 8);
  data[2] = (uint8_t)(all_bits >> 16);
  data[3] = (uint8_t)(all_bits >> 24);
  data[4] = (uint8_t)(all_bits >> 32);
  data[5] = (uint8_t)(all_bits >> 40);
  data[6] = (uint8_t)(all_bits >> 48);
  data[7] = (uint8_t)(all_bits >> 56);
}
static inline void whole_position_value_decode(whole_position_value_t* value, const uint8_t data[8]) {
  const uint64_t all_bits =
    (uint64_t)data[0] |
    ((uint64_t)data[1] << 8) |
    ((uint64_t)data[2] << 16) |
    ((uint64_t)data[3] << 24) |
    ((uint64_t)data[4] << 32) |
    ((uint64_t)data[5] << 40) |
    ((uint64_t)data[6] << 48) |
    ((uint64_t)data[7] << 56);
  value->all = whole_double_of(all_bits);
}
static inline double whole_position_value_all_km(const whole_position_value_t* value) {
  return ((double)value->all - 2000.0) / 1000.0;
}
static inline void whole_position_value_set_all_km(whole_position_value_t* value, double km_) {
  value->all = (double)(km_ * 1000.0 + 2000.0);
}

// Position, i.
typedef struct whole_position_i_t {
  // [-9223372036854775808, 9223372036854775807]
  int64_t wide;
} whole_position_i_t;
static inline void whole_position_i_encode(const whole_position_i_t* value, uint8_t data[8]) {
  const uint64_t wide_bits = (uint64_t)value->wide;
  data[0] = (uint8_t)(wide_bits >> 56);
  data[1] = (uint8_t)(wide_bits >> 48);
  data[2] = (uint8_t)(wide_bits >> 40);
  data[3] = (uint8_t)(wide_bits >> 32);
  data[4] = (uint8_t)(wide_bits >> 24);
  data[5] = (uint8_t)(wide_bits >> 16);
  data[6] = (uint8_t)(wide_bits >> 8);
  data[7] = (uint8_t)(wide_bits);
}
static inline void whole_position_i_decode(whole_position_i_t* value, const uint8_t data[8]) {
  const uint64_t wide_bits =
    (uint64_t)data[7] |
    ((uint64_t)data[6] << 8) |
    ((uint64_t)data[5] << 16) |
    ((uint64_t)data[4] << 24) |
    ((uint64_t)data[3] << 32) |
    ((uint64_t)data[2] << 40) |
    ((uint64_t)data[1] << 48) |
    ((uint64_t)data[0] << 56);
  value->wide = (int64_t)wide_bits;
}

// Position, tail.
typedef struct whole_position_tail_t {
  // [0, 9223372036854775807]
  uint64_t far;
} whole_position_tail_t;
static inline void whole_position_tail_encode(const whole_position_tail_t* value, uint8_t data[8]) {
  const uint64_t far_bits = (uint64_t)whole_at_most_u64(value->far, UINT64_C(0x7FFFFFFFFFFFFFFF));
  data[0] = (uint8_t)((far_bits & 0x7Fu) << 1);
  data[1] = (uint8_t)(far_bits >> 7);
  data[2] = (uint8_t)(far_bits >> 15);
  data[3] = (uint8_t)(far_bits >> 23);
  data[4] = (uint8_t)(far_bits >> 31);
  data[5] = (uint8_t)(far_bits >> 39);
  data[6] = (uint8_t)(far_bits >> 47);
  data[7] = (uint8_t)(far_bits >> 55);
}
static inline void whole_position_tail_decode(whole_position_tail_t* value, const uint8_t data[8]) {
  const uint64_t far_bits =
    (((uint64_t)data[0] >> 1) & 0x7Fu) |
    ((uint64_t)data[1] << 7) |
    ((uint64_t)data[2] << 15) |
    ((uint64_t)data[3] << 23) |
    ((uint64_t)data[4] << 31) |
    ((uint64_t)data[5] << 39) |
    ((uint64_t)data[6] << 47) |
    ((uint64_t)data[7] << 55);
  value->far = (uint64_t)far_bits;
}

// Position, last.
typedef struct whole_position_last_t {
  uint8_t nothing;  // C has no empty struct
} whole_position_last_t;
static inline void whole_position_last_encode(const whole_position_last_t* value, uint8_t data[8]) {
  (void)value;
  data[0] = 0;
  data[1] = 0;
  data[2] = 0;
  data[3] = 0;
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_position_last_decode(whole_position_last_t* value, const uint8_t data[8]) {
  (void)data;
  value->nothing = 0;
}

// Position. Sensor of main_board. [decided: for tests]
#define WHOLE_POSITION_ID 0x10u
#define WHOLE_POSITION_PRIORITY WHOLE_HIGH
#define WHOLE_POSITION_FRAMES 8u
typedef struct whole_position_t {
  whole_position_pose_t pose;
  whole_position_cell_t cell[3];
  whole_position_value_t value;
  whole_position_i_t i;
  whole_position_tail_t tail;
  whole_position_last_t last;
} whole_position_t;
// Frame `index`, from 0 to 7, in the order in which they are sent; any other is the last.
static inline whole_frame whole_position_frame(const whole_position_t* value, uint8_t index,
                                               whole_priority priority) {
  whole_frame frame = {0, 8, {0, 0, 0, 0, 0, 0, 0, 0}};
  switch (index) {
  case 0:
    frame.id = whole_sample_id(0x10, priority);
    whole_position_pose_encode(&value->pose, frame.data);
    break;
  case 1:
    frame.id = whole_sample_id(0x11, priority);
    whole_position_cell_encode(&value->cell[0], frame.data);
    break;
  case 2:
    frame.id = whole_sample_id(0x12, priority);
    whole_position_cell_encode(&value->cell[1], frame.data);
    break;
  case 3:
    frame.id = whole_sample_id(0x13, priority);
    whole_position_cell_encode(&value->cell[2], frame.data);
    break;
  case 4:
    frame.id = whole_sample_id(0x14, priority);
    whole_position_value_encode(&value->value, frame.data);
    break;
  case 5:
    frame.id = whole_sample_id(0x15, priority);
    whole_position_i_encode(&value->i, frame.data);
    break;
  case 6:
    frame.id = whole_sample_id(0x16, priority);
    whole_position_tail_encode(&value->tail, frame.data);
    break;
  default:
    frame.dlc = 0;
    frame.id = whole_sample_id(0x17, priority);
    whole_position_last_encode(&value->last, frame.data);
    break;
  }
  return frame;
}
// Whatever the priority. Which frame it was, from 0; a sample is complete when its last frame came after all
// others; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_position_take(whole_position_t* value,
                                      const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  switch (whole_topic_of(frame->id)) {
  case 0x10:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_pose_decode(&value->pose, frame->data);
    return 0;
  case 0x11:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_cell_decode(&value->cell[0], frame->data);
    return 1;
  case 0x12:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_cell_decode(&value->cell[1], frame->data);
    return 2;
  case 0x13:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_cell_decode(&value->cell[2], frame->data);
    return 3;
  case 0x14:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_value_decode(&value->value, frame->data);
    return 4;
  case 0x15:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_i_decode(&value->i, frame->data);
    return 5;
  case 0x16:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_position_tail_decode(&value->tail, frame->data);
    return 6;
  case 0x17:
    if (frame->dlc != 0) return WHOLE_WRONG_LENGTH;
    whole_position_last_decode(&value->last, frame->data);
    return 7;
  default: return WHOLE_FOREIGN;
  }
}

// --- second_position

// Second position, pose.
typedef struct whole_second_position_pose_t {
  // 0.001 m a bit, [-8388.608, 8388.607] m
  int32_t x;
  // 0.001 m a bit, [-8388.608, 8388.607] m
  int32_t y;
  // 0.0001 rad a bit, [0, 6.5535] rad
  uint16_t orientation;
} whole_second_position_pose_t;
static inline void whole_second_position_pose_encode(const whole_second_position_pose_t* value, uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)whole_held_i32(value->x, -8388608, 8388607);
  const uint32_t y_bits = (uint32_t)whole_held_i32(value->y, -8388608, 8388607);
  const uint32_t orientation_bits = (uint32_t)value->orientation;
  data[0] = (uint8_t)(x_bits >> 16);
  data[1] = (uint8_t)(x_bits >> 8);
  data[2] = (uint8_t)(x_bits);
  data[3] = (uint8_t)(y_bits >> 16);
  data[4] = (uint8_t)(y_bits >> 8);
  data[5] = (uint8_t)(y_bits);
  data[6] = (uint8_t)(orientation_bits >> 8);
  data[7] = (uint8_t)(orientation_bits);
}
static inline void whole_second_position_pose_decode(whole_second_position_pose_t* value, const uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)data[2] | ((uint32_t)data[1] << 8) | ((uint32_t)data[0] << 16);
  value->x = (int32_t)((x_bits ^ 0x00800000u) - 0x00800000u);
  const uint32_t y_bits = (uint32_t)data[5] | ((uint32_t)data[4] << 8) | ((uint32_t)data[3] << 16);
  value->y = (int32_t)((y_bits ^ 0x00800000u) - 0x00800000u);
  const uint32_t orientation_bits = (uint32_t)data[7] | ((uint32_t)data[6] << 8);
  value->orientation = (uint16_t)orientation_bits;
}
static inline double whole_second_position_pose_x_m(const whole_second_position_pose_t* value) {
  return (double)value->x / 1000.0;
}
static inline void whole_second_position_pose_set_x_m(whole_second_position_pose_t* value, double m_) {
  value->x = (int32_t)whole_nearest(m_ * 1000.0, -8388608, 8388607);
}
static inline double whole_second_position_pose_y_m(const whole_second_position_pose_t* value) {
  return (double)value->y / 1000.0;
}
static inline void whole_second_position_pose_set_y_m(whole_second_position_pose_t* value, double m_) {
  value->y = (int32_t)whole_nearest(m_ * 1000.0, -8388608, 8388607);
}
static inline double whole_second_position_pose_orientation_rad(const whole_second_position_pose_t* value) {
  return (double)value->orientation / 10000.0;
}
static inline void whole_second_position_pose_set_orientation_rad(whole_second_position_pose_t* value, double rad_) {
  value->orientation = (uint16_t)whole_nearest(rad_ * 10000.0, 0, 65535);
}

// Second position, cell: each cell's own. [table 7]
typedef struct whole_second_position_cell_t {
  // 0.5 V a unit, [-2.5, 40] V
  float data;
  // [0, 4000] mA
  uint16_t on;
  // see below
  uint32_t restrict_;
} whole_second_position_cell_t;
#define WHOLE_SECOND_POSITION_CELL_RESTRICT_LOW 0x01u
#define WHOLE_SECOND_POSITION_CELL_RESTRICT_HIGH 0x00040000u
static inline void whole_second_position_cell_encode(const whole_second_position_cell_t* value, uint8_t data[8]) {
  const uint32_t data_bits = whole_bits_of_float(value->data);
  const uint32_t on_bits = (uint32_t)whole_at_most_u32(value->on, 0x0FFFu);
  const uint32_t restrict_bits = (uint32_t)whole_at_most_u32(value->restrict_, 0x0007FFFFu);
  data[0] = (uint8_t)(data_bits);
  data[1] = (uint8_t)(data_bits >> 8);
  data[2] = (uint8_t)(data_bits >> 16);
  data[3] = (uint8_t)(data_bits >> 24);
  data[4] = (uint8_t)((on_bits & 0x7Fu) << 1);
  data[5] = (uint8_t)(((on_bits >> 7) & 0x1Fu) | ((restrict_bits & 0x07u) << 5));
  data[6] = (uint8_t)(restrict_bits >> 3);
  data[7] = (uint8_t)(restrict_bits >> 11);
}
static inline void whole_second_position_cell_decode(whole_second_position_cell_t* value, const uint8_t data[8]) {
  const uint32_t data_bits =
    (uint32_t)data[0] |
    ((uint32_t)data[1] << 8) |
    ((uint32_t)data[2] << 16) |
    ((uint32_t)data[3] << 24);
  value->data = whole_float_of(data_bits);
  const uint32_t on_bits = (((uint32_t)data[4] >> 1) & 0x7Fu) | (((uint32_t)data[5] & 0x1Fu) << 7);
  value->on = (uint16_t)on_bits;
  const uint32_t restrict_bits =
    (((uint32_t)data[5] >> 5) & 0x07u) |
    ((uint32_t)data[6] << 3) |
    ((uint32_t)data[7] << 11);
  value->restrict_ = (uint32_t)restrict_bits;
}
static inline double whole_second_position_cell_data_V(const whole_second_position_cell_t* value) {
  return (double)value->data / 2.0;
}
static inline void whole_second_position_cell_set_data_V(whole_second_position_cell_t* value, double V_) {
  value->data = (float)(whole_within(V_, -2.5, 40.0) * 2.0);
}
static inline double whole_second_position_cell_on_mA(const whole_second_position_cell_t* value) {
  return (double)value->on;
}
static inline void whole_second_position_cell_set_on_mA(whole_second_position_cell_t* value, double mA_) {
  value->on = (uint16_t)whole_nearest(mA_, 0, 4000);
}

// Second position, value.
typedef struct whole_second_position_value_t {
  // 0.001 km a unit, from -2 km on
  double all;
} whole_second_position_value_t;
static inline void whole_second_position_value_encode(const whole_second_position_value_t* value, uint8_t data[8]) {
  const uint64_t all_bits = whole_bits_of_double(value->all);
  data[0] = (uint8_t)(all_bits);
  data[1] = (uint8_t)(all_bits >> 8);
  data[2] = (uint8_t)(all_bits >> 16);
  data[3] = (uint8_t)(all_bits >> 24);
  data[4] = (uint8_t)(all_bits >> 32);
  data[5] = (uint8_t)(all_bits >> 40);
  data[6] = (uint8_t)(all_bits >> 48);
  data[7] = (uint8_t)(all_bits >> 56);
}
static inline void whole_second_position_value_decode(whole_second_position_value_t* value, const uint8_t data[8]) {
  const uint64_t all_bits =
    (uint64_t)data[0] |
    ((uint64_t)data[1] << 8) |
    ((uint64_t)data[2] << 16) |
    ((uint64_t)data[3] << 24) |
    ((uint64_t)data[4] << 32) |
    ((uint64_t)data[5] << 40) |
    ((uint64_t)data[6] << 48) |
    ((uint64_t)data[7] << 56);
  value->all = whole_double_of(all_bits);
}
static inline double whole_second_position_value_all_km(const whole_second_position_value_t* value) {
  return ((double)value->all - 2000.0) / 1000.0;
}
static inline void whole_second_position_value_set_all_km(whole_second_position_value_t* value, double km_) {
  value->all = (double)(km_ * 1000.0 + 2000.0);
}

// Second position, i.
typedef struct whole_second_position_i_t {
  // [-9223372036854775808, 9223372036854775807]
  int64_t wide;
} whole_second_position_i_t;
static inline void whole_second_position_i_encode(const whole_second_position_i_t* value, uint8_t data[8]) {
  const uint64_t wide_bits = (uint64_t)value->wide;
  data[0] = (uint8_t)(wide_bits >> 56);
  data[1] = (uint8_t)(wide_bits >> 48);
  data[2] = (uint8_t)(wide_bits >> 40);
  data[3] = (uint8_t)(wide_bits >> 32);
  data[4] = (uint8_t)(wide_bits >> 24);
  data[5] = (uint8_t)(wide_bits >> 16);
  data[6] = (uint8_t)(wide_bits >> 8);
  data[7] = (uint8_t)(wide_bits);
}
static inline void whole_second_position_i_decode(whole_second_position_i_t* value, const uint8_t data[8]) {
  const uint64_t wide_bits =
    (uint64_t)data[7] |
    ((uint64_t)data[6] << 8) |
    ((uint64_t)data[5] << 16) |
    ((uint64_t)data[4] << 24) |
    ((uint64_t)data[3] << 32) |
    ((uint64_t)data[2] << 40) |
    ((uint64_t)data[1] << 48) |
    ((uint64_t)data[0] << 56);
  value->wide = (int64_t)wide_bits;
}

// Second position, tail.
typedef struct whole_second_position_tail_t {
  // [0, 9223372036854775807]
  uint64_t far;
} whole_second_position_tail_t;
static inline void whole_second_position_tail_encode(const whole_second_position_tail_t* value, uint8_t data[8]) {
  const uint64_t far_bits = (uint64_t)whole_at_most_u64(value->far, UINT64_C(0x7FFFFFFFFFFFFFFF));
  data[0] = (uint8_t)((far_bits & 0x7Fu) << 1);
  data[1] = (uint8_t)(far_bits >> 7);
  data[2] = (uint8_t)(far_bits >> 15);
  data[3] = (uint8_t)(far_bits >> 23);
  data[4] = (uint8_t)(far_bits >> 31);
  data[5] = (uint8_t)(far_bits >> 39);
  data[6] = (uint8_t)(far_bits >> 47);
  data[7] = (uint8_t)(far_bits >> 55);
}
static inline void whole_second_position_tail_decode(whole_second_position_tail_t* value, const uint8_t data[8]) {
  const uint64_t far_bits =
    (((uint64_t)data[0] >> 1) & 0x7Fu) |
    ((uint64_t)data[1] << 7) |
    ((uint64_t)data[2] << 15) |
    ((uint64_t)data[3] << 23) |
    ((uint64_t)data[4] << 31) |
    ((uint64_t)data[5] << 39) |
    ((uint64_t)data[6] << 47) |
    ((uint64_t)data[7] << 55);
  value->far = (uint64_t)far_bits;
}

// Second position, last.
typedef struct whole_second_position_last_t {
  uint8_t nothing;  // C has no empty struct
} whole_second_position_last_t;
static inline void whole_second_position_last_encode(const whole_second_position_last_t* value, uint8_t data[8]) {
  (void)value;
  data[0] = 0;
  data[1] = 0;
  data[2] = 0;
  data[3] = 0;
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_second_position_last_decode(whole_second_position_last_t* value, const uint8_t data[8]) {
  (void)data;
  value->nothing = 0;
}

// Second position: of the other end. Sensor of a_board_with_a_name_of_35_characters. [decided: the same]
#define WHOLE_SECOND_POSITION_ID 0x18u
#define WHOLE_SECOND_POSITION_PRIORITY WHOLE_HIGH
#define WHOLE_SECOND_POSITION_FRAMES 8u
typedef struct whole_second_position_t {
  whole_second_position_pose_t pose;
  whole_second_position_cell_t cell[3];
  whole_second_position_value_t value;
  whole_second_position_i_t i;
  whole_second_position_tail_t tail;
  whole_second_position_last_t last;
} whole_second_position_t;
// Frame `index`, from 0 to 7, in the order in which they are sent; any other is the last.
static inline whole_frame whole_second_position_frame(const whole_second_position_t* value, uint8_t index,
                                                      whole_priority priority) {
  whole_frame frame = {0, 8, {0, 0, 0, 0, 0, 0, 0, 0}};
  switch (index) {
  case 0:
    frame.id = whole_sample_id(0x18, priority);
    whole_second_position_pose_encode(&value->pose, frame.data);
    break;
  case 1:
    frame.id = whole_sample_id(0x19, priority);
    whole_second_position_cell_encode(&value->cell[0], frame.data);
    break;
  case 2:
    frame.id = whole_sample_id(0x1A, priority);
    whole_second_position_cell_encode(&value->cell[1], frame.data);
    break;
  case 3:
    frame.id = whole_sample_id(0x1B, priority);
    whole_second_position_cell_encode(&value->cell[2], frame.data);
    break;
  case 4:
    frame.id = whole_sample_id(0x1C, priority);
    whole_second_position_value_encode(&value->value, frame.data);
    break;
  case 5:
    frame.id = whole_sample_id(0x1D, priority);
    whole_second_position_i_encode(&value->i, frame.data);
    break;
  case 6:
    frame.id = whole_sample_id(0x1E, priority);
    whole_second_position_tail_encode(&value->tail, frame.data);
    break;
  default:
    frame.dlc = 0;
    frame.id = whole_sample_id(0x1F, priority);
    whole_second_position_last_encode(&value->last, frame.data);
    break;
  }
  return frame;
}
// Whatever the priority. Which frame it was, from 0; a sample is complete when its last frame came after all
// others; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_second_position_take(whole_second_position_t* value,
                                             const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  switch (whole_topic_of(frame->id)) {
  case 0x18:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_pose_decode(&value->pose, frame->data);
    return 0;
  case 0x19:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_cell_decode(&value->cell[0], frame->data);
    return 1;
  case 0x1A:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_cell_decode(&value->cell[1], frame->data);
    return 2;
  case 0x1B:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_cell_decode(&value->cell[2], frame->data);
    return 3;
  case 0x1C:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_value_decode(&value->value, frame->data);
    return 4;
  case 0x1D:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_i_decode(&value->i, frame->data);
    return 5;
  case 0x1E:
    if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
    whole_second_position_tail_decode(&value->tail, frame->data);
    return 6;
  case 0x1F:
    if (frame->dlc != 0) return WHOLE_WRONG_LENGTH;
    whole_second_position_last_decode(&value->last, frame->data);
    return 7;
  default: return WHOLE_FOREIGN;
  }
}

// --- ring

// Ring, sensor.
typedef struct whole_ring_sensor_t {
  // [0, 65535]
  uint16_t proximity;
  // [0, 65535]
  uint16_t ambient;
} whole_ring_sensor_t;
static inline void whole_ring_sensor_encode(const whole_ring_sensor_t* value, uint8_t data[8]) {
  const uint32_t proximity_bits = (uint32_t)value->proximity;
  const uint32_t ambient_bits = (uint32_t)value->ambient;
  data[0] = (uint8_t)(proximity_bits);
  data[1] = (uint8_t)(proximity_bits >> 8);
  data[2] = (uint8_t)(ambient_bits);
  data[3] = (uint8_t)(ambient_bits >> 8);
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_ring_sensor_decode(whole_ring_sensor_t* value, const uint8_t data[8]) {
  const uint32_t proximity_bits = (uint32_t)data[0] | ((uint32_t)data[1] << 8);
  value->proximity = (uint16_t)proximity_bits;
  const uint32_t ambient_bits = (uint32_t)data[2] | ((uint32_t)data[3] << 8);
  value->ambient = (uint16_t)ambient_bits;
}

// Ring, mean.
typedef struct whole_ring_mean_t {
  // [0, 65535]
  uint16_t proximity;
} whole_ring_mean_t;
static inline void whole_ring_mean_encode(const whole_ring_mean_t* value, uint8_t data[8]) {
  const uint32_t proximity_bits = (uint32_t)value->proximity;
  data[0] = (uint8_t)(proximity_bits);
  data[1] = (uint8_t)(proximity_bits >> 8);
  data[2] = 0;
  data[3] = 0;
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_ring_mean_decode(whole_ring_mean_t* value, const uint8_t data[8]) {
  const uint32_t proximity_bits = (uint32_t)data[0] | ((uint32_t)data[1] << 8);
  value->proximity = (uint16_t)proximity_bits;
}

// Ring. Sensor of a_board_with_a_name_of_35_characters. [decided: for tests]
#define WHOLE_RING_ID 0x30u
#define WHOLE_RING_PRIORITY WHOLE_LOW
#define WHOLE_RING_FRAMES 5u
typedef struct whole_ring_t {
  whole_ring_sensor_t sensor[4];
  whole_ring_mean_t mean;
} whole_ring_t;
// Frame `index`, from 0 to 4, in the order in which they are sent; any other is the last.
static inline whole_frame whole_ring_frame(const whole_ring_t* value, uint8_t index,
                                           whole_priority priority) {
  whole_frame frame = {0, 4, {0, 0, 0, 0, 0, 0, 0, 0}};
  switch (index) {
  case 0:
    frame.id = whole_sample_id(0x30, priority);
    whole_ring_sensor_encode(&value->sensor[0], frame.data);
    break;
  case 1:
    frame.id = whole_sample_id(0x31, priority);
    whole_ring_sensor_encode(&value->sensor[1], frame.data);
    break;
  case 2:
    frame.id = whole_sample_id(0x32, priority);
    whole_ring_sensor_encode(&value->sensor[2], frame.data);
    break;
  case 3:
    frame.id = whole_sample_id(0x33, priority);
    whole_ring_sensor_encode(&value->sensor[3], frame.data);
    break;
  default:
    frame.dlc = 2;
    frame.id = whole_sample_id(0x34, priority);
    whole_ring_mean_encode(&value->mean, frame.data);
    break;
  }
  return frame;
}
// Whatever the priority. Which frame it was, from 0; a sample is complete when its last frame came after all
// others; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_ring_take(whole_ring_t* value,
                                  const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  switch (whole_topic_of(frame->id)) {
  case 0x30:
    if (frame->dlc != 4) return WHOLE_WRONG_LENGTH;
    whole_ring_sensor_decode(&value->sensor[0], frame->data);
    return 0;
  case 0x31:
    if (frame->dlc != 4) return WHOLE_WRONG_LENGTH;
    whole_ring_sensor_decode(&value->sensor[1], frame->data);
    return 1;
  case 0x32:
    if (frame->dlc != 4) return WHOLE_WRONG_LENGTH;
    whole_ring_sensor_decode(&value->sensor[2], frame->data);
    return 2;
  case 0x33:
    if (frame->dlc != 4) return WHOLE_WRONG_LENGTH;
    whole_ring_sensor_decode(&value->sensor[3], frame->data);
    return 3;
  case 0x34:
    if (frame->dlc != 2) return WHOLE_WRONG_LENGTH;
    whole_ring_mean_decode(&value->mean, frame->data);
    return 4;
  default: return WHOLE_FOREIGN;
  }
}

// --- floor

// Floor.
typedef struct whole_floor_t {
  // [0, 4095]
  uint16_t left;
  // [0, 4095]
  uint16_t right;
  float a_field_with_a_name_of_some_37_letters;
  // see below
  int8_t sum;
} whole_floor_t;
#define WHOLE_FLOOR_SUM_NONE 0
static inline void whole_floor_encode(const whole_floor_t* value, uint8_t data[8]) {
  const uint32_t left_bits = (uint32_t)whole_at_most_u32(value->left, 0x0FFFu);
  const uint32_t right_bits = (uint32_t)whole_at_most_u32(value->right, 0x0FFFu);
  const uint32_t a_field_with_a_name_of_some_37_letters_bits = whole_bits_of_float(value->a_field_with_a_name_of_some_37_letters);
  const uint32_t sum_bits = (uint32_t)value->sum;
  data[0] = (uint8_t)(left_bits >> 4);
  data[1] = (uint8_t)(((left_bits & 0x0Fu) << 4) | ((right_bits >> 8) & 0x0Fu));
  data[2] = (uint8_t)(right_bits);
  data[3] = (uint8_t)(a_field_with_a_name_of_some_37_letters_bits);
  data[4] = (uint8_t)(a_field_with_a_name_of_some_37_letters_bits >> 8);
  data[5] = (uint8_t)(a_field_with_a_name_of_some_37_letters_bits >> 16);
  data[6] = (uint8_t)(a_field_with_a_name_of_some_37_letters_bits >> 24);
  data[7] = (uint8_t)(sum_bits);
}
static inline void whole_floor_decode(whole_floor_t* value, const uint8_t data[8]) {
  const uint32_t left_bits = (((uint32_t)data[1] >> 4) & 0x0Fu) | ((uint32_t)data[0] << 4);
  value->left = (uint16_t)left_bits;
  const uint32_t right_bits = (uint32_t)data[2] | (((uint32_t)data[1] & 0x0Fu) << 8);
  value->right = (uint16_t)right_bits;
  const uint32_t a_field_with_a_name_of_some_37_letters_bits =
    (uint32_t)data[3] |
    ((uint32_t)data[4] << 8) |
    ((uint32_t)data[5] << 16) |
    ((uint32_t)data[6] << 24);
  value->a_field_with_a_name_of_some_37_letters = whole_float_of(a_field_with_a_name_of_some_37_letters_bits);
  const uint32_t sum_bits = (uint32_t)data[7];
  value->sum = (int8_t)((sum_bits ^ 0x80u) - 0x80u);
}

// Floor. Sensor of idle. [decided: for tests]
#define WHOLE_FLOOR_ID 0x40u
#define WHOLE_FLOOR_PRIORITY WHOLE_MEDIUM
#define WHOLE_FLOOR_FRAMES 1u
static inline whole_frame whole_floor_frame(const whole_floor_t* value,
                                            whole_priority priority) {
  whole_frame frame = {0, 8, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_sample_id(0x40, priority);
  whole_floor_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_floor_take(whole_floor_t* value,
                                   const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x40u) return WHOLE_FOREIGN;
  if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
  whole_floor_decode(value, frame->data);
  return 0;
}

// --- a_topic_with_a_name_longer_than_dbc_has

// A topic with a name longer than dbc has.
typedef struct whole_a_topic_with_a_name_longer_than_dbc_has_t {
  // see below
  uint32_t count_of_wheels;
} whole_a_topic_with_a_name_longer_than_dbc_has_t;
#define WHOLE_A_TOPIC_WITH_A_NAME_LONGER_THAN_DBC_HAS_COUNT_OF_WHEELS_FIRST 0x01u
#define WHOLE_A_TOPIC_WITH_A_NAME_LONGER_THAN_DBC_HAS_COUNT_OF_WHEELS_ALL 0x80000000u
static inline void whole_a_topic_with_a_name_longer_than_dbc_has_encode(const whole_a_topic_with_a_name_longer_than_dbc_has_t* value, uint8_t data[8]) {
  const uint32_t count_of_wheels_bits = (uint32_t)value->count_of_wheels;
  data[0] = (uint8_t)(count_of_wheels_bits);
  data[1] = (uint8_t)(count_of_wheels_bits >> 8);
  data[2] = (uint8_t)(count_of_wheels_bits >> 16);
  data[3] = (uint8_t)(count_of_wheels_bits >> 24);
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_a_topic_with_a_name_longer_than_dbc_has_decode(whole_a_topic_with_a_name_longer_than_dbc_has_t* value, const uint8_t data[8]) {
  const uint32_t count_of_wheels_bits =
    (uint32_t)data[0] |
    ((uint32_t)data[1] << 8) |
    ((uint32_t)data[2] << 16) |
    ((uint32_t)data[3] << 24);
  value->count_of_wheels = (uint32_t)count_of_wheels_bits;
}

// A topic with a name longer than dbc has. Sensor of idle. [decided: for tests]
#define WHOLE_A_TOPIC_WITH_A_NAME_LONGER_THAN_DBC_HAS_ID 0x41u
#define WHOLE_A_TOPIC_WITH_A_NAME_LONGER_THAN_DBC_HAS_PRIORITY WHOLE_HIGH
#define WHOLE_A_TOPIC_WITH_A_NAME_LONGER_THAN_DBC_HAS_FRAMES 1u
static inline whole_frame whole_a_topic_with_a_name_longer_than_dbc_has_frame(const whole_a_topic_with_a_name_longer_than_dbc_has_t* value,
                                                                              whole_priority priority) {
  whole_frame frame = {0, 4, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_sample_id(0x41, priority);
  whole_a_topic_with_a_name_longer_than_dbc_has_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_a_topic_with_a_name_longer_than_dbc_has_take(whole_a_topic_with_a_name_longer_than_dbc_has_t* value,
                                                                     const whole_frame* frame) {
  if (frame->id > 0x7FFu || !whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x41u) return WHOLE_FOREIGN;
  if (frame->dlc != 4) return WHOLE_WRONG_LENGTH;
  whole_a_topic_with_a_name_longer_than_dbc_has_decode(value, frame->data);
  return 0;
}

// --- motors

// Motors.
typedef struct whole_motors_t {
  // 0.000001 m/s a bit, [-0.5, 0.5] m/s
  int32_t x;
  // 0.000001 rad/s a bit, [-2147.483648, 2147.483647] rad/s
  int32_t z;
} whole_motors_t;
static inline void whole_motors_encode(const whole_motors_t* value, uint8_t data[8]) {
  const uint32_t x_bits = (uint32_t)value->x;
  const uint32_t z_bits = (uint32_t)value->z;
  data[0] = (uint8_t)(x_bits);
  data[1] = (uint8_t)(x_bits >> 8);
  data[2] = (uint8_t)(x_bits >> 16);
  data[3] = (uint8_t)(x_bits >> 24);
  data[4] = (uint8_t)(z_bits);
  data[5] = (uint8_t)(z_bits >> 8);
  data[6] = (uint8_t)(z_bits >> 16);
  data[7] = (uint8_t)(z_bits >> 24);
}
static inline void whole_motors_decode(whole_motors_t* value, const uint8_t data[8]) {
  const uint32_t x_bits =
    (uint32_t)data[0] |
    ((uint32_t)data[1] << 8) |
    ((uint32_t)data[2] << 16) |
    ((uint32_t)data[3] << 24);
  value->x = (int32_t)x_bits;
  const uint32_t z_bits =
    (uint32_t)data[4] |
    ((uint32_t)data[5] << 8) |
    ((uint32_t)data[6] << 16) |
    ((uint32_t)data[7] << 24);
  value->z = (int32_t)z_bits;
}
static inline double whole_motors_x_m_per_s(const whole_motors_t* value) {
  return (double)value->x / 1000000.0;
}
static inline void whole_motors_set_x_m_per_s(whole_motors_t* value, double m_per_s_) {
  value->x = (int32_t)whole_nearest(m_per_s_ * 1000000.0, -500000, 500000);
}
static inline double whole_motors_z_rad_per_s(const whole_motors_t* value) {
  return (double)value->z / 1000000.0;
}
static inline void whole_motors_set_z_rad_per_s(whole_motors_t* value, double rad_per_s_) {
  value->z = (int32_t)whole_nearest(rad_per_s_ * 1000000.0, INT32_MIN, 2147483647);
}

// Motors: how fast it drives. Actuator of main_board. [decided: for tests; timeout: table 8]
#define WHOLE_MOTORS_ID 0x01u
#define WHOLE_MOTORS_PRIORITY WHOLE_HIGH
static inline whole_frame whole_motors_frame(const whole_motors_t* value,
                                             whole_priority priority) {
  whole_frame frame = {0, 8, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_command_id(0x01, priority);
  whole_motors_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_motors_take(whole_motors_t* value,
                                    const whole_frame* frame) {
  if (frame->id > 0x7FFu || whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x01u) return WHOLE_FOREIGN;
  if (frame->dlc != 8) return WHOLE_WRONG_LENGTH;
  whole_motors_decode(value, frame->data);
  return 0;
}

// --- lamp

// Lamp.
typedef struct whole_lamp_t {
  // [0, 255]
  uint8_t red;
  // [0, 255]
  uint8_t green;
  // [0, 255]
  uint8_t blue;
} whole_lamp_t;
static inline void whole_lamp_encode(const whole_lamp_t* value, uint8_t data[8]) {
  const uint32_t red_bits = (uint32_t)value->red;
  const uint32_t green_bits = (uint32_t)value->green;
  const uint32_t blue_bits = (uint32_t)value->blue;
  data[0] = (uint8_t)(red_bits);
  data[1] = (uint8_t)(green_bits);
  data[2] = (uint8_t)(blue_bits);
  data[3] = 0;
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_lamp_decode(whole_lamp_t* value, const uint8_t data[8]) {
  const uint32_t red_bits = (uint32_t)data[0];
  value->red = (uint8_t)red_bits;
  const uint32_t green_bits = (uint32_t)data[1];
  value->green = (uint8_t)green_bits;
  const uint32_t blue_bits = (uint32_t)data[2];
  value->blue = (uint8_t)blue_bits;
}

// Lamp. Actuator of idle. [decided: for tests]
#define WHOLE_LAMP_ID 0x20u
#define WHOLE_LAMP_PRIORITY WHOLE_HIGH
#define WHOLE_LAMP_COUNT 3u
// Number 1 to 3; 0 is the first, any other the last.
static inline whole_frame whole_lamp_frame(const whole_lamp_t* value, uint8_t number,
                                           whole_priority priority) {
  whole_frame frame = {0, 3, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_command_id((uint8_t)(0x20u + (number < 1u ? 0u : number < 3u ? number - 1u : 2u)), priority);
  whole_lamp_encode(value, frame.data);
  return frame;
}
// Whatever the priority. The number of the one it was for, from 1; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH,
// and the struct is as it was.
static inline int whole_lamp_take(whole_lamp_t* value,
                                  const whole_frame* frame) {
  const uint8_t index = (uint8_t)(whole_topic_of(frame->id) - 0x20u);
  if (frame->id > 0x7FFu || whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (index >= 3u) return WHOLE_FOREIGN;
  if (frame->dlc != 3) return WHOLE_WRONG_LENGTH;
  whole_lamp_decode(value, frame->data);
  return index + 1;
}

// --- brake

// Brake.
typedef struct whole_brake_t {
  uint8_t nothing;  // C has no empty struct
} whole_brake_t;
static inline void whole_brake_encode(const whole_brake_t* value, uint8_t data[8]) {
  (void)value;
  data[0] = 0;
  data[1] = 0;
  data[2] = 0;
  data[3] = 0;
  data[4] = 0;
  data[5] = 0;
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_brake_decode(whole_brake_t* value, const uint8_t data[8]) {
  (void)data;
  value->nothing = 0;
}

// Brake. Actuator of idle. [decided: for tests]
#define WHOLE_BRAKE_ID 0x28u
#define WHOLE_BRAKE_PRIORITY WHOLE_HIGH
static inline whole_frame whole_brake_frame(const whole_brake_t* value,
                                            whole_priority priority) {
  whole_frame frame = {0, 0, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_command_id(0x28, priority);
  whole_brake_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_brake_take(whole_brake_t* value,
                                   const whole_frame* frame) {
  if (frame->id > 0x7FFu || whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x28u) return WHOLE_FOREIGN;
  if (frame->dlc != 0) return WHOLE_WRONG_LENGTH;
  whole_brake_decode(value, frame->data);
  return 0;
}

// --- arm

// Arm: its forearm.
typedef struct whole_arm_t {
  // [-32768, 32767] deg; see below
  int16_t angle;
  // [-90, 90] deg
  float bend;
} whole_arm_t;
#define WHOLE_ARM_ANGLE_REST 0
static inline void whole_arm_encode(const whole_arm_t* value, uint8_t data[8]) {
  const uint32_t angle_bits = (uint32_t)value->angle;
  const uint32_t bend_bits = whole_bits_of_float(value->bend);
  data[0] = (uint8_t)(angle_bits);
  data[1] = (uint8_t)(angle_bits >> 8);
  data[2] = (uint8_t)(bend_bits);
  data[3] = (uint8_t)(bend_bits >> 8);
  data[4] = (uint8_t)(bend_bits >> 16);
  data[5] = (uint8_t)(bend_bits >> 24);
  data[6] = 0;
  data[7] = 0;
}
static inline void whole_arm_decode(whole_arm_t* value, const uint8_t data[8]) {
  const uint32_t angle_bits = (uint32_t)data[0] | ((uint32_t)data[1] << 8);
  value->angle = (int16_t)((angle_bits ^ 0x8000u) - 0x8000u);
  const uint32_t bend_bits =
    (uint32_t)data[2] |
    ((uint32_t)data[3] << 8) |
    ((uint32_t)data[4] << 16) |
    ((uint32_t)data[5] << 24);
  value->bend = whole_float_of(bend_bits);
}
static inline double whole_arm_angle_deg(const whole_arm_t* value) {
  return (double)value->angle;
}
static inline void whole_arm_set_angle_deg(whole_arm_t* value, double deg_) {
  value->angle = (int16_t)whole_nearest(deg_, -32768, 32767);
}
static inline double whole_arm_bend_deg(const whole_arm_t* value) {
  return (double)value->bend;
}
static inline void whole_arm_set_bend_deg(whole_arm_t* value, double deg_) {
  value->bend = (float)(whole_within(deg_, -90.0, 90.0));
}

// Arm. Actuator of idle. [decided: for tests]
#define WHOLE_ARM_ID 0x29u
#define WHOLE_ARM_PRIORITY WHOLE_HIGH
static inline whole_frame whole_arm_frame(const whole_arm_t* value,
                                          whole_priority priority) {
  whole_frame frame = {0, 6, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = whole_command_id(0x29, priority);
  whole_arm_encode(value, frame.data);
  return frame;
}
// Whatever the priority. 0; or WHOLE_FOREIGN, or WHOLE_WRONG_LENGTH, and the struct is as it was.
static inline int whole_arm_take(whole_arm_t* value,
                                 const whole_frame* frame) {
  if (frame->id > 0x7FFu || whole_is_sample(frame->id)) return WHOLE_FOREIGN;
  if (whole_topic_of(frame->id) != 0x29u) return WHOLE_FOREIGN;
  if (frame->dlc != 6) return WHOLE_WRONG_LENGTH;
  whole_arm_decode(value, frame->data);
  return 0;
}

// EEC1. engine's speed 8 bytes, parameter group 0x0F004, every 20 ms. [by hand; period: measured]
#define WHOLE_EEC1_ID 0x18F004FEu
#define WHOLE_EEC1_EXTENDED 1
#define WHOLE_EEC1_LENGTH 8u
#define WHOLE_EEC1_FD 0
#define WHOLE_EEC1_PERIOD_US 20000u
typedef struct whole_EEC1 { uint8_t bytes[8]; } whole_EEC1;
#define WHOLE_EEC1_STATE_OFF 0
#define WHOLE_EEC1_STATE_ON 1
#define WHOLE_EEC1_STATE_OFF_ 14
#define WHOLE_EEC1_TORQUE_LOST 255
// Each field at its start value, all other bits zero.
static inline void whole_EEC1_init(whole_EEC1* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  message->bytes[0] = 0x01u;
  message->bytes[3] = 0x20u;
  message->bytes[4] = 0x03u;
}
static inline int whole_EEC1_is(uint32_t id, int extended) {
  return extended && (id & 0x03FFFF00u) == 0x00F00400u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_EEC1_decode(whole_EEC1* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 8u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Speed: of the crank. In rpm. Stated range: 0 to 8031.875.
static inline uint16_t whole_EEC1_Speed_raw(const whole_EEC1* message) {
  const uint32_t bits = (uint32_t)message->bytes[3] | ((uint32_t)message->bytes[4] << 8);
  return (uint16_t)bits;
}
static inline void whole_EEC1_set_Speed_raw(whole_EEC1* message, uint16_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[3] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[4] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
}
static inline double whole_EEC1_Speed(const whole_EEC1* message) {
  return (double)whole_EEC1_Speed_raw(message) / 8.0;
}
static inline void whole_EEC1_set_Speed(whole_EEC1* message, double value) {
  whole_EEC1_set_Speed_raw(message, (uint16_t)whole_nearest(value * 8.0, 0, 65535));
}
// State.
static inline uint8_t whole_EEC1_State(const whole_EEC1* message) {
  const uint32_t bits = ((uint32_t)message->bytes[0] & 0x0Fu);
  return (uint8_t)bits;
}
static inline void whole_EEC1_set_State(whole_EEC1* message, uint8_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x0Fu);
  message->bytes[0] = (uint8_t)((message->bytes[0] & 0xF0u) | ((uint32_t)bits & 0x0Fu));
}
// Torque. In %. [table 9]
static inline uint8_t whole_EEC1_Torque_raw(const whole_EEC1* message) {
  const uint32_t bits = (uint32_t)message->bytes[1];
  return (uint8_t)bits;
}
static inline void whole_EEC1_set_Torque_raw(whole_EEC1* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[1] = (uint8_t)((uint32_t)bits & 0xFFu);
}
static inline double whole_EEC1_Torque(const whole_EEC1* message) {
  return (double)whole_EEC1_Torque_raw(message) - 125.0;
}
static inline void whole_EEC1_set_Torque(whole_EEC1* message, double value) {
  whole_EEC1_set_Torque_raw(message, (uint8_t)whole_nearest(value + 125.0, 0, 255));
}

// Call. 3 bytes, parameter group 0x0EA00.
#define WHOLE_CALL_ID 0x0CEA0103u
#define WHOLE_CALL_EXTENDED 1
#define WHOLE_CALL_LENGTH 3u
#define WHOLE_CALL_FD 0
typedef struct whole_Call { uint8_t bytes[8]; } whole_Call;
// Each field at its start value, all other bits zero.
static inline void whole_Call_init(whole_Call* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int whole_Call_is(uint32_t id, int extended) {
  return extended && (id & 0x03FF0000u) == 0x00EA0000u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Call_decode(whole_Call* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 3u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 3u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Group.
static inline uint32_t whole_Call_Group(const whole_Call* message) {
  const uint32_t bits =
    (uint32_t)message->bytes[0] |
    ((uint32_t)message->bytes[1] << 8) |
    ((uint32_t)message->bytes[2] << 16);
  return (uint32_t)bits;
}
static inline void whole_Call_set_Group(whole_Call* message, uint32_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x00FFFFFFu);
  message->bytes[0] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[1] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[2] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
}

// Long. 39 bytes, parameter group 0x0FEE3, every 5000 ms.
#define WHOLE_LONG_ID 0x18FEE3FEu
#define WHOLE_LONG_EXTENDED 1
#define WHOLE_LONG_LENGTH 39u
#define WHOLE_LONG_FD 0
#define WHOLE_LONG_PERIOD_US 5000000u
typedef struct whole_Long { uint8_t bytes[39]; } whole_Long;
// Each field at its start value, all other bits zero.
static inline void whole_Long_init(whole_Long* message) {
  unsigned i;
  for (i = 0; i < 39u; ++i) message->bytes[i] = 0;
}
static inline int whole_Long_is(uint32_t id, int extended) {
  return extended && (id & 0x03FFFF00u) == 0x00FEE300u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Long_decode(whole_Long* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 39u) return 0;
  for (i = 0; i < 39u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Curve. In Nm.
static inline int64_t whole_Long_Curve_raw(const whole_Long* message) {
  const uint64_t bits =
    (uint64_t)message->bytes[34] |
    ((uint64_t)message->bytes[33] << 8) |
    ((uint64_t)message->bytes[32] << 16) |
    ((uint64_t)message->bytes[31] << 24) |
    ((uint64_t)message->bytes[30] << 32);
  return (int64_t)((bits ^ UINT64_C(0x0000008000000000)) - UINT64_C(0x0000008000000000));
}
static inline void whole_Long_set_Curve_raw(whole_Long* message, int64_t value) {
  const uint64_t bits = (uint64_t)whole_held_i64(value, INT64_C(-549755813888), INT64_C(549755813887));
  message->bytes[34] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[33] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[32] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[31] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
  message->bytes[30] = (uint8_t)((uint32_t)(bits >> 32) & 0xFFu);
}
static inline double whole_Long_Curve(const whole_Long* message) {
  return (double)whole_Long_Curve_raw(message) * -1.0 / 100.0;
}
static inline void whole_Long_set_Curve(whole_Long* message, double value) {
  whole_Long_set_Curve_raw(message, (int64_t)whole_nearest(value * 100.0 / -1.0, INT64_C(-549755813888), INT64_C(549755813887)));
}
// Step.
static inline int8_t whole_Long_Step(const whole_Long* message) {
  const uint32_t bits = ((uint32_t)message->bytes[38] & 0x01u);
  return (int8_t)((bits ^ 0x01u) - 0x01u);
}
static inline void whole_Long_set_Step(whole_Long* message, int8_t value) {
  const uint32_t bits = (uint32_t)whole_held_i32(value, -1, 0);
  message->bytes[38] = (uint8_t)((message->bytes[38] & 0xFEu) | ((uint32_t)bits & 0x01u));
}

// Nine_bytes. 9 bytes, parameter group 0x0FEE4, every 1000 ms.
#define WHOLE_NINE_BYTES_ID 0x18FEE4FEu
#define WHOLE_NINE_BYTES_EXTENDED 1
#define WHOLE_NINE_BYTES_LENGTH 9u
#define WHOLE_NINE_BYTES_FD 0
#define WHOLE_NINE_BYTES_PERIOD_US 1000000u
typedef struct whole_Nine_bytes { uint8_t bytes[9]; } whole_Nine_bytes;
// Each field at its start value, all other bits zero.
static inline void whole_Nine_bytes_init(whole_Nine_bytes* message) {
  unsigned i;
  for (i = 0; i < 9u; ++i) message->bytes[i] = 0;
}
static inline int whole_Nine_bytes_is(uint32_t id, int extended) {
  return extended && (id & 0x03FFFF00u) == 0x00FEE400u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Nine_bytes_decode(whole_Nine_bytes* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 9u) return 0;
  for (i = 0; i < 9u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Ninth. In V.
static inline uint8_t whole_Nine_bytes_Ninth(const whole_Nine_bytes* message) {
  const uint32_t bits = (uint32_t)message->bytes[8];
  return (uint8_t)bits;
}
static inline void whole_Nine_bytes_set_Ninth(whole_Nine_bytes* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[8] = (uint8_t)((uint32_t)bits & 0xFFu);
}

// Service. 64 bytes of CAN FD, identifier 0x7DF, every 1.5 ms.
#define WHOLE_SERVICE_ID 0x7DFu
#define WHOLE_SERVICE_EXTENDED 0
#define WHOLE_SERVICE_LENGTH 64u
#define WHOLE_SERVICE_FD 1
#define WHOLE_SERVICE_PERIOD_US 1500u
typedef struct whole_Service { uint8_t bytes[64]; } whole_Service;
#define WHOLE_SERVICE_SUB_MODE 0
#define WHOLE_SERVICE_SUB_X 1
#define WHOLE_SERVICE_LAMPS_LEFT 0x01u
#define WHOLE_SERVICE_LAMPS_RIGHT 0x8000u
#define WHOLE_SERVICE_ANGLE_LOST (-1)
#define WHOLE_SERVICE_ANGLE_LOST_ 3
#define WHOLE_SERVICE_ANGLE_LEAST (INT64_MIN)
#define WHOLE_SERVICE_SERIAL_ALL UINT64_C(0xFFFFFFFFFFFFFFFF)
#define WHOLE_SERVICE_SERIAL_ONE UINT64_C(0x01)
// Each field at its start value, all other bits zero.
static inline void whole_Service_init(whole_Service* message) {
  unsigned i;
  for (i = 0; i < 64u; ++i) message->bytes[i] = 0;
  message->bytes[0] = 0x04u;
  message->bytes[3] = 0xC0u;
  message->bytes[4] = 0x3Fu;
  message->bytes[32] = 0x9Au;
  message->bytes[33] = 0x99u;
  message->bytes[34] = 0x99u;
  message->bytes[35] = 0x99u;
  message->bytes[36] = 0x99u;
  message->bytes[37] = 0x99u;
  message->bytes[38] = 0xB9u;
  message->bytes[39] = 0xBFu;
}
static inline int whole_Service_is(uint32_t id, int extended) {
  return !extended && id == 0x7DFu;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Service_decode(whole_Service* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 64u) return 0;
  for (i = 0; i < 64u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Mode.
static inline int8_t whole_Service_Mode(const whole_Service* message) {
  const uint32_t bits = (uint32_t)message->bytes[0];
  return (int8_t)((bits ^ 0x80u) - 0x80u);
}
static inline void whole_Service_set_Mode(whole_Service* message, int8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[0] = (uint8_t)((uint32_t)bits & 0xFFu);
}
// Angle.
static inline int64_t whole_Service_Angle(const whole_Service* message) {
  const uint64_t bits =
    (uint64_t)message->bytes[23] |
    ((uint64_t)message->bytes[22] << 8) |
    ((uint64_t)message->bytes[21] << 16) |
    ((uint64_t)message->bytes[20] << 24) |
    ((uint64_t)message->bytes[19] << 32) |
    ((uint64_t)message->bytes[18] << 40) |
    ((uint64_t)message->bytes[17] << 48) |
    ((uint64_t)message->bytes[16] << 56);
  return (int64_t)bits;
}
static inline void whole_Service_set_Angle(whole_Service* message, int64_t value) {
  const uint64_t bits = (uint64_t)value;
  message->bytes[23] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[22] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[21] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[20] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
  message->bytes[19] = (uint8_t)((uint32_t)(bits >> 32) & 0xFFu);
  message->bytes[18] = (uint8_t)((uint32_t)(bits >> 40) & 0xFFu);
  message->bytes[17] = (uint8_t)((uint32_t)(bits >> 48) & 0xFFu);
  message->bytes[16] = (uint8_t)((uint32_t)(bits >> 56) & 0xFFu);
}
// Serial.
static inline uint64_t whole_Service_Serial(const whole_Service* message) {
  const uint64_t bits =
    (uint64_t)message->bytes[24] |
    ((uint64_t)message->bytes[25] << 8) |
    ((uint64_t)message->bytes[26] << 16) |
    ((uint64_t)message->bytes[27] << 24) |
    ((uint64_t)message->bytes[28] << 32) |
    ((uint64_t)message->bytes[29] << 40) |
    ((uint64_t)message->bytes[30] << 48) |
    ((uint64_t)message->bytes[31] << 56);
  return (uint64_t)bits;
}
static inline void whole_Service_set_Serial(whole_Service* message, uint64_t value) {
  const uint64_t bits = (uint64_t)value;
  message->bytes[24] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[25] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[26] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[27] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
  message->bytes[28] = (uint8_t)((uint32_t)(bits >> 32) & 0xFFu);
  message->bytes[29] = (uint8_t)((uint32_t)(bits >> 40) & 0xFFu);
  message->bytes[30] = (uint8_t)((uint32_t)(bits >> 48) & 0xFFu);
  message->bytes[31] = (uint8_t)((uint32_t)(bits >> 56) & 0xFFu);
}
// Exact.
static inline uint64_t whole_Service_Exact_raw(const whole_Service* message) {
  const uint64_t bits =
    (uint64_t)message->bytes[32] |
    ((uint64_t)message->bytes[33] << 8) |
    ((uint64_t)message->bytes[34] << 16) |
    ((uint64_t)message->bytes[35] << 24) |
    ((uint64_t)message->bytes[36] << 32) |
    ((uint64_t)message->bytes[37] << 40) |
    ((uint64_t)message->bytes[38] << 48) |
    ((uint64_t)message->bytes[39] << 56);
  return (uint64_t)bits;
}
static inline void whole_Service_set_Exact_raw(whole_Service* message, uint64_t value) {
  const uint64_t bits = (uint64_t)value;
  message->bytes[32] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[33] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[34] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[35] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
  message->bytes[36] = (uint8_t)((uint32_t)(bits >> 32) & 0xFFu);
  message->bytes[37] = (uint8_t)((uint32_t)(bits >> 40) & 0xFFu);
  message->bytes[38] = (uint8_t)((uint32_t)(bits >> 48) & 0xFFu);
  message->bytes[39] = (uint8_t)((uint32_t)(bits >> 56) & 0xFFu);
}
static inline double whole_Service_Exact(const whole_Service* message) {
  return whole_double_of(whole_Service_Exact_raw(message));
}
static inline void whole_Service_set_Exact(whole_Service* message, double value) {
  whole_Service_set_Exact_raw(message, whole_bits_of_double(value));
}
// Scaled. In m.
static inline uint64_t whole_Service_Scaled_raw(const whole_Service* message) {
  const uint64_t bits =
    (uint64_t)message->bytes[40] |
    ((uint64_t)message->bytes[41] << 8) |
    ((uint64_t)message->bytes[42] << 16) |
    ((uint64_t)message->bytes[43] << 24) |
    ((uint64_t)message->bytes[44] << 32) |
    ((uint64_t)message->bytes[45] << 40) |
    ((uint64_t)message->bytes[46] << 48) |
    ((uint64_t)message->bytes[47] << 56);
  return (uint64_t)bits;
}
static inline void whole_Service_set_Scaled_raw(whole_Service* message, uint64_t value) {
  const uint64_t bits = (uint64_t)value;
  message->bytes[40] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[41] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[42] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[43] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
  message->bytes[44] = (uint8_t)((uint32_t)(bits >> 32) & 0xFFu);
  message->bytes[45] = (uint8_t)((uint32_t)(bits >> 40) & 0xFFu);
  message->bytes[46] = (uint8_t)((uint32_t)(bits >> 48) & 0xFFu);
  message->bytes[47] = (uint8_t)((uint32_t)(bits >> 56) & 0xFFu);
}
static inline double whole_Service_Scaled(const whole_Service* message) {
  return whole_double_of(whole_Service_Scaled_raw(message)) / 2.0;
}
static inline void whole_Service_set_Scaled(whole_Service* message, double value) {
  whole_Service_set_Scaled_raw(message, whole_bits_of_double(value * 2.0));
}
// Plain. In A.
static inline uint32_t whole_Service_Plain_raw(const whole_Service* message) {
  const uint32_t bits =
    (uint32_t)message->bytes[48] |
    ((uint32_t)message->bytes[49] << 8) |
    ((uint32_t)message->bytes[50] << 16) |
    ((uint32_t)message->bytes[51] << 24);
  return (uint32_t)bits;
}
static inline void whole_Service_set_Plain_raw(whole_Service* message, uint32_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[48] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[49] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[50] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[51] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
}
static inline float whole_Service_Plain(const whole_Service* message) {
  return whole_float_of(whole_Service_Plain_raw(message));
}
static inline void whole_Service_set_Plain(whole_Service* message, float value) {
  whole_Service_set_Plain_raw(message, whole_bits_of_float(value));
}
// Scaled64. In bit.
static inline uint64_t whole_Service_Scaled64_raw(const whole_Service* message) {
  const uint64_t bits =
    (uint64_t)message->bytes[52] |
    ((uint64_t)message->bytes[53] << 8) |
    ((uint64_t)message->bytes[54] << 16) |
    ((uint64_t)message->bytes[55] << 24) |
    ((uint64_t)message->bytes[56] << 32) |
    ((uint64_t)message->bytes[57] << 40) |
    ((uint64_t)message->bytes[58] << 48) |
    ((uint64_t)message->bytes[59] << 56);
  return (uint64_t)bits;
}
static inline void whole_Service_set_Scaled64_raw(whole_Service* message, uint64_t value) {
  const uint64_t bits = (uint64_t)value;
  message->bytes[52] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[53] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[54] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[55] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
  message->bytes[56] = (uint8_t)((uint32_t)(bits >> 32) & 0xFFu);
  message->bytes[57] = (uint8_t)((uint32_t)(bits >> 40) & 0xFFu);
  message->bytes[58] = (uint8_t)((uint32_t)(bits >> 48) & 0xFFu);
  message->bytes[59] = (uint8_t)((uint32_t)(bits >> 56) & 0xFFu);
}
static inline double whole_Service_Scaled64(const whole_Service* message) {
  return (double)whole_Service_Scaled64_raw(message) / 2.0;
}
static inline void whole_Service_set_Scaled64(whole_Service* message, double value) {
  whole_Service_set_Scaled64_raw(message, whole_nearest_u64(value * 2.0));
}
// Load. In kW. Stated range: 0 to 10.
static inline int whole_Service_has_Load(const whole_Service* message) {
  uint32_t bits;
  bits = (uint32_t)message->bytes[0];
  return bits == 0x01u || (bits >= 0x04u && bits <= 0x09u);
}
static inline uint32_t whole_Service_Load_raw(const whole_Service* message) {
  const uint32_t bits =
    (uint32_t)message->bytes[1] |
    ((uint32_t)message->bytes[2] << 8) |
    ((uint32_t)message->bytes[3] << 16) |
    ((uint32_t)message->bytes[4] << 24);
  return (uint32_t)bits;
}
static inline void whole_Service_set_Load_raw(whole_Service* message, uint32_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[1] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[2] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[3] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[4] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
}
static inline int whole_Service_Load(const whole_Service* message, double* value) {
  if (!whole_Service_has_Load(message)) return 0;
  *value = (double)whole_float_of(whole_Service_Load_raw(message)) * 2.0 + 1.0;
  return 1;
}
static inline int whole_Service_set_Load(whole_Service* message, double value) {
  if (!whole_Service_has_Load(message)) return 0;
  whole_Service_set_Load_raw(message, whole_bits_of_float((float)((value - 1.0) / 2.0)));
  return 1;
}
// Sub.
static inline int whole_Service_has_Sub(const whole_Service* message) {
  uint32_t bits;
  bits = (uint32_t)message->bytes[0];
  return bits == 0x00u || bits >= 0xFAu;
}
static inline int whole_Service_Sub(const whole_Service* message, uint8_t* value) {
  uint32_t bits;
  if (!whole_Service_has_Sub(message)) return 0;
  bits = ((uint32_t)message->bytes[5] & 0x03u);
  *value = (uint8_t)bits;
  return 1;
}
static inline int whole_Service_set_Sub(whole_Service* message, uint8_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x03u);
  if (!whole_Service_has_Sub(message)) return 0;
  message->bytes[5] = (uint8_t)((message->bytes[5] & 0xFCu) | ((uint32_t)bits & 0x03u));
  return 1;
}
// Rare. In h.
static inline int whole_Service_has_Rare(const whole_Service* message) {
  uint32_t bits;
  bits = (uint32_t)message->bytes[0];
  return bits == 0x03u;
}
static inline uint8_t whole_Service_Rare_raw(const whole_Service* message) {
  const uint32_t bits = (uint32_t)message->bytes[9];
  return (uint8_t)bits;
}
static inline void whole_Service_set_Rare_raw(whole_Service* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[9] = (uint8_t)((uint32_t)bits & 0xFFu);
}
static inline int whole_Service_Rare(const whole_Service* message, double* value) {
  if (!whole_Service_has_Rare(message)) return 0;
  *value = (double)whole_Service_Rare_raw(message) / 2.0;
  return 1;
}
static inline int whole_Service_set_Rare(whole_Service* message, double value) {
  if (!whole_Service_has_Rare(message)) return 0;
  whole_Service_set_Rare_raw(message, (uint8_t)whole_nearest(value * 2.0, 0, 255));
  return 1;
}
// Lamps: what shines.
static inline int whole_Service_has_Lamps(const whole_Service* message) {
  uint32_t bits;
  bits = (uint32_t)message->bytes[0];
  return bits == 0x02u;
}
static inline int whole_Service_Lamps(const whole_Service* message, uint16_t* value) {
  uint32_t bits;
  if (!whole_Service_has_Lamps(message)) return 0;
  bits = (uint32_t)message->bytes[10] | ((uint32_t)message->bytes[11] << 8);
  *value = (uint16_t)bits;
  return 1;
}
static inline int whole_Service_set_Lamps(whole_Service* message, uint16_t value) {
  const uint32_t bits = (uint32_t)value;
  if (!whole_Service_has_Lamps(message)) return 0;
  message->bytes[10] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[11] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  return 1;
}
// Deep.
static inline int whole_Service_has_Deep(const whole_Service* message) {
  uint32_t bits;
  if (!whole_Service_has_Sub(message)) return 0;
  bits = ((uint32_t)message->bytes[5] & 0x03u);
  return bits >= 0x02u;
}
static inline int whole_Service_Deep(const whole_Service* message, uint16_t* value) {
  uint32_t bits;
  if (!whole_Service_has_Deep(message)) return 0;
  bits = (((uint32_t)message->bytes[6] >> 2) & 0x3Fu) | (((uint32_t)message->bytes[7] & 0x7Fu) << 6);
  *value = (uint16_t)bits;
  return 1;
}
static inline int whole_Service_set_Deep(whole_Service* message, uint16_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x1FFFu);
  if (!whole_Service_has_Deep(message)) return 0;
  message->bytes[6] = (uint8_t)((message->bytes[6] & 0x03u) | (((uint32_t)bits & 0x3Fu) << 2));
  message->bytes[7] = (uint8_t)((message->bytes[7] & 0x80u) | ((uint32_t)(bits >> 6) & 0x7Fu));
  return 1;
}
// Always.
static inline int whole_Service_has_Always(const whole_Service* message) {
  if (!whole_Service_has_Sub(message)) return 0;
  return 1;
}
static inline int whole_Service_Always(const whole_Service* message, uint8_t* value) {
  uint32_t bits;
  if (!whole_Service_has_Always(message)) return 0;
  bits = (uint32_t)message->bytes[8];
  *value = (uint8_t)bits;
  return 1;
}
static inline int whole_Service_set_Always(whole_Service* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  if (!whole_Service_has_Always(message)) return 0;
  message->bytes[8] = (uint8_t)((uint32_t)bits & 0xFFu);
  return 1;
}

// int. ends in a backslash/ 5 bytes, identifier 0x18FEF100.
#define WHOLE_INT_ID 0x18FEF100u
#define WHOLE_INT_EXTENDED 1
#define WHOLE_INT_LENGTH 5u
#define WHOLE_INT_FD 0
typedef struct whole_int_ { uint8_t bytes[8]; } whole_int_;
// Each field at its start value, all other bits zero.
static inline void whole_int_init(whole_int_* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int whole_int_is(uint32_t id, int extended) {
  return extended && id == 0x18FEF100u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_int_decode(whole_int_* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 5u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 5u; ++i) message->bytes[i] = data[i];
  return 1;
}
// NULL.
static inline uint16_t whole_int_NULL_(const whole_int_* message) {
  const uint32_t bits = (((uint32_t)message->bytes[1] >> 4) & 0x0Fu) | ((uint32_t)message->bytes[0] << 4);
  return (uint16_t)bits;
}
static inline void whole_int_set_NULL_(whole_int_* message, uint16_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x0FFFu);
  message->bytes[1] = (uint8_t)((message->bytes[1] & 0x0Fu) | (((uint32_t)bits & 0x0Fu) << 4));
  message->bytes[0] = (uint8_t)((uint32_t)(bits >> 4) & 0xFFu);
}
// a.b. Stated range: 0 to 0.
static inline uint16_t whole_int_a_b(const whole_int_* message) {
  const uint32_t bits = (uint32_t)message->bytes[2] | (((uint32_t)message->bytes[1] & 0x0Fu) << 8);
  return (uint16_t)bits;
}
static inline void whole_int_set_a_b(whole_int_* message, uint16_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x0FFFu);
  message->bytes[2] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[1] = (uint8_t)((message->bytes[1] & 0xF0u) | ((uint32_t)(bits >> 8) & 0x0Fu));
}
// a-b. In 1/.
static inline uint16_t whole_int_a_b_2(const whole_int_* message) {
  const uint32_t bits = (uint32_t)message->bytes[4] | ((uint32_t)message->bytes[3] << 8);
  return (uint16_t)bits;
}
static inline void whole_int_set_a_b_2(whole_int_* message, uint16_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[4] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[3] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
}

// 2nd_message_of_a_long_name_for_DBC. 1 byte, identifier 0x002. Beyond its length, and not here: Later.
#define WHOLE_N2ND_MESSAGE_OF_A_LONG_NAME_FOR_DBC_ID 0x002u
#define WHOLE_N2ND_MESSAGE_OF_A_LONG_NAME_FOR_DBC_EXTENDED 0
#define WHOLE_N2ND_MESSAGE_OF_A_LONG_NAME_FOR_DBC_LENGTH 1u
#define WHOLE_N2ND_MESSAGE_OF_A_LONG_NAME_FOR_DBC_FD 0
typedef struct whole_n2nd_message_of_a_long_name_for_DBC { uint8_t bytes[8]; } whole_n2nd_message_of_a_long_name_for_DBC;
#define WHOLE_N2ND_MESSAGE_OF_A_LONG_NAME_FOR_DBC_BIT_SET_ 0x01u
// Each field at its start value, all other bits zero.
static inline void whole_n2nd_message_of_a_long_name_for_DBC_init(whole_n2nd_message_of_a_long_name_for_DBC* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int whole_n2nd_message_of_a_long_name_for_DBC_is(uint32_t id, int extended) {
  return !extended && id == 0x002u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_n2nd_message_of_a_long_name_for_DBC_decode(whole_n2nd_message_of_a_long_name_for_DBC* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 1u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 1u; ++i) message->bytes[i] = data[i];
  return 1;
}
// a_signal_that_has_a_name_longer_than_32_characters. In |<_*.
static inline uint8_t whole_n2nd_message_of_a_long_name_for_DBC_a_signal_that_has_a_name_longer_than_32_characters(const whole_n2nd_message_of_a_long_name_for_DBC* message) {
  const uint32_t bits = ((uint32_t)message->bytes[0] & 0x07u);
  return (uint8_t)bits;
}
static inline void whole_n2nd_message_of_a_long_name_for_DBC_set_a_signal_that_has_a_name_longer_than_32_characters(whole_n2nd_message_of_a_long_name_for_DBC* message, uint8_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x07u);
  message->bytes[0] = (uint8_t)((message->bytes[0] & 0xF8u) | ((uint32_t)bits & 0x07u));
}
// Bit.
static inline uint8_t whole_n2nd_message_of_a_long_name_for_DBC_Bit(const whole_n2nd_message_of_a_long_name_for_DBC* message) {
  const uint32_t bits = (((uint32_t)message->bytes[0] >> 7) & 0x01u);
  return (uint8_t)bits;
}
static inline void whole_n2nd_message_of_a_long_name_for_DBC_set_Bit(whole_n2nd_message_of_a_long_name_for_DBC* message, uint8_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x01u);
  message->bytes[0] = (uint8_t)((message->bytes[0] & 0x7Fu) | (((uint32_t)bits & 0x01u) << 7));
}

// Simple. 3 bytes, identifier 0x101.
#define WHOLE_SIMPLE_ID 0x101u
#define WHOLE_SIMPLE_EXTENDED 0
#define WHOLE_SIMPLE_LENGTH 3u
#define WHOLE_SIMPLE_FD 0
typedef struct whole_Simple { uint8_t bytes[8]; } whole_Simple;
// Each field at its start value, all other bits zero.
static inline void whole_Simple_init(whole_Simple* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int whole_Simple_is(uint32_t id, int extended) {
  return !extended && id == 0x101u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Simple_decode(whole_Simple* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 3u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 3u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Page.
static inline uint8_t whole_Simple_Page(const whole_Simple* message) {
  const uint32_t bits = (uint32_t)message->bytes[0];
  return (uint8_t)bits;
}
static inline void whole_Simple_set_Page(whole_Simple* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[0] = (uint8_t)((uint32_t)bits & 0xFFu);
}
// First.
static inline int whole_Simple_has_First(const whole_Simple* message) {
  uint32_t bits;
  bits = (uint32_t)message->bytes[0];
  return bits == 0x00u;
}
static inline int whole_Simple_First(const whole_Simple* message, int16_t* value) {
  uint32_t bits;
  if (!whole_Simple_has_First(message)) return 0;
  bits = (uint32_t)message->bytes[1] | ((uint32_t)message->bytes[2] << 8);
  *value = (int16_t)((bits ^ 0x8000u) - 0x8000u);
  return 1;
}
static inline int whole_Simple_set_First(whole_Simple* message, int16_t value) {
  const uint32_t bits = (uint32_t)value;
  if (!whole_Simple_has_First(message)) return 0;
  message->bytes[1] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[2] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  return 1;
}
// Second.
static inline int whole_Simple_has_Second(const whole_Simple* message) {
  uint32_t bits;
  bits = (uint32_t)message->bytes[0];
  return bits == 0x01u;
}
static inline uint16_t whole_Simple_Second_raw(const whole_Simple* message) {
  const uint32_t bits = (uint32_t)message->bytes[2] | ((uint32_t)message->bytes[1] << 8);
  return (uint16_t)bits;
}
static inline void whole_Simple_set_Second_raw(whole_Simple* message, uint16_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[2] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[1] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
}
static inline int whole_Simple_Second(const whole_Simple* message, double* value) {
  if (!whole_Simple_has_Second(message)) return 0;
  *value = (double)whole_Simple_Second_raw(message) * 10.0 + 5.0;
  return 1;
}
static inline int whole_Simple_set_Second(whole_Simple* message, double value) {
  if (!whole_Simple_has_Second(message)) return 0;
  whole_Simple_set_Second_raw(message, (uint16_t)whole_nearest((value - 5.0) / 10.0, 0, 65535));
  return 1;
}

// Two_pages. 3 bytes, identifier 0x102.
#define WHOLE_TWO_PAGES_ID 0x102u
#define WHOLE_TWO_PAGES_EXTENDED 0
#define WHOLE_TWO_PAGES_LENGTH 3u
#define WHOLE_TWO_PAGES_FD 0
typedef struct whole_Two_pages { uint8_t bytes[8]; } whole_Two_pages;
// Each field at its start value, all other bits zero.
static inline void whole_Two_pages_init(whole_Two_pages* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int whole_Two_pages_is(uint32_t id, int extended) {
  return !extended && id == 0x102u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Two_pages_decode(whole_Two_pages* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 3u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 3u; ++i) message->bytes[i] = data[i];
  return 1;
}
// Page.
static inline uint8_t whole_Two_pages_Page(const whole_Two_pages* message) {
  const uint32_t bits = ((uint32_t)message->bytes[0] & 0x0Fu);
  return (uint8_t)bits;
}
static inline void whole_Two_pages_set_Page(whole_Two_pages* message, uint8_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x0Fu);
  message->bytes[0] = (uint8_t)((message->bytes[0] & 0xF0u) | ((uint32_t)bits & 0x0Fu));
}
// Other.
static inline uint8_t whole_Two_pages_Other(const whole_Two_pages* message) {
  const uint32_t bits = (((uint32_t)message->bytes[0] >> 4) & 0x0Fu);
  return (uint8_t)bits;
}
static inline void whole_Two_pages_set_Other(whole_Two_pages* message, uint8_t value) {
  const uint32_t bits = (uint32_t)whole_at_most_u32(value, 0x0Fu);
  message->bytes[0] = (uint8_t)((message->bytes[0] & 0x0Fu) | (((uint32_t)bits & 0x0Fu) << 4));
}
// First.
static inline int whole_Two_pages_has_First(const whole_Two_pages* message) {
  uint32_t bits;
  bits = ((uint32_t)message->bytes[0] & 0x0Fu);
  return bits == 0x00u;
}
static inline int whole_Two_pages_First(const whole_Two_pages* message, uint8_t* value) {
  uint32_t bits;
  if (!whole_Two_pages_has_First(message)) return 0;
  bits = (uint32_t)message->bytes[1];
  *value = (uint8_t)bits;
  return 1;
}
static inline int whole_Two_pages_set_First(whole_Two_pages* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  if (!whole_Two_pages_has_First(message)) return 0;
  message->bytes[1] = (uint8_t)((uint32_t)bits & 0xFFu);
  return 1;
}
// Second.
static inline int whole_Two_pages_has_Second(const whole_Two_pages* message) {
  uint32_t bits;
  bits = (((uint32_t)message->bytes[0] >> 4) & 0x0Fu);
  return bits == 0x0Fu;
}
static inline int whole_Two_pages_Second(const whole_Two_pages* message, uint8_t* value) {
  uint32_t bits;
  if (!whole_Two_pages_has_Second(message)) return 0;
  bits = (uint32_t)message->bytes[2];
  *value = (uint8_t)bits;
  return 1;
}
static inline int whole_Two_pages_set_Second(whole_Two_pages* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  if (!whole_Two_pages_has_Second(message)) return 0;
  message->bytes[2] = (uint8_t)((uint32_t)bits & 0xFFu);
  return 1;
}

// Nothing. 0 bytes, identifier 0x000.
#define WHOLE_NOTHING_ID 0x000u
#define WHOLE_NOTHING_EXTENDED 0
#define WHOLE_NOTHING_LENGTH 0u
#define WHOLE_NOTHING_FD 0
typedef struct whole_Nothing { uint8_t bytes[8]; } whole_Nothing;
// Each field at its start value, all other bits zero.
static inline void whole_Nothing_init(whole_Nothing* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int whole_Nothing_is(uint32_t id, int extended) {
  return !extended && id == 0x000u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int whole_Nothing_decode(whole_Nothing* message, const uint8_t* data, unsigned length) {
  unsigned i;
  (void)length;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  (void)data;
  return 1;
}

#ifdef __cplusplus
}
#endif

#endif
