/// Which fields to show: `gyroscope.x`, `odometry.velocity.x`, `power` (all of it). What is
/// derived of a field is chosen by its own name only: `ring.sensor_4.distance`.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

struct ChosenField {
  const protocol::Topic* topic = nullptr;
  const protocol::FrameLayout* layout = nullptr;
  const protocol::Field* field = nullptr;
  std::string name;  ///< topic.field, or topic.frame.field where the topic has several frames
};

class Selection {
 public:
  /// Everything is shown.
  Selection() = default;
  /// The fields that the words name, in their order, each once. A word is a topic (by name, alias or group),
  /// with a field, a frame or both behind it. The failure names the word and what there is.
  [[nodiscard]] static transport::Outcome<Selection> of(const protocol::Catalogue& catalogue,
                                                        std::span<const std::string> words);

  [[nodiscard]] bool everything() const noexcept { return fields_.empty(); }
  /// Layouts may share their fields: it takes both to know one.
  [[nodiscard]] bool has(const protocol::FrameLayout& layout, const protocol::Field& field) const noexcept;
  /// Whether a frame has anything to show.
  [[nodiscard]] bool has(const protocol::FrameLayout& layout) const noexcept;
  [[nodiscard]] std::span<const ChosenField> fields() const noexcept { return fields_; }

 private:
  std::vector<ChosenField> fields_;
};

}  // namespace ocm::cli
