/// The formats in which received frames are shown, one file a format, all behind one interface.
#pragma once

#include <iterator>
#include <memory>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/reflective/sample.hpp"

namespace ocm::cli {

/// A frame as it came, and what it means.
struct Event {
  std::string_view bus;
  const can::Received& received;
  const reflective::Reception& reception;
};

using Buffer = fmt::memory_buffer;

inline void append(Buffer& out, std::string_view text) {
  out.append(text.data(), text.data() + text.size());
}
inline void append(Buffer& out, base::Decimal number) {
  append(out, base::to_text(number).view());
}

/// A field's value in `frame`, exactly.
[[nodiscard]] inline base::Decimal physical(const protocol::Field& field, const can::Payload& data) {
  const std::int64_t raw = field.raw(data);
  const auto value = field.physical(raw);
  return value ? *value : base::normalised(raw, 0);
}

/// What a frame is called within its topic; a topic's only frame has the topic's name.
[[nodiscard]] inline std::string_view frame_name(protocol::FrameRef frame) {
  return frame.layout().name.empty() ? frame.topic->name : frame.layout().name;
}

/// Writes events as text into a buffer, which `Printer` empties.
class Output {
 public:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  virtual ~Output() = default;
  virtual void begin(Buffer&) {}  ///< a head line, where the format has one
  virtual void write(Buffer& out, const Event& event) = 0;
};

enum class Format { pretty, json, csv, raw };

/// `catalogue` outlives the output.
[[nodiscard]] std::unique_ptr<Output> make_output(Format format, const protocol::Catalogue& catalogue,
                                                  bool colour);
[[nodiscard]] std::unique_ptr<Output> make_pretty(const protocol::Catalogue& catalogue, bool colour);
[[nodiscard]] std::unique_ptr<Output> make_json(const protocol::Catalogue& catalogue);
[[nodiscard]] std::unique_ptr<Output> make_csv();
[[nodiscard]] std::unique_ptr<Output> make_raw();

/// An output on stdout: gathers lines and writes them in large pieces, or at once when nothing more is
/// waiting.
class Printer {
 public:
  explicit Printer(std::unique_ptr<Output> output) : output_(std::move(output)) { output_->begin(buffer_); }
  void write(const Event& event) {
    output_->write(buffer_, event);
    if (buffer_.size() >= enough) flush();
  }
  /// Leaves with exit_failure when stdout takes no more (a full disk, a closed file).
  void flush();

 private:
  static constexpr std::size_t enough = 1 << 16;
  std::unique_ptr<Output> output_;
  Buffer buffer_;
};

}  // namespace ocm::cli
