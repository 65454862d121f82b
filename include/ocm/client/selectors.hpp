/// Frames of multiplexed messages whose selector has a value that chooses no field: the sender knows a page
/// that the spec has not, or the spec is of another version. Its other fields are shown all the same; a
/// receiver counts them. Built once of a layout; O(selectors * log ranges) a frame.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "ocm/protocol/topic.hpp"

namespace ocm::client {

class Selectors {
 public:
  Selectors() = default;
  /// The layout must outlive this.
  explicit Selectors(const protocol::FrameLayout& layout) : layout_(&layout) {
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      Selector selector{&layout.fields[i], {}};
      for (const protocol::Field& field : layout.fields)
        if (field.selector == i)
          selector.chosen.insert(selector.chosen.end(), field.selected.begin(), field.selected.end());
      if (selector.chosen.empty()) continue;
      join(selector.chosen);
      selectors_.push_back(std::move(selector));
    }
  }

  /// Whether the layout has no selector.
  [[nodiscard]] bool empty() const noexcept { return selectors_.empty(); }
  /// Whether a selector that is in the frame chooses no field. `data` as FrameLayout::has takes it.
  [[nodiscard]] bool choose_nothing(std::span<const std::uint8_t> data) const noexcept {
    return std::any_of(selectors_.begin(), selectors_.end(), [&](const Selector& selector) {
      if (!layout_->has(*selector.field, data)) return false;
      const auto bits = static_cast<std::uint64_t>(protocol::get(data, selector.field->position, false));
      const auto above =
          std::upper_bound(selector.chosen.begin(), selector.chosen.end(), bits,
                           [](std::uint64_t value, const auto& range) { return value < range.first; });
      return above == selector.chosen.begin() || (above - 1)->last < bits;
    });
  }

 private:
  struct Selector {
    const protocol::Field* field;
    std::vector<protocol::SelectorRange> chosen;  // by first, without overlap
  };

  static void join(std::vector<protocol::SelectorRange>& ranges) {
    std::sort(ranges.begin(), ranges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::size_t count = 1;
    for (const protocol::SelectorRange& range : ranges) {
      protocol::SelectorRange& before = ranges[count - 1];
      if (range.first <= before.last)
        before.last = std::max(before.last, range.last);
      else
        ranges[count++] = range;
    }
    ranges.resize(count);
  }

  const protocol::FrameLayout* layout_ = nullptr;
  std::vector<Selector> selectors_;
};

}  // namespace ocm::client
