/// A sample or a set point as one JSON object, with the numbers that `decode --json` prints:
/// {"x":12.5,"y":0}. Of a topic of several frames it has an object a frame:
/// {"velocity":{"x":0.1,"z":0},"pose":{"x":2.5}}; a set point is one frame, and has that one's. A field that
/// is not in the frame has no key.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ocm/client/sample.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/output/field_text.hpp"

namespace ocm::cli {

/// Of one topic or message; what is the same in every sample is made once.
class SampleText {
 public:
  /// The topic must outlive it.
  explicit SampleText(const protocol::Topic& topic);

  /// Most bytes that a print may write, those behind the end of the text included.
  [[nodiscard]] std::size_t room() const noexcept { return room_; }
  /// Returns the end.
  char* print(char* to, const client::Sample& sample) const;
  /// What the topic's frame of that number carries.
  char* print(char* to, std::size_t frame, std::span<const std::uint8_t> data) const;

 private:
  /// A field's value, and the text before it.
  struct Value {
    std::string before;
    FieldText text;
  };
  struct FrameText {
    std::string begin;
    std::vector<Value> values;
    std::string end;
    const protocol::FrameLayout* layout = nullptr;
    bool varies = false;  // not every frame has every field
  };

  static FrameText text_of(const protocol::FrameLayout& frame, bool alone);
  static char* print(char* to, const FrameText& frame, std::span<const std::uint8_t> data);

  std::vector<FrameText> frames_;
  std::size_t room_ = 0;
};

/// What such objects of a topic look like, in JSON Schema, with the units of the numbers.
[[nodiscard]] std::string sample_schema(const protocol::Topic& topic);

}  // namespace ocm::cli
