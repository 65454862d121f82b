// The proximity ring's eight frames every 4 ms, as if the spec said so, beside all that the boards send.
// expect g++: misses_its_deadline<ocm::analysis::FreshFrame<Ring, 500000, 3,
// expect clang++: misses_its_deadline<ocm::analysis::FreshFrame<Ring, 500000, 3,
#include "firmware/boards/bus.hpp"

using namespace ocm;

struct Ring : amiro::ProximityRing {
#ifdef OCM_MUST_FAIL
  static constexpr protocol::Period period{4, protocol::PeriodUnit::milliseconds};
#else
  static constexpr protocol::Period period{10, protocol::PeriodUnit::milliseconds};
#endif
  static constexpr Ring decode(const std::array<can::Payload, 8>& all) noexcept {
    return {amiro::ProximityRing::decode(all)};
  }
};
struct MiddleBoard {
  using sensors = protocol::TopicList<amiro::PowerStatus, Ring, amiro::PowerManagementStatus>;
};
using Bus = analysis::SentBy<amiro::bit_rate, amiro::DiWheelDrive, MiddleBoard, amiro::LightRing>;

static_assert(analysis::schedulable<Bus>);
