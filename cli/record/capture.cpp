#include "cli/record/capture.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "cli/record/can_capture.hpp"
#include "cli/shared/buses.hpp"

namespace ocm::cli::record {
namespace {

using transport::BusState;

/// What any transport::Bus gives: the virtual bus, a serial adapter.
class BusCapture final : public Capture {
 public:
  BusCapture(std::unique_ptr<transport::Bus> bus, Filters filters, bool serial)
      : bus_(std::move(bus)), filters_(std::move(filters)), serial_(serial) {}

  std::size_t read(std::span<log::Entry> into, std::uint16_t interface) override {
    std::size_t count = 0;
    while (count < std::min(into.size(), batch)) {
      const auto received = bus_->receive_any(base::Duration{0});
      if (!received) {
        closed_ = received.error == base::Error::closed;
        break;
      }
      log::Entry entry{received->time, received->frame, interface};
      entry.direction = log::Direction::received;
      if (passes(entry, filters_)) into[count++] = entry;
    }
    return count;
  }

  std::string_view name() const override { return bus_->name(); }
  int descriptor() const override { return bus_->descriptor(); }
  BusState state() const override { return closed_ ? BusState::closed : bus_->state(); }
  const transport::Failure& failure() const override { return bus_->failure(); }
  std::uint64_t lost() const override { return bus_->counters().lost; }
  std::uint32_t bit_rate() const override { return bus_->bit_rate(); }
  bool keeps_times() const override { return !serial_; }  // of a serial adapter they are taken on arrival
  bool may_return() const override { return serial_; }

 private:
  std::unique_ptr<transport::Bus> bus_;
  Filters filters_;
  bool serial_;
  bool closed_ = false;
};

}  // namespace

transport::Outcome<std::unique_ptr<Capture>> open_capture(std::string_view name, const Filters& filters) {
  const BusName parsed = parse_bus_name(name);
  if (parsed.kind == BusName::Kind::interface) return CanCapture::open(name, filters);
  auto bus = open_bus(parsed);
  if (!bus) return std::move(bus.error);
  return std::unique_ptr<Capture>{
      std::make_unique<BusCapture>(std::move(*bus), filters, parsed.kind == BusName::Kind::serial)};
}

}  // namespace ocm::cli::record
