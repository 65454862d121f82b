#include "cli/serve/operator_watch.hpp"

#include <cstddef>
#include <map>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>

#include <catch2/catch.hpp>

#include "tool/serve/played_operator.hpp"
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

/// What is known behind the first look for an operator that answers so.
std::pair<OperatorWatch::Presence, std::string> first_look(std::map<std::string, std::string> answers) {
  const ocm::test::PlayedOperator guard{"can97", std::move(answers)};
  const OperatorWatch watch{"can97"};
  while (watch.presence() == OperatorWatch::Presence::unknown) std::this_thread::yield();
  return {watch.presence(), watch.newest()};
}

TEST_CASE("operator watch: what an operator says of itself, and one that does not answer") {
  using Presence = OperatorWatch::Presence;
  const auto [presence, text] = first_look({});
  CHECK(presence == Presence::runs);
  const std::string who = "operator guard (process " + std::to_string(::getpid()) + ")";
  CHECK(text ==
        R"({"running":true,"who":")" + who + R"x(","status":{"asked":"status"},"why":{"asked":"why"}})x");
  for (const char* const request : {"hello ", "status json", "why json"}) {
    INFO(request);
    const auto [other, nothing] = first_look({{request, "no\nit is asked too much\nwait"}});
    CHECK(other == Presence::silent);
    CHECK(nothing == R"({"running":false})");
  }
}

}  // namespace serve_operator_watch_test
