// The parts of the three boards on buses that are not there, as object code for a Cortex-M: every driver is
// instantiated. What the object then still needs is looked at: no heap, no exceptions, no RTTI, no streams.
#include "firmware/boards/di_wheel_drive/parts.hpp"

#include "firmware/boards/light_ring/parts.hpp"
#include "firmware/boards/power_management/parts.hpp"

using namespace ocm;
using namespace ocm::firmware;

// Defined nowhere: this is compiled, never linked.
struct I2c {
  base::Status transfer(std::uint8_t address7, std::span<const std::uint8_t> write,
                        std::span<std::uint8_t> read);
};
struct Spi {
  base::Status transfer(const drivers::SpiSettings& settings, std::span<const std::uint8_t> out,
                        std::span<std::uint8_t> in);
};
struct Motors {
  std::array<std::uint16_t, 2> encoders();
  void set_duty(std::int16_t left, std::int16_t right);
};
struct Pins {
  std::uint8_t read();
  void write(std::uint8_t levels);
};
struct SystemMutex {
  void lock();
  void unlock();
};

template class boards::di_wheel_drive::Parts<I2c, I2c, Spi, Spi, Motors, Pins, SystemMutex>;
template class boards::power_management::Parts<I2c, I2c, Pins, SystemMutex>;
template class boards::light_ring::Parts<Spi, Pins, SystemMutex>;
using Bottom = boards::di_wheel_drive::Parts<I2c, I2c, Spi, Spi, Motors, Pins>;
static_assert(boards::di_wheel_drive::Regulated<Bottom> && boards::di_wheel_drive::Maintained<Bottom>);
using Middle = boards::power_management::Parts<I2c, I2c, Pins>;
static_assert(boards::power_management::Maintained<Middle>);
using Top = boards::light_ring::Parts<Spi, Pins>;
static_assert(boards::light_ring::Maintained<Top>);
