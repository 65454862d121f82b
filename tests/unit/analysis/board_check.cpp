#include "ocm/analysis/board_check.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/topics/amiro.hpp"

namespace analysis_board_check_test {

using namespace ocm;
using namespace ocm::analysis;
using namespace std::chrono_literals;
using protocol::Priority;
using scheduling::Level;

using Check = BoardCheck<64>;
using Admission = BoardAdmission<amiro::DiWheelDrive, amiro::bit_rate>;

const protocol::Topic& topic(std::string_view name) {
  return *amiro::catalogue.find(name);
}

TEST_CASE("board_check: streams of one level delay each other whatever their identifiers are") {
  Check check{amiro::catalogue, 0};
  check.runs(topic("mag"), 900us, Priority::medium);
  CHECK(check.fits());  // 270 us of any other frame and 542 of its own
  check.runs(topic("gyro"), 500ms, Priority::medium);
  CHECK(!check.fits());  // 222 us more, although its identifier is the less urgent one
  check.runs(topic("gyro"), 500ms, Priority::low);
  CHECK(check.fits());
}

TEST_CASE("board_check: other boards' streams change nothing") {
  Check check{amiro::catalogue, 0};
  check.runs(topic("mag"), 900us, Priority::medium);
  check.runs(topic("ring"), 1us, Priority::urgent);
  CHECK(check.fits());
}

TEST_CASE("board_check: of a board with more sensors nothing is known") {
  CHECK(BoardCheck<8>{amiro::catalogue, 0}.fits());
  CHECK(!BoardCheck<7>{amiro::catalogue, 0}.fits());
}

TEST_CASE("board_check: as a board decides that has no processor to speak of") {
  std::vector<const protocol::Topic*> sensors;
  for (const auto& each : amiro::catalogue.topics)
    if (each.kind == protocol::Kind::sensor && each.board == 0) sensors.push_back(&each);
  REQUIRE(sensors.size() == amiro::DiWheelDrive::sensors::size);
  std::mt19937 random{7};  // NOLINT: the same every time
  std::array<int, 2> seen{};
  for (int round = 0; round < 2000; ++round) {
    Admission board;
    Check check{amiro::catalogue, 0};
    bool fits = true;
    for (std::size_t i = 0; i < sensors.size() && fits; ++i) {
      const base::Duration period = std::chrono::microseconds{800 << random() % 8};
      const auto level = static_cast<Level>(random() % 4);
      fits = board.admit(i, period, level) == base::Error::none;
      check.runs(*sensors[i], period, static_cast<Priority>(level));
      CHECK(check.fits() == fits);
    }
    ++seen[fits ? 1 : 0];
  }
  CHECK(seen[0] > 200);
  CHECK(seen[1] > 200);
}

}  // namespace analysis_board_check_test
