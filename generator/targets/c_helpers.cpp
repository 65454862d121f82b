#include "generator/targets/c_helpers.hpp"

#include <iterator>
#include <vector>

#include "generator/targets/c_text.hpp"

namespace ocm::generate {
namespace {

struct Helper {
  std::string_view name;  ///< behind the robot's
  std::string_view text;
};

/// What one calls stands before it.
constexpr Helper table[] = {
    {"at_most_u32",
     R"(static inline uint32_t @_at_most_u32(uint32_t number, uint32_t most) { return number < most ? number : most; }
)"},
    {"at_most_u64",
     R"(static inline uint64_t @_at_most_u64(uint64_t number, uint64_t most) { return number < most ? number : most; }
)"},
    {"held_i32", R"(static inline int32_t @_held_i32(int32_t number, int32_t least, int32_t most) {
  return number < least ? least : number > most ? most : number;
}
)"},
    {"held_i64", R"(static inline int64_t @_held_i64(int64_t number, int64_t least, int64_t most) {
  return number < least ? least : number > most ? most : number;
}
)"},
    {"nearest", R"(// The nearest whole number, halves away from zero, within [least, most].
static inline int64_t @_nearest(double value, int64_t least, int64_t most) {
  int64_t whole = 0;
  double rest = 0;
  if (value != value) return least > 0 ? least : most < 0 ? most : 0;
  if (value <= (double)least) return least;
  if (value >= (double)most) return most;
  whole = (int64_t)value;
  rest = value - (double)whole;
  return whole + (rest >= 0.5 ? 1 : rest <= -0.5 ? -1 : 0);
}
)"},
    {"within", R"(// The nearest in [least, most]; not a number: the one nearest to zero.
static inline double @_within(double value, double least, double most) {
  if (value != value) return least > 0 ? least : most < 0 ? most : 0;
  return value < least ? least : value > most ? most : value;
}
)"},
    {"nearest_u64", R"(static inline uint64_t @_nearest_u64(double value) {
  if (!(value > 0)) return 0;
  if (value >= 18446744073709551615.0) return UINT64_MAX;
  if (value >= 9007199254740992.0) return (uint64_t)value;
  return (uint64_t)@_nearest(value, 0, INT64_MAX);
}
)"},
    {"float_of", R"(static inline float @_float_of(uint32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
)"},
    {"bits_of_float", R"(static inline uint32_t @_bits_of_float(float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}
)"},
    {"double_of", R"(// Where double has 64 bits.
static inline double @_double_of(uint64_t bits) {
  double value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
)"},
    {"bits_of_double", R"(static inline uint64_t @_bits_of_double(double value) {
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}
)"},
};

bool calls(std::string_view code, std::string_view before, std::string_view name) {
  return code.find(std::string{before} + "_" + std::string{name} + "(") != std::string_view::npos;
}

}  // namespace

std::string named(std::string_view text, const std::string& robot) {
  const std::string macro = upper(robot);
  std::string out;
  for (const char c : text) {
    if (c == '@')
      out += robot;
    else if (c == '$')
      out += macro;
    else
      out += c;
  }
  return out;
}

std::set<std::string> names_in(std::string_view text, const std::string& robot) {
  const auto is_part = [](char c) {
    return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  std::set<std::string> names;
  for (std::size_t begin = text.find_first_of("@$"); begin != std::string_view::npos;
       begin = text.find_first_of("@$", begin + 1)) {
    std::size_t end = begin + 1;
    while (end < text.size() && is_part(text[end])) ++end;
    names.insert(named(text.substr(begin, end - begin), robot));
  }
  return names;
}

std::set<std::string> names_of_helpers(const std::string& robot) {
  std::set<std::string> names;
  for (const Helper& helper : table) names.merge(names_in(helper.text, robot));
  return names;
}

std::string helpers_of(std::string_view body, const std::string& robot) {
  std::vector<std::string_view> needed;  // the last first: what is called stands before
  for (auto helper = std::rbegin(table); helper != std::rend(table); ++helper) {
    bool is_called = calls(body, robot, helper->name);
    for (const std::string_view caller : needed) is_called = is_called || calls(caller, "@", helper->name);
    if (is_called) needed.push_back(helper->text);
  }
  std::string out;
  for (auto text = needed.rbegin(); text != needed.rend(); ++text) out += named(*text, robot);
  return needed.empty() ? out : out + "\n";
}

std::string held(const spec::FieldModel& field, const std::string& number, const std::string& robot) {
  const unsigned width = field.position.width;
  if (width == type_width(field)) return number;
  const bool wide = is_wide(field);
  if (!field.is_signed)
    return robot + (wide ? "_at_most_u64(" : "_at_most_u32(") + number + ", " +
           word_literal((std::uint64_t{1} << width) - 1, wide) + ")";
  return robot + (wide ? "_held_i64(" : "_held_i32(") + number + ", " +
         literal(protocol::lowest(width, true)) + ", " + literal(protocol::highest(width, true)) + ")";
}

}  // namespace ocm::generate
