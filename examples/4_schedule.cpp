// A schedule that fails does not compile: the tasks of a processor, and the messages of a bus. Make Camera's
// cost 30 ms, and the compiler says misses_its_deadline<Camera, ...>.
#include <chrono>
#include <cstdio>

#include "ocm/analysis/schedulable.hpp"
#include "ocm/analysis/task_list.hpp"
#include "ocm/topics/amiro.hpp"

using namespace ocm;
using namespace std::chrono_literals;

constexpr std::int64_t ns(std::chrono::nanoseconds time) {
  return time.count();
}

struct Balance {
  static constexpr analysis::Task task{.cost = ns(200us), .period = ns(2ms), .level = 0};
};
struct Camera {
  static constexpr analysis::Task task{
      .cost = ns(12ms), .period = ns(40ms), .deadline = ns(20ms), .level = 1};
};
using Tasks = analysis::TaskList<Balance, Camera>;
static_assert(analysis::schedulable<Tasks>);

// What the compass and the floor sensors send unless a request changes it, and set points for the
// motors every 100 ms.
template <class Topic, std::size_t frame = 0, std::int64_t period = 0>
using Frame = analysis::TopicFrame<Topic, amiro::bit_rate, frame, 1, period>;
constexpr std::int64_t bit = 1'000'000'000 / amiro::bit_rate;
using Bus = analysis::Traffic<bit, Frame<amiro::Motors, 0, ns(100ms)>, Frame<amiro::FloorProximity>,
                              Frame<amiro::Magnetometer, 0>, Frame<amiro::Magnetometer, 1>,
                              Frame<amiro::Magnetometer, 2>>;
static_assert(analysis::schedulable<Bus>);

int main() {
  std::printf("the camera's picture is done within %lld us, the compass is heard within %lld us\n",
              static_cast<long long>(Tasks::results[1].response / 1000),
              static_cast<long long>(Bus::results[4].response / 1000));
}
