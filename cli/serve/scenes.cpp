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
    R"("ranges":{"type":"array","items":{"type":"number"},"description":"m from the robot's middle; 0: nothing in sight"},)"
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

double SightOffset::above(double counts) noexcept {
  samples_[count_++ % averaged] = counts;
  const std::size_t kept = std::min(count_, averaged);
  double sum = 0;
  for (std::size_t i = 0; i < kept; ++i) sum += samples_[i];
  const double mean = sum / static_cast<double>(kept);
  least_ = count_ == 1 ? mean : std::min(least_, mean);
  return counts - least_;
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
        std::size_t sensors = 0;
        for (const protocol::FrameLayout& frame : topic.frames) sensors += frame.fields.size();
        sources_.push_back(
            {&topic, i, next_, {}, json_string(robot), found->geometry, std::vector<SightOffset>(sensors)});
        add(fmt::format("/{}{}/scan", of, topic.name), "foxglove.LaserScan", scan_schema);
      }
    }
  }
}

void Scenes::add(std::string topic, std::string_view schema_name, std::string_view schema) {
  channels_.push_back({next_++, std::move(topic), std::string{schema_name}, std::string{schema}});
}

void Scenes::forget() {
  for (Source& source : sources_) source.offsets.assign(source.offsets.size(), {});
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

std::string Scenes::pose_text(const Source& source, base::Time time, const Pose& pose) {
  return fmt::format(
      R"({{{},"frame_id":{},"pose":{{"position":{{"x":{:.9g},"y":{:.9g},"z":0}},"orientation":{}}}}})",
      stamp_of(time), source.parent, pose.x_m, pose.y_m, quaternion(pose.heading_rad));
}

std::string Scenes::transform_text(const Source& source, base::Time time, const Pose& pose) {
  return fmt::format(
      R"({{{},"parent_frame_id":{},"child_frame_id":{},"translation":{{"x":{:.9g},"y":{:.9g},"z":0}},"rotation":{}}})",
      stamp_of(time), source.parent, source.child, pose.x_m, pose.y_m, quaternion(pose.heading_rad));
}

std::vector<double> Scenes::counts_above(Source& source, const client::Sample& sample) {
  std::vector<double> above;
  for (std::size_t i = 0; i < sample.topic->frames.size(); ++i)
    for (const protocol::Field& field : sample.topic->frames[i].fields)
      above.push_back(source.offsets[above.size()].above(field.value(field.raw(sample.data(i)))));
  return above;
}

std::string Scenes::scan_text(const Source& source, base::Time time, std::span<const double> counts_above) {
  const spec::RingGeometry& geometry = *source.geometry;
  const double first = geometry.first.as_double();
  std::string ranges, intensities;
  for (const double counts : counts_above) {
    const char* const comma = ranges.empty() ? "" : ",";
    const auto metres = distance_m(counts, *law_of(*source.topic));
    ranges += fmt::format("{}{:.4f}", comma, metres ? geometry.radius.as_double() + *metres : 0.0);
    intensities += fmt::format("{}{:.1f}", comma, std::max(counts, 0.0));
  }
  const double last = first + geometry.step.as_double() *
                                  (static_cast<double>(std::max<std::size_t>(counts_above.size(), 1)) - 1);
  return fmt::format(
      R"({{{},"frame_id":{},"pose":{{"position":{{"x":0,"y":0,"z":0}},"orientation":{{"x":0,"y":0,"z":0,"w":1}}}},)"
      R"("start_angle":{:.9f},"end_angle":{:.9f},"ranges":[{}],"intensities":[{}]}})",
      stamp_of(time), source.child, first, last, ranges, intensities);
}

}  // namespace ocm::cli::serve
