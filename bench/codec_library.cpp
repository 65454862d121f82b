// The same work with the generated header, and with its catalogue.
#include "ocm/client/frame_index.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/topics/amiro.hpp"

#include "bench/codec.hpp"

namespace ocm::bench {

std::uint64_t decode_by_library(std::span<const can::Frame> frames) {
  std::uint64_t sum = 0;
  for (const can::Frame& frame : frames) {
    switch (protocol::Identifier::decode(frame.id).topic.value) {
      case amiro::Motors::id.value: {
        const auto m = amiro::Motors::decode(frame.data);
        sum += weighted(m.x, m.z);
        break;
      }
      case amiro::OdometryVelocity::id.value: {
        const auto v = amiro::OdometryVelocity::decode(frame.data);
        sum += weighted(v.x, v.z);
        break;
      }
      case amiro::OdometryPose::id.value: {
        const auto p = amiro::OdometryPose::decode(frame.data);
        sum += weighted(p.x, p.y, p.orientation);
        break;
      }
      case amiro::FloorProximity::id.value: {
        const auto f = amiro::FloorProximity::decode(frame.data);
        sum += weighted(f.sensor_1, f.sensor_2, f.sensor_3, f.sensor_4);
        break;
      }
      case amiro::MagnetometerX::id.value:
        sum += weighted(amiro::MagnetometerX::decode(frame.data).field);
        break;
      case amiro::MagnetometerY::id.value:
        sum += weighted(amiro::MagnetometerY::decode(frame.data).field);
        break;
      case amiro::MagnetometerZ::id.value:
        sum += weighted(amiro::MagnetometerZ::decode(frame.data).field);
        break;
      case amiro::Gyroscope::id.value: {
        const auto g = amiro::Gyroscope::decode(frame.data);
        sum += weighted(g.x, g.y, g.z);
        break;
      }
      case amiro::Accelerometer::id.value: {
        const auto a = amiro::Accelerometer::decode(frame.data);
        sum += weighted(a.x, a.y, a.z);
        break;
      }
      case amiro::PowerStatus::id.value: {
        const auto p = amiro::PowerStatus::decode(frame.data);
        sum += weighted(p.flags, p.state_of_charge, p.minutes, p.power);
        break;
      }
      case amiro::ProximityRingSensor::id.value:
      case amiro::ProximityRingSensor::id.value + 1:
      case amiro::ProximityRingSensor::id.value + 2:
      case amiro::ProximityRingSensor::id.value + 3:
      case amiro::ProximityRingSensor::id.value + 4:
      case amiro::ProximityRingSensor::id.value + 5:
      case amiro::ProximityRingSensor::id.value + 6:
      case amiro::ProximityRingSensor::id.value + 7:
        sum += weighted(amiro::ProximityRingSensor::decode(frame.data).proximity);
        break;
      case amiro::Led::id.value:
      case amiro::Led::id.value + 1:
      case amiro::Led::id.value + 2:
      case amiro::Led::id.value + 3:
      case amiro::Led::id.value + 4:
      case amiro::Led::id.value + 5:
      case amiro::Led::id.value + 6:
      case amiro::Led::id.value + 7: {
        const auto l = amiro::Led::decode(frame.data);
        sum += weighted(l.red, l.green, l.blue);
        break;
      }
      default:
        break;
    }
  }
  return sum;
}

std::uint64_t decode_by_catalogue(std::span<const can::Frame> frames) {
  static const client::FrameIndex index{amiro::catalogue};
  static constexpr std::uint64_t weights[] = {1, 3, 5, 9};
  std::uint64_t sum = 0;
  for (const can::Frame& frame : frames) {
    const auto ref = index.find(protocol::Identifier::decode(frame.id));
    if (!ref) continue;
    std::size_t i = 0;
    for (const protocol::Field& field : ref.layout().fields)
      sum += weights[i++] * static_cast<std::uint64_t>(field.raw(frame.data));
  }
  return sum;
}

namespace {

template <class T>
T narrow(std::int32_t number) {
  return static_cast<T>(number);
}

void encode(const Numbers& n, can::Payload& out) {
  const auto& f = n.field;
  using i16 = std::int16_t;
  using u16 = std::uint16_t;
  using u8 = std::uint8_t;
  switch (n.topic) {
    case amiro::Motors::id.value:
      out = amiro::Motors{f[0], f[1]}.encode();
      break;
    case amiro::OdometryVelocity::id.value:
      out = amiro::OdometryVelocity{f[0], f[1]}.encode();
      break;
    case amiro::OdometryPose::id.value:
      out = amiro::OdometryPose{f[0], f[1], narrow<u16>(f[2])}.encode();
      break;
    case amiro::FloorProximity::id.value:
      out = amiro::FloorProximity{narrow<u16>(f[0]), narrow<u16>(f[1]), narrow<u16>(f[2]), narrow<u16>(f[3])}
                .encode();
      break;
    case amiro::MagnetometerX::id.value:
      out = amiro::MagnetometerX{f[0]}.encode();
      break;
    case amiro::MagnetometerY::id.value:
      out = amiro::MagnetometerY{f[0]}.encode();
      break;
    case amiro::MagnetometerZ::id.value:
      out = amiro::MagnetometerZ{f[0]}.encode();
      break;
    case amiro::Gyroscope::id.value:
      out = amiro::Gyroscope{narrow<i16>(f[0]), narrow<i16>(f[1]), narrow<i16>(f[2])}.encode();
      break;
    case amiro::Accelerometer::id.value:
      out = amiro::Accelerometer{narrow<i16>(f[0]), narrow<i16>(f[1]), narrow<i16>(f[2])}.encode();
      break;
    case amiro::PowerStatus::id.value:
      out = amiro::PowerStatus{narrow<u8>(f[0]), narrow<u8>(f[1]), narrow<u16>(f[2]), narrow<i16>(f[3])}
                .encode();
      break;
    case amiro::ProximityRingSensor::id.value:
    case amiro::ProximityRingSensor::id.value + 1:
    case amiro::ProximityRingSensor::id.value + 2:
    case amiro::ProximityRingSensor::id.value + 3:
    case amiro::ProximityRingSensor::id.value + 4:
    case amiro::ProximityRingSensor::id.value + 5:
    case amiro::ProximityRingSensor::id.value + 6:
    case amiro::ProximityRingSensor::id.value + 7:
      out = amiro::ProximityRingSensor{narrow<u16>(f[0])}.encode();
      break;
    case amiro::Led::id.value:
    case amiro::Led::id.value + 1:
    case amiro::Led::id.value + 2:
    case amiro::Led::id.value + 3:
    case amiro::Led::id.value + 4:
    case amiro::Led::id.value + 5:
    case amiro::Led::id.value + 6:
    case amiro::Led::id.value + 7:
      out = amiro::Led{narrow<u8>(f[0]), narrow<u8>(f[1]), narrow<u8>(f[2])}.encode();
      break;
    default:
      break;
  }
}

}  // namespace

void encode_by_library(std::span<const Numbers> numbers, can::Payload* frames) {
  for (const Numbers& n : numbers) encode(n, *frames++);
}

}  // namespace ocm::bench
