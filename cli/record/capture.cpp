#include "cli/record/capture.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "ocm/base/text.hpp"

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
      const auto received = bus_->receive(base::Duration{0});
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

canid_t raw_id(const log::Entry& entry) noexcept {
  canid_t id = entry.id;
  if (can::is_extended(entry.format)) id |= CAN_EFF_FLAG;
  if (can::is_remote(entry.format)) id |= CAN_RTR_FLAG;
  return id;
}

}  // namespace

bool passes(const log::Entry& entry, std::span<const can_filter> filters) noexcept {
  if (filters.empty() || entry.format == can::Format::error) return true;
  const canid_t id = raw_id(entry);
  return std::any_of(filters.begin(), filters.end(), [id](const can_filter& filter) {
    const bool opposite = (filter.can_id & CAN_INV_FILTER) != 0;
    const canid_t wanted = filter.can_id & ~canid_t{CAN_INV_FILTER};
    return ((id & filter.can_mask) == (wanted & filter.can_mask)) != opposite;
  });
}

transport::Outcome<can_filter> parse_filter(std::string_view text) {
  const transport::Failure refused{fmt::format("--filter {}: not a filter", text),
                                   "write id:mask in hexadecimal, such as 600:700 or 18FF0000:1FFF0000; "
                                   "id~mask for all the others"};
  const auto sign = text.find_first_of(":~");
  if (sign == std::string_view::npos) return refused;
  const auto id = base::parse_unsigned(text.substr(0, sign), 16);
  const auto mask = base::parse_unsigned(text.substr(sign + 1), 16);
  if (!id || !mask || *id > CAN_EFF_MASK || *mask > UINT32_MAX) return refused;
  can_filter filter{static_cast<canid_t>(*id), static_cast<canid_t>(*mask) & ~canid_t{CAN_ERR_FLAG}};
  if (sign == 8) filter.can_id |= CAN_EFF_FLAG;
  if (text[sign] == '~') filter.can_id |= CAN_INV_FILTER;
  return filter;
}

transport::Outcome<std::unique_ptr<Capture>> open_capture(std::string_view name, const Filters& filters) {
  const BusName parsed = parse_bus_name(name);
  if (parsed.kind == BusName::Kind::interface) return CanCapture::open(name, filters);
  auto bus = open_bus(parsed);
  if (!bus) return std::move(bus.error);
  return std::unique_ptr<Capture>{
      std::make_unique<BusCapture>(std::move(*bus), filters, parsed.kind == BusName::Kind::serial)};
}

}  // namespace ocm::cli::record
