/// What several targets make of a plain message: names that are given out once, which fields its length
/// holds, what selects them, and the bytes that it begins with.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "generator/spec/model.hpp"

namespace ocm::generate {

/// `name` and what is put behind it, with one underscore between them: two in a row are for the compiler's
/// own names.
[[nodiscard]] inline std::string joined(std::string name, std::string_view behind) {
  if (name.ends_with('_') && behind.starts_with('_')) name.pop_back();
  return name.append(behind);
}

/// Names of one scope, each given out once.
class Scope {
 public:
  /// `taken` must outlive it.
  explicit Scope(std::set<std::string>& taken) : taken_(taken) {}

  /// A name of which no other in the scope has any of `forms`, "_raw" and the like; with a number behind it
  /// where it must be.
  std::string claim(const std::string& name, const std::vector<std::pair<std::string, std::string>>& forms) {
    for (unsigned number = 1;; ++number) {
      const std::string candidate = number == 1 ? name : joined(name, "_" + std::to_string(number));
      if (std::any_of(forms.begin(), forms.end(), [&](const auto& form) {
            return taken_.contains(joined(form.first + candidate, form.second));
          }))
        continue;
      for (const auto& [before, behind] : forms) taken_.insert(joined(before + candidate, behind));
      return candidate;
    }
  }

 private:
  std::set<std::string>& taken_;
};

/// That of the spec; of a bus that names none its own name, as C++ has it.
[[nodiscard]] std::string name_space_of(const spec::Model& model);

/// A frame of up to eight bytes is handled as eight, in one step.
[[nodiscard]] inline std::size_t held_bytes(const spec::MessageModel& message) {
  return std::max<std::size_t>(message.length, 8);
}

/// The fields of a message that its length holds; what ends beyond it is in longer frames only.
[[nodiscard]] inline std::vector<const spec::FieldModel*> fields_within(const spec::MessageModel& message) {
  std::vector<const spec::FieldModel*> fields;
  for (const auto& field : message.fields)
    if (field.position.bytes() <= message.length) fields.push_back(&field);
  return fields;
}
/// The names of the others.
[[nodiscard]] inline std::vector<std::string> fields_beyond(const spec::MessageModel& message) {
  std::vector<std::string> names;
  for (const auto& field : message.fields)
    if (field.position.bytes() > message.length) names.push_back(field.name);
  return names;
}

/// What selects a field, within the message's length; nullptr: nothing, or it is not there.
[[nodiscard]] inline const spec::FieldModel* selector_of(const spec::MessageModel& message,
                                                         const spec::FieldModel& field) {
  if (field.selector.empty()) return nullptr;
  for (const auto* const each : fields_within(message))
    if (each->name == field.selector) return each;
  return nullptr;
}

/// In order, with what overlaps or follows as one, up to the greatest that a selector of this width can be.
[[nodiscard]] inline std::vector<protocol::SelectorRange> merged(std::vector<protocol::SelectorRange> ranges,
                                                                 std::uint64_t most) {
  std::sort(ranges.begin(), ranges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<protocol::SelectorRange> out;
  for (const auto& [first, last] : ranges) {
    if (first > most) break;
    if (out.empty() || (out.back().last != UINT64_MAX && first > out.back().last + 1))
      out.push_back({first, std::min(last, most)});
    else
      out.back().last = std::max(out.back().last, std::min(last, most));
  }
  return out;
}

/// An expression, in C or C++, that is true where `variable` is in one of the ranges: `true_word` where it
/// always is, empty where it never is. `most`: the greatest that it can be; `number` writes one of its
/// numbers.
template <class F>
[[nodiscard]] std::string in_ranges(const std::vector<protocol::SelectorRange>& ranges, std::uint64_t most,
                                    const std::string& variable, std::string_view true_word, F&& number) {
  std::string cases;
  for (const auto& [first, last] : merged(ranges, most)) {
    std::string text;
    if (first == last)
      text = variable + " == " + number(first);
    else if (first == 0 && last >= most)
      text = true_word;
    else if (first == 0)
      text = variable + " <= " + number(last);
    else if (last >= most)
      text = variable + " >= " + number(first);
    else
      text = "(" + variable + " >= " + number(first) + " && " + variable + " <= " + number(last) + ")";
    cases += (cases.empty() ? "" : " || ") + text;
  }
  return cases;
}

/// How many selectors stand before each field within the message's length, one before the other.
[[nodiscard]] std::map<const spec::FieldModel*, std::size_t> selection_levels(
    const spec::MessageModel& message);

/// The bytes in which each field that is there has its start value.
[[nodiscard]] std::vector<std::uint8_t> start_bytes(const spec::MessageModel& message);

/// The parameter group's number of a message of J1939.
[[nodiscard]] inline std::uint32_t group_of(const protocol::Address& address) {
  const std::uint32_t group = address.number >> 8 & 0x3'FFFF;
  return (group >> 8 & 0xFF) < 240 ? group & 0x3'FF00 : group;
}

/// "0x100", "0x18FEF100"
[[nodiscard]] std::string hexadecimal(std::uint64_t number, int digits);

/// "8 bytes of CAN FD, identifier 0x100, every 10 ms."
[[nodiscard]] std::string address_text(const spec::MessageModel& message);

}  // namespace ocm::generate
