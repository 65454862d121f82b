/* The C header of the robot with the frames of the thesis, typed by hand. Returns how many are wrong. */
#include "amiro.h"

#include <stdio.h>
#include <string.h>

static int wrong = 0;

static void expect(int holds, const char* what) {
  if (holds) return;
  printf("not so: %s\n", what);
  ++wrong;
}
#define EXPECT(condition) expect((condition), #condition)

static int is(const amiro_frame* frame, uint16_t id, uint8_t dlc, const char* bytes) {
  return frame->id == id && frame->dlc == dlc && memcmp(frame->data, bytes, dlc) == 0;
}

/* [Thesis 4.2, figure 4.2] */
static void requests(void) {
  amiro_frame frame = amiro_publish_every(AMIRO_MAGNETOMETER_ID, 900, AMIRO_MICROSECONDS, AMIRO_MEDIUM);
  amiro_request request;
  memset(&request, 0, sizeof request);
  EXPECT(is(&frame, 0x205, 4, "\x01\x84\x03\x02"));
  EXPECT(amiro_read_request(&frame, &request) == 0);
  EXPECT(request.topic == AMIRO_MAGNETOMETER_ID && request.priority == AMIRO_MEDIUM);
  EXPECT(request.mode == AMIRO_PUBLISH && amiro_period_us(request.count, request.unit) == 900);
  frame = amiro_publish_every(AMIRO_GYROSCOPE_ID, 500, AMIRO_MILLISECONDS, AMIRO_HIGH);
  EXPECT(is(&frame, 0x108, 4, "\x01\xF4\x01\x00"));
  frame = amiro_publish(AMIRO_MAGNETOMETER_ID, AMIRO_MEDIUM);
  EXPECT(is(&frame, 0x205, 1, "\x01"));
  EXPECT(amiro_read_request(&frame, &request) == 0 && request.count == 0);
  frame = amiro_once(AMIRO_FLOOR_PROXIMITY_ID, AMIRO_MEDIUM);
  EXPECT(is(&frame, 0x204, 1, "\x02"));
  frame = amiro_stop(AMIRO_MAGNETOMETER_ID, AMIRO_MEDIUM);
  EXPECT(is(&frame, 0x205, 1, "\x00"));
}

static void bad_requests(void) {
  amiro_frame frame = amiro_once(AMIRO_FLOOR_PROXIMITY_ID, AMIRO_URGENT);
  amiro_request request;
  memset(&request, 0x5A, sizeof request);
  frame.data[0] = 3;
  EXPECT(amiro_read_request(&frame, &request) == AMIRO_WRONG_MODE);
  frame.data[0] = 1;
  frame.dlc = 2;
  EXPECT(amiro_read_request(&frame, &request) == AMIRO_WRONG_LENGTH);
  frame.dlc = 0;
  EXPECT(amiro_read_request(&frame, &request) == AMIRO_WRONG_LENGTH);
  frame.dlc = 4;
  EXPECT(amiro_read_request(&frame, &request) == AMIRO_WRONG_PERIOD);
  frame.data[1] = 1;
  frame.data[3] = 3;
  EXPECT(amiro_read_request(&frame, &request) == AMIRO_WRONG_UNIT);
  frame.id |= 0x400;
  EXPECT(amiro_read_request(&frame, &request) == AMIRO_FOREIGN);
  EXPECT(request.topic == 0x5A);
}

/* [Thesis figures 6.3, 7.2] */
static void samples(void) {
  amiro_gyroscope_t gyroscope = {62, 30, -4};
  amiro_magnetometer_t magnetometer = {{53760}, {-939520}, {1523200}};
  amiro_power_status_t power = {0, 0, 0, 0};
  const amiro_frame gauge = {0x61E, 6, {0x02, 52, 137, 0, 0x5E, 0xFC, 0, 0}};
  amiro_frame frame = amiro_gyroscope_frame(&gyroscope, AMIRO_MEDIUM);
  EXPECT(is(&frame, 0x608, 6, "\x3E\x00\x1E\x00\xFC\xFF"));
  memset(&gyroscope, 0, sizeof gyroscope);
  EXPECT(amiro_gyroscope_take(&gyroscope, &frame) == 0);
  EXPECT(gyroscope.x == 62 && gyroscope.y == 30 && gyroscope.z == -4);
  EXPECT(amiro_gyroscope_z_deg_per_s(&gyroscope) == -0.07);
  frame.dlc = 5;
  EXPECT(amiro_gyroscope_take(&gyroscope, &frame) == AMIRO_WRONG_LENGTH);
  EXPECT(amiro_power_status_take(&power, &frame) == AMIRO_FOREIGN);
  frame = amiro_magnetometer_frame(&magnetometer, 1, AMIRO_MEDIUM);
  EXPECT(is(&frame, 0x606, 4, "\x00\xAA\xF1\xFF"));
  EXPECT(amiro_magnetometer_take(&magnetometer, &frame) == 1);
  EXPECT(amiro_magnetometer_y_field_gauss(&magnetometer.y) == -0.93952);
  EXPECT(amiro_power_status_take(&power, &gauge) == 0);
  EXPECT(power.power == -930 && power.flags == AMIRO_POWER_STATUS_FLAGS_CHARGING);
  EXPECT(AMIRO_POWER_STATUS_MINUTES_UNKNOWN == 65535);
}

/* [Thesis table 4.9; 4.2.2] What is too large becomes the largest, and never of the other sign. */
static void set_points(void) {
  amiro_motors_t motors = {50000, -1};
  amiro_led_t led = {100, 50, 120};
  amiro_odometry_pose_t pose = {9000000, -9000000, 0};
  uint8_t data[8];
  volatile double huge = 1e308;
  amiro_frame frame = amiro_motors_frame(&motors, AMIRO_MEDIUM);
  EXPECT(is(&frame, 0x201, 8, "\x50\xC3\x00\x00\xFF\xFF\xFF\xFF"));
  amiro_motors_set_x_m_per_s(&motors, 0.05);
  EXPECT(motors.x == 50000);
  amiro_motors_set_x_m_per_s(&motors, 1e9);
  EXPECT(motors.x == 1000000);
  amiro_motors_set_x_m_per_s(&motors, huge * huge - huge * huge); /* not a number */
  EXPECT(motors.x == 0);
  frame = amiro_led_frame(&led, 5, AMIRO_MEDIUM); /* LED 5, as in the thesis and on the command line: led_5 */
  EXPECT(is(&frame, 0x240, 3, "\x64\x32\x78"));
  EXPECT(amiro_led_take(&led, &frame) == 5);
  EXPECT(amiro_led_frame(&led, 1, AMIRO_MEDIUM).id == 0x23C && amiro_led_frame(&led, 8, AMIRO_MEDIUM).id == 0x243);
  EXPECT(amiro_led_frame(&led, 0, AMIRO_MEDIUM).id == 0x23C && amiro_led_frame(&led, 255, AMIRO_MEDIUM).id == 0x243);
  frame.id = 0x244;
  EXPECT(amiro_led_take(&led, &frame) == AMIRO_FOREIGN);
  amiro_odometry_pose_encode(&pose, data);
  EXPECT(memcmp(data, "\xFF\xFF\x7F\x00\x00\x80\x00\x00", 8) == 0);
}

int main(void) {
  requests();
  bad_requests();
  samples();
  set_points();
  return wrong;
}
