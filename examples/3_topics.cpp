/// Topics: the generated header, typed; and the catalogue, the same facts as data.
#include <cstdio>

#include "ocm/can/text.hpp"
#include "ocm/topics/amiro.hpp"

using namespace ocm;

int main() {
  // Typed, for who knows the topic. 65532 is what the thesis's receiver printed for -4.
  const auto gyroscope = amiro::Gyroscope::decode(can::Payload{0x3E, 0x00, 0x1E, 0x00, 0xFC, 0xFF});
  std::printf("gyroscope: %.4f %.4f %.4f deg/s\n", gyroscope.x_deg_per_s(), gyroscope.y_deg_per_s(),
              gyroscope.z_deg_per_s());

  // As data, for tools: exact decimals, no floating point.
  const protocol::Topic* topic = amiro::catalogue.find("gyro");
  if (topic == nullptr) return 1;
  for (const auto& field : topic->frames[0].fields) {
    const auto value = field.physical(field.raw({0x3E, 0x00, 0x1E, 0x00, 0xFC, 0xFF}));
    const auto text = base::to_text(*value);
    std::printf("%.*s = %.*s %.*s\n", static_cast<int>(field.name.size()), field.name.data(),
                static_cast<int>(text.view().size()), text.view().data(), static_cast<int>(field.unit.size()),
                field.unit.data());
  }
}
