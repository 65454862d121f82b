/// A value or the reason why there is none: what a function returns that can fail, without exceptions.
/// No heap; `Result<T>` is `sizeof(T)` plus the error. A result that is ignored does not compile
/// (warnings are errors here).
#pragma once

#include <cstdint>
#include <string_view>

namespace ocm::base {

/// Why an operation of the core failed. `describe` says it in words.
enum class Error : std::uint8_t {
  none,
  bad_syntax,       ///< text that is not of the expected form
  bad_identifier,   ///< identifier too wide for its frame format
  bad_length,       ///< DLC or number of bytes that the frame or request cannot have
  bad_mode,         ///< request mode other than stop, publish, once
  bad_unit,         ///< request unit other than ms, s, us
  bad_period,       ///< period of zero, negative, or not representable on the wire
  out_of_range,     ///< number outside what its field or type holds
  unknown_topic,    ///< no board serves this topic
  not_sampled,      ///< a part did not deliver a sample
  full,             ///< a bounded container or queue has no room left
  closed,           ///< the bus is gone: interface down, peer closed
  timed_out,        ///< nothing came before the deadline
  no_answer,        ///< a part did not acknowledge, or is not the one that belongs there
  bus_fault,        ///< a board-internal bus failed: arbitration lost, line stuck, wrong signal
  not_schedulable,  ///< a stream would miss its deadline: CPU or bus cannot carry it
};

[[nodiscard]] constexpr std::string_view describe(Error error) noexcept {
  switch (error) {
    case Error::none:
      return "no error";
    case Error::bad_syntax:
      return "not of the expected form";
    case Error::bad_identifier:
      return "identifier out of range for its format";
    case Error::bad_length:
      return "length that this frame cannot have";
    case Error::bad_mode:
      return "mode other than 0 stop, 1 publish, 2 once";
    case Error::bad_unit:
      return "unit other than 0 ms, 1 s, 2 us";
    case Error::bad_period:
      return "period that the wire cannot carry";
    case Error::out_of_range:
      return "number out of range";
    case Error::unknown_topic:
      return "unknown topic";
    case Error::not_sampled:
      return "the part delivered no sample";
    case Error::full:
      return "no room left";
    case Error::closed:
      return "the bus is gone";
    case Error::timed_out:
      return "nothing came in time";
    case Error::no_answer:
      return "the part does not answer";
    case Error::bus_fault:
      return "the bus of the part failed";
    case Error::not_schedulable:
      return "a stream would miss its deadline";
  }
  return "unknown error";
}

/// Either a `T` (when `error == E{}`) or an error. Both members are public so that a result is a structural
/// type and can stand in a static_assert.
template <class T, class E = Error>
struct [[nodiscard]] Result {
  using value_type = T;

  T value{};
  E error{};

  constexpr Result() = default;
  constexpr Result(T v) : value(static_cast<T&&>(v)) {}  // NOLINT: a value is a result
  constexpr Result(E e) : error(static_cast<E&&>(e)) {}  // NOLINT: so is an error

  [[nodiscard]] constexpr bool ok() const noexcept { return error == E{}; }
  constexpr explicit operator bool() const noexcept { return ok(); }
  constexpr const T& operator*() const noexcept { return value; }
  constexpr T& operator*() noexcept { return value; }
  constexpr const T* operator->() const noexcept { return &value; }
  constexpr T* operator->() noexcept { return &value; }
  /// constexpr where T's is: said outright, clang 14 refuses a T whose comparison is not.
  friend bool operator==(const Result&, const Result&) = default;
};

/// Success or an error, with no value.
template <class E>
struct [[nodiscard]] Result<void, E> {
  E error{};

  constexpr Result() = default;
  constexpr Result(E e) : error(static_cast<E&&>(e)) {}  // NOLINT: an error is a result
  [[nodiscard]] constexpr bool ok() const noexcept { return error == E{}; }
  constexpr explicit operator bool() const noexcept { return ok(); }
  friend bool operator==(const Result&, const Result&) = default;
};

using Status = Result<void>;

}  // namespace ocm::base
