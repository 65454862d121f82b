#include "firmware/drivers/part.hpp"

#include <catch2/catch.hpp>

#include "tests/firmware/drivers/fixture.hpp"

namespace firmware_drivers_part_test {

using namespace drivers_tests;
using namespace ocm;
using namespace ocm::firmware::drivers;

struct Driver {
  bool there = true;
  Error read_error = Error::none;
  int starts = 0, checks = 0, reads = 0;

  base::Result<base::Duration> start() {
    ++starts;
    if (!there) return Error::no_answer;
    return base::Duration{20ms};
  }
  base::Status check() {
    ++checks;
    return there ? Error::none : Error::no_answer;
  }
  base::Result<int> read() {
    ++reads;
    if (!there) return Error::no_answer;
    if (read_error != Error::none) return read_error;
    return 7;
  }
};

using Test = Part<Driver>;
base::Result<int> read(Test& part) {
  return part.use([](Driver& driver) { return driver.read(); });
}

TEST_CASE("a part is started, waited for, and read") {
  Test part;
  const base::Time t0{};
  CHECK(read(part).error == Error::no_answer);  // not looked at yet
  CHECK(part.maintain(t0));
  CHECK(read(part).error == Error::not_sampled);  // settling
  CHECK_FALSE(part.absent());
  CHECK_FALSE(part.maintain(t0 + 19ms));
  CHECK(read(part).error == Error::not_sampled);
  CHECK_FALSE(part.maintain(t0 + 20ms));  // no transfer for that
  CHECK(read(part) == base::Result<int>{7});
  CHECK(part.faults() == 0);
  CHECK(part.driver().reads == 1);
}

TEST_CASE("a part that is not there costs a start a second and nothing on reading") {
  Test part;
  part.driver().there = false;
  base::Time now{};
  for (int ms = 0; ms < 10'000; ms += 10) {
    part.maintain(now);
    CHECK(read(part).error == Error::no_answer);
    now += 10ms;
  }
  CHECK(part.driver().starts == 10);
  CHECK(part.driver().reads == 0);
  CHECK(part.faults() == 10);
  CHECK(part.absent());

  part.driver().there = true;
  for (int ms = 0; ms < 1100; ms += 10) {
    part.maintain(now);
    now += 10ms;
  }
  CHECK(read(part) == base::Result<int>{7});
  CHECK(part.faults() == 10);
}

TEST_CASE("a part that stops answering is lost at once, and tried again at once") {
  Test part;
  base::Time now{};
  part.maintain(now);
  part.maintain(now += 20ms);
  part.maintain(now += 1500ms);
  REQUIRE(read(part).ok());
  part.driver().there = false;
  CHECK(read(part).error == Error::no_answer);
  CHECK(part.absent());
  CHECK(part.faults() == 1);
  part.driver().there = true;
  part.maintain(now += 10ms);
  CHECK_FALSE(part.absent());
  part.maintain(now += 20ms);
  CHECK(read(part).ok());
  CHECK(part.faults() == 1);
}

TEST_CASE("a part that flaps is started once a second at the most") {
  Test part;
  part.driver().read_error = Error::bus_fault;
  base::Time now{};
  for (int ms = 0; ms < 10'000; ms += 10) {
    part.maintain(now);
    (void)read(part);
    now += 10ms;
  }
  CHECK(part.driver().starts == 10);
  CHECK(part.driver().reads == 10);
}

TEST_CASE("a part that is never read is missed nevertheless") {
  Test part;
  base::Time now{};
  part.maintain(now);
  part.maintain(now += 20ms);
  part.driver().there = false;
  for (int i = 0; i < 99; ++i) part.maintain(now += 10ms);
  CHECK_FALSE(part.absent());
  part.maintain(now += 10ms);  // the check is due
  CHECK(part.absent());
}

TEST_CASE("no new sample is no fault") {
  Test part;
  base::Time now{};
  part.maintain(now);
  part.maintain(now += 20ms);
  part.driver().read_error = Error::not_sampled;
  CHECK(read(part).error == Error::not_sampled);
  CHECK(part.running());
  CHECK(part.faults() == 0);
}

}  // namespace firmware_drivers_part_test
