// An actuator cannot be asked for samples.
// expect: SensorType
#include "ocm/client/robot.hpp"
#include "ocm/topics/amiro.hpp"
#include "ocm/transport/bus.hpp"

using Robot = ocm::client::Robot<ocm::transport::Bus>;

ocm::base::Status ask(Robot& robot) {
#ifdef OCM_MUST_FAIL
  return robot.once<amiro::Motors>();
#else
  return robot.once<amiro::Gyroscope>();
#endif
}
