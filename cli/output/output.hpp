/// The formats in which frames are shown, one file a format, all behind one interface. A frame of a log and a
/// frame from a bus are shown alike: both are entries.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "ocm/client/sample.hpp"
#include "ocm/log/bytes.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/output/selection.hpp"

namespace ocm::cli {

/// A frame as it came, and what it means. A CAN FD frame means nothing (Meaning::unknown): no topic has one.
struct Event {
  std::string_view bus;
  const log::Entry& entry;
  const client::Reception& reception;
};

using Buffer = log::Bytes;

/// Formats by way of another buffer, and allocates nothing for what is short. In output.cpp alone, because it
/// compiles all of fmt again.
void vappend_formatted(Buffer& out, fmt::string_view text, fmt::format_args arguments);
/// For what is rarely written.
template <class... Arguments>
void append_formatted(Buffer& out, fmt::format_string<Arguments...> text, Arguments&&... arguments) {
  vappend_formatted(out, text, fmt::make_format_args(arguments...));
}

/// What a frame is called within its topic; a topic's only frame has the topic's name.
[[nodiscard]] inline std::string_view frame_name(protocol::FrameRef frame) {
  return frame.layout().name.empty() ? frame.topic->name : frame.layout().name;
}

/// What an entry means; the receiver counts all but CAN FD frames, of which it knows nothing.
[[nodiscard]] inline client::Reception understand(client::Receiver& receiver, const log::Entry& entry) {
  return receiver.take(entry.view(), entry.time, entry.interface);
}

/// The bytes with the fields of a topic's frame or a message: of the frame, or of the message that it
/// completes.
[[nodiscard]] inline std::span<const std::uint8_t> bytes_of(const Event& event) {
  return event.reception.transported != nullptr ? event.reception.transported->data : event.entry.bytes();
}

/// Writes events as text into a buffer, which `Printer` empties.
class Output {
 public:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  virtual ~Output() = default;
  virtual void begin(Buffer&) {}  ///< a head line, where the format has one
  /// Whether there was anything to show.
  virtual bool write(Buffer& out, const Event& event) = 0;
};

enum class Format { pretty, json, csv, raw };

/// The width of the terminal, which may change while a verb runs. None: a line is as long as it is.
using Columns = std::size_t (*)();

/// The catalogue outlives the output. With a selection, only its fields, and only frames that have one.
[[nodiscard]] std::unique_ptr<Output> make_output(Format format, const protocol::Catalogue& catalogue,
                                                  const Selection& selection, bool colour,
                                                  Columns columns = nullptr);
[[nodiscard]] std::unique_ptr<Output> make_pretty(const protocol::Catalogue& catalogue,
                                                  const Selection& selection, bool colour,
                                                  Columns columns = nullptr);
[[nodiscard]] std::unique_ptr<Output> make_json(const protocol::Catalogue& catalogue,
                                                const Selection& selection);
[[nodiscard]] std::unique_ptr<Output> make_csv(const protocol::Catalogue& catalogue,
                                               const Selection& selection);
[[nodiscard]] std::unique_ptr<Output> make_raw();

}  // namespace ocm::cli
