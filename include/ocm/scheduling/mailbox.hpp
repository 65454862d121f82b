/// A queue with one place, from one context to another: what is put replaces what was not taken, and that is
/// counted. For what is only ever wanted in its newest form: a set point, a command to the motors.
///
/// The port's lock is held for one copy of a T: O(1), any context, interrupts too. sizeof(T) and 12 bytes at
/// most. No heap.
#pragma once

#include <concepts>
#include <cstdint>
#include <type_traits>

#include "ocm/base/result.hpp"

namespace ocm::scheduling {

/// `P`: anything with `lock()`, such as a port.
template <class T, class P>
requires std::is_trivially_copyable_v<T> && requires(P& port) {
  { port.lock() } -> std::destructible;
}
class Mailbox {
 public:
  /// The port must outlive the mailbox.
  constexpr explicit Mailbox(P& port) noexcept : port_(&port) {}
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  void put(const T& item) noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    put_locked(item);
  }
  /// What was put last; Error::no_answer when nothing was since the last `take`.
  [[nodiscard]] base::Result<T> take() noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return take_locked();
  }
  /// What is in it is void: lost, where there is something.
  void clear() noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    clear_locked();
  }

  // The same with the port's lock held already: with what else belongs to that moment
  void put_locked(const T& item) noexcept {
    lost_ += full_ ? 1U : 0U;
    item_ = item;
    full_ = true;
  }
  [[nodiscard]] base::Result<T> take_locked() noexcept {
    if (!full_) return base::Error::no_answer;
    full_ = false;
    return item_;
  }
  void clear_locked() noexcept {
    lost_ += full_ ? 1U : 0U;
    full_ = false;
  }
  [[nodiscard]] bool empty_locked() const noexcept { return !full_; }

  /// How many were put and never taken. It wraps.
  [[nodiscard]] std::uint32_t lost() const noexcept {
    [[maybe_unused]] const auto guard = port_->lock();
    return lost_;
  }

 private:
  P* port_;
  T item_{};
  std::uint32_t lost_ = 0;
  bool full_ = false;
};

}  // namespace ocm::scheduling
