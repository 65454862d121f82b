/// The pages of a multiplexed message in turn: every value of a selector that selects a field, and within it
/// those of the selectors that it selects. A range of values counts with its ends.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ocm/protocol/codec.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::sim {

class Pages {
 public:
  /// The layout must outlive it. Selectors whose values no frame can hold stay as they are.
  explicit Pages(const protocol::FrameLayout& layout) : layout_(&layout), values_(layout.fields.size()) {
    for (const auto& field : layout.fields) {
      if (field.selector >= layout.fields.size()) continue;
      const auto& position = layout.fields[field.selector].position;
      if (position.bytes() > layout.length || field.position.bytes() > layout.length) continue;
      const std::uint64_t most = ~std::uint64_t{0} >> (64U - position.width);
      auto& values = values_[field.selector];
      for (const auto& range : field.selected)
        for (const std::uint64_t value : {range.first, std::min(range.last, most)})
          if (value <= most && value >= range.first) values.push_back(value);
    }
    for (auto& values : values_) {
      std::sort(values.begin(), values.end());
      values.erase(std::unique(values.begin(), values.end()), values.end());
    }
    for (std::size_t i = 0; i < values_.size(); ++i)
      if (is_root(i)) count_ = std::max(count_, pages_of(i, values_.size()));
  }

  /// After so many messages every page was there.
  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  /// Whether the page decides the value of field `index`.
  [[nodiscard]] bool chosen(std::size_t index) const noexcept { return !values_[index].empty(); }

  /// Puts the selectors of page `number`, which counts on and on.
  void put(std::uint64_t number, std::span<std::uint8_t> data) const noexcept {
    for (std::size_t i = 0; i < values_.size(); ++i)
      if (is_root(i)) put(i, number, data, values_.size());
  }

 private:
  [[nodiscard]] bool is_root(std::size_t index) const noexcept {
    return chosen(index) && layout_->fields[index].selector == protocol::no_selector;
  }
  [[nodiscard]] bool selects(std::size_t selector, std::uint64_t value, std::size_t index) const noexcept {
    const auto& field = layout_->fields[index];
    return field.selector == selector &&
           std::any_of(field.selected.begin(), field.selected.end(),
                       [value](const auto& range) { return range.first <= value && value <= range.last; });
  }
  /// `depth`: selectors that may still be below one another, so that a circle ends.
  [[nodiscard]] std::size_t pages_within(std::size_t selector, std::uint64_t value,
                                         std::size_t depth) const noexcept {
    std::size_t pages = 1;
    for (std::size_t i = 0; i < values_.size() && depth != 0; ++i)
      if (chosen(i) && selects(selector, value, i)) pages = std::max(pages, pages_of(i, depth - 1));
    return pages;
  }
  [[nodiscard]] std::size_t pages_of(std::size_t selector, std::size_t depth) const noexcept {
    std::size_t pages = 0;
    for (const std::uint64_t value : values_[selector]) pages += pages_within(selector, value, depth);
    return pages;
  }
  void put(std::size_t selector, std::uint64_t number, std::span<std::uint8_t> data,
           std::size_t depth) const noexcept {
    std::uint64_t page = number % pages_of(selector, depth);
    for (const std::uint64_t value : values_[selector]) {
      const std::size_t within = pages_within(selector, value, depth);
      if (page >= within) {
        page -= within;
        continue;
      }
      protocol::put(data, layout_->fields[selector].position, static_cast<std::int64_t>(value));
      for (std::size_t i = 0; i < values_.size() && depth != 0; ++i)
        if (chosen(i) && selects(selector, value, i)) put(i, page, data, depth - 1);
      return;
    }
  }

  const protocol::FrameLayout* layout_;
  std::vector<std::vector<std::uint64_t>> values_;  // of each field that is a selector
  std::size_t count_ = 1;
};

}  // namespace ocm::sim
