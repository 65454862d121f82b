/// What the unit tests use of Catch2, for a Cortex-M without exceptions and iostreams: the same test sources
/// compile here unchanged. A failed CHECK is reported and counted; a failed REQUIRE is reported and ends the
/// program, for without exceptions nothing else leaves a test case. Values are not told: the host runs the
/// same test.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <string_view>

namespace ocm::target {

/// Where a message goes: the host's stderr, by semihosting.
class Out {
 public:
  Out& operator<<(std::string_view text) noexcept;
  Out& operator<<(const char* text) noexcept { return *this << std::string_view{text}; }
  Out& operator<<(char c) noexcept { return *this << std::string_view{&c, 1}; }
  Out& operator<<(bool b) noexcept { return *this << (b ? "true" : "false"); }
  template <std::integral T>
  Out& operator<<(T number) noexcept {
    char digits[std::numeric_limits<T>::digits10 + 3];
    const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
    return *this << std::string_view{digits, static_cast<std::size_t>(end - digits)};
  }
  /// In millionths; the library's own way to write a float takes more flash than the tests have.
  template <std::floating_point T>
  Out& operator<<(T number) noexcept {
    const bool fits = number > T(-9e12) && number < T(9e12);
    return fits ? *this << static_cast<long long>(number * T(1e6)) << "e-6" : *this << "(no number, or huge)";
  }
};

/// What INFO and CAPTURE say in addition, while it is in scope. Said only when a check fails, with the values
/// of that moment: a million checks that hold format nothing.
class Note {
 public:
  Note(const Note&) = delete;
  Note& operator=(const Note&) = delete;
  static void tell_all(Out& out) {
    for (const Note* note = last_; note != nullptr; note = note->before_) {
      out << "  with: ";
      note->tell_(*note, out);
      out << '\n';
    }
  }

 protected:
  using Tell = void (*)(const Note&, Out&);
  explicit Note(Tell tell) noexcept : tell_(tell), before_(last_) { last_ = this; }
  ~Note() { last_ = before_; }

 private:
  Tell tell_;
  Note* before_;
  static inline Note* last_ = nullptr;
};

template <class Say>
class NoteOf : public Note {
 public:
  explicit NoteOf(Say say) noexcept
      : Note([](const Note& note, Out& out) { static_cast<const NoteOf&>(note).say_(out); }), say_(say) {}

 private:
  Say say_;
};

/// The names of CAPTURE as one text, then the values.
template <class... Values>
void say_values(Out& out, std::string_view names, const Values&... values) {
  out << names << " =";
  ((out << ' ' << values), ...);
}

/// A test case enlists itself before main.
class TestCase {
 public:
  TestCase(std::string_view name, void (*body)()) noexcept : name_(name), body_(body), before_(last_) {
    last_ = this;
  }
  /// All of them, each told when it fails. Returns how many failed.
  static int run_all();

 private:
  std::string_view name_;
  void (*body_)();
  TestCase* before_;
  static inline TestCase* last_ = nullptr;
};

/// A case with sections, none within another, runs once for each of them, as with Catch2.
class Section {
 public:
  explicit operator bool() const noexcept { return met_++ == wanted_; }
  template <class Body>
  static void run_each(Body body) {
    wanted_ = 0;
    do {
      met_ = 0;
      body();
    } while (++wanted_ < met_);
  }

 private:
  static inline int wanted_ = 0;
  static inline int met_ = 0;
};

enum class Severity { check, require };

/// Counts a check; tells it where it does not hold.
void check(bool holds, Severity severity, std::string_view expression, std::string_view file, int line);

}  // namespace ocm::target

namespace Catch {

/// As Catch2's: equal within a relative 100 float epsilons.
class Approx {
 public:
  explicit Approx(double value) noexcept : value_(value) {}
  /// The share of the value by which the other may differ.
  Approx& epsilon(double share) noexcept {
    epsilon_ = share;
    return *this;
  }
  friend bool operator==(double left, const Approx& right) noexcept {
    return std::abs(left - right.value_) <= right.epsilon_ * std::abs(right.value_);
  }

 private:
  double value_;
  double epsilon_ = static_cast<double>(std::numeric_limits<float>::epsilon()) * 100;
};

}  // namespace Catch
using Catch::Approx;

// Macros, because the tests are written with Catch2's.
#define OCM_TARGET_JOIN_(a, b) a##b
#define OCM_TARGET_JOIN(a, b) OCM_TARGET_JOIN_(a, b)
#define OCM_TARGET_NAME(base) OCM_TARGET_JOIN(base, __COUNTER__)

#define OCM_TARGET_FIRST(first, ...) first
#define OCM_TARGET_CASE(function, ...)                                                               \
  static void function();                                                                            \
  static ::ocm::target::TestCase OCM_TARGET_JOIN(function, _case){OCM_TARGET_FIRST(__VA_ARGS__, ""), \
                                                                  function};                         \
  static void function()
#define TEST_CASE(...) OCM_TARGET_CASE(OCM_TARGET_NAME(ocm_test_), __VA_ARGS__)

#define SECTION(...) if (::ocm::target::Section{})

#define OCM_TARGET_CHECK(severity, holds, ...)                                                       \
  ::ocm::target::check(static_cast<bool>(__VA_ARGS__) == (holds), ::ocm::target::Severity::severity, \
                       (holds) ? #__VA_ARGS__ : "not: " #__VA_ARGS__, __FILE__, __LINE__)
#define CHECK(...) OCM_TARGET_CHECK(check, true, __VA_ARGS__)
#define CHECK_FALSE(...) OCM_TARGET_CHECK(check, false, __VA_ARGS__)
#define REQUIRE(...) OCM_TARGET_CHECK(require, true, __VA_ARGS__)
#define REQUIRE_FALSE(...) OCM_TARGET_CHECK(require, false, __VA_ARGS__)
#define STATIC_REQUIRE(...) static_assert(__VA_ARGS__)
#define STATIC_REQUIRE_FALSE(...) static_assert(!(__VA_ARGS__))

#define OCM_TARGET_NOTE(...)                                                \
  [[maybe_unused]] const ::ocm::target::NoteOf OCM_TARGET_NAME(ocm_note_) { \
    [&](::ocm::target::Out& ocm_out) { __VA_ARGS__; }                       \
  }
#define INFO(...) OCM_TARGET_NOTE(ocm_out << __VA_ARGS__)
#define CAPTURE(...) OCM_TARGET_NOTE(::ocm::target::say_values(ocm_out, #__VA_ARGS__, __VA_ARGS__))
