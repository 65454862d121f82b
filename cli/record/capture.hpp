/// Where recorded frames come from: all that happens on one bus, in batches, as entries of a log. A CAN
/// interface of Linux gives CAN FD frames, directions and the kernel's own times, which a plain
/// transport::Bus does not.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/log/entry.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/filters.hpp"

namespace ocm::cli::record {

class Capture {
 public:
  /// Frames that are fetched at once at most.
  static constexpr std::size_t batch = 64;

  Capture() = default;
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  virtual ~Capture() = default;

  /// Frames that wait, each marked with `interface`. Fewer than `batch` and than `into.size()`: no more do.
  /// Never waits.
  [[nodiscard]] virtual std::size_t read(std::span<log::Entry> into, std::uint16_t interface) = 0;
  /// Looks whether the bus is up, and what was lost since a frame last told of it. To call now and then.
  virtual void look() {}

  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual int descriptor() const = 0;  ///< readable when frames wait
  [[nodiscard]] virtual transport::BusState state() const = 0;
  [[nodiscard]] virtual const transport::Failure& failure() const = 0;  ///< why it is closed
  [[nodiscard]] virtual std::uint64_t lost() const = 0;                 ///< frames, before this program
  [[nodiscard]] virtual std::uint32_t bit_rate() const = 0;             ///< bit/s; 0: not known
  /// Whether frames wait in a queue with their times on them, so that they may be fetched later.
  [[nodiscard]] virtual bool keeps_times() const = 0;
  /// Whether something of this name can come back after it was closed: an adapter that is plugged in again.
  [[nodiscard]] virtual bool may_return() const = 0;
};

/// A bus by its name (Session::open_bus). The filters work in the kernel where it is a CAN interface.
[[nodiscard]] transport::Outcome<std::unique_ptr<Capture>> open_capture(std::string_view name,
                                                                        const Filters& filters);

}  // namespace ocm::cli::record
