// What may be no frame is not sent as one.
// expect g++: invalid initialization of reference of type 'const ocm::can::Frame&'
// expect clang++: no known conversion from 'const base::Result<can::Frame>'
#include "ocm/protocol/request.hpp"

using namespace std::chrono_literals;

bool valid(const ocm::can::Frame& frame) {
  return ocm::can::validate(frame).ok();
}
bool use() {
  const auto frame = ocm::protocol::publish_every(ocm::protocol::TopicId{0x08}, 500ms);
#ifdef OCM_MUST_FAIL
  return valid(frame);
#else
  return frame && valid(*frame);
#endif
}
