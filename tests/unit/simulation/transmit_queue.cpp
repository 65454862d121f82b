#include "ocm/simulation/transmit_queue.hpp"

#include <catch2/catch.hpp>

namespace simulation_transmit_queue_test {

using namespace ocm;
using simulation::QueueOrder;
using simulation::TransmitQueue;
using simulation::WaitingFrame;

// A classic frame that may start at once, unless more is said.
static_assert(WaitingFrame{}.key == 0 && WaitingFrame{}.fd == 0 && WaitingFrame{}.ready == 0);

/// A frame that is known by its key.
WaitingFrame waiting(std::uint32_t key, std::uint64_t ready = 0) {
  return {.frame = {.id = key}, .key = key, .ready = ready};
}

std::vector<std::uint32_t> keys(const TransmitQueue& queue) {
  std::vector<std::uint32_t> result;
  for (std::size_t i = 0; i < queue.size(); ++i) result.push_back(queue[i].key);
  return result;
}

using Keys = std::vector<std::uint32_t>;

TEST_CASE("a FIFO offers its oldest, mailboxes their lowest that is ready, of equals the oldest") {
  for (const QueueOrder order : {QueueOrder::fifo, QueueOrder::by_identifier}) {
    TransmitQueue queue{order, 4};
    CHECK(queue.offer(0) == queue.size());
    queue.push(waiting(7, 10));
    queue.push(waiting(3, 11));
    queue.push(waiting(3, 12));
    queue.push(waiting(1, 20));
    CHECK(queue.earliest() == 10);
    CHECK(queue.offer(9) == queue.size());
    CHECK(queue.offer(10) == 0);
    CHECK(queue.offer(19) == (order == QueueOrder::fifo ? 0U : 1U));
    CHECK(queue.offer(20) == (order == QueueOrder::fifo ? 0U : 3U));
  }
}

TEST_CASE("what was taken goes back to its place, wherever the ring begins") {
  for (std::size_t turns = 0; turns < 6; ++turns)
    for (std::size_t position = 0; position < 4; ++position) {
      CAPTURE(turns, position);
      TransmitQueue queue{QueueOrder::by_identifier, 4};
      for (std::size_t i = 0; i < turns; ++i) {
        queue.push(waiting(99));
        queue.take(0);
      }
      for (const std::uint32_t key : {10U, 11U, 12U, 13U}) queue.push(waiting(key));
      CHECK(queue.room() == 0);
      const WaitingFrame taken = queue.take(position);
      CHECK(taken.key == 10 + position);
      CHECK(queue.room() == 1);
      queue.push(waiting(14));  // came since, and fills the queue
      CHECK(queue.room() == 0);
      queue.put_back(position, taken);
      CHECK(keys(queue) == Keys{10, 11, 12, 13, 14});
      CHECK(queue.room() == 0);
      queue.take(0);
      CHECK(queue.room() == 0);
      queue.take(0);
      CHECK(queue.room() == 1);
      CHECK(keys(queue) == Keys{12, 13, 14});
    }
}

TEST_CASE("a queue has room for at least one frame, none at all before it is made") {
  CHECK(TransmitQueue{QueueOrder::fifo, 0}.room() == 1);
  CHECK(TransmitQueue{}.room() == 0);
  TransmitQueue queue{QueueOrder::fifo, 2};
  queue.push(waiting(1));
  queue.clear();
  CHECK(queue.empty());
  CHECK(queue.room() == 2);
}

}  // namespace simulation_transmit_queue_test
