// DiWheelDrive's side of the protocol as one would write it in C for this board alone: tables, a switch,
// shifts. It does all that the library's controller does there, and nothing else: requests and their refusal
// by cause, seven sensors on a drift-free grid at four levels, late, missed and overrun releases counted,
// samples that wait for the bus, set points with a watchdog, rest when the bus is lost, two tasks, status and
// refusals. Same locks.
#include <limits.h>
#include <stddef.h>
#include <string.h>

#include "work.h"

enum {
  watchdog,
  task_0,
  task_1,
  odometry,
  floor_,
  magnetometer,
  gyroscope,
  accelerometer,
  status,
  refusal,
  streams
};
enum { sensors_from = odometry, sensors = streams - sensors_from };
enum { urgent, high, medium, low, levels };
enum { not_requested, stopped, periodic, single };
enum { unused, taken, held };
// As the library numbers them: they travel in the refusal.
enum { ok, bad_length = 3, bad_mode = 4, bad_unit = 5, bad_period = 6, failed = 7 };

#define MS INT64_C(1000000)
#define NEVER INT64_MAX

struct stream {
  int64_t next;
  int64_t period;
  uint32_t jitter_ns;
  uint32_t missed, late, overrun;
  uint8_t level, taken_at, state, use;
};
static struct stream table[streams];
static unsigned held_streams;
static int64_t armed = NEVER;

static struct {
  uint32_t received, foreign, requests, set_points;
  uint32_t bad_length, bad_mode, bad_unit, bad_period, not_served, failed;
  uint32_t samples, sent, not_sampled, send_failed;
  uint32_t timeouts, bus_lost;
} counters;
static uint32_t faults;
static int64_t start_time;
static struct { uint8_t topic, reason; } last_refusal;

// --- frames ---
static inline void put16(uint8_t* at, uint16_t value) {
  at[0] = (uint8_t)value;
  at[1] = (uint8_t)(value >> 8);
}
static inline void put24(uint8_t* at, uint32_t value) {
  at[0] = (uint8_t)value;
  at[1] = (uint8_t)(value >> 8);
  at[2] = (uint8_t)(value >> 16);
}
static inline void put32(uint8_t* at, uint32_t value) {
  put16(at, (uint16_t)value);
  put16(at + 2, (uint16_t)(value >> 16));
}
static inline int32_t get32(const uint8_t* at) {
  return (int32_t)(at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24);
}
static inline uint32_t within_24_bits(int32_t value) {
  return (uint32_t)(value < -0x800000 ? -0x800000 : value > 0x7FFFFF ? 0x7FFFFF : value);
}
static void encode_gyroscope(uint8_t d[8], int16_t x, int16_t y, int16_t z) {
  put16(d, (uint16_t)x);
  put16(d + 2, (uint16_t)y);
  put16(d + 4, (uint16_t)z);
  put16(d + 6, 0);
}
static void encode_odometry(uint8_t d[16], int32_t vx, int32_t vz, int32_t x, int32_t y,
                            uint16_t orientation) {
  put32(d, (uint32_t)vx);
  put32(d + 4, (uint32_t)vz);
  put24(d + 8, within_24_bits(x));
  put24(d + 11, within_24_bits(y));
  put16(d + 14, orientation);
}
static void encode_ring(uint8_t d[64], const uint16_t sensor[8]) {
  for (int i = 0; i < 8; ++i) {
    put32(d + 8 * i, sensor[i]);
    put32(d + 8 * i + 4, 0);
  }
}

// --- scheduling ---
static uint32_t skip_passed(struct stream* s, int64_t now) {
  const int64_t skipped = (now - s->next) / s->period + 1;
  s->next += skipped * s->period;
  return skipped > UINT32_MAX ? UINT32_MAX : (uint32_t)skipped;
}
static bool takeable(const struct stream* s) {
  return s->state >= periodic && s->use == unused;
}
static void arm_by(int64_t when) {
  if (when >= armed) return;
  armed = when;
  port_armed = when;
}
static void attend(struct stream* s) {
  if (!takeable(s)) return;
  if (s->next <= port_time)
    port_pended = 1U << s->level;
  else
    arm_by(s->next);
}
static void start(struct stream* s, int64_t period, uint8_t level, int64_t from, uint32_t jitter_ns) {
  const uint32_t mask = port_lock();
  s->next = from;
  s->period = period;
  s->jitter_ns = jitter_ns;
  s->level = level;
  s->state = periodic;
  attend(s);
  port_unlock(mask);
}
static void once(struct stream* s, uint8_t level, int64_t when) {
  const uint32_t mask = port_lock();
  s->next = when;
  s->jitter_ns = UINT32_MAX;
  s->level = level;
  s->state = single;
  attend(s);
  port_unlock(mask);
}
static void stop(struct stream* s) {
  const uint32_t mask = port_lock();
  s->state = stopped;
  port_unlock(mask);
}
static void expire(void) {
  const uint32_t mask = port_lock();
  unsigned due = 0;
  int64_t next = NEVER;
  for (struct stream* s = table; s != table + streams; ++s) {
    if (!takeable(s)) continue;
    if (s->next <= port_time)
      due |= 1U << s->level;
    else if (s->next < next)
      next = s->next;
  }
  for (unsigned level = 0; level < levels; ++level)
    if (due >> level & 1U) port_pended = 1U << level;
  armed = NEVER;
  arm_by(next);
  port_unlock(mask);
}
static struct stream* take(unsigned level) {
  const uint32_t mask = port_lock();
  const int64_t now = port_time;
  struct stream* found = NULL;
  for (struct stream* s = table; s != table + streams; ++s) {
    if (s->level != level || !takeable(s) || s->next > now) continue;
    if (found == NULL || s->next < found->next) found = s;
  }
  if (found != NULL) {
    struct stream* s = found;
    s->taken_at = s->level;
    s->use = taken;
    if (s->state == single) {
      s->state = stopped;
    } else {
      int64_t scheduled = s->next;
      uint32_t missed = 0;
      s->next += s->period;
      if (s->next <= now) {
        missed = skip_passed(s, now);
        scheduled = s->next - s->period;
        s->missed += missed;
      }
      if (missed != 0 || (s->jitter_ns != UINT32_MAX && now - scheduled > (int64_t)s->jitter_ns)) ++s->late;
    }
  }
  port_unlock(mask);
  return found;
}
static bool overdue_while_held(const struct stream* s, int64_t now) {
  return s->use == held && s->state == periodic && s->next <= now;
}
static void done(struct stream* s) {
  const uint32_t mask = port_lock();
  if (overdue_while_held(s, port_time)) s->overrun += skip_passed(s, port_time);
  if (s->use == held) --held_streams;
  s->use = unused;
  attend(s);
  port_unlock(mask);
}
static void hold(struct stream* s) {
  const uint32_t mask = port_lock();
  s->use = held;
  ++held_streams;
  port_unlock(mask);
}
static void writable(void) {
  const uint32_t mask = port_lock();
  for (struct stream* s = table; s != table + streams; ++s)
    if (s->use != unused) port_pended = 1U << s->taken_at;
  port_unlock(mask);
}
static struct stream* find_held(unsigned level, struct stream* from) {
  const uint32_t mask = port_lock();
  if (held_streams == 0) from = table + streams;
  while (from != table + streams && !(from->use == held && from->taken_at == level)) ++from;
  port_unlock(mask);
  return from;
}

// --- status and refusals ---
static uint32_t saturated_16(uint64_t n) {
  return n > UINT16_MAX ? UINT16_MAX : (uint32_t)n;
}
static uint32_t refused(void) {
  return counters.bad_length + counters.bad_mode + counters.bad_unit + counters.bad_period +
         counters.not_served + counters.failed;
}
static void refuse(uint8_t cause) {
  switch (cause) {
    case bad_length:
      ++counters.bad_length;
      break;
    case bad_mode:
      ++counters.bad_mode;
      break;
    case bad_unit:
      ++counters.bad_unit;
      break;
    case bad_period:
      ++counters.bad_period;
      break;
    default:
      ++counters.failed;
      break;
  }
}
static void tell(uint8_t topic, uint8_t reason) {
  const uint32_t mask = port_lock();
  last_refusal.topic = topic;
  last_refusal.reason = reason;
  const bool published = table[refusal].state == periodic;
  port_unlock(mask);
  if (!published) once(&table[refusal], low, port_time);
}
static uint32_t overload_of(const struct stream* s) {
  const uint32_t mask = port_lock();
  struct stream copy = *s;
  uint32_t all = copy.missed + copy.late + copy.overrun;
  if (overdue_while_held(&copy, port_time))
    all += skip_passed(&copy, port_time);
  else if (copy.state == periodic && copy.next <= port_time)
    all += skip_passed(&copy, port_time) - 1;
  port_unlock(mask);
  return all;
}

// --- sensors ---
static bool sample_odometry(uint8_t d[][8]) {
  int32_t velocity[2], pose[2];
  uint16_t orientation;
  if (!part_odometry(velocity, pose, &orientation)) return false;
  encode_odometry(d[0], velocity[0], velocity[1], pose[0], pose[1], orientation);
  return true;
}
static bool sample_floor(uint8_t d[][8]) {
  uint16_t counts[4];
  if (!part_floor(counts)) return false;
  for (int i = 0; i < 4; ++i) put16(d[0] + 2 * i, counts[i]);
  return true;
}
static bool sample_magnetometer(uint8_t d[][8]) {
  int32_t field[3];
  if (!part_magnetometer(field)) return false;
  for (int i = 0; i < 3; ++i) {
    put32(d[i], (uint32_t)field[i]);
    put32(d[i] + 4, 0);
  }
  return true;
}
static bool sample_gyroscope(uint8_t d[][8]) {
  int16_t rate[3];
  if (!part_gyroscope(rate)) return false;
  encode_gyroscope(d[0], rate[0], rate[1], rate[2]);
  return true;
}
static bool sample_accelerometer(uint8_t d[][8]) {
  int16_t force[3];
  if (!part_accelerometer(force)) return false;
  encode_gyroscope(d[0], force[0], force[1], force[2]);
  return true;
}
static bool sample_status(uint8_t d[][8]) {
  const int64_t uptime_s = (port_time - start_time) / (1000 * MS);
  put24(d[0], uptime_s > 0xFFFFFF ? 0xFFFFFF : (uint32_t)uptime_s);
  d[0][3] = 0;  // the cause of the reset is not known
  put32(d[0] + 4, wire_hash);
  uint64_t overload = 0;
  unsigned publishing = 0;
  for (int i = task_0; i < streams; ++i) {
    overload += overload_of(&table[i]);
    if (i >= sensors_from && table[i].state == periodic) publishing |= 1U << (i - sensors_from);
  }
  d[1][0] = 255;  // nor is the load
  d[1][1] = 0;    // nor the bus
  d[1][2] = (uint8_t)publishing;
  d[1][3] = (uint8_t)faults;
  put16(d[1] + 4, (uint16_t)saturated_16(overload));
  put16(d[1] + 6, (uint16_t)saturated_16(counters.send_failed));
  return true;
}
static bool sample_refusal(uint8_t d[][8]) {
  const uint32_t mask = port_lock();
  d[0][0] = last_refusal.topic;
  d[0][1] = last_refusal.reason;
  put16(d[0] + 2, (uint16_t)saturated_16(refused()));
  put32(d[0] + 4, saturated_16(counters.not_sampled));  // and no host on a serial line
  port_unlock(mask);
  return true;
}

static uint8_t payloads[11][8];
static struct { uint8_t level, next; } sending[sensors];
static const struct sensor {
  bool (*sample)(uint8_t d[][8]);
  uint8_t (*payloads)[8];
  int64_t default_period;
  uint32_t jitter_ns;
  uint8_t frames;
  struct {
    uint8_t id, dlc;
  } heads[3];
} table_of_sensors[sensors] = {
    {sample_odometry, payloads, 50 * MS, 1 * MS, 2, {{0x02, 8}, {0x03, 8}}},
    {sample_floor, payloads + 2, 50 * MS, 1 * MS, 1, {{0x04, 8}}},
    {sample_magnetometer, payloads + 3, 50 * MS, 1 * MS, 3, {{0x05, 4}, {0x06, 4}, {0x07, 4}}},
    {sample_gyroscope, payloads + 6, 50 * MS, 1 * MS, 1, {{0x08, 6}}},
    {sample_accelerometer, payloads + 7, 50 * MS, 1 * MS, 1, {{0x09, 6}}},
    {sample_status, payloads + 8, 1000 * MS, 1 * MS, 2, {{0x1B, 8}, {0x1C, 8}}},
    {sample_refusal, payloads + 10, 1000 * MS, 1 * MS, 1, {{0x1D, 8}}},
};

/// False: the bus has no room, and the rest waits.
static bool serve_sensor(unsigned number, bool resumed, uint8_t level) {
  const struct sensor* sensor = &table_of_sensors[number];
  if (!resumed) {
    const bool sampled = sensor->sample(sensor->payloads);
    if (sampled) {
      sending[number].level = level;
      sending[number].next = 0;
    }
    const uint32_t mask = port_lock();
    ++*(sampled ? &counters.samples : &counters.not_sampled);
    const uint32_t bit = UINT32_C(1) << number;
    faults = sampled ? faults & ~bit : faults | bit;
    port_unlock(mask);
    if (!sampled) return true;
  }
  for (; sending[number].next < sensor->frames; ++sending[number].next) {
    const unsigned i = sending[number].next;
    struct frame frame = {UINT32_C(1) << 10 | (uint32_t)sending[number].level << 8 | sensor->heads[i].id,
                          sensor->heads[i].dlc,
                          {0},
                          0};
    memcpy(frame.data, sensor->payloads[i], 8);
    const uint32_t mask = port_lock();
    const enum bus_answer answer = bus_send(&frame);
    if (answer == bus_took)
      ++counters.sent;
    else if (answer == bus_failed)
      ++counters.send_failed;
    port_unlock(mask);
    if (answer != bus_took) return answer == bus_failed;
  }
  return true;
}

// --- actuators ---
static struct {
  int64_t expires_at;
  int32_t x, z;
  bool fresh, applying;
} motors = {NEVER, 0, 0, false, false};
static struct {
  uint8_t action;
  bool fresh, applying;
} calibration;

static void watch(void) {
  const uint32_t mask = port_lock();
  int64_t when = motors.expires_at;
  const bool left = (motors.fresh && !motors.applying) || (calibration.fresh && !calibration.applying);
  if (left && port_time < when) when = port_time;
  if (when == NEVER) table[watchdog].state = stopped;
  port_unlock(mask);
  if (when != NEVER) once(&table[watchdog], urgent, when);
}
/// Who comes second leaves it to the first, who goes on until nothing is fresh.
static void apply_motors(void) {
  for (bool mine = false;; mine = true) {
    const uint32_t mask = port_lock();
    const bool others = !mine && motors.applying;
    const bool fresh = motors.fresh;
    const int32_t x = motors.x, z = motors.z;
    if (!others) {
      motors.applying = fresh;
      motors.fresh = false;
    }
    port_unlock(mask);
    if (others || !fresh) return;
    part_motors(x, z);
  }
}
static void apply_calibration(void) {
  for (bool mine = false;; mine = true) {
    const uint32_t mask = port_lock();
    const bool others = !mine && calibration.applying;
    const bool fresh = calibration.fresh;
    const uint8_t action = calibration.action;
    if (!others) {
      calibration.applying = fresh;
      calibration.fresh = false;
    }
    port_unlock(mask);
    if (others || !fresh) return;
    part_calibrate_floor(action);
  }
}
static uint8_t set_motors(const struct frame* frame, int64_t now) {
  const uint32_t mask = port_lock();
  if (frame->dlc != 8) {
    refuse(bad_length);
    port_unlock(mask);
    return bad_length;
  }
  ++counters.set_points;
  motors.x = get32(frame->data);
  motors.z = get32(frame->data + 4);
  motors.expires_at = motors.x == 0 && motors.z == 0 ? NEVER : now + 500 * MS;
  motors.fresh = true;
  port_unlock(mask);
  apply_motors();
  watch();
  return ok;
}
static uint8_t set_calibration(const struct frame* frame) {
  const uint32_t mask = port_lock();
  if (frame->dlc != 1) {
    refuse(bad_length);
    port_unlock(mask);
    return bad_length;
  }
  ++counters.set_points;
  calibration.action = frame->data[0];
  calibration.fresh = true;
  port_unlock(mask);
  apply_calibration();
  watch();
  return ok;
}
static void settle(void) {
  const uint32_t mask = port_lock();
  if (port_time >= motors.expires_at) {
    motors.expires_at = NEVER;
    ++counters.timeouts;
    motors.x = motors.z = 0;
    motors.fresh = true;
  }
  port_unlock(mask);
  apply_motors();
  apply_calibration();
  watch();
}
static void bus_lost(void) {
  const uint32_t mask = port_lock();
  if (motors.expires_at != NEVER) {
    motors.expires_at = NEVER;
    motors.x = motors.z = 0;
    motors.fresh = true;
    ++counters.bus_lost;
  }
  port_unlock(mask);
  watch();
}

// --- requests ---
struct request {
  uint8_t mode, level, unit, error;
  uint16_t count;
};
static struct request decode(const struct frame* frame) {
  struct request r = {0, (uint8_t)(frame->id >> 8 & 3), 0, ok, 50};
  if (frame->dlc == 0 || frame->dlc > 8)
    r.error = bad_length;
  else if (frame->data[0] > 2)
    r.error = bad_mode;
  else if (r.mode = frame->data[0], r.mode != 1)
    r.error = frame->dlc == 1 ? ok : bad_length;
  else if (frame->dlc == 1)
    ;
  else if (frame->dlc != 4)
    r.error = bad_length;
  else if (frame->data[3] > 2)
    r.error = bad_unit;
  else if (r.count = (uint16_t)(frame->data[1] | frame->data[2] << 8), r.unit = frame->data[3], r.count == 0)
    r.error = bad_period;
  return r;
}
static int64_t duration(const struct request* r) {
  return r->count * (r->unit == 1 ? INT64_C(1000000000) : r->unit == 0 ? INT64_C(1000000) : INT64_C(1000));
}
static uint8_t request(unsigned number, const struct frame* frame, int64_t now) {
  const struct request r = decode(frame);
  const struct sensor* sensor = &table_of_sensors[number];
  struct stream* s = &table[sensors_from + number];
  {
    const uint32_t mask = port_lock();
    if (r.error != ok)
      refuse(r.error);
    else
      ++counters.requests;
    port_unlock(mask);
  }
  if (r.error != ok) return r.error;
  if (r.mode == 0)
    stop(s);
  else if (r.mode == 2)
    once(s, r.level, now);
  else
    start(s, frame->dlc == 1 ? sensor->default_period : duration(&r), r.level, now, sensor->jitter_ns);
  return ok;
}

// --- the board ---
static void receive(const struct frame* frame, int64_t now) {
  bool mine = false;
  if (frame->format == 0 && (frame->id >> 10 & 1) == 0) {
    uint8_t error = ok;
    mine = true;
    switch (frame->id & 0xFF) {
      case 0x03:
        error = request(0, frame, now);
        break;
      case 0x04:
        error = request(1, frame, now);
        break;
      case 0x05:
        error = request(2, frame, now);
        break;
      case 0x08:
        error = request(3, frame, now);
        break;
      case 0x09:
        error = request(4, frame, now);
        break;
      case 0x1B:
        error = request(5, frame, now);
        break;
      case 0x1D:
        error = request(6, frame, now);
        break;
      case 0x01:
        error = set_motors(frame, now);
        break;
      case 0x0A:
        error = set_calibration(frame);
        break;
      default:
        mine = false;
        break;
    }
    if (error != ok) tell((uint8_t)frame->id, error);
  }
  const uint32_t mask = port_lock();
  ++counters.received;
  if (!mine) ++counters.foreign;
  port_unlock(mask);
}
static bool serve(struct stream* s, bool resumed, uint8_t level) {
  const int number = (int)(s - table);
  if (number >= sensors_from) return serve_sensor((unsigned)(number - sensors_from), resumed, level);
  if (number == watchdog)
    settle();
  else
    task(number - task_0);
  return true;
}
static void run(unsigned level) {
  for (struct stream* s = find_held(level, table); s != table + streams; s = find_held(level, s + 1))
    if (serve(s, true, (uint8_t)level)) done(s);
  for (struct stream* s; (s = take(level)) != NULL;) serve(s, false, (uint8_t)level) ? done(s) : hold(s);
}
static void set_up(void) {
  start_time = port_time;
  for (struct stream* s = table; s != table + streams; ++s) s->level = medium;
  start(&table[task_0], 50 * MS, high, port_time, UINT32_MAX);
  start(&table[task_1], 10 * MS, urgent, port_time, UINT32_MAX);
}
static bool decode_request(const struct frame* frame, uint8_t* mode, uint32_t* count_and_unit) {
  if (frame->format != 0 || frame->id > 0x7FF || (frame->id >> 10 & 1) != 0) return false;
  const struct request r = decode(frame);
  *mode = r.mode;
  *count_and_unit = r.count | (uint32_t)r.unit << 16;
  return r.error == ok;
}

const struct board board_by_hand = {set_up, receive, expire, run, writable, bus_lost};
const struct codec codec_by_hand = {decode_request, encode_gyroscope, encode_odometry, encode_ring};
