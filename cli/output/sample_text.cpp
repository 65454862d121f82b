#include "cli/output/sample_text.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "cli/output/json_text.hpp"
#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

/// The unit, and the names of values: "0 off, 1 on".
std::string description(const protocol::Field& field) {
  std::string text{field.unit};
  for (const protocol::NamedValue& value : field.values)
    text +=
        fmt::format("{}{}{} {}", text.empty() ? "" : ", ", field.flags ? "bit " : "", value.raw, value.name);
  return text;
}

std::string object_schema(std::string_view properties) {
  return fmt::format(R"("type":"object","properties":{{{}}})", properties);
}

std::string fields_schema(const protocol::FrameLayout& frame) {
  std::string properties;
  for (const protocol::Field& field : frame.values()) {
    const std::string about = description(field);
    properties +=
        fmt::format(R"({}{}:{{"type":"number"{}{}}})", properties.empty() ? "" : ",", json_string(field.name),
                    about.empty() ? "" : R"(,"description":)", about.empty() ? "" : json_string(about));
  }
  return object_schema(properties);
}

char* copy(char* to, std::string_view text) {
  return std::copy(text.begin(), text.end(), to);
}

}  // namespace

std::string sample_schema(const protocol::Topic& topic) {
  std::string type;
  if (topic.frames.size() == 1) {
    type = fields_schema(topic.frames.front());
  } else {
    std::string properties;
    for (std::size_t i = 0; i < topic.frames.size(); ++i)
      properties += fmt::format("{}{}:{{{}}}", i == 0 ? "" : ",",
                                json_string(frame_name({&topic, static_cast<std::uint8_t>(i)})),
                                fields_schema(topic.frames[i]));
    type = object_schema(properties);
  }
  return fmt::format(
      R"({{"$schema":"https://json-schema.org/draft/2020-12/schema","title":{},"description":{},{}}})",
      json_string(topic.name), json_string(topic.source), type);
}

SampleText::SampleText(const protocol::Topic& topic) {
  for (const protocol::FrameLayout& frame : topic.frames) {
    const FrameText& made = frames_.emplace_back(text_of(frame, topic.frames.size() == 1));
    for (const Value& value : made.values) room_ += 1 + value.before.size() + FieldText::room;
    room_ += made.begin.size() + made.end.size() + 1;
  }
  room_ += 2;
}

SampleText::FrameText SampleText::text_of(const protocol::FrameLayout& frame, bool alone) {
  FrameText made{alone ? "" : json_string(frame.name) + ":{", {}, alone ? "" : "}", &frame};
  for (const protocol::Field& field : frame.values()) {
    made.values.push_back({json_string(field.name) + ':', FieldText{field}});
    made.varies = made.varies || frame.may_lack(field);
  }
  return made;
}

char* SampleText::print(char* to, const FrameText& frame, std::span<const std::uint8_t> data) {
  to = copy(to, frame.begin);
  bool first = true;
  for (const Value& value : frame.values) {
    if (frame.varies && !frame.layout->has(value.text.field(), data)) continue;
    if (!first) *to++ = ',';
    first = false;
    to = value.text.print_json(copy(to, value.before), data.data());
  }
  return copy(to, frame.end);
}

char* SampleText::print(char* to, const client::Sample& sample) const {
  *to++ = '{';
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (i != 0) *to++ = ',';
    to = print(to, frames_[i], sample.data(i));
  }
  *to++ = '}';
  return to;
}

char* SampleText::print(char* to, std::size_t frame, std::span<const std::uint8_t> data) const {
  *to++ = '{';
  to = print(to, frames_[frame], data);
  *to++ = '}';
  return to;
}

}  // namespace ocm::cli
