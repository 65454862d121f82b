// The same work with the header that ocm-generate makes of the DBC file.
#include <algorithm>
#include <bit>
#include <cstring>
#include <small_car.hpp>

#include "bench/messages.hpp"

namespace ocm::bench {
namespace {

template <class T>
T read(const can::Frame& frame) {
  T message;
  message.bytes = frame.data;
  return message;
}

std::uint64_t service(const small_car::Service& m) {
  using Page = small_car::Service::PageValue;
  switch (m.Page()) {
    case Page::software:
      return weighted_sum(m.Page_raw(), m.SoftwareMajor_raw(), m.SoftwareMinor_raw(), m.BuildNumber_raw());
    case Page::faults:
      return weighted_sum(m.Page_raw(), m.FaultCode_raw(), m.FaultCount_raw(), m.FaultActive_raw());
    case Page::time:
      return weighted_sum(m.Page_raw(), m.OperatingTime_raw());
    case Page::distance:
      return weighted_sum(m.Page_raw(), m.Odometer_raw(), m.NextService_raw());
  }
  return weighted_sum(m.Page_raw());
}

}  // namespace

std::uint64_t decode_car_by_library(std::span<const can::Frame> frames) {
  using namespace small_car;
  std::uint64_t sum = 0;
  for (const can::Frame& frame : frames) {
    switch (frame.id) {
      case Engine::address.number: {
        const auto m = read<Engine>(frame);
        sum += weighted_sum(m.Speed_raw(), m.Torque_raw(), m.Throttle_raw(), m.Coolant_raw(),
                            m.OilPressureLow_raw(), m.Running_raw(), m.Counter());
        break;
      }
      case Transmission::address.number: {
        const auto m = read<Transmission>(frame);
        sum += weighted_sum(m.Lever_raw(), m.Gear_raw(), m.OilTemperature_raw(), m.InputSpeed_raw());
        break;
      }
      case Wheels::address.number: {
        const auto m = read<Wheels>(frame);
        sum += weighted_sum(m.FrontLeft_raw(), m.FrontRight_raw(), m.RearLeft_raw(), m.RearRight_raw());
        break;
      }
      case Driving::address.number: {
        const auto m = read<Driving>(frame);
        sum += weighted_sum(m.Speed_raw(), m.Acceleration_raw(), m.BrakePressure_raw(), m.BrakePedal_raw(),
                            m.StabilityControl_raw(), m.SteeringAngle_raw());
        break;
      }
      case Doors::address.number: {
        const auto m = read<Doors>(frame);
        sum += weighted_sum(m.DriverOpen_raw(), m.PassengerOpen_raw(), m.RearLeftOpen_raw(),
                            m.RearRightOpen_raw(), m.TailgateOpen_raw(), m.Locked_raw(), m.DriverWindow());
        break;
      }
      case Lights::address.number: {
        const auto m = read<Lights>(frame);
        sum += weighted_sum(m.Beam_raw(), m.Indicator_raw(), m.BrakeLight_raw(), m.FogLight_raw(),
                            m.Instruments_raw());
        break;
      }
      case LockCommand::address.number: {
        const auto m = read<LockCommand>(frame);
        sum += weighted_sum(m.Action_raw(), m.From_raw());
        break;
      }
      case Battery::address.number: {
        const auto m = read<Battery>(frame);
        sum += weighted_sum(m.Voltage_raw(), m.Current_raw(), m.Charge_raw(), m.Temperature(), m.State_raw());
        break;
      }
      case Trip::address.number: {
        const auto m = read<Trip>(frame);
        sum += weighted_sum(m.Distance_raw(), m.Consumption_raw());
        break;
      }
      case Service::address.number:
        sum += service(read<Service>(frame));
        break;
      default:
        break;
    }
  }
  return sum;
}

void encode_car_by_library(std::span<const CarNumbers> numbers, can::Payload* frames) {
  using namespace small_car;
  for (const CarNumbers& n : numbers) {
    const auto& f = n.field;
    can::Payload& out = *frames++;
    const auto begin = [](auto message) {
      message.bytes = {};
      return message;
    };
    const auto u8 = [&f](unsigned i) { return static_cast<std::uint8_t>(f[i]); };
    const auto u16 = [&f](unsigned i) { return static_cast<std::uint16_t>(f[i]); };
    const auto i16 = [&f](unsigned i) { return static_cast<std::int16_t>(f[i]); };
    switch (n.id) {
      case Engine::address.number: {
        auto m = begin(Engine{});
        m.set_Speed_raw(u16(0)), m.set_Torque_raw(i16(1)), m.set_Throttle_raw(u8(2)),
            m.set_Coolant_raw(u8(3));
        m.set_OilPressureLow_raw(u8(4)), m.set_Running_raw(u8(5)), m.set_Counter(u8(6));
        out = m.bytes;
        break;
      }
      case Transmission::address.number: {
        auto m = begin(Transmission{});
        m.set_Lever_raw(u8(0)), m.set_Gear_raw(static_cast<std::int8_t>(f[1]));
        m.set_OilTemperature_raw(u8(2)), m.set_InputSpeed_raw(u16(3));
        out = m.bytes;
        break;
      }
      case Wheels::address.number: {
        auto m = begin(Wheels{});
        m.set_FrontLeft_raw(u16(0)), m.set_FrontRight_raw(u16(1));
        m.set_RearLeft_raw(u16(2)), m.set_RearRight_raw(u16(3));
        out = m.bytes;
        break;
      }
      case Driving::address.number: {
        auto m = begin(Driving{});
        m.set_Speed_raw(u16(0)), m.set_Acceleration_raw(i16(1)), m.set_BrakePressure_raw(u16(2));
        m.set_BrakePedal_raw(u8(3)), m.set_StabilityControl_raw(u8(4)), m.set_SteeringAngle_raw(i16(5));
        out = m.bytes;
        break;
      }
      case Doors::address.number: {
        auto m = begin(Doors{});
        m.set_DriverOpen_raw(u8(0)), m.set_PassengerOpen_raw(u8(1)), m.set_RearLeftOpen_raw(u8(2));
        m.set_RearRightOpen_raw(u8(3)), m.set_TailgateOpen_raw(u8(4)), m.set_Locked_raw(u8(5));
        m.set_DriverWindow(u8(6));
        out = m.bytes;
        break;
      }
      case Lights::address.number: {
        auto m = begin(Lights{});
        m.set_Beam_raw(u8(0)), m.set_Indicator_raw(u8(1)), m.set_BrakeLight_raw(u8(2)),
            m.set_FogLight_raw(u8(3));
        m.set_Instruments_raw(u8(4));
        out = m.bytes;
        break;
      }
      case LockCommand::address.number: {
        auto m = begin(LockCommand{});
        m.set_Action_raw(u8(0)), m.set_From_raw(u8(1));
        out = m.bytes;
        break;
      }
      case Battery::address.number: {
        auto m = begin(Battery{});
        m.set_Voltage_raw(u16(0)), m.set_Current_raw(i16(1)), m.set_Charge_raw(u8(2));
        m.set_Temperature(static_cast<std::int8_t>(f[3])), m.set_State_raw(u8(4));
        out = m.bytes;
        break;
      }
      case Trip::address.number: {
        auto m = begin(Trip{});
        m.set_Distance_raw(static_cast<std::uint32_t>(f[0]));
        m.set_Consumption_raw(static_cast<std::uint32_t>(f[1]));
        out = m.bytes;
        break;
      }
      case Service::address.number: {
        auto m = begin(Service{});
        m.set_Page(Service::PageValue::faults);
        m.set_FaultCode_raw(u16(0)), m.set_FaultCount_raw(u8(1)), m.set_FaultActive_raw(u8(2));
        out = m.bytes;
        break;
      }
      default:
        out = {};
        break;
    }
  }
}

// --- a table ---

namespace {

/// A field of a frame that is read as one word: of its bytes as they are, or from the last to the first.
struct Row {
  std::uint64_t mask = 0;
  std::uint64_t sign = 0;
  std::uint32_t shift = 0;
  std::uint32_t word = 0;
};
constexpr std::size_t rows_of_one = 8;
using Rows = std::array<Row, rows_of_one>;

constexpr Row row(protocol::Position at, bool is_signed) {
  Row row;
  row.mask = ~std::uint64_t{0} >> (64U - at.width);
  row.sign = is_signed ? std::uint64_t{1} << (at.width - 1U) : 0;
  row.word = at.order == protocol::ByteOrder::big ? 1 : 0;
  const unsigned first = at.start / 8U * 8U + 7U - at.start % 8U;
  row.shift = row.word == 0 ? at.start : 64U - first - at.width;
  return row;
}
constexpr Rows rows(std::initializer_list<Row> some) {
  Rows all{};
  std::copy(some.begin(), some.end(), all.begin());
  return all;
}

/// What an identifier leads to: the first of its sets of rows, and which bits of the frame say how many
/// further.
struct Entry {
  std::uint16_t first = 0;
  std::uint16_t mask = 0;
};

struct Table {
  std::array<Entry, 0x800> entries{};
  std::array<Rows, 11 + 256> sets{};  // 0: nothing, of identifiers that no message has
};

constexpr Table make_table() {
  using namespace small_car;
  Table table;
  std::uint16_t next = 1;
  const auto add = [&](const protocol::Address& address, const Rows& set) {
    table.sets[next] = set;
    table.entries[address.number].first = next++;
  };
  const auto u = [](protocol::Position at) { return row(at, false); };
  const auto i = [](protocol::Position at) { return row(at, true); };
  add(Engine::address,
      rows({u(Engine::Speed_at), i(Engine::Torque_at), u(Engine::Throttle_at), u(Engine::Coolant_at),
            u(Engine::OilPressureLow_at), u(Engine::Running_at), u(Engine::Counter_at)}));
  add(Transmission::address, rows({u(Transmission::Lever_at), i(Transmission::Gear_at),
                                   u(Transmission::OilTemperature_at), u(Transmission::InputSpeed_at)}));
  add(Wheels::address, rows({u(Wheels::FrontLeft_at), u(Wheels::FrontRight_at), u(Wheels::RearLeft_at),
                             u(Wheels::RearRight_at)}));
  add(Driving::address,
      rows({u(Driving::Speed_at), i(Driving::Acceleration_at), u(Driving::BrakePressure_at),
            u(Driving::BrakePedal_at), u(Driving::StabilityControl_at), i(Driving::SteeringAngle_at)}));
  add(Doors::address, rows({u(Doors::DriverOpen_at), u(Doors::PassengerOpen_at), u(Doors::RearLeftOpen_at),
                            u(Doors::RearRightOpen_at), u(Doors::TailgateOpen_at), u(Doors::Locked_at),
                            u(Doors::DriverWindow_at)}));
  add(Lights::address, rows({u(Lights::Beam_at), u(Lights::Indicator_at), u(Lights::BrakeLight_at),
                             u(Lights::FogLight_at), u(Lights::Instruments_at)}));
  add(LockCommand::address, rows({u(LockCommand::Action_at), u(LockCommand::From_at)}));
  add(Battery::address, rows({u(Battery::Voltage_at), i(Battery::Current_at), u(Battery::Charge_at),
                              i(Battery::Temperature_at), u(Battery::State_at)}));
  add(Trip::address, rows({u(Trip::Distance_at), u(Trip::Consumption_at)}));
  // A set of rows for each number of the selector, which is the first byte.
  table.entries[Service::address.number] = {next, 0xFF};
  for (unsigned page = 0; page < 256; ++page) table.sets[next + page] = rows({u(Service::Page_at)});
  table.sets[next] = rows({u(Service::Page_at), u(Service::SoftwareMajor_at), u(Service::SoftwareMinor_at),
                           u(Service::BuildNumber_at)});
  table.sets[next + 1U] = rows(
      {u(Service::Page_at), u(Service::FaultCode_at), u(Service::FaultCount_at), u(Service::FaultActive_at)});
  table.sets[next + 2U] = rows({u(Service::Page_at), u(Service::OperatingTime_at)});
  table.sets[next + 3U] = rows({u(Service::Page_at), u(Service::Odometer_at), i(Service::NextService_at)});
  return table;
}

constexpr Table table = make_table();

}  // namespace

std::uint64_t decode_car_by_table(std::span<const can::Frame> frames) {
  std::uint64_t sum = 0;
  for (const can::Frame& frame : frames) {
    std::uint64_t words[2];
    std::memcpy(&words[0], frame.data.data(), sizeof words[0]);
    words[1] = __builtin_bswap64(words[0]);
    const Entry entry = table.entries[frame.id & 0x7FF];
    const Rows& set = table.sets[entry.first + (words[0] & entry.mask)];
    std::array<std::int64_t, rows_of_one> raw;
    for (std::size_t i = 0; i < rows_of_one; ++i)
      raw[i] = static_cast<std::int64_t>(
          (((words[set[i].word] >> set[i].shift) & set[i].mask) ^ set[i].sign) - set[i].sign);
    for (std::size_t i = 0; i < rows_of_one; ++i) sum += (2 * i + 1) * static_cast<std::uint64_t>(raw[i]);
  }
  return sum;
}

#if defined(__x86_64__)

namespace {

using Four = std::uint64_t __attribute__((vector_size(32)));

/// The same rows, a column each.
struct alignas(64) Columns {
  std::array<std::uint64_t, rows_of_one> swapped{}, shift{}, mask{}, sign{};
};

constexpr auto make_columns() {
  std::array<Columns, table.sets.size()> all{};
  for (std::size_t set = 0; set < all.size(); ++set)
    for (std::size_t i = 0; i < rows_of_one; ++i) {
      const Row& row = table.sets[set][i];
      all[set].swapped[i] = row.word == 0 ? 0 : ~std::uint64_t{0};
      all[set].shift[i] = row.shift;
      all[set].mask[i] = row.mask;
      all[set].sign[i] = row.sign;
    }
  return all;
}
constexpr auto columns = make_columns();

}  // namespace

[[gnu::target("avx2")]] std::uint64_t decode_car_by_vectors(std::span<const can::Frame> frames) {
  static constexpr std::array<std::uint64_t, rows_of_one> weights{1, 3, 5, 7, 9, 11, 13, 15};
  Four sum{};
  for (const can::Frame& frame : frames) {
    std::uint64_t word;
    std::memcpy(&word, frame.data.data(), sizeof word);
    const Entry entry = table.entries[frame.id & 0x7FF];
    const Columns& set = columns[entry.first + (word & entry.mask)];
    const std::uint64_t other = word ^ __builtin_bswap64(word);
    const Four as_it_is{word, word, word, word}, difference{other, other, other, other};
    for (std::size_t i = 0; i < rows_of_one; i += 4) {
      Four swapped, shift, mask, sign, weight;
      std::memcpy(&swapped, &set.swapped[i], sizeof swapped);
      std::memcpy(&shift, &set.shift[i], sizeof shift);
      std::memcpy(&mask, &set.mask[i], sizeof mask);
      std::memcpy(&sign, &set.sign[i], sizeof sign);
      std::memcpy(&weight, &weights[i], sizeof weight);
      sum += (((((as_it_is ^ (difference & swapped)) >> shift) & mask) ^ sign) - sign) * weight;
    }
  }
  return sum[0] + sum[1] + sum[2] + sum[3];
}
bool has_vectors() {
  return __builtin_cpu_supports("avx2") != 0;
}

#else

std::uint64_t decode_car_by_vectors(std::span<const can::Frame> frames) {
  return decode_car_by_table(frames);
}
bool has_vectors() {
  return false;
}

#endif

}  // namespace ocm::bench
