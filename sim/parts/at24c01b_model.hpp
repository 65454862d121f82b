/// Model of the EEPROM AT24C01BN. [data sheet: Atmel AT24C01B, 5156]
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "ocm/base/time.hpp"

#include "sim/parts/i2c_bus.hpp"
#include "sim/parts/part_clock.hpp"
#include "sim/parts/violations.hpp"

namespace ocm::sim {

class At24c01bModel : public I2cPart {
 public:
  At24c01bModel(Violations& violations, PartClock now)
      : I2cPart(0x50), violations_(&violations), now_(std::move(now)) {
    bytes_.fill(0xFF);  // as delivered
  }

  /// What is kept, without power too.
  [[nodiscard]] std::array<std::uint8_t, 128>& bytes() noexcept { return bytes_; }
  /// WP high: nothing is written, though all is acknowledged. [Write Protect]
  void set_protected(bool on) noexcept { protected_ = on; }
  /// Power fails while the `n`th page write from now is under way: half of it is in.
  void tear(std::size_t n) noexcept { tear_ = n; }
  [[nodiscard]] std::size_t pages_written() const noexcept { return pages_; }

  bool write(std::span<const std::uint8_t> bytes) override {
    if (bytes.empty()) return true;
    pointer_ = bytes[0] & 0x7F;
    if (bytes[0] > 0x7F) violations_->add("AT24C01B: there are 128 bytes");
    const auto data = bytes.subspan(1);
    if (data.empty()) return true;
    if (pointer_ % 8 + data.size() > 8)
      violations_->add("AT24C01B: written over the end of a page: it goes on at the page's start");
    const std::size_t page = pointer_ / 8 * 8;
    ++pages_;
    std::size_t left = data.size();
    if (tear_ != 0 && --tear_ == 0) {
      left /= 2;
      set_present(false);
    }
    for (std::size_t i = 0; i < left; ++i) {
      if (!protected_) bytes_[page + (pointer_ + i) % 8] = data[i];
    }
    written_ = now_();
    writing_ = !protected_;
    return true;
  }
  void read(std::span<std::uint8_t> bytes) override {
    for (std::uint8_t& byte : bytes) {
      byte = bytes_[pointer_];
      pointer_ = (pointer_ + 1) % bytes_.size();
    }
  }

 private:
  void power_up() override { writing_ = false; }
  [[nodiscard]] bool busy() override {
    if (writing_ && now_() - written_ >= std::chrono::milliseconds{5}) writing_ = false;
    return writing_;
  }

  Violations* violations_;
  PartClock now_;
  std::array<std::uint8_t, 128> bytes_{};
  std::size_t pointer_ = 0;
  std::size_t tear_ = 0;
  std::size_t pages_ = 0;
  base::Time written_{};
  bool writing_ = false;
  bool protected_ = false;
};

}  // namespace ocm::sim
