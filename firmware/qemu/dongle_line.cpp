#include "firmware/qemu/dongle_line.hpp"

namespace ocm::firmware::qemu {

void DongleLine::listen() noexcept {
  line_.start([](void* self) { static_cast<DongleLine*>(self)->on_byte(); }, this);
  pin_.start([](void* self) { static_cast<DongleLine*>(self)->on_pin(); }, this);
  constexpr std::uint8_t ready = '\r';
  pin_.write({&ready, 1});
}

void DongleLine::on_byte() noexcept {
  if (std::uint8_t byte = 0; line_.take(byte)) receive_(robot_, byte);
}

void DongleLine::on_pin() noexcept {
  std::uint8_t level = 0;
  if (!pin_.take(level) || (level != '0' && level != '1')) return;
  linked_ = level == '0';
  if (!linked_) {
    const chibios::Lock lock;
    dropped_ += static_cast<std::uint32_t>(size_);
    size_ = 0;
  }
  link_changed_(robot_);
}

std::size_t DongleLine::send(std::span<const std::uint8_t> bytes) noexcept {
  const chibios::Lock lock;
  if (!linked_) {  // it was lost behind the look of who sends
    dropped_ += static_cast<std::uint32_t>(bytes.size());
    return bytes.size();
  }
  std::size_t taken = 0;
  while (taken != bytes.size() && size_ != ring_.size())
    ring_[(begin_ + size_++) % ring_.size()] = bytes[taken++];
  if (!sending_) send_next();
  return taken;
}

// With the lock held.
void DongleLine::send_next() noexcept {
  constexpr systime_t byte_ticks = CH_CFG_ST_FREQUENCY * 10 / baud;  // start, eight bits, stop
  sending_ = size_ != 0;
  if (!sending_) return;
  line_.write({&ring_[begin_], 1});
  begin_ = (begin_ + 1) % ring_.size();
  --size_;
  chVTSetI(
      &timer_, byte_ticks,
      [](void* self) {
        const chibios::Lock later;
        static_cast<DongleLine*>(self)->send_next();
      },
      this);
}

}  // namespace ocm::firmware::qemu
