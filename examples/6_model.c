/* A model, as a tool makes C of it: inputs, outputs, one step function. Around it, what connects it with a robot.
 *
 *     amiroctl generate c -o amiro.h
 *     gcc -std=c99 -D_GNU_SOURCE -I. -Iinclude examples/6_model.c -lm -o model
 *     amiroctl sim &
 *     ./model sim 40        40 steps, or until Ctrl-C
 *
 * The model holds the heading of the robot while it drives, by its odometry. */
#include <math.h>
#include <signal.h>

#include "amiro.h"
#include "ocm/c/client.h"

/* --- what the tool makes --- */

typedef struct {
  double heading; /* rad */
} ExtU_model;
typedef struct {
  double forward; /* m/s */
  double turn;    /* rad/s */
} ExtY_model;
static ExtU_model model_U;
static ExtY_model model_Y;

/* Every 50 ms. */
static void model_step(void) {
  model_Y.forward = 0.05;
  model_Y.turn = fmax(-0.5, fmin(0.5, -2.0 * model_U.heading));
}

/* --- what connects it --- */

static volatile sig_atomic_t ended;
static void end(int number) {
  (void)number;
  ended = 1;
}

static int command(ocm_client* bus, double forward, double turn) {
  amiro_motors_t motors = {0, 0};
  amiro_frame frame;
  amiro_motors_set_x_m_per_s(&motors, forward);
  amiro_motors_set_z_rad_per_s(&motors, turn);
  frame = amiro_motors_frame(&motors, AMIRO_MOTORS_PRIORITY);
  return ocm_client_send(bus, frame.id, frame.dlc, frame.data, 50);
}

int main(int argc, char** argv) {
  static ocm_client bus;
  amiro_odometry_t odometry;
  amiro_frame frame;
  long steps = argc > 2 ? strtol(argv[2], NULL, 10) : -1;
  int got = 0;
  if (argc < 2 || ocm_client_open(&bus, argv[1], 2000) < 0) {
    fprintf(stderr, "model: %s\n", argc < 2 ? "usage: model BUS [STEPS]" : bus.why);
    return argc < 2 ? 2 : 1;
  }
  signal(SIGINT, end);
  signal(SIGTERM, end);

  frame = amiro_publish_every(AMIRO_ODOMETRY_ID, 50, AMIRO_MILLISECONDS, AMIRO_HIGH);
  ocm_client_send(&bus, frame.id, frame.dlc, frame.data, 100);
  while (!ended && steps != 0) {
    /* A step for each sample: the robot's period is the model's. */
    got = ocm_client_receive_base(&bus, &frame.id, &frame.dlc, frame.data, 200);
    if (got <= 0) break; /* a robot that is silent must not be driven */
    /* The pose is the second of its frames. */
    if (amiro_odometry_take(&odometry, &frame) != 1) continue;
    /* 0 to 2 pi on the bus. */
    model_U.heading = remainder(amiro_odometry_pose_orientation_rad(&odometry.pose), 6.283185307179586);
    model_step();
    if (command(&bus, model_Y.forward, model_Y.turn) != 1) break;
    if (steps > 0) --steps;
  }

  /* However it ended: motors to zero, and the stream is stopped. */
  frame = amiro_stop(AMIRO_ODOMETRY_ID, AMIRO_HIGH);
  if (command(&bus, 0, 0) != 1) fprintf(stderr, "model: THE ROBOT MAY STILL MOVE: %s\n", bus.why);
  ocm_client_send(&bus, frame.id, frame.dlc, frame.data, 100);
  if (got <= 0) fprintf(stderr, "model: %s\n", got < 0 ? bus.why : "no odometry for 200 ms");
  printf("heading %.3f rad, %lu frames received, %lu lost\n", model_U.heading, (unsigned long)bus.received,
         (unsigned long)bus.lost);
  ocm_client_close(&bus);
  return got < 0 || (got == 0 && !ended) ? 1 : 0;
}
