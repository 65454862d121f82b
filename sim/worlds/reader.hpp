/// Reads a world of mappers, a JSON file that `world.schema.json` describes. Every problem is reported with
/// its place, what is wrong and what would be right, as those of a spec are.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "generator/spec/problem.hpp"
#include "sim/mapper/world_model.hpp"

namespace ocm::sim::worlds {

using sim::mapper::WorldModel;
using spec::Problem;

/// There is a world exactly when there are no problems. They are all that were found, in the order of the
/// file.
struct Loaded {
  std::optional<WorldModel> world;
  std::vector<Problem> problems;
};

/// A file of a world is at most this large.
inline constexpr std::size_t max_world_bytes = 1'000'000;

/// Any bytes are a problem at worst: throws std::bad_alloc only. `file_name` is for the places.
[[nodiscard]] Loaded parse(std::string_view text, std::string_view file_name);
[[nodiscard]] Loaded load(const std::filesystem::path& file);

/// A world as a person names it: the file of this name, else the one that is compiled in.
[[nodiscard]] Loaded find(const std::string& name);
/// "place: what"; what alone of a world that there is not.
[[nodiscard]] std::string in_words(const Problem& problem);

/// A world that is compiled in: those of `sim/worlds`, by name ("square"). The text of its file.
[[nodiscard]] std::optional<std::string_view> built_in(std::string_view name) noexcept;
[[nodiscard]] std::vector<std::string_view> built_in_names();

/// The JSON schema that is compiled in: what `world.schema.json` of this release says.
[[nodiscard]] std::string_view schema_text() noexcept;

}  // namespace ocm::sim::worlds
