#include "cli/serve/attendance.hpp"

#include <chrono>
#include <vector>

#include <catch2/catch.hpp>

namespace serve_attendance_test {

using namespace std::chrono_literals;
using ocm::cli::serve::Attendance;
using ocm::cli::serve::ViewerId;
using ocm::cli::serve::Viewers;

TEST_CASE("attendance: a viewer for whom robots drive is asked, and silent after two seconds") {
  Viewers viewers{1};
  const ViewerId there = viewers.add();
  const ViewerId off = viewers.add();
  const ViewerId looks = viewers.add();
  Attendance attendance;
  ocm::base::Time now{1h};
  const ocm::base::Time begin = now;
  std::vector<ViewerId> silent;
  for (; silent.empty() && now < begin + 10s; now += 50ms) {
    silent = attendance.silent({there, off}, viewers, now);
    if (viewers.take_asked(there)) viewers.hear(there);
    (void)viewers.take_asked(off);
    CHECK_FALSE(viewers.take_asked(looks));
  }
  CHECK(silent == std::vector<ViewerId>{off});
  CHECK(now - 50ms - begin == 2s);
  // It is reported once; one that drives again is asked again.
  CHECK(attendance.silent({there}, viewers, now += 500ms).empty());
  CHECK(attendance.silent({there, off}, viewers, now += 500ms).empty());
  CHECK(viewers.has_next(off));
  CHECK(viewers.take_asked(off));
  CHECK_FALSE(viewers.take_asked(off));
}

TEST_CASE("attendance: whatever a viewer says is an answer, and the server's own sleep is no silence") {
  Viewers viewers{1};
  const ViewerId viewer = viewers.add();
  Attendance attendance;
  ocm::base::Time now{1h};
  for (int i = 0; i < 20; ++i) {
    CHECK(attendance.silent({viewer}, viewers, now += 1s).empty());
    if (i % 3 == 2) viewers.hear(viewer);  // late, but there
  }
  viewers.hear(viewer);
  CHECK(attendance.silent({viewer}, viewers, now += 500ms).empty());
  CHECK(attendance.silent({viewer}, viewers, now += 1h).empty());  // this program was stopped
  // One that has stopped driving begins afresh.
  for (int i = 0; i < 2; ++i) CHECK(attendance.silent({viewer}, viewers, now += 500ms).empty());
  CHECK(attendance.silent({}, viewers, now += 500ms).empty());
  for (int i = 0; i < 4; ++i) CHECK(attendance.silent({viewer}, viewers, now += 500ms).empty());
  CHECK(attendance.silent({viewer}, viewers, now += 500ms) == std::vector<ViewerId>{viewer});
  viewers.remove(viewer);
  CHECK(attendance.silent({viewer}, viewers, now += 500ms).empty());
}

}  // namespace serve_attendance_test
