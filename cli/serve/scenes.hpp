/// What has a role, in messages that other programs' panels know: of a pose foxglove.PoseInFrame and
/// foxglove.FrameTransform, of a ring foxglove.LaserScan, so that Foxglove's 3D panel shows any robot. Pure:
/// it knows no socket. [github.com/foxglove/foxglove-sdk, schemas]
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/serve/foxglove.hpp"
#include "generator/spec/model.hpp"

namespace ocm::cli::serve {

/// A sensor's counts with nothing in sight: the least that it saw, each time on average of eight samples, of
/// which noise is less. An obstacle that was there from the beginning shows once it has gone.
class SightOffset {
 public:
  /// How many counts are above it.
  [[nodiscard]] double above(double counts) noexcept;

 private:
  static constexpr std::size_t averaged = 8;
  std::array<double, averaged> samples_{};
  std::size_t count_ = 0;
  double least_ = 0;
};

/// Metres by the law of the spec; nothing: nothing in sight.
[[nodiscard]] std::optional<double> distance_m(double counts_above, const protocol::Law& law) noexcept;
/// Of a ring's first sensor: the offset, which is found here, is all in which the others differ. nullptr: the
/// spec has none.
[[nodiscard]] const protocol::Law* law_of(const protocol::Topic& ring) noexcept;

class Scenes {
 public:
  struct Message {
    std::uint32_t channel = 0;
    std::string payload;  ///< JSON
  };

  /// Channels of the poses and rings of each interface, the first of which has the number `first`. The
  /// catalogue must outlive it.
  Scenes(const protocol::Catalogue& catalogue, const spec::Model& model,
         std::span<const std::string> interfaces, std::uint32_t first);
  [[nodiscard]] const std::vector<foxglove::Channel>& channels() const noexcept { return channels_; }
  /// What a sample says of the robot in the room; of all topics without such a role nothing. Calls
  /// `wanted(channel)` before a message is made, and `publish(Message)`.
  template <class Wanted, class Publish>
  void take(const client::Sample& sample, std::size_t interface, const Wanted& wanted,
            const Publish& publish) {
    Source* const source = source_of(sample.topic, interface);
    if (source == nullptr) return;
    if (source->geometry) return take_ring(*source, sample, wanted, publish);
    const auto pose = pose_of(sample);
    if (!pose) return;
    if (wanted(source->channel)) publish(Message{source->channel, pose_text(*source, sample.time, *pose)});
    if (wanted(source->channel + 1))
      publish(Message{source->channel + 1, transform_text(*source, sample.time, *pose)});
  }
  /// A log is read from its beginning again.
  void forget();

 private:
  struct Pose {
    double x_m = 0, y_m = 0, heading_rad = 0;
  };
  struct Source {
    const protocol::Topic* topic = nullptr;
    std::size_t interface = 0;
    std::uint32_t channel = 0;  ///< a pose has the next one, too
    std::string parent, child;  ///< frames, as JSON has them; of a ring the child is the robot's
    std::optional<spec::RingGeometry> geometry{};
    std::vector<SightOffset> offsets{};
  };

  void add(std::string topic, std::string_view schema_name, std::string_view schema);
  [[nodiscard]] Source* source_of(const protocol::Topic* topic, std::size_t interface) noexcept;
  [[nodiscard]] static std::optional<Pose> pose_of(const client::Sample& sample);
  [[nodiscard]] static std::string pose_text(const Source& source, base::Time time, const Pose& pose);
  [[nodiscard]] static std::string transform_text(const Source& source, base::Time time, const Pose& pose);
  [[nodiscard]] static std::vector<double> counts_above(Source& source, const client::Sample& sample);
  [[nodiscard]] static std::string scan_text(const Source& source, base::Time time,
                                             std::span<const double> counts_above);

  template <class Wanted, class Publish>
  void take_ring(Source& source, const client::Sample& sample, const Wanted& wanted, const Publish& publish) {
    // Offsets are learnt whether or not anyone looks.
    const std::vector<double> above = counts_above(source, sample);
    if (wanted(source.channel)) publish(Message{source.channel, scan_text(source, sample.time, above)});
  }

  std::uint32_t next_;
  std::vector<foxglove::Channel> channels_;
  std::vector<Source> sources_;
};

}  // namespace ocm::cli::serve
