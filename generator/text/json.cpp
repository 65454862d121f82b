#include "generator/text/json.hpp"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

namespace ocm::generate {

/// A value at a time: a tree of nlohmann's takes memory while it is destroyed, and survives no
/// std::bad_alloc.
struct JsonPrinter {
  using Value = nlohmann::json;

  std::string out{};
  bool indented = false;

  void print(const Json& json, std::size_t depth = 0) {
    switch (json.kind_) {
      case Json::Kind::null:
        return put(nullptr);
      case Json::Kind::boolean:
        return put(json.whole_ != 0);
      case Json::Kind::whole:
        return put(static_cast<std::int64_t>(json.whole_));
      case Json::Kind::natural:
        return put(json.whole_);
      case Json::Kind::real:
        return put(json.real_);
      case Json::Kind::text:
        return put(json.text_);
      case Json::Kind::array:
      case Json::Kind::object:
        break;
    }
    const bool is_object = json.kind_ == Json::Kind::object;
    out += is_object ? '{' : '[';
    for (std::size_t i = 0; i < json.items_.size(); ++i) {
      if (i != 0) out += ',';
      end_line(depth + 1);
      if (is_object) {
        put(json.names_[i]);
        out += indented ? ": " : ":";
      }
      print(json.items_[i], depth + 1);
    }
    if (!json.items_.empty()) end_line(depth);
    out += is_object ? '}' : ']';
  }

 private:
  void put(const Value& value) { out += value.dump(-1, ' ', false, Value::error_handler_t::replace); }
  void end_line(std::size_t depth) {
    if (!indented) return;
    out += '\n';
    out.append(2 * depth, ' ');
  }
};

Json::Json(std::initializer_list<Member> members) : kind_(Kind::object) {
  for (const Member& member : members) (*this)[member.name] = member.value;
}

Json Json::array() {
  Json json;
  json.kind_ = Kind::array;
  return json;
}

Json Json::object() {
  Json json;
  json.kind_ = Kind::object;
  return json;
}

Json& Json::operator[](std::string_view name) {
  if (is_null()) kind_ = Kind::object;
  const auto at = static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  if (at == names_.size()) {
    names_.emplace_back(name);
    items_.emplace_back();
  }
  return items_[at];
}

void Json::push_back(Json item) {
  if (is_null()) kind_ = Kind::array;
  items_.push_back(std::move(item));
}

std::string Json::line() const {
  JsonPrinter printer{{}, false};
  printer.print(*this);
  return std::move(printer.out);
}

std::string Json::lines() const {
  JsonPrinter printer{{}, true};
  printer.print(*this);
  printer.out += '\n';
  return std::move(printer.out);
}

}  // namespace ocm::generate
