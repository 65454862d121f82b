#include "firmware/qemu/parts_link.hpp"

#include <algorithm>

namespace ocm::firmware::qemu {

void PartsLink::write(link::Request request, std::span<const std::uint8_t> head) noexcept {
  auto header = link::header(request);
  header[4] = static_cast<std::uint8_t>(head.size() + request.written.size());
  const chibios::Lock lock;  // a frame stays whole, also if another is posted meanwhile
  uart_->write(header);
  uart_->write(head);
  uart_->write(request.written);
}

void PartsLink::post(link::Request request) noexcept {
  request.sequence = 0;
  request.asked = 0;
  if (request.written.size() <= link::max_bytes) write(request, {});
}

void PartsLink::post_at_last(link::Request request) noexcept {
  UartRegisters uart{uart_number};
  uart.write(link::header(request));
  uart.write(request.written);
}

base::Status PartsLink::exchange(link::Request request, std::span<std::uint8_t> read,
                                 std::span<const std::uint8_t> head) noexcept {
  if (head.size() + request.written.size() > link::max_bytes || read.size() > link::max_bytes)
    return base::Error::bad_length;
  mutex_.lock();
  if (++sequence_ == 0) sequence_ = 1;
  request.sequence = sequence_;
  request.asked = static_cast<std::uint8_t>(read.size());
  write(request, head);

  base::Status result = base::Error::bus_fault;
  for (bool waiting = true; waiting;) {
    std::uint8_t byte = 0;
    if (!uart_->read(byte)) {
      waiting = signal_.wait(patience);
      if (!waiting)
        reader_ = {};  // half an answer, to the program before a restart, is not finished any more
    } else if (reader_.feed(byte) && reader_.answer().sequence == request.sequence) {
      const link::Answer answer = reader_.answer();
      if (answer.status != base::Error::none) {
        result = answer.status;
      } else if (answer.bytes.size() == read.size()) {
        std::ranges::copy(answer.bytes, read.begin());
        result = {};
      }
      waiting = false;
    }
  }
  mutex_.unlock();
  return result;
}

std::array<std::uint16_t, 2> LinkMotorTimers::encoders() noexcept {
  std::array<std::uint8_t, 4> bytes{};
  if (link_->exchange({.kind = link::Kind::encoders}, bytes))
    counts_ = {static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8),
               static_cast<std::uint16_t>(bytes[2] | bytes[3] << 8)};
  return counts_;
}

void LinkMotorTimers::set_duty(std::int16_t left, std::int16_t right) noexcept {
  const auto l = static_cast<std::uint16_t>(left);
  const auto r = static_cast<std::uint16_t>(right);
  const std::array<std::uint8_t, 4> bytes{static_cast<std::uint8_t>(l), static_cast<std::uint8_t>(l >> 8U),
                                          static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(r >> 8U)};
  link_->post({.kind = link::Kind::set_duty, .written = bytes});
}

std::uint8_t LinkInputs::read() noexcept {
  std::array<std::uint8_t, 1> byte{};
  if (link_->exchange({.kind = link::Kind::inputs, .unit = group_}, byte)) levels_ = byte[0];
  return levels_;
}

void LinkOutputs::write(std::uint8_t levels) noexcept {
  link_->post({.kind = link::Kind::outputs, .unit = group_, .written = {&levels, 1}});
}

base::Result<std::uint16_t> LinkConverter::convert(std::uint8_t channel) noexcept {
  std::array<std::uint8_t, 2> bytes{};
  if (const auto done = link_->exchange({.kind = link::Kind::convert, .unit = channel}, bytes); !done)
    return done.error;
  return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
}

void LinkPulseTimer::set_width(std::uint16_t counts) noexcept {
  const std::array<std::uint8_t, 2> bytes{static_cast<std::uint8_t>(counts),
                                          static_cast<std::uint8_t>(counts >> 8U)};
  link_->post({.kind = link::Kind::set_pulse, .unit = channel_, .written = bytes});
}

}  // namespace ocm::firmware::qemu
