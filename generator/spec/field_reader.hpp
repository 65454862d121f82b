/// Reading the fields of a frame: where they lie, what their bits mean, and what is wrong with them. For
/// reader.cpp only.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/spec/names.hpp"
#include "generator/spec/node_reader.hpp"

namespace ocm::spec {

// What a frame's struct and a topic's struct have already; a field, frame or flag cannot be called so.
inline constexpr std::array<std::string_view, 17> struct_members{
    "id",       "ids",    "dlc",      "count",   "name",   "frames", "instances",       "kind",  "role",
    "priority", "period", "deadline", "timeout", "jitter", "encode", "shortest_period", "decode"};

inline constexpr std::string_view derived_form =
    R"("derived": [{"name": "distance", "of": "proximity", "law": "inverse_square", "at_one": 0.94, )"
    R"("offset": 2300, "noise": 4.6, "unit": "m", "range": [0.004, 0.2]}])";

class FieldReader : protected NodeReader {
 public:
  using NodeReader::NodeReader;

 protected:
  /// A member of a generated struct.
  void check_member_name(const At& at, std::string_view member) {
    if (std::find(struct_members.begin(), struct_members.end(), member) != struct_members.end())
      tell(at, quoted(member) + " has a meaning of its own in the generated struct",
           "another name, such as " + quoted(std::string{member} + "_value"));
  }
  /// Returns how many bytes the fields take.
  [[nodiscard]] std::uint8_t read_fields(const At& at, std::optional<std::uint8_t> dlc,
                                         protocol::ByteOrder order, const std::string& type,
                                         FrameModel& frame) {
    if (!is_kind(at, Kind::array, "a list of fields")) return 0;
    if (at.node->items.empty() && dlc.value_or(1) != 0)
      tell(at, "the list is empty", "at least one field, or \"dlc\": 0 for a frame that says all by coming");
    std::uint64_t taken = 0;
    std::map<std::string, std::string> members;
    std::vector<std::pair<std::uint64_t, std::string>> masks;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At field_at = at.item(i);
      if (!is_object(field_at, R"({"name": "x", "byte": 0, "type": "i16"})")) continue;
      FieldModel field = read_field(field_at, order);
      const std::uint64_t mask = field.position.mask();
      if (mask != 0) {
        const At place = position_of(field_at);
        if ((mask & taken) != 0) {
          for (const auto& [other_mask, other_name] : masks)
            if ((mask & other_mask) != 0)
              tell(place,
                   field_title(field) + " overlaps " + quoted(other_name) + " in " + bits(mask & other_mask),
                   free_hint(taken, field.position.width));
        }
        if (dlc && *dlc < 8 && (mask >> (8 * *dlc)) != 0)
          tell(place, field_title(field) + " reaches beyond the frame's " + std::to_string(*dlc) + " bytes",
               "\"dlc\": " + std::to_string(bytes_of(mask)) + ", or another place for the field");
        taken |= mask;
        masks.emplace_back(mask, field.name);
      }
      claim_members(field_at, field, type, members);
      frame.fields.push_back(std::move(field));
    }
    return bytes_of(taken);
  }

  /// After the fields.
  void read_derived(const At& at, FrameModel& frame) {
    if (!is_kind(at, Kind::array, derived_form)) return;
    if (at.node->items.empty())
      tell(at, "the list is empty", "leave it out, or " + std::string{derived_form});
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, derived_form)) continue;
      if (auto derived = read_law(item, frame)) frame.derived.push_back(std::move(*derived));
    }
  }

 private:
  [[nodiscard]] std::optional<DerivedModel> read_law(const At& at, const FrameModel& frame) {
    check_keys(at,
               {"name", "description", "of", "law", "at_one", "offset", "noise", "unit", "range", "source"});
    DerivedModel derived;
    bool good = true;
    if (const auto a = require(at, "name", "what the quantity is called")) {
      derived.name = name(*a);
      const auto taken = [&](const std::string& word) {
        return std::any_of(frame.fields.begin(), frame.fields.end(),
                           [&](const FieldModel& field) { return field.name == word; }) ||
               std::any_of(frame.derived.begin(), frame.derived.end(), [&](const DerivedModel& other) {
                 return other.name == word || other.uncertainty_name() == word;
               });
      };
      for (const std::string& word : {derived.name, derived.uncertainty_name()})
        if (!derived.name.empty() && taken(word))
          tell(*a, "a second " + quoted(word) + " in the frame",
               "a name of its own; its uncertainty is called " + quoted(derived.uncertainty_name()));
    }
    if (const auto a = at.member("description")) derived.description = line(*a);
    derived.source = read_source(at, {"law", "at_one", "offset", "noise", "unit", "range"}, true);
    if (const auto a = require(at, "of", "the field of the frame from which it follows")) {
      const auto found = std::find_if(frame.fields.begin(), frame.fields.end(), [&](const FieldModel& field) {
        return !field.name.empty() && field.name == a->node->text;
      });
      if (found == frame.fields.end()) {
        tell(*a, "the frame has no field " + shown(*a->node), "the name of one of its fields");
        good = false;
      } else {
        derived.of = static_cast<std::size_t>(found - frame.fields.begin());
        if (found->flags || !found->values.empty()) {
          tell(*a, quoted(found->name) + " has names of values", "a field that measures something");
          good = false;
        }
      }
    } else {
      good = false;
    }
    enum class Kinds : std::uint8_t { inverse_square };
    static constexpr std::pair<std::string_view, Kinds> kinds[] = {{"inverse_square", Kinds::inverse_square}};
    if (const auto a = require(at, "law", "\"inverse_square\": measured = at_one / value^2 + offset"))
      static_cast<void>(one_of(*a, kinds));
    if (const auto a = require(at, "unit", "of the quantity, such as \"m\"")) derived.unit = line(*a);
    protocol::Law law;
    const auto read = [&](std::string_view key, std::string_view what,
                          bool positive) -> std::optional<Decimal> {
      const auto number_at = require(at, key, what);
      const auto number = number_at ? decimal(*number_at, what) : std::nullopt;
      if (number && (positive ? number->digits <= 0 : number->digits < 0)) {
        tell(*number_at, positive ? "not above zero" : "below zero", std::string{what});
        return std::nullopt;
      }
      return number;
    };
    if (const auto number = read("at_one", "what is measured above the offset where the quantity is 1", true))
      law.at_one = *number;
    else
      good = false;
    if (const auto number =
            read("noise", "standard deviation of what is measured; 0 where it is not known", false))
      law.noise = *number;
    if (const auto a = require(at, "range", "the values at which the law holds, [0.004, 0.2]")) {
      const auto range = stated_range(*a);
      if (range && range->min.digits <= 0)
        tell(*a, "the range begins at or below zero", "above zero: [0.004, 0.2]");
      if (!range || range->min.digits <= 0) good = false;
      if (range) law.min = range->min, law.max = range->max;
    } else {
      good = false;
    }
    static constexpr std::string_view offsets =
        "what is measured when nothing is there: a number, or a list with one for each of the frame's count";
    if (const auto a = require(at, "offset", offsets)) {
      const bool is_list = a->node->is(Kind::array);
      const std::size_t count = is_list ? a->node->items.size() : 1;
      if (is_list && count != frame.count) {
        tell(*a, std::to_string(count) + " offsets for " + std::to_string(frame.count) + " frames",
             std::string{offsets});
        good = false;
      }
      for (std::size_t i = 0; i < count; ++i) {
        const auto number = decimal(is_list ? a->item(i) : *a, offsets);
        law.offset = number.value_or(Decimal{});
        derived.laws.push_back(law);
      }
    }
    if (!good || derived.laws.empty() || derived.name.empty()) return std::nullopt;
    return derived;
  }

  /// Members that a field brings: itself and its accessors.
  void claim_member(const At& at, std::map<std::string, std::string>& members, const std::string& member) {
    const auto [other, is_new] = members.emplace(member, at.path);
    if (is_new) return;
    const std::string where = other->second == at.path ? "" : " (see " + other->second + ")";
    tell(at, "the generated struct would have two members " + member + where, "another name for one of them");
  }

  [[nodiscard]] static std::uint8_t bytes_of(std::uint64_t mask) {
    std::uint8_t bytes = 0;
    for (; mask != 0; mask >>= 8) ++bytes;
    return bytes;
  }
  [[nodiscard]] static At position_of(const At& field) {
    if (const auto at = field.member("byte")) return *at;
    return field.member("bit").value_or(field);
  }
  [[nodiscard]] static std::string field_title(const FieldModel& field) {
    return field.name.empty() ? "the field" : quoted(field.name);
  }
  [[nodiscard]] static std::string bits(std::uint64_t mask) {
    unsigned first = 0;
    while ((mask >> first & 1) == 0) ++first;
    unsigned last = 63;
    while ((mask >> last & 1) == 0) --last;
    if (first == last) return "bit " + std::to_string(first);
    return "bits " + std::to_string(first) + " to " + std::to_string(last);
  }
  [[nodiscard]] static std::string free_hint(std::uint64_t taken, unsigned width) {
    const unsigned bytes = (width + 7) / 8;
    for (unsigned byte = 0; byte + bytes <= 8; ++byte) {
      const std::uint64_t mask = protocol::detail::low_mask(8 * bytes) << (8 * byte);
      if ((mask & taken) == 0) return "\"byte\": " + std::to_string(byte) + " is free";
    }
    return "a narrower type, or another frame: no " + std::to_string(bytes) + " bytes in a row are left";
  }

  void claim_members(const At& at, const FieldModel& field, const std::string& type,
                     std::map<std::string, std::string>& members) {
    if (field.name.empty()) return;
    const At name_at = at.member("name").value_or(at);
    check_member_name(name_at, field.name);
    if (const auto other = members.find(field.name); other != members.end())
      return tell(name_at, "a second " + quoted(field.name) + " (see " + other->second + ")",
                  "a name of its own for each field and flag of the frame");
    claim_member(name_at, members, field.name);
    if (!field.unit_name.empty()) {
      claim_member(name_at, members, field.name + "_" + field.unit_name);
      claim_member(name_at, members, "set_" + field.name + "_" + field.unit_name);
    }
    std::set<std::string> named;
    for (const ValueModel& value : field.values) {
      if (!named.insert(value.name).second) continue;  // told already
      if (field.flags) {
        claim_member(name_at, members, value.name);
        claim_member(name_at, members, "set_" + value.name);
        claim_member(name_at, members, value.name + "_flag");
        check_member_name(name_at, value.name);
      } else if (!field.is_enumeration()) {
        claim_member(name_at, members, field.name + "_" + value.name);
      }
    }
    claim_member(name_at, members, pascal_case(field.name) + "Bits");
    if (!field.is_enumeration()) return;
    if (pascal_case(field.name) == type)
      tell(name_at, "the generated header would have a type " + type + " within a type " + type,
           "another name for the field");
    claim_member(name_at, members, pascal_case(field.name));
  }

  [[nodiscard]] FieldModel read_field(const At& at, protocol::ByteOrder order) {
    check_keys(at, {"name", "description", "byte", "bit", "type", "byte_order", "scale", "offset", "unit",
                    "unit_name", "range", "values", "flags", "source"});
    FieldModel field;
    if (const auto a = require(at, "name", "what the number is called")) field.name = name(*a);
    if (const auto a = at.member("description")) field.description = line(*a);
    field.source = read_source(
        at, {"byte", "bit", "type", "byte_order", "scale", "offset", "unit", "range", "values", "flags"},
        true);
    order = read_order(at, order);
    const bool typed = read_type(at, field);
    read_position(at, order, typed, field);
    read_unit(at, field);
    if (const auto a = at.member("scale")) {
      if (const auto scale = decimal(*a, "physical units a bit, such as 0.0175")) {
        if (scale->digits == 0)
          tell(*a, "a scale of zero", "physical units a bit, such as 0.0175; leave it out for 1");
        else
          field.scale = *scale;
      }
    }
    if (const auto a = at.member("offset"))
      field.offset = decimal(*a, "what the raw number 0 means, such as -40").value_or(Decimal{});
    if (typed) {
      field.raw_min = protocol::lowest(field.position.width, field.is_signed);
      field.raw_max = protocol::highest(field.position.width, field.is_signed);
      if (field.number != protocol::Number::integer)
        read_float_range(at, field);
      else if (check_exact(at, field))
        read_range(at, field);
    }
    read_values(at, typed, field);
    return field;
  }

  [[nodiscard]] bool read_type(const At& at, FieldModel& field) {
    static constexpr std::string_view form =
        "i2 to i64 (signed), u1 to u63 (unsigned), f32 or f64, such as \"i16\", \"u12\", \"f32\"";
    const auto a = require(at, "type", form);
    if (!a) return false;
    const std::string_view text = a->node->is(Kind::string) ? std::string_view{a->node->text} : "";
    const auto width = text.size() < 2 || text[1] == '0'
                           ? base::Result<std::uint64_t>{base::Error::bad_syntax}
                           : base::parse_unsigned(text.substr(1));
    const bool is_signed = !text.empty() && text.front() == 'i';
    if (text == "f32" || text == "f64") {
      field.number = text == "f32" ? protocol::Number::float32 : protocol::Number::float64;
      field.position.width = static_cast<std::uint8_t>(*width);
      return true;
    }
    if (!width || (text.front() != 'i' && text.front() != 'u')) {
      tell(*a, "unknown type " + shown(*a->node), std::string{form});
      return false;
    }
    if (*width < (is_signed ? 2U : 1U) || *width > (is_signed ? 64U : 63U)) {
      tell(*a, "no type has the width of " + shown(*a->node), std::string{form});
      return false;
    }
    field.is_signed = is_signed;
    field.position.width = static_cast<std::uint8_t>(*width);
    return true;
  }

  void read_position(const At& at, protocol::ByteOrder order, bool typed, FieldModel& field) {
    field.position.order = order;
    field.position.start = UINT16_MAX;  // until the place is known; overlaps nothing
    const auto byte = at.member("byte");
    const auto bit = at.member("bit");
    if (byte && bit) tell(*bit, "both \"byte\" and \"bit\"", "one of them says where the field begins");
    if (!byte && !bit)
      tell(at, "no \"byte\" and no \"bit\"",
           "add \"byte\": 0 to 7, or \"bit\": 0 to 63, where the field begins");
    if (!byte && !bit) return;
    const auto number = byte ? integer(*byte, 0, 7) : integer(*bit, 0, 63);
    if (!number) return;
    const auto n = static_cast<unsigned>(*number);
    const bool big = order == protocol::ByteOrder::big;
    const unsigned start = !byte ? n : big ? 8 * n + 7 : 8 * n;
    field.position.start = static_cast<std::uint16_t>(start);
    if (!typed || field.position.mask() != 0) return;
    const unsigned width = field.position.width;
    const unsigned most = 64 - (big ? start / 8 * 8 + 7 - start % 8 : start);
    tell(byte ? *byte : *bit,
         "a field of " + std::to_string(width) + " bits that begins here does not end within 8 bytes",
         byte ? "\"byte\": " + std::to_string((64 - width) / 8) + " or below, or at most " +
                    std::to_string(most) + " bits"
              : "at most " + std::to_string(most) + " bits, or an earlier beginning");
  }

  void read_unit(const At& at, FieldModel& field) {
    const auto unit = at.member("unit");
    const auto name_at = at.member("unit_name");
    if (unit) field.unit = line(*unit);
    if (field.unit.empty()) {
      if (name_at) tell(*name_at, "\"unit_name\" without \"unit\"", "leave it out, or add \"unit\"");
      return;
    }
    if (name_at) {
      const std::string& text = name_at->node->text;
      const bool good =
          name_at->node->is(Kind::string) && !text.empty() && text.size() <= 40 && unit_name(text) == text;
      if (good)
        field.unit_name = text;
      else
        tell(*name_at, shown(*name_at->node) + " cannot end a name",
             "letters, digits and underscores, such as \"gauss\"");
      return;
    }
    field.unit_name = unit_name(field.unit);
    if (field.unit_name.empty() || field.unit_name.size() > 40) {
      field.unit_name.clear();
      tell(*unit, "the unit " + quoted(field.unit) + " cannot be read as a name",
           "add \"unit_name\", which ends the name of the accessor, such as \"gauss\"");
    }
  }

  /// Every raw number must have its physical value exactly.
  [[nodiscard]] bool check_exact(const At& at, const FieldModel& field) {
    for (const std::int64_t raw : {field.raw_min, field.raw_max, std::int64_t{1}}) {
      const int exponent = field.offset.digits == 0
                               ? field.scale.exponent
                               : std::min<int>(field.scale.exponent, field.offset.exponent);
      std::int64_t product = 0;
      std::int64_t sum = 0;
      bool good = !base::detail::multiply_overflows(raw, field.scale.digits, product) &&
                  field.scale.exponent > -80 && field.scale.exponent < 80 && field.offset.exponent > -80 &&
                  field.offset.exponent < 80;
      if (good && field.offset.digits != 0) {
        const auto a = base::detail::scaled(product, field.scale.exponent - exponent);
        const auto b = base::detail::scaled(field.offset.digits, field.offset.exponent - exponent);
        good = a && b && !__builtin_add_overflow(*a, *b, &sum);
      }
      if (good) continue;
      const auto place = at.member("scale");
      tell(place ? *place : at.member("offset").value_or(at),
           "scale and offset have too many digits for " + std::to_string(field.position.width) + " bits",
           "raw number times the digits of the scale, plus offset, must stay within 18 digits");
      return false;
    }
    return true;
  }

  [[nodiscard]] std::optional<RangeModel> stated_range(const At& a) {
    static constexpr std::string_view form = "two numbers in the field's unit, lowest first: [-500, 500]";
    if (!is_kind(a, Kind::array, form)) return std::nullopt;
    if (a.node->items.size() != 2) {
      tell(a, "a range of " + std::to_string(a.node->items.size()) + " numbers", std::string{form});
      return std::nullopt;
    }
    const auto low = decimal(a.item(0), form);
    const auto high = decimal(a.item(1), form);
    if (!low || !high) return std::nullopt;
    if (base::compare(*low, *high) > 0) {
      tell(a, "the range begins at " + print(*low) + " and ends below it, at " + print(*high),
           std::string{form});
      return std::nullopt;
    }
    return RangeModel{*low, *high};
  }

  /// Of a float there is no raw number for each end: the range is what its values are held within.
  void read_float_range(const At& at, FieldModel& field) {
    if (const auto a = at.member("range")) field.range = stated_range(*a);
    field.has_range = field.range.has_value();
  }

  void read_range(const At& at, FieldModel& field) {
    const auto a = at.member("range");
    if (!a) return;
    const auto stated = stated_range(*a);
    if (!stated) return;
    const Decimal* const low = &stated->min;
    const Decimal* const high = &stated->max;
    const std::int64_t lowest_raw = field.raw_min;
    const std::int64_t highest_raw = field.raw_max;
    const bool falling = field.scale.digits < 0;
    const auto held = [&](std::int64_t raw) { return *raw_to_physical(field, raw); };
    const Decimal bottom = held(falling ? highest_raw : lowest_raw);
    const Decimal top = held(falling ? lowest_raw : highest_raw);
    if (base::compare(*low, bottom) < 0 || base::compare(*high, top) > 0)
      return tell(*a,
                  "the range [" + print(*low) + ", " + print(*high) + "] is wider than what " +
                      std::to_string(field.position.width) + " bits hold, [" + print(bottom) + ", " +
                      print(top) + "]",
                  "a range within it, a wider type or a larger scale");
    // The raw numbers whose physical value lies in the range, found by bisection: exact, whatever the digits.
    // Both bounds lie between what the bits hold, so that neither search can go past them.
    const std::int64_t first = first_raw(field, falling ? *high : *low, falling);
    const std::int64_t last = last_raw(field, falling ? *low : *high, falling);
    if (first > last)
      return tell(*a, "no raw number lies in the range [" + print(*low) + ", " + print(*high) + "]",
                  "a wider range, or a smaller scale");
    field.raw_min = first;
    field.raw_max = last;
    field.has_range = true;
  }
  [[nodiscard]] static base::Result<Decimal> raw_to_physical(const FieldModel& field, std::int64_t raw) {
    const auto scaled = base::multiply({raw, 0}, field.scale);
    if (!scaled) return scaled.error;
    return base::add(*scaled, field.offset);
  }
  /// Lowest raw number that is not before `bound`, where "before" follows the sign of the scale.
  [[nodiscard]] static std::int64_t first_raw(const FieldModel& field, Decimal bound, bool falling) {
    std::int64_t low = field.raw_min;
    std::int64_t high = field.raw_max;
    while (low < high) {
      const std::int64_t middle = midpoint(low, high);
      const int order = base::compare(*raw_to_physical(field, middle), bound);
      if (falling ? order > 0 : order < 0)
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }
  [[nodiscard]] static std::int64_t last_raw(const FieldModel& field, Decimal bound, bool falling) {
    std::int64_t low = field.raw_min;
    std::int64_t high = field.raw_max;
    while (low < high) {
      const std::int64_t middle = midpoint(low, high) + 1;
      const int order = base::compare(*raw_to_physical(field, middle), bound);
      if (falling ? order < 0 : order > 0)
        high = middle - 1;
      else
        low = middle;
    }
    return low;
  }
  /// Rounded down; no overflow.
  [[nodiscard]] static std::int64_t midpoint(std::int64_t low, std::int64_t high) {
    const auto distance = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low);
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + distance / 2);
  }

  void read_values(const At& at, bool typed, FieldModel& field) {
    const auto values = at.member("values");
    const auto flags = at.member("flags");
    if (values && flags) tell(*flags, "both \"values\" and \"flags\"", "a field is one or the other");
    const auto a = flags ? flags : values;
    if (!a) return;
    field.flags = flags.has_value();
    const std::string form = field.flags ? R"(names and numbers of bits: {"charging": 1})"
                                         : R"(names and raw numbers: {"unknown": 65535})";
    if (!is_object(*a, form)) return;
    if (a->node->members.empty()) tell(*a, "no names", form);
    if (field.number != protocol::Number::integer)
      return tell(*a, "names of values in a field that is a floating-point number",
                  "an integer type, such as \"u8\"");
    if (field.flags && field.is_signed)
      tell(*a, "flags in a signed field", "an unsigned type, such as \"u8\"");
    if (field.flags && (!field.unit.empty() || at.member("scale") || at.member("offset")))
      tell(*a, "flags with a unit, scale or offset", "flags are bits: leave these out");
    std::map<std::int64_t, std::string> seen;
    for (const auto& [key, node] : a->node->members) {
      const At entry{&node, a->path + "/" + pointer_step(key)};
      Node key_node;  // a name like any other, only that it stands left of a colon
      key_node.kind = Kind::string;
      key_node.text = key;
      key_node.line = node.line;
      const std::string value_name = name({&key_node, entry.path});
      if (!typed) continue;
      const unsigned width = field.position.width;
      const auto raw = field.flags ? integer(entry, 0, width - 1)
                                   : integer(entry, protocol::lowest(width, field.is_signed),
                                             protocol::highest(width, field.is_signed));
      if (!raw || value_name.empty()) continue;
      const auto [other, is_new] = seen.emplace(*raw, value_name);
      if (!is_new)
        tell(entry,
             quoted(value_name) + " and " + quoted(other->second) + " are both " + std::to_string(*raw),
             "a number of its own for each name");
      field.values.push_back({value_name, *raw});
    }
  }
};

}  // namespace ocm::spec
