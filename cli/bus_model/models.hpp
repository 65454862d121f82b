/// The models of all buses that frames come from: one of a live bus, one an interface of a log.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/bus_model/model.hpp"

namespace ocm::cli::bus_model {

/// One of the buses that are shown.
struct Bus {
  std::string name;
  const Model* model = nullptr;
};

class Models {
 public:
  /// How long after each other the values of graphs are kept: they reach a minute back.
  static constexpr base::Duration step = std::chrono::milliseconds{250};

  /// The catalogue must outlive it; a bit rate of 0 is not known, of either kind.
  Models(const protocol::Catalogue& catalogue, std::uint32_t bit_rate, std::uint32_t data_bit_rate = 0)
      : catalogue_(&catalogue), rates_{bit_rate, data_bit_rate} {}

  /// A bus is there before its first frame.
  Model& of(std::string_view name);
  void take(const log::Entry& entry, const log::Interfaces& interfaces) {
    until(entry.time);
    of(interfaces.name(entry.interface)).take(entry);
  }
  void lost(std::string_view name, std::uint64_t frames) { of(name).lost(frames); }
  /// It is so late by now.
  void until(base::Time now);
  /// Keeps these fields of a bus, by its number in buses(); whether there is anything new among them.
  bool follow(std::size_t bus, const std::set<FieldKey>& fields);

  [[nodiscard]] std::vector<Bus> buses() const;

 private:
  struct Named {
    std::string name;
    Model model;
  };
  const protocol::Catalogue* catalogue_;
  measure::BitRates rates_;
  std::deque<Named> models_;
  std::size_t last_ = 0;  ///< that was asked for
  std::optional<base::Time> next_tick_;
};

}  // namespace ocm::cli::bus_model
