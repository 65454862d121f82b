/// A log format that is read: entries in the order of the file, in batches, so that the call costs nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "ocm/log/complaints.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/input.hpp"
#include "ocm/log/interfaces.hpp"

namespace ocm::log {

/// What the recorder of a log says of an interface.
struct Recorded {
  std::uint64_t received = 0;
  std::uint64_t dropped = 0;  ///< frames that were on the bus and are not in the log
};

/// Entries that are asked for at once: enough to make the call cheap, few enough to stay in the first cache.
inline constexpr std::size_t batch = 256;

class Reader {
 public:
  /// `input` must outlive the reader.
  explicit Reader(Input& input) : input_(&input) {}
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  virtual ~Reader() = default;

  /// Fills `into` from the front; 0: the log is at its end. Waits for the first entry only (Input::Wait):
  /// fewer than the size of `into` say nothing but that no more was there yet. What cannot be read is in
  /// `complaints`.
  [[nodiscard]] virtual std::size_t read(std::span<Entry> into) = 0;

  [[nodiscard]] const Interfaces& interfaces() const noexcept { return interfaces_; }
  [[nodiscard]] const Complaints& complaints() const noexcept { return complaints_; }
  /// By number of the interface; empty where the format does not say. Complete at the end of the log.
  [[nodiscard]] const std::vector<Recorded>& recorded() const noexcept { return recorded_; }

 protected:
  /// Something that was passed over, at the line or byte where it begins.
  void complain(Cause cause, Place place, std::string_view detail) { complaints_.add(cause, place, detail); }

  /// Why a line is refused: one without its end is cut off, whatever else is wrong with it. A writer that is
  /// killed within write(2) leaves what Linux had copied, up to the end of a page.
  [[nodiscard]] Cause cause_of_line(Cause cause, Input::Line taken) const noexcept {
    if (taken != Input::Line::last) return cause;
    return input_->failure().empty() ? Cause::cut_line : Cause::truncated;
  }

  Input* input_;
  Interfaces interfaces_;
  Complaints complaints_;
  std::vector<Recorded> recorded_;
};

}  // namespace ocm::log
