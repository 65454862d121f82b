/// What the verbs that show frames have in common, whether the frames come from a bus or out of a log: what
/// they mean, how they are shown, and the summary at the end.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "ocm/client/sample.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/measure/statistics.hpp"

#include "cli/output/format_options.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/session.hpp"
#include "cli/watch/contradictions.hpp"

namespace ocm::cli {

/// Frames in, text on stdout out.
class Display {
 public:
  /// `verb` is for messages. Prints the head line, where the format has one.
  Display(std::string_view verb, Session& session, const FormatOptions& options);

  /// What the entry means, which is counted. Valid until the next.
  [[nodiscard]] client::Reception understand(const log::Entry& entry) {
    const client::Reception reception = cli::understand(receiver_, entry);
    last_ = entry.time;
    if (reception.meaning == client::Meaning::wrong_dlc && !wrong_length_)
      wrong_length_ = {entry.id, entry.length, reception.frame.layout().length};
    return reception;
  }
  /// Frames of interface `number` come over the one of this name: topics of others are none of theirs.
  void on_interface(std::uint16_t number, std::string_view name) { receiver_.on_interface(number, name); }
  [[nodiscard]] bool has_buses() const noexcept { return receiver_.has_buses(); }
  /// Whether there was anything to show.
  bool show(std::string_view bus, const log::Entry& entry, const client::Reception& reception) {
    const bool shown = printer_.write({bus, entry, reception});
    shown_ += shown ? 1 : 0;
    return shown;
  }
  void flush() { printer_.flush(); }

  [[nodiscard]] std::uint64_t shown() const noexcept { return shown_; }  ///< lines, or frames with --csv
  [[nodiscard]] const client::ReceiverCounters& counters() const noexcept { return receiver_.counters(); }
  /// Whether any frame or message was lost, unknown, wrong, incomplete or of a page that the spec has not. To
  /// be asked after `summarise`.
  [[nodiscard]] bool any_fault() noexcept;
  /// What came, and every fault by its cause, on stderr. `until`: up to when was listened, if that is later
  /// than the last frame.
  void summarise(std::uint64_t lost, base::Time until = {});
  /// On stderr, if it is so.
  void tell_contradictions(Seen where) const;

 private:
  void summarise_transport();

  client::Receiver receiver_;
  Printer printer_;
  std::uint64_t shown_ = 0;
  base::Time last_{};
  std::optional<measure::WrongLength> wrong_length_;  ///< the first
};

}  // namespace ocm::cli
