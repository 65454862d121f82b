// Made by ocm-generate from small.json. Do not edit: change the spec, and generate again.
//
// The messages of 1st: a bus that says little.
//
// For C99 and C++11. No other file is needed, nothing is to be linked, and there is no heap.
//
// A struct of a message holds its bytes. _decode() takes those of a frame, if they are enough. _x() is the
// physical value of field x, and _set_x() puts the nearest that the width holds; _x_raw() and _set_x_raw()
// are the number as it travels, where it is another. Where _has_x() is 0 a multiplexed field is not there:
// _x() and _set_x() are 0 then, and change nothing. _init() puts start values.
#ifndef N1ST_MESSAGES_H
#define N1ST_MESSAGES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

// Bits per second on the bus.
#define N1ST_BIT_RATE 125000u

// One. 4 bytes, identifier 0x001, every 10 ms.
#define N1ST_ONE_ID 0x001u
#define N1ST_ONE_EXTENDED 0
#define N1ST_ONE_LENGTH 4u
#define N1ST_ONE_FD 0
#define N1ST_ONE_PERIOD_US 10000u
typedef struct n1st_One { uint8_t bytes[8]; } n1st_One;
// Each field at its start value, all other bits zero.
static inline void n1st_One_init(n1st_One* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  message->bytes[2] = 0x07u;
}
static inline int n1st_One_is(uint32_t id, int extended) {
  return !extended && id == 0x001u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int n1st_One_decode(n1st_One* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 4u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 4u; ++i) message->bytes[i] = data[i];
  return 1;
}
// a.
static inline uint16_t n1st_One_a(const n1st_One* message) {
  const uint32_t bits = (uint32_t)message->bytes[1] | ((uint32_t)message->bytes[0] << 8);
  return (uint16_t)bits;
}
static inline void n1st_One_set_a(n1st_One* message, uint16_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[1] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[0] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
}
// b.
static inline uint8_t n1st_One_b(const n1st_One* message) {
  const uint32_t bits = (uint32_t)message->bytes[2];
  return (uint8_t)bits;
}
static inline void n1st_One_set_b(n1st_One* message, uint8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[2] = (uint8_t)((uint32_t)bits & 0xFFu);
}
// c.
static inline int8_t n1st_One_c(const n1st_One* message) {
  const uint32_t bits = (uint32_t)message->bytes[3];
  return (int8_t)((bits ^ 0x80u) - 0x80u);
}
static inline void n1st_One_set_c(n1st_One* message, int8_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[3] = (uint8_t)((uint32_t)bits & 0xFFu);
}

// one. 4 bytes, identifier 0x7FF, every 1000 ms.
#define N1ST_ONE_ID_ 0x7FFu
#define N1ST_ONE_EXTENDED_ 0
#define N1ST_ONE_LENGTH_ 4u
#define N1ST_ONE_FD_ 0
#define N1ST_ONE_PERIOD_US_ 1000000u
typedef struct n1st_one { uint8_t bytes[8]; } n1st_one;
// Each field at its start value, all other bits zero.
static inline void n1st_one_init(n1st_one* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  message->bytes[0] = 0xFFu;
  message->bytes[1] = 0xFFu;
  message->bytes[2] = 0xFFu;
  message->bytes[3] = 0xFFu;
}
static inline int n1st_one_is(uint32_t id, int extended) {
  return !extended && id == 0x7FFu;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int n1st_one_decode(n1st_one* message, const uint8_t* data, unsigned length) {
  unsigned i;
  if (length < 4u) return 0;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
  for (i = 0; i < 4u; ++i) message->bytes[i] = data[i];
  return 1;
}
// One.
static inline int32_t n1st_one_One(const n1st_one* message) {
  const uint32_t bits =
    (uint32_t)message->bytes[3] |
    ((uint32_t)message->bytes[2] << 8) |
    ((uint32_t)message->bytes[1] << 16) |
    ((uint32_t)message->bytes[0] << 24);
  return (int32_t)bits;
}
static inline void n1st_one_set_One(n1st_one* message, int32_t value) {
  const uint32_t bits = (uint32_t)value;
  message->bytes[3] = (uint8_t)((uint32_t)bits & 0xFFu);
  message->bytes[2] = (uint8_t)((uint32_t)(bits >> 8) & 0xFFu);
  message->bytes[1] = (uint8_t)((uint32_t)(bits >> 16) & 0xFFu);
  message->bytes[0] = (uint8_t)((uint32_t)(bits >> 24) & 0xFFu);
}

// ONE. 0 bytes, identifier 0x007.
#define N1ST_ONE_ID__ 0x007u
#define N1ST_ONE_EXTENDED__ 0
#define N1ST_ONE_LENGTH__ 0u
#define N1ST_ONE_FD__ 0
typedef struct n1st_ONE { uint8_t bytes[8]; } n1st_ONE;
// Each field at its start value, all other bits zero.
static inline void n1st_ONE_init(n1st_ONE* message) {
  unsigned i;
  for (i = 0; i < 8u; ++i) message->bytes[i] = 0;
}
static inline int n1st_ONE_is(uint32_t id, int extended) {
  return !extended && id == 0x007u;
}
// 0, and the struct is as it was, where it is shorter than the message.
static inline int n1st_ONE_decode(n1st_ONE* message, const uint8_t* data, unsigned length) {
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
