/// A board that runs as an image in QEMU: the process and its two lines. On one of them the board is an SLCAN
/// adapter with what it sends and hears, on the other it asks for its parts.
///
///     auto board = QemuBoard::start({.name = "light_ring", .image = "light_ring_qemu_m3.elf", ...});
///     board->read([&](const can::Frame& frame) { return arbiter.send(node, frame); }, answer_parts);
///     board->hear(frame);
///
/// Waits for nothing; `descriptors()` are readable when there is something to do. Host only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "ocm/can/frame.hpp"
#include "ocm/can/slcan_codec.hpp"
#include "ocm/can/slcan_host.hpp"
#include "ocm/transport/bus.hpp"

#include "sim/qemu/process.hpp"

namespace ocm::sim {

struct QemuCounters {
  std::uint64_t sent = 0;       ///< frames of the board that the bus took
  std::uint64_t heard = 0;      ///< frames handed to the board
  std::uint64_t deaf = 0;       ///< frames that the board's line had no room for: lost to it
  std::uint64_t garbage = 0;    ///< lines of the board that were no SLCAN
  std::uint64_t exchanges = 0;  ///< with its parts
};

class QemuBoard {
 public:
  [[nodiscard]] static transport::Outcome<std::unique_ptr<QemuBoard>> start(QemuOptions options) {
    auto qemu = QemuProcess::start(std::move(options), 2);
    if (!qemu) return qemu.error;
    return std::unique_ptr<QemuBoard>{new QemuBoard(std::move(*qemu))};
  }
  QemuBoard(const QemuBoard&) = delete;
  QemuBoard& operator=(const QemuBoard&) = delete;

  [[nodiscard]] const std::string& name() const noexcept { return qemu_->name(); }
  [[nodiscard]] const QemuCounters& counters() const noexcept { return counters_; }
  /// To poll for input.
  [[nodiscard]] std::array<int, 2> descriptors() const noexcept {
    return {qemu_->line(can_line), qemu_->line(parts_line)};
  }
  /// The bus had no room for a frame of the board: `read` again when it has.
  [[nodiscard]] bool waiting() const noexcept { return held_.has_value(); }
  /// The board has said that it listens. What it should hear before that is lost to it, as to any board that
  /// starts.
  [[nodiscard]] bool ready() const noexcept { return ready_; }
  /// Why QEMU has ended; empty while it runs.
  [[nodiscard]] std::string ended() { return qemu_->ended(); }

  /// Takes what the board has sent. `send(const can::Frame&) -> bool`: false when the bus has no room, then
  /// the board's line waits. `answer(const firmware::qemu::link::Request&, std::span<std::uint8_t>) ->
  /// base::Status` stands for the board's parts.
  template <class Send, class Answer>
  void read(Send&& send, Answer&& answer) {
    counters_.exchanges += parts_.serve(*qemu_, parts_line, answer);
    read_can(send);
  }

  /// The board hears a frame. What its line has no room for is lost to it, and counted.
  void hear(const can::Frame& frame) {
    const auto text = can::slcan::encode(frame);
    if (!text) return;
    ++(qemu_->write(can_line, text->view()) ? counters_.heard : counters_.deaf);
  }

 private:
  static constexpr std::size_t can_line = 0;
  static constexpr std::size_t parts_line = 1;

  explicit QemuBoard(std::unique_ptr<QemuProcess> qemu) : qemu_(std::move(qemu)) {}

  template <class Send>
  void read_can(Send& send) {
    for (;;) {
      if (held_) {
        if (!send(*held_)) return;
        held_.reset();
        ++counters_.sent;
      }
      if (at_ == size_) {
        size_ = qemu_->read(can_line, buffer_).size();
        at_ = 0;
        if (size_ == 0) return;
      }
      using Kind = can::slcan::Answer::Kind;
      const auto answer = lines_.feed(buffer_[at_++]);
      if (answer.kind == Kind::frame) held_ = answer.frame;
      if (answer.kind == Kind::done) ready_ = true;
      counters_.garbage = lines_.faults().total();
    }
  }

  std::unique_ptr<QemuProcess> qemu_;
  PartsServer parts_;
  can::slcan::AnswerReader lines_;
  std::array<char, 4096> buffer_{};
  std::size_t at_ = 0;
  std::size_t size_ = 0;
  std::optional<can::Frame> held_;
  bool ready_ = false;
  QemuCounters counters_;
};

}  // namespace ocm::sim
