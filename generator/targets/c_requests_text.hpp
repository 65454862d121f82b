/// The part of a C header that is the same for every robot: identifiers with priority, and requests. @ is the
/// prefix of its functions, $ that of its macros.
#pragma once

#include <string_view>

namespace ocm::generate {

/// For `named`.
inline constexpr std::string_view c_request_part = R"(// --- identifiers and requests

typedef struct @_frame {
  uint16_t id;  // 11 bits
  uint8_t dlc;
  uint8_t data[8];
} @_frame;

typedef enum @_priority { $_URGENT = 0, $_HIGH = 1, $_MEDIUM = 2, $_LOW = 3 } @_priority;
typedef enum @_mode { $_STOP = 0, $_PUBLISH = 1, $_ONCE = 2 } @_mode;
typedef enum @_unit { $_MILLISECONDS = 0, $_SECONDS = 1, $_MICROSECONDS = 2 } @_unit;

// What _take() and @_read_request() return in place of a number of 0 or more.
#define $_FOREIGN (-1)       // a frame of another topic, or no request
#define $_WRONG_LENGTH (-2)
#define $_WRONG_MODE (-3)
#define $_WRONG_UNIT (-4)
#define $_WRONG_PERIOD (-5)  // zero

// Of a request or a set point, to a board.
static inline uint16_t @_command_id(uint8_t topic, @_priority priority) {
  return (uint16_t)((((uint32_t)priority & 3u) << 8) | topic);
}
// Of samples, from a board.
static inline uint16_t @_sample_id(uint8_t topic, @_priority priority) {
  return (uint16_t)(0x400u | (((uint32_t)priority & 3u) << 8) | topic);
}
static inline int @_is_sample(uint16_t id) { return (id & 0x400u) != 0; }
static inline @_priority @_priority_of(uint16_t id) { return (@_priority)(((uint32_t)id >> 8) & 3u); }
static inline uint8_t @_topic_of(uint16_t id) { return (uint8_t)(id & 0xFFu); }

static inline @_frame @_request_of_mode(uint8_t topic, @_mode mode, @_priority priority) {
  @_frame frame = {0, 1, {0, 0, 0, 0, 0, 0, 0, 0}};
  frame.id = @_command_id(topic, priority);
  frame.data[0] = (uint8_t)mode;
  return frame;
}
static inline @_frame @_stop(uint8_t topic, @_priority priority) {
  return @_request_of_mode(topic, $_STOP, priority);
}
static inline @_frame @_once(uint8_t topic, @_priority priority) {
  return @_request_of_mode(topic, $_ONCE, priority);
}
// At the topic's own period.
static inline @_frame @_publish(uint8_t topic, @_priority priority) {
  return @_request_of_mode(topic, $_PUBLISH, priority);
}
// Every `count` units; a board refuses a count of 0.
static inline @_frame @_publish_every(uint8_t topic, uint16_t count, @_unit unit, @_priority priority) {
  @_frame frame = @_request_of_mode(topic, $_PUBLISH, priority);
  frame.dlc = 4;
  frame.data[1] = (uint8_t)(count & 0xFFu);
  frame.data[2] = (uint8_t)(count >> 8);
  frame.data[3] = (uint8_t)unit;
  return frame;
}

// For a board: what an operator asks.
typedef struct @_request {
  uint8_t topic;
  @_priority priority;  // of the samples that answer
  @_mode mode;
  uint16_t count;       // of a publish; 0: the topic's own period
  @_unit unit;
} @_request;

static inline uint64_t @_period_us(uint16_t count, @_unit unit) {
  return (uint64_t)count * (unit == $_SECONDS ? 1000000u : unit == $_MILLISECONDS ? 1000u : 1u);
}

// Reads a command frame on a sensor's topic. 0, or why it is none; then *request is as it was.
static inline int @_read_request(const @_frame* frame, @_request* request) {
  const uint32_t count = frame->data[1] | ((uint32_t)frame->data[2] << 8);
  const int has_period = frame->dlc == 4;
  if (frame->id > 0x3FFu) return $_FOREIGN;
  if (frame->dlc == 0 || frame->dlc > 8) return $_WRONG_LENGTH;
  if (frame->data[0] > 2) return $_WRONG_MODE;
  if (frame->dlc != 1 && !(has_period && frame->data[0] == 1)) return $_WRONG_LENGTH;
  if (has_period && frame->data[3] > 2) return $_WRONG_UNIT;
  if (has_period && count == 0) return $_WRONG_PERIOD;
  request->topic = @_topic_of(frame->id);
  request->priority = @_priority_of(frame->id);
  request->mode = (@_mode)frame->data[0];
  request->count = (uint16_t)(has_period ? count : 0u);
  request->unit = has_period ? (@_unit)frame->data[3] : $_MILLISECONDS;
  return 0;
}

)";

}  // namespace ocm::generate
