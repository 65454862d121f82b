/// An I2C bus with models of parts on it: who acknowledges, and what comes back. It satisfies
/// firmware::drivers::I2c.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "ocm/base/result.hpp"

#include "sim/parts/violations.hpp"

namespace ocm::sim {

/// One part on a bus, byte by byte after its address.
class I2cPart {
 public:
  explicit I2cPart(std::uint8_t address7) noexcept : address_(address7) {}
  virtual ~I2cPart() = default;
  I2cPart(const I2cPart&) = delete;
  I2cPart& operator=(const I2cPart&) = delete;

  /// Adds who acknowledges this address now; a multiplexer adds who is behind it.
  virtual void find(std::uint8_t address7, std::vector<I2cPart*>& found) {
    if (address7 == address_ && present() && !busy()) found.push_back(this);
  }
  /// What is written between START and the next START or STOP; false: a byte was not acknowledged.
  virtual bool write(std::span<const std::uint8_t> bytes) = 0;
  virtual void read(std::span<std::uint8_t> bytes) = 0;
  virtual void stop() {}

  /// Takes the part off the board, or puts it back: it then begins as after power-up.
  void set_present(bool present) {
    if (present && !present_) power_up();
    present_ = present;
  }
  /// Whether it is there, asked each time; besides `set_present`.
  void set_presence(std::function<bool()> presence) { presence_ = std::move(presence); }

 protected:
  virtual void power_up() = 0;
  [[nodiscard]] virtual bool busy() { return false; }

  [[nodiscard]] bool present() {
    const bool now = present_ && (!presence_ || presence_());
    if (now && away_) power_up();
    away_ = !now;
    return now;
  }

 private:
  std::uint8_t address_;
  bool present_ = true;
  bool away_ = false;
  std::function<bool()> presence_;
};

class I2cBus {
 public:
  explicit I2cBus(Violations& violations) noexcept : violations_(&violations) {}

  /// The part must outlive the bus.
  void attach(I2cPart& part) { parts_.push_back(&part); }
  void find(std::uint8_t address7, std::vector<I2cPart*>& found) const {
    for (I2cPart* part : parts_) part->find(address7, found);
  }
  /// The data line is held down: no START comes through.
  void set_stuck(bool stuck) noexcept { stuck_ = stuck; }
  /// Transfers begun, for those who bound them.
  [[nodiscard]] std::uint64_t transfers() const noexcept { return transfers_; }

  base::Status transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read) {
    ++transfers_;
    if (stuck_) return base::Error::bus_fault;
    std::vector<I2cPart*> found;
    find(address7, found);
    if (found.empty()) return base::Error::no_answer;
    if (found.size() > 1) {
      violations_->add("two parts answer to one address");
      return base::Error::bus_fault;
    }
    I2cPart& part = *found.front();
    bool acknowledged = true;
    if (!write.empty() || read.empty()) acknowledged = part.write(write);
    if (acknowledged && !read.empty()) part.read(read);
    part.stop();
    return acknowledged ? base::Error::none : base::Error::no_answer;
  }

 private:
  Violations* violations_;
  std::vector<I2cPart*> parts_;
  std::uint64_t transfers_ = 0;
  bool stuck_ = false;
};

}  // namespace ocm::sim
