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

/// What one sensor of a ring sees.
struct Sight {
  enum class Kind : std::uint8_t {
    nothing,   ///< within the range of the law
    obstacle,  ///< `metres` from the sensor
    unknown    ///< the sensor's offset has not been seen yet
  };
  Kind kind = Kind::unknown;
  double metres = 0;
  double counts_above = 0;  ///< the offset; where that is unknown, the spec's
};

/// One sensor of a ring. Its offset is the least that it saw, each time on average of eight samples, of which
/// noise is less. That is an offset only where it is no more than the spec's, and what an obstacle at the end
/// of the range adds: an obstacle that was there from the beginning hides the offset until it has gone once.
/// Until then an obstacle is what no offset explains, at the distance that the spec's offset gives; of all
/// else nothing is known.
class SightSensor {
 public:
  /// `spread`: by how much, in counts, offsets of such sensors differ. The law must outlive it.
  SightSensor(const protocol::Law& law, double spread) noexcept;
  [[nodiscard]] Sight take(double counts) noexcept;

 private:
  static constexpr std::size_t averaged = 8;
  const protocol::Law* law_;
  double at_range_;  ///< counts of an obstacle at the end of the range
  double spread_;
  std::array<double, averaged> samples_{};
  std::size_t count_ = 0;
  double least_ = 0;
};

/// Metres by the law of the spec; nothing: nothing in sight.
[[nodiscard]] std::optional<double> distance_m(double counts_above, const protocol::Law& law) noexcept;
/// Of a ring's first sensor: the offset is all in which the others differ. nullptr: the spec has none.
[[nodiscard]] const protocol::Law* law_of(const protocol::Topic& ring) noexcept;
/// A sensor for each field of a ring that has a law, in their order.
[[nodiscard]] std::vector<SightSensor> sensors_of(const protocol::Topic& ring);

class Scenes {
 public:
  struct Message {
    std::uint32_t channel = 0;
    base::Time time;
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
    if (source->geometry) {
      look(*source, sample);  // offsets are learnt whether or not anyone looks
    } else if (const auto pose = pose_of(sample)) {
      source->pose = *pose;
    } else {
      return;
    }
    source->time = sample.time;
    for (std::uint32_t channel = source->channel; channel < source->channel + channels_of(*source); ++channel)
      if (wanted(channel)) publish(*newest(channel));
  }
  /// What came last on a channel, as it was published then; nothing: nothing came, or it is not of these.
  [[nodiscard]] std::optional<Message> newest(std::uint32_t channel) const;
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
    std::vector<SightSensor> sensors{};
    base::Time time{};  ///< of what came last:
    std::optional<Pose> pose{};
    std::vector<Sight> sights{};
  };

  void add(std::string topic, std::string_view schema_name, std::string_view schema);
  [[nodiscard]] Source* source_of(const protocol::Topic* topic, std::size_t interface) noexcept;
  [[nodiscard]] static std::optional<Pose> pose_of(const client::Sample& sample);
  [[nodiscard]] static std::uint32_t channels_of(const Source& source) noexcept {
    return source.geometry ? 1 : 2;
  }
  static void look(Source& source, const client::Sample& sample);
  [[nodiscard]] static std::string pose_text(const Source& source);
  [[nodiscard]] static std::string transform_text(const Source& source);
  [[nodiscard]] static std::string scan_text(const Source& source);

  std::uint32_t next_;
  std::vector<foxglove::Channel> channels_;
  std::vector<Source> sources_;
};

}  // namespace ocm::cli::serve
