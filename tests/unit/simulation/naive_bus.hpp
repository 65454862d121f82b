/// A CAN bus that goes bit by bit, to judge the arbiter where the wire is disturbed: each bit that is sent,
/// tells of an error, or is silent. It is slow, holds no arbitration ahead of time and skips nothing. Tests
/// only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "ocm/can/length.hpp"

namespace ocm::test {

struct NaiveFrame {
  can::Frame frame{};
  std::uint64_t ready = 0;
};

struct NaiveDelivery {
  can::Frame frame{};
  std::size_t from = 0;
  std::uint64_t start = 0;
  std::uint64_t end = 0;
  bool sent = true;
  friend bool operator==(const NaiveDelivery&, const NaiveDelivery&) = default;
};

struct NaiveNode {
  bool fifo = true;
  std::vector<NaiveFrame> queue;  ///< in order of hand-over, all of the run
  unsigned transmit_errors = 0;
  unsigned receive_errors = 0;
  unsigned off = 0;  ///< sequences until it may come back

  [[nodiscard]] bool passive() const { return transmit_errors > 127 || receive_errors > 127; }
};

class NaiveBus {
 public:
  explicit NaiveBus(std::vector<NaiveNode> nodes) : nodes_(std::move(nodes)) {}

  std::map<std::uint64_t, unsigned> disturbances;  ///< boundary, length of the flags
  std::vector<NaiveDelivery> deliveries;
  std::uint64_t errors = 0;
  std::uint64_t overloads = 0;
  std::uint64_t bits_in_use = 0;
  std::uint64_t times_off = 0;

  [[nodiscard]] const std::vector<NaiveNode>& nodes() const { return nodes_; }

  void run(std::uint64_t bits) {
    for (now_ = 0; now_ < bits; ++now_) {
      const auto found = disturbances.find(now_);
      disturbed_ = found != disturbances.end();
      flags_ = disturbed_ ? found->second : 0;
      // A dominant bit in the last bit of the intermission is a start of frame.
      if (phase_ == Phase::idle || (phase_ == Phase::intermission && left_ == 1 && disturbed_)) {
        if (try_start()) {
          if (phase_ == Phase::intermission) disturbed_ = false;
          phase_ = Phase::frame;
        }
      }
      bits_in_use += phase_ != Phase::idle || disturbed_ ? 1 : 0;
      bit();
    }
  }

 private:
  enum class Phase { idle, frame, error, intermission };
  static constexpr std::size_t no_sender = SIZE_MAX;

  bool try_start() {
    const can::Frame* best = nullptr;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      NaiveNode& node = nodes_[n];
      if (node.off != 0 || (node.passive() && n == last_sender_ && since_intermission_ < 8)) continue;
      for (std::size_t i = 0; i < node.queue.size() && node.queue[i].ready <= now_; ++i) {
        const can::Frame& frame = node.queue[i].frame;
        if (best == nullptr || can::arbitration_key(frame) < can::arbitration_key(*best)) {
          best = &frame;
          sender_ = n;
          position_ = i;
        }
        if (node.fifo) break;
      }
    }
    if (best == nullptr) return false;
    last_sender_ = sender_;
    start_ = now_;
    left_ = can::frame_bits(*best);
    return true;
  }

  void bit() {
    switch (phase_) {
      case Phase::idle:
        ++since_intermission_;
        if (!disturbed_) return level(true);
        level(false);
        last_sender_ = no_sender;
        error(6);
        return;
      case Phase::frame:
        --left_;
        // ACK delimiter and end of frame, 8 bits, are recessive and follow a dominant bit.
        level(left_ < 8 && !disturbed_);
        if (left_ == 0 || disturbed_) end_frame();
        return;
      case Phase::error:
        --left_;
        level(left_ < 8 && !disturbed_);
        if (disturbed_)
          error(0);
        else if (left_ == 0)
          intermission();
        return;
      case Phase::intermission:
        --left_;
        level(!disturbed_);
        if (disturbed_ && left_ == 0) {
          last_sender_ = no_sender;
          error(6);
        } else if (disturbed_) {
          ++overloads;
          phase_ = Phase::error;
          left_ = flags_ + 8;
        } else if (left_ == 0) {
          phase_ = Phase::idle;
        }
        return;
    }
  }

  void end_frame() {
    NaiveNode& node = nodes_[sender_];
    const can::Frame frame = node.queue[position_].frame;
    if (left_ == 0) deliveries.push_back({frame, sender_, start_, now_ + 1, !disturbed_});
    if (disturbed_) {
      left_ = 0;
      error(0);
    } else {
      node.queue.erase(node.queue.begin() + static_cast<std::ptrdiff_t>(position_));
      for (std::size_t n = 0; n < nodes_.size(); ++n) succeed(nodes_[n], n == sender_);
      intermission();
    }
    sender_ = no_sender;
  }

  void intermission() {
    phase_ = Phase::intermission;
    left_ = 3;
    since_intermission_ = 0;
  }

  static void succeed(NaiveNode& node, bool sent) {
    if (node.off != 0) return;
    if (sent)
      node.transmit_errors -= node.transmit_errors > 0 ? 1 : 0;
    else if (node.receive_errors > 127)
      node.receive_errors = 120;
    else
      node.receive_errors -= node.receive_errors > 0 ? 1 : 0;
  }

  /// From the next bit on, or some bits later.
  void error(unsigned later) {
    ++errors;
    left_ = std::max<unsigned>(phase_ == Phase::error ? left_ : 0, later + flags_ + 8);
    phase_ = Phase::error;
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      NaiveNode& node = nodes_[n];
      if (node.off != 0) continue;
      if (n != last_sender_)
        node.receive_errors = std::min(node.receive_errors + 1, 255U);
      else if ((node.transmit_errors += 8) > 255)
        node.off = 128, ++times_off;
    }
  }

  void level(bool recessive) {
    in_a_row_ = recessive ? in_a_row_ + 1 : 0;
    if (in_a_row_ < 11) return;
    in_a_row_ = 0;
    for (NaiveNode& node : nodes_)
      if (node.off != 0 && --node.off == 0) node.transmit_errors = node.receive_errors = 0;
  }

  std::vector<NaiveNode> nodes_;
  std::uint64_t now_ = 0;
  Phase phase_ = Phase::idle;
  bool disturbed_ = false;
  unsigned flags_ = 0;
  unsigned left_ = 0;  ///< bits of the phase
  unsigned in_a_row_ = 0;
  std::uint64_t since_intermission_ = 0;
  std::size_t sender_ = no_sender;
  std::size_t last_sender_ = no_sender;
  std::size_t position_ = 0;
  std::uint64_t start_ = 0;
};

}  // namespace ocm::test
