#include <theirs.hpp>

static_assert(ferry::Range{0xABC, 0x123}.encode() == ocm::can::Payload{0xAB, 0xC1, 0x23});

int main() {
  ferry::Wheels wheels;
  wheels.set_x_m_per_s(0.5);
  return ferry::Wheels::decode(wheels.encode()).x == 500 ? 0 : 1;
}
