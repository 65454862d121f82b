#include "ocm/log/interfaces.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

#include <catch2/catch.hpp>

namespace log_interfaces_test {

using ocm::log::Interfaces;

TEST_CASE("interfaces are numbered as they come up") {
  Interfaces interfaces;
  CHECK(interfaces.number("can0") == 0);
  CHECK(interfaces.number("can1") == 1);
  CHECK(interfaces.number("can1") == 1);
  CHECK(interfaces.number("can0") == 0);
  CHECK(interfaces.size() == 2);
  CHECK(interfaces.name(1) == "can1");
  CHECK(interfaces.name(2).empty());
}

TEST_CASE("an interface that is added is another one, whatever it is called") {
  Interfaces interfaces;
  CHECK(interfaces.add("") == 0);
  CHECK(interfaces.add("") == 1);
  CHECK(interfaces.size() == 2);
}

TEST_CASE("a damaged log does not make interfaces without end") {
  Interfaces interfaces;
  for (std::size_t i = 0; i < Interfaces::most + 10; ++i) {
    const auto number = interfaces.number(std::to_string(i));
    CHECK(number == std::min(i, Interfaces::most - 1));
  }
  CHECK(interfaces.size() == Interfaces::most);
  CHECK(interfaces.name(Interfaces::most - 1) == std::to_string(Interfaces::most - 1));
  // Nor does one whose format numbers them.
  Interfaces numbered;
  for (std::size_t i = 0; i < Interfaces::most + 10; ++i)
    CHECK(numbered.add("can0") == std::min(i, Interfaces::most - 1));
  CHECK(numbered.size() == Interfaces::most);
  CHECK(numbered.number("can0") == 0);
}

}  // namespace log_interfaces_test
