// Instructions of one call each, by hand and with the library, on QEMU's netduino2 (Cortex-M3) with -icount
// shift=0: an instruction takes a nanosecond, and TIM2 counts nanoseconds. After every step both must have
// sent the same frames and applied the same set points, or the run fails.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stubs.h"

#define MS INT64_C(1000000)

/// [RM0033, 15.4: TIM2 of the STM32F205]
static volatile uint32_t* const tim2_cr1 = (volatile uint32_t*)0x40000000;
static volatile uint32_t* const tim2_cnt = (volatile uint32_t*)0x40000024;

static const struct board* board;
static const struct codec* codec;
static uint32_t empty;  // what reading the counter twice costs

#define COST(call)                     \
  ({                                   \
    const uint32_t begin_ = *tim2_cnt; \
    __asm volatile("" ::: "memory");   \
    call;                              \
    __asm volatile("" ::: "memory");   \
    const uint32_t end_ = *tim2_cnt;   \
    end_ - begin_ - empty;             \
  })

static struct frame request(uint8_t topic, unsigned level, uint8_t mode, uint16_t count, uint8_t unit) {
  struct frame f = {
      level << 8 | topic, mode == 1 ? 4 : 1, {mode, (uint8_t)count, (uint8_t)(count >> 8), unit}, 0};
  return f;
}

enum { rows_max = 32 };
static struct row {
  const char* what;
  uint32_t cost[2];
  uint32_t sum[2];
  uint32_t sent[2];
} rows[rows_max];
static unsigned row_count;
static unsigned row;
static unsigned column;

static void note(const char* what, uint32_t cost) {
  rows[row].what = what;
  rows[row].cost[column] = cost;
  rows[row].sum[column] = work_sum;
  rows[row].sent[column] = sent_frames;
  ++row;
}

/// Runs all levels until nothing is pended, uncounted.
static void settle(void) {
  board->expire();
  for (unsigned level = 0; level < 4; ++level) board->run(level);
}
static uint32_t release(unsigned level) {
  return COST((board->expire(), board->run(level)));
}

static void work(void) {
  work_sum = sent_frames = 0;
  port_time = 1000 * MS;
  row = 0;
  board->set_up();
  settle();

  uint8_t mode;
  uint32_t count;
  uint8_t data[64];
  struct frame f = request(0x08, 2, 1, 500, 0);
  note("decode a request", COST(codec->decode_request(&f, &mode, &count)));
  work_sum += mode + count;
  note("encode gyroscope, 1 frame", COST(codec->encode_gyroscope(data, 1, -2, 32767)));
  for (int i = 0; i < 8; ++i) work_sum += data[i] << i;
  note("encode odometry, 2 frames", COST(codec->encode_odometry(data, 1, -2, 0x7FFFFFFF, -5, 24543)));
  for (int i = 0; i < 16; ++i) work_sum += data[i] << i;
  const uint16_t ring[8] = {1, 2, 3, 4, 5, 6, 7, 65535};
  note("encode the ring, 8 frames", COST(codec->encode_ring(data, ring)));
  for (int i = 0; i < 64; ++i) work_sum += (uint32_t)data[i] << i % 24;

  note("request gyroscope: decode and start", COST(board->receive(&f, port_time)));
  settle();
  f = request(0x08, 2, 0, 0, 0);
  note("stop gyroscope", COST(board->receive(&f, port_time)));
  f = request(0x08, 2, 1, 0, 0);
  note("a request that is refused", COST(board->receive(&f, port_time)));
  settle();
  f = request(0x1E, 2, 1, 500, 0);
  note("a request for another board", COST(board->receive(&f, port_time)));
  f = (struct frame){0x201, 8, {1, 2, 3, 4, 5, 6, 7, 8}, 0};
  note("set point of the motors", COST(board->receive(&f, port_time)));

  f = request(0x08, 2, 1, 50, 0);
  board->receive(&f, port_time);
  settle();
  port_time += 50 * MS;
  board->run(0), board->run(1);  // the tasks are not what is measured
  note("release gyroscope: expire, take, read, encode, send, done", release(2));
  settle();
  // All that the board has, every 50 ms, as under full load.
  static const uint8_t topics[] = {0x03, 0x04, 0x05, 0x08, 0x09};
  for (unsigned i = 0; i < sizeof topics; ++i) {
    f = request(topics[i], 2, 1, 50, 0);
    board->receive(&f, port_time);
  }
  settle();
  port_time += 50 * MS;
  board->run(0), board->run(1);
  note("release all five sensors, 8 frames", release(2));
  settle();
  bus_says = bus_full;
  port_time += 50 * MS;
  board->run(0), board->run(1);
  board->expire();
  board->run(2);
  bus_says = bus_took;
  note("five samples that waited go on: room again, 8 frames", COST((board->writable(), board->run(2))));
  settle();
  port_time += 357 * MS;
  board->run(0), board->run(1);
  note("five releases, each seven periods late", release(2));
  settle();
  note("nothing due: expire and run", release(2));
  f = request(0x1B, 3, 2, 0, 0);
  board->receive(&f, port_time);
  note("one status, 2 frames", COST(board->run(3)));
  board->bus_lost();
  settle();
  note("(after the bus was lost)", 0);
}

int main(void) {
  *tim2_cr1 = 1;
  empty = COST((void)0);
  for (column = 0; column < 2; ++column) {
    board = column == 0 ? &board_by_hand : &board_by_library;
    codec = column == 0 ? &codec_by_hand : &codec_by_library;
    work();
    row_count = row;
  }
  int result = 0;
  printf("| instructions | by hand | library | ratio |\n|---|---|---|---|\n");
  for (row = 0; row < row_count; ++row) {
    const struct row* r = &rows[row];
    if (r->sum[0] != r->sum[1] || r->sent[0] != r->sent[1]) {
      fprintf(stderr, "%s: not the same work: %lu frames, sum %08lx; %lu frames, sum %08lx\n", r->what,
              (unsigned long)r->sent[0], (unsigned long)r->sum[0], (unsigned long)r->sent[1],
              (unsigned long)r->sum[1]);
      result = 1;
    }
    if (r->cost[0] != 0)
      printf("| %s | %lu | %lu | %lu.%02lu |\n", r->what, (unsigned long)r->cost[0],
             (unsigned long)r->cost[1], (unsigned long)(r->cost[1] / r->cost[0]),
             (unsigned long)(r->cost[1] * 100 / r->cost[0] % 100));
  }
  return result;
}
