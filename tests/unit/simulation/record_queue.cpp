#include "ocm/simulation/record_queue.hpp"

#include <deque>

#include <catch2/catch.hpp>

#include "unit/base/random.hpp"

namespace simulation_record_queue_test {

using namespace ocm;
using simulation::RecordQueue;
namespace vb = transport::virtual_bus;

vb::Record record(std::uint32_t number) {
  return vb::to_record(vb::Count{.type = vb::Type::credit, .count = number});
}

/// The oldest `count`, as the kernel would take them.
std::deque<std::uint64_t> front(RecordQueue& queue, std::size_t count) {
  std::deque<std::uint64_t> numbers;
  for (const iovec& piece : queue.front(count))
    for (std::size_t at = 0; at < piece.iov_len; at += vb::record_size) {
      vb::Record one;
      std::memcpy(one.data(), static_cast<const std::byte*>(piece.iov_base) + at, one.size());
      numbers.push_back(vb::from_record<vb::Count>(one).count);
    }
  return numbers;
}

TEST_CASE("records come out in the order in which they went in, up to the limit") {
  RecordQueue queue;
  CHECK(queue.push(record(1), 2));
  CHECK(queue.push(record(2), 2));
  CHECK_FALSE(queue.push(record(3), 2));
  CHECK(front(queue, 2) == std::deque<std::uint64_t>{1, 2});
  queue.pop(1);
  CHECK(queue.push(record(4), 2));
  CHECK(front(queue, 2) == std::deque<std::uint64_t>{2, 4});
  queue.clear();
  CHECK(queue.size() == 0);
}

TEST_CASE("several records go in together or not at all") {
  RecordQueue queue;
  const std::array three{record(1), record(2), record(3)};
  CHECK(queue.push(three, 4));
  CHECK_FALSE(queue.push(three, 4));
  CHECK(queue.size() == 3);
  CHECK(queue.push(std::span{three}.first(1), 4));
  CHECK_FALSE(queue.push(std::span{three}.first(1), 3));  // a limit below what is there
  CHECK(front(queue, 4) == std::deque<std::uint64_t>{1, 2, 3, 1});
  queue.pop(3);
  CHECK(vb::from_record<vb::Count>(queue[0]).count == 1);
}

TEST_CASE("it is a queue, however it grows and turns") {
  ocm::test::Random random{7};
  RecordQueue queue;
  std::deque<std::uint64_t> expected;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    if (random.below(3) != 0) {
      const bool room = expected.size() < 1000;
      REQUIRE(queue.push(record(i), 1000) == room);
      if (room) expected.push_back(i);
    } else if (!expected.empty()) {
      const std::size_t count =
          random.below(static_cast<std::uint32_t>(std::min<std::size_t>(expected.size(), 40)) + 1);
      const auto numbers = front(queue, count);
      REQUIRE(numbers.size() == count);
      REQUIRE(std::equal(numbers.begin(), numbers.end(), expected.begin()));
      queue.pop(count);
      expected.erase(expected.begin(), expected.begin() + static_cast<std::ptrdiff_t>(count));
    }
    REQUIRE(queue.size() == expected.size());
  }
}

}  // namespace simulation_record_queue_test
