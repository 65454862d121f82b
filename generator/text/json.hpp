/// JSON for other programs to read, built by hand and printed once. nlohmann-json does the printing, in
/// json.cpp alone: it takes seconds to compile.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace ocm::generate {

class Json {
 public:
  struct Member;

  Json() = default;  ///< null
  Json(std::nullptr_t) {}
  template <class T>
  requires std::is_arithmetic_v<T> Json(T value) {
    if constexpr (std::same_as<T, bool>)
      kind_ = Kind::boolean, whole_ = value ? 1 : 0;
    else if constexpr (std::floating_point<T>)
      kind_ = Kind::real, real_ = static_cast<double>(value);
    else
      kind_ = std::is_signed_v<T> ? Kind::whole : Kind::natural, whole_ = static_cast<std::uint64_t>(value);
  }
  Json(std::string_view text) : kind_(Kind::text), text_(text) {}
  Json(const std::string& text) : kind_(Kind::text), text_(text) {}
  Json(const char* text) : kind_(Kind::text), text_(text) {}
  /// An array.
  template <class Range>
  requires(!std::convertible_to<Range, std::string_view> && !std::same_as<Range, Json> &&
           requires(const Range& range) { range.begin(), range.end(); }) Json(const Range& range)
      : kind_(Kind::array) {
    for (const auto& each : range) items_.emplace_back(each);
  }
  /// An object: {{"name", value}, {"name", value}}.
  Json(std::initializer_list<Member> members);
  [[nodiscard]] static Json array();
  [[nodiscard]] static Json object();

  /// The member of that name, which is added as null if it is missing; null becomes an object.
  Json& operator[](std::string_view name);
  /// One more item; null becomes an array.
  void push_back(Json item);

  [[nodiscard]] bool is_null() const noexcept { return kind_ == Kind::null; }
  [[nodiscard]] bool is_text() const noexcept { return kind_ == Kind::text; }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

  /// On one line, without its end. What is no UTF-8 becomes the replacement character.
  [[nodiscard]] std::string line() const;
  /// Indented by two, on several lines, with the end of the last one.
  [[nodiscard]] std::string lines() const;

 private:
  friend struct JsonPrinter;
  enum class Kind : std::uint8_t { null, boolean, whole, natural, real, text, array, object };

  Kind kind_ = Kind::null;
  std::uint64_t whole_ = 0;  ///< a whole number as its two's complement
  double real_ = 0;
  std::string text_;
  std::vector<Json> items_;
  std::vector<std::string> names_;  ///< of the items of an object
};

struct Json::Member {
  std::string_view name;
  Json value;
};

}  // namespace ocm::generate
