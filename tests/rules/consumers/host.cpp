#include <ocm/can/text.hpp>
#include <ocm/client/robot.hpp>
#include <ocm/topics/amiro.hpp>
#include <ocm/transport/socketcan.hpp>
#include <ocm/transport/virtual_bus.hpp>

bool wrong_interface_is_refused() {
  return !ocm::transport::SocketCan::open("no-such-can");
}
