/* A control loop at its own pace: a model with a state and two inputs takes a step each 50 ms, by the clock of this
 * machine, and not by the robot's samples.
 *
 *     amiroctl generate c -o amiro.h
 *     gcc -std=c99 -D_GNU_SOURCE -I. -Iinclude examples/7_loop.c -lm -o loop
 *     amiroctl sim &
 *     ./loop sim 100        100 steps, or until Ctrl-C; it ends, too, when it has come to a wall
 *
 * The robot drives ahead, and comes to rest before what its ring sees. */
#include <math.h>
#include <signal.h>

#include "amiro.h"
#include "ocm/c/client.h"

/* --- what the tool makes of the model: the names are those of Embedded Coder --- */

typedef struct {
  double nearness; /* of what is ahead: counts of the nearest sensor, larger is nearer */
  double velocity; /* as the robot measures it, m/s */
} ExtU_loop;
typedef struct {
  double forward; /* m/s */
  int arrived;    /* something is near, and the robot is at rest */
} ExtY_loop;
typedef struct {
  double forward; /* of the last step */
} DW_loop;
static ExtU_loop loop_U;
static ExtY_loop loop_Y;
static DW_loop loop_DW;

static void loop_initialize(void) {
  loop_DW.forward = 0.0;
  loop_Y.forward = 0.0;
  loop_Y.arrived = 0;
}
/* Every 50 ms: at most 0.02 m/s faster or 0.05 m/s slower than in the last step. */
static void loop_step(void) {
  const double goal = loop_U.nearness > 2700.0 ? 0.0 : 0.2;
  loop_DW.forward = fmax(loop_DW.forward - 0.05, fmin(loop_DW.forward + 0.02, goal));
  loop_Y.forward = loop_DW.forward;
  loop_Y.arrived = goal == 0.0 && loop_DW.forward == 0.0 && fabs(loop_U.velocity) < 0.005;
}

/* --- what connects it --- */

enum { step_ms = 50, silent_ms = 300 };

static volatile sig_atomic_t ended;
static void end(int number) {
  (void)number;
  ended = 1;
}

static int64_t now_ms(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static int command(ocm_client* bus, double forward) {
  amiro_motors_t motors = {0, 0};
  amiro_frame frame;
  amiro_motors_set_x_m_per_s(&motors, forward);
  frame = amiro_motors_frame(&motors, AMIRO_MOTORS_PRIORITY);
  return ocm_client_send(bus, frame.id, frame.dlc, frame.data, step_ms);
}

static int ask(ocm_client* bus, amiro_frame frame) {
  return ocm_client_send(bus, frame.id, frame.dlc, frame.data, 100);
}

int main(int argc, char** argv) {
  static ocm_client bus;
  amiro_proximity_ring_t ring;
  amiro_odometry_t odometry;
  amiro_frame frame;
  const char* why = NULL;
  long steps = argc > 2 ? strtol(argv[2], NULL, 10) : -1;
  long taken = 0, late = 0;
  int64_t next, ring_at, odometry_at;
  int got = 0, sensor, rests;
  if (argc < 2 || ocm_client_open(&bus, argv[1], 2000) < 0) {
    fprintf(stderr, "loop: %s\n", argc < 2 ? "usage: loop BUS [STEPS]" : bus.why);
    return argc < 2 ? 2 : 1;
  }
  signal(SIGINT, end);
  signal(SIGTERM, end);

  if (ask(&bus, amiro_publish_every(AMIRO_PROXIMITY_RING_ID, step_ms, AMIRO_MILLISECONDS, AMIRO_HIGH)) != 1 ||
      ask(&bus, amiro_publish_every(AMIRO_ODOMETRY_ID, step_ms, AMIRO_MILLISECONDS, AMIRO_HIGH)) != 1)
    why = "the bus takes no request";
  loop_initialize();
  ring_at = odometry_at = now_ms();
  next = ring_at + 2 * step_ms; /* both have come by then */
  while (why == NULL && !ended && steps != 0 && !loop_Y.arrived) {
    /* Until the next step is due: what comes is the newest input. */
    int64_t left = next - now_ms();
    if (left > 0) {
      got = ocm_client_receive_base(&bus, &frame.id, &frame.dlc, frame.data, (int)left);
      if (got < 0) why = bus.why;
      if (got <= 0) continue;
      if (amiro_proximity_ring_take(&ring, &frame) == (int)AMIRO_PROXIMITY_RING_FRAMES - 1) {
        loop_U.nearness = 0.0;
        for (sensor = 2; sensor <= 5; ++sensor) /* 3 to 6 look ahead and to the sides */
          loop_U.nearness = fmax(loop_U.nearness, ring.sensor[sensor].proximity);
        ring_at = now_ms();
      } else if (amiro_odometry_take(&odometry, &frame) == 0) {
        loop_U.velocity = amiro_odometry_velocity_x_m_per_s(&odometry.velocity);
        odometry_at = now_ms();
      }
      continue;
    }
    if (now_ms() - (ring_at < odometry_at ? ring_at : odometry_at) > silent_ms) {
      why = "no ring or no odometry for 300 ms"; /* a model must not drive by old inputs */
      break;
    }
    loop_step();
    if (command(&bus, loop_Y.forward) != 1) why = "the bus takes no set point";
    ++taken;
    if (steps > 0) --steps;
    next += step_ms;
    if (left <= -step_ms) { /* what was missed is not made up for */
      ++late;
      next = now_ms() + step_ms;
    }
  }

  /* However it ended: motors to zero, and the streams are stopped. */
  rests = command(&bus, 0.0);
  if (rests != 1) fprintf(stderr, "loop: THE ROBOT MAY STILL MOVE: %s\n", bus.why);
  ask(&bus, amiro_stop(AMIRO_PROXIMITY_RING_ID, AMIRO_HIGH));
  ask(&bus, amiro_stop(AMIRO_ODOMETRY_ID, AMIRO_HIGH));
  if (why != NULL) fprintf(stderr, "loop: %s\n", why);
  printf("%s after %ld steps, %ld of them late, %lu frames lost\n", loop_Y.arrived ? "arrived" : "ended", taken, late,
         (unsigned long)bus.lost);
  ocm_client_close(&bus);
  return why != NULL || rests != 1 ? 1 : 0;
}
