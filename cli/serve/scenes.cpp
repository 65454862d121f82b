#include "cli/serve/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cli/output/json_text.hpp"

namespace ocm::cli::serve {
namespace {

// The schemas under their own names, by which panels know them; a test compares them with Foxglove's.
#define OCM_TIME \
  R"("timestamp":{"type":"object","title":"time","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}})"
#define OCM_VECTOR                                                                                            \
  R"({"type":"object","title":"foxglove.Vector3","properties":{"x":{"type":"number"},"y":{"type":"number"},)" \
  R"("z":{"type":"number"}}})"
#define OCM_QUATERNION                                                                                           \
  R"({"type":"object","title":"foxglove.Quaternion","properties":{"x":{"type":"number"},"y":{"type":"number"},)" \
  R"("z":{"type":"number"},"w":{"type":"number"}}})"
#define OCM_POSE                                                                            \
  R"("pose":{"type":"object","title":"foxglove.Pose","properties":{"position":)" OCM_VECTOR \
  R"(,"orientation":)" OCM_QUATERNION "}}"

constexpr std::string_view pose_schema =
    R"({"type":"object","title":"foxglove.PoseInFrame","properties":{)" OCM_TIME
    R"(,"frame_id":{"type":"string"},)" OCM_POSE "}}";
constexpr std::string_view transform_schema =
    R"({"type":"object","title":"foxglove.FrameTransform","properties":{)" OCM_TIME
    R"(,"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":)" OCM_VECTOR
    R"(,"rotation":)" OCM_QUATERNION "}}";
constexpr std::string_view scan_schema =
    R"({"type":"object","title":"foxglove.LaserScan","properties":{)" OCM_TIME
    R"(,"frame_id":{"type":"string"},)" OCM_POSE
    R"(,"start_angle":{"type":"number","description":"rad"},"end_angle":{"type":"number","description":"rad"},)"
    R"("ranges":{"type":"array","items":{"type":"number"},"description":"m from the robot's middle; 0: nothing in sight; null: not known yet"},)"
    R"("intensities":{"type":"array","items":{"type":"number"},"description":"counts above the sensor's offset"}}})";

#undef OCM_TIME
#undef OCM_VECTOR
#undef OCM_QUATERNION
#undef OCM_POSE

std::string stamp_of(base::Time time) {
  constexpr std::int64_t second = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(time.time_since_epoch().count(), 0);
  return fmt::format(R"("timestamp":{{"sec":{},"nsec":{}}})", ns / second, ns % second);
}

/// About the vertical axis.
std::string quaternion(double heading_rad) {
  return fmt::format(R"({{"x":0,"y":0,"z":{:.9f},"w":{:.9f}}})", std::sin(heading_rad / 2),
                     std::cos(heading_rad / 2));
}

}  // namespace

SightSensor::SightSensor(const protocol::Law& law, double spread) noexcept
    : law_(&law),
      at_range_(law.at_one.as_double() / law.max.as_double() / law.max.as_double()),
      spread_(std::max(spread, at_range_)) {}

Sight SightSensor::take(double counts) noexcept {
  samples_[count_++ % averaged] = counts;
  const std::size_t kept = std::min(count_, averaged);
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) sum += samples_[i];
  const double mean = sum / static_cast<double>(kept);
  least_ = count_ == 1 ? mean : std::min(least_, mean);
  const double of_spec = law_->offset.as_double();
  const bool known = least_ <= of_spec + at_range_;
  const double above = counts - (known ? least_ : of_spec);
  if (!known && above <= spread_) return {Sight::Kind::unknown, 0, above};
  const auto metres = distance_m(above, *law_);
  return {metres ? Sight::Kind::obstacle : Sight::Kind::nothing, metres.value_or(0), above};
}

std::optional<double> distance_m(double counts_above, const protocol::Law& law) noexcept {
  if (!(counts_above > 0)) return std::nullopt;
  const double metres = std::sqrt(law.at_one.as_double() / counts_above);
  return metres <= law.max.as_double() ? std::optional{metres} : std::nullopt;
}

const protocol::Law* law_of(const protocol::Topic& ring) noexcept {
  for (const protocol::Field& field : ring.frames.front().values())
    if (field.is_derived()) return field.law;
  return nullptr;
}

std::vector<SightSensor> sensors_of(const protocol::Topic& ring) {
  std::vector<const protocol::Law*> laws;
  for (const protocol::FrameLayout& frame : ring.frames)
    for (std::size_t i = 0; i < frame.fields.size(); ++i) {
      const auto values = frame.values();
      const auto found = std::find_if(values.begin(), values.end(), [i](const protocol::Field& value) {
        return value.is_derived() && value.derived_from == i && !value.uncertainty;
      });
      laws.push_back(found == values.end() ? law_of(ring) : found->law);
    }
  const auto [least, greatest] = std::minmax_element(
      laws.begin(), laws.end(),
      [](const auto* a, const auto* b) { return a->offset.as_double() < b->offset.as_double(); });
  std::vector<SightSensor> sensors;
  for (const protocol::Law* law : laws)
    sensors.emplace_back(*law, (*greatest)->offset.as_double() - (*least)->offset.as_double());
  return sensors;
}

Scenes::Scenes(const protocol::Catalogue& catalogue, const spec::Model& model,
               std::span<const std::string> interfaces, std::uint32_t first)
    : next_(first) {
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const std::string of = interfaces.size() == 1 ? "" : interfaces[i] + '/';
    const std::string robot = of + "base_link";
    bool any = false;
    for (const protocol::Topic& topic : catalogue.topics) {
      if (topic.role == protocol::Role::pose) {
        // What the robot's rings are on is its first pose.
        const std::string child =
            std::exchange(any, true) ? fmt::format("{}{}/base_link", of, topic.name) : robot;
        sources_.push_back({&topic, i, next_, json_string(of + "odom"), json_string(child)});
        add(fmt::format("/{}{}/pose", of, topic.name), "foxglove.PoseInFrame", pose_schema);
        add(fmt::format("/{}{}/transform", of, topic.name), "foxglove.FrameTransform", transform_schema);
      } else if (topic.role == protocol::Role::ring) {
        const auto found =
            std::find_if(model.topics.begin(), model.topics.end(),
                         [&topic](const spec::TopicModel& each) { return each.name == topic.name; });
        if (found == model.topics.end() || !found->geometry || law_of(topic) == nullptr) continue;
        sources_.push_back({&topic, i, next_, {}, json_string(robot), found->geometry, sensors_of(topic)});
        add(fmt::format("/{}{}/scan", of, topic.name), "foxglove.LaserScan", scan_schema);
      }
    }
  }
}

void Scenes::add(std::string topic, std::string_view schema_name, std::string_view schema) {
  channels_.push_back({next_++, std::move(topic), std::string{schema_name}, std::string{schema}});
}

void Scenes::forget() {
  for (Source& source : sources_) {
    if (source.geometry) source.sensors = sensors_of(*source.topic);
    source.pose.reset();
    source.sights.clear();
  }
}

Scenes::Source* Scenes::source_of(const protocol::Topic* topic, std::size_t interface) noexcept {
  const auto found = std::find_if(sources_.begin(), sources_.end(), [&](const Source& source) {
    return source.topic == topic && source.interface == interface;
  });
  return found == sources_.end() ? nullptr : &*found;
}

/// In a sample with velocities, too, the pose is the frame that has an orientation.
std::optional<Scenes::Pose> Scenes::pose_of(const client::Sample& sample) {
  for (std::size_t i = 0; i < sample.topic->frames.size(); ++i) {
    const auto data = sample.data(i);
    const auto value = [&](std::string_view name) -> std::optional<double> {
      for (const protocol::Field& field : sample.topic->frames[i].fields)
        if (field.name == name) return field.value(field.raw(data));
      return std::nullopt;
    };
    const auto x = value("x"), y = value("y"), heading = value("orientation");
    if (x && y && heading) return Pose{*x, *y, *heading};
  }
  return std::nullopt;
}

std::optional<Scenes::Message> Scenes::newest(std::uint32_t channel) const {
  for (const Source& source : sources_) {
    if (channel < source.channel || channel >= source.channel + channels_of(source)) continue;
    if (!source.pose && source.sights.empty()) return std::nullopt;
    return Message{channel, source.time,
                   source.geometry             ? scan_text(source)
                   : channel == source.channel ? pose_text(source)
                                               : transform_text(source)};
  }
  return std::nullopt;
}

std::string Scenes::pose_text(const Source& source) {
  return fmt::format(
      R"({{{},"frame_id":{},"pose":{{"position":{{"x":{:.9g},"y":{:.9g},"z":0}},"orientation":{}}}}})",
      stamp_of(source.time), source.parent, source.pose->x_m, source.pose->y_m,
      quaternion(source.pose->heading_rad));
}

std::string Scenes::transform_text(const Source& source) {
  return fmt::format(
      R"({{{},"parent_frame_id":{},"child_frame_id":{},"translation":{{"x":{:.9g},"y":{:.9g},"z":0}},"rotation":{}}})",
      stamp_of(source.time), source.parent, source.child, source.pose->x_m, source.pose->y_m,
      quaternion(source.pose->heading_rad));
}

void Scenes::look(Source& source, const client::Sample& sample) {
  source.sights.clear();
  for (std::size_t i = 0; i < sample.topic->frames.size(); ++i)
    for (const protocol::Field& field : sample.topic->frames[i].fields)
      source.sights.push_back(
          source.sensors[source.sights.size()].take(field.value(field.raw(sample.data(i)))));
}

std::string Scenes::scan_text(const Source& source) {
  const spec::RingGeometry& geometry = *source.geometry;
  const double first = geometry.first.as_double();
  std::string ranges, intensities;
  for (const Sight& sight : source.sights) {
    const char* const comma = ranges.empty() ? "" : ",";
    ranges += comma;
    ranges += sight.kind == Sight::Kind::unknown
                  ? "null"
                  : fmt::format("{:.4f}", sight.kind == Sight::Kind::obstacle
                                              ? geometry.radius.as_double() + sight.metres
                                              : 0.0);
    intensities += fmt::format("{}{:.1f}", comma, std::max(sight.counts_above, 0.0));
  }
  const double last = first + geometry.step.as_double() *
                                  (static_cast<double>(std::max<std::size_t>(source.sights.size(), 1)) - 1);
  return fmt::format(
      R"({{{},"frame_id":{},"pose":{{"position":{{"x":0,"y":0,"z":0}},"orientation":{{"x":0,"y":0,"z":0,"w":1}}}},)"
      R"("start_angle":{:.9f},"end_angle":{:.9f},"ranges":[{}],"intensities":[{}]}})",
      stamp_of(source.time), source.child, first, last, ranges, intensities);
}

}  // namespace ocm::cli::serve
