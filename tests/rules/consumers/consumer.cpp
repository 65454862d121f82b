// A program that uses ocm. Two source files include everything: what is not inline does not link.
#include <cstdio>
#include <ocm/can/text.hpp>

#ifdef OCM_CONSUMER_GENERATED
#include <mine/topics.hpp>  // made by the installed ocm-generate
#else
#include <ocm/topics/amiro.hpp>
#endif

bool wrong_interface_is_refused();

int main() {
  // The request that is printed in the thesis: the magnetometer every 900 us. [Thesis 4.2]
  using namespace std::chrono_literals;
  const auto request = ocm::protocol::publish_every(amiro::MagnetometerX::id, 900us);
  if (!request || ocm::can::to_text(*request).view() != "205#01840302") {
    std::puts("the request is wrong");
    return 1;
  }
  if (!wrong_interface_is_refused()) {
    std::puts("a CAN interface was opened that does not exist");
    return 1;
  }
  return 0;
}
