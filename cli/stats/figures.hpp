/// What was measured, of each bus that was looked at.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/measure/statistics.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::stats {

struct Bus {
  std::string name;
  measure::BusFigures figures;  ///< with NaN for each load, where the bit rate is 0: not known
  std::uint64_t drops = 0;      ///< frames that were on the bus and did not arrive
};

struct Report {
  std::string_view robot;
  std::string source;
  std::vector<Bus> buses;
  std::vector<const protocol::Topic*> never_came{};  ///< see Collector::never_came
};

/// Sorts frames by the interface that they came over. A log of another interface of the same name goes on
/// with its figures.
class Collector {
 public:
  /// `rates_of`: the bit rates of an interface; 0 is not known, and then no share of the bus is.
  Collector(const protocol::Catalogue& catalogue,
            std::function<measure::BitRates(std::string_view interface)> rates_of)
      : catalogue_(&catalogue), rates_of_(std::move(rates_of)) {}

  void take(std::span<const log::Entry> entries, const log::Interfaces& interfaces);
  void lost(std::string_view interface, std::uint64_t frames) { find(interface).drops += frames; }
  [[nodiscard]] bool any() const noexcept;
  /// As of the last frame, or of `now`.
  [[nodiscard]] std::vector<Bus> buses(std::optional<base::Time> now = {}) const;
  /// Messages with a stated period that came on none of the buses, though one was looked at for as long.
  [[nodiscard]] std::vector<const protocol::Topic*> never_came(const std::vector<Bus>& buses) const;

 private:
  struct Part {
    std::string name;
    measure::BusStatistics statistics;
    std::uint64_t drops = 0;
    bool has_rate = true;
  };
  Part& find(std::string_view name);

  const protocol::Catalogue* catalogue_;
  std::function<measure::BitRates(std::string_view)> rates_of_;
  std::deque<Part> parts_;  // in place: `last_` points into it
  Part* last_ = nullptr;
};

}  // namespace ocm::cli::stats
