#include "ocm/mapper/app/input.hpp"

#include <deque>
#include <random>

#include <catch2/catch.hpp>

namespace mapper_app_input_test {

using namespace ocm;
using mapper::app::Input;

TEST_CASE("mapper input: first in, first out, and a byte without room is lost and counted",
          "[mapper_input]") {
  Input<3> input;
  CHECK(input.pop().error == base::Error::no_answer);
  for (std::uint8_t byte = 1; byte <= 5; ++byte) input.push(byte);
  CHECK(input.lost() == 2);
  CHECK(*input.pop() == 1);
  input.push(6);
  CHECK(*input.pop() == 2);
  CHECK(*input.pop() == 3);
  CHECK(*input.pop() == 6);
  CHECK(input.pop().error == base::Error::no_answer);
  CHECK(input.lost() == 2);
}

TEST_CASE("mapper input: what is dropped is gone, and counted", "[mapper_input]") {
  Input<4> input;
  input.push(1);
  input.push(2);
  input.drop();
  CHECK(input.dropped() == 2);
  CHECK(input.size() == 0);
  input.push(3);
  CHECK(*input.pop() == 3);
  CHECK(input.lost() == 0);
}

TEST_CASE("mapper input: half full is when it should be read", "[mapper_input]") {
  Input<4> input;
  input.push(1);
  CHECK_FALSE(input.filling());
  input.push(1);
  CHECK(input.filling());
}

TEST_CASE("mapper input: random pushes and pops against a queue", "[mapper_input]") {
  std::mt19937 random{3};
  Input<16> input;
  std::deque<std::uint8_t> model;
  std::uint32_t lost = 0;
  for (int i = 0; i < 100'000; ++i) {
    if (random() % 100 < 55) {
      const auto byte = static_cast<std::uint8_t>(random());
      input.push(byte);
      if (model.size() < 16)
        model.push_back(byte);
      else
        ++lost;
    } else {
      const auto byte = input.pop();
      REQUIRE(byte.ok() == !model.empty());
      if (!byte) continue;
      REQUIRE(*byte == model.front());
      model.pop_front();
    }
    REQUIRE(input.size() == model.size());
  }
  CHECK(input.lost() == lost);
  CHECK(lost > 1000);
}

}  // namespace mapper_app_input_test
