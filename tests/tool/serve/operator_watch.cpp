#include "cli/serve/operator_watch.hpp"

#include <cstddef>
#include <thread>

#include <catch2/catch.hpp>

#include "tool/thread_signals.hpp"

namespace serve_operator_watch_test {

using ocm::cli::serve::OperatorWatch;
using ocm::test::keeps_all_away;
using ocm::test::kept_away;

TEST_CASE("operator watch: no operator runs, and signals are for the thread that has the bus") {
  const auto before = kept_away();
  const OperatorWatch watch{"can97"};
  while (watch.presence() == OperatorWatch::Presence::unknown) std::this_thread::yield();
  CHECK(watch.presence() == OperatorWatch::Presence::none);
  CHECK(watch.newest() == R"({"running":false})");
  std::size_t others = 0;
  for (const auto& [thread, signals] : kept_away()) {
    if (const auto known = before.find(thread); known != before.end()) {
      CHECK(signals == known->second);
    } else {
      CHECK(keeps_all_away(signals));
      ++others;
    }
  }
  CHECK(others == 1);
}

}  // namespace serve_operator_watch_test
