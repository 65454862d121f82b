/// Files of `spec/` that are compiled in, so that an installed program needs none.
#pragma once

#include <span>
#include <string_view>

namespace ocm::sim::worlds {

struct Text {
  std::string_view name;
  std::string_view text;
};

/// Those of `sim/worlds`, in the order of their names.
[[nodiscard]] std::span<const Text> world_texts() noexcept;

}  // namespace ocm::sim::worlds
