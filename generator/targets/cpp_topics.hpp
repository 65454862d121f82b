/// The topics of a spec in its C++ header: a struct a topic, and one a frame of those that have several.
#pragma once

#include <cstdint>
#include <string>

#include "generator/spec/model.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {

void write_topic(Writer& out, const spec::Model& model, const spec::TopicModel& topic);

/// A raw number as a literal that has no warning in any type.
[[nodiscard]] std::string cpp_literal(std::int64_t number);

[[nodiscard]] inline bool is_float(const spec::FieldModel& field) {
  return field.number != protocol::Number::integer;
}

/// Of `instances` frames with consecutive ids the greatest number of bits at each priority, as an
/// initializer.
[[nodiscard]] std::string worst_bits(const spec::TopicModel& topic, const spec::FrameModel& frame,
                                     unsigned id, unsigned instances);

}  // namespace ocm::generate
