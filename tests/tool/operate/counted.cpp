// Whether set points come as the proof counts them.
#include "cli/operate/counted.hpp"

#include <chrono>

#include <catch2/catch.hpp>

namespace operate_counted_test {

using namespace std::chrono_literals;
using namespace ocm;
namespace operate = cli::operate;
using protocol::Priority;

TEST_CASE("counted: two set points may come at once, and the third one a period behind the first") {
  operate::OperatorFile file;
  file.parts.resize(2);
  file.parts[0].expected.push_back({3, 100ms, Priority::medium});
  file.stated_others.push_back({5, 200ms, Priority::low});
  operate::Counted counted{file};
  const base::Time now{1h};
  const auto takes = [&](base::Duration after, std::uint16_t topic = 3, Priority priority = Priority::medium,
                         std::uint16_t configuration = 0) {
    return counted.take(configuration, topic, priority, now + after);
  };
  CHECK(takes(0ms));
  CHECK(takes(0ms));
  CHECK_FALSE(takes(0ms));
  CHECK_FALSE(takes(100ms - 1ns));
  CHECK(takes(100ms));
  CHECK_FALSE(takes(1s, 3, Priority::high));
  CHECK(takes(1s, 3, Priority::low));
  for (int i = 0; i < 5; ++i) CHECK(takes(0ms, 9));                       // it is not counted
  for (int i = 0; i < 5; ++i) CHECK(takes(0ms, 3, Priority::urgent, 1));  // nor there
  CHECK(takes(0ms, 5, Priority::low));
  CHECK_FALSE(takes(1s, 5, Priority::medium));
}

}  // namespace operate_counted_test
