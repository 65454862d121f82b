/// The page's files, which are in the program: cmake/OcmEmbed.cmake puts them there.
#pragma once

#include <span>
#include <string_view>

namespace ocm::cli::serve {

struct Asset {
  std::string_view name;  ///< "page.js"
  std::string_view content;
};

/// Empty where the program was built without the page.
[[nodiscard]] std::span<const Asset> assets() noexcept;

}  // namespace ocm::cli::serve
