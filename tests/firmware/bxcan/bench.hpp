/// A controller that has started, on its model.
#pragma once

#include <cstdint>

#include "ocm/base/time.hpp"
#include "ocm/can/bit_timing.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/topics/amiro.hpp"

#include "firmware/drivers/bxcan.hpp"
#include "sim/parts/bxcan_model.hpp"

namespace ocm::bxcan_tests {

namespace bxcan = firmware::drivers::bxcan;
using Model = sim::BxcanModel;
using ModelRegisters = sim::BxcanModelRegisters;
using bxcan::Register;
using End = Model::End;

inline constexpr can::BitTiming timing = *can::find_bit_timing(36'000'000, 500'000, 833);

template <std::size_t capacity = 24, std::size_t reserve = 4>
struct Bench {
  Model model;
  bxcan::Bxcan<ModelRegisters, capacity, reserve> can{ModelRegisters{model}};
  base::Status started = can.start(timing, bxcan::filter_banks_of<amiro::DiWheelDrive>());

  Bench() {
    model.write(Register::mcr, model.read(Register::mcr)), model.read(Register::msr);
  }  // time passes

  /// One frame on the bus, if there is one, and the interrupt after it.
  bool transfer(End how = End::acknowledged) {
    if (!model.begin()) return false;
    model.end(how);
    interrupt();
    return true;
  }
  void interrupt() {
    while (model.transmit_interrupt()) can.on_transmit();
  }
};

/// A frame whose data number it.
constexpr can::Frame frame(std::uint32_t id, std::uint8_t serial = 0, std::uint8_t more = 0) {
  return {id, 8, {serial, more, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77}};
}

}  // namespace ocm::bxcan_tests
