#include "generator/text/json.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace ocm::generate {

struct JsonPrinter {
  using Tree = nlohmann::ordered_json;

  static Tree tree(const Json& json) {
    switch (json.kind_) {
      case Json::Kind::null:
        return nullptr;
      case Json::Kind::boolean:
        return json.whole_ != 0;
      case Json::Kind::whole:
        return static_cast<std::int64_t>(json.whole_);
      case Json::Kind::natural:
        return json.whole_;
      case Json::Kind::real:
        return json.real_;
      case Json::Kind::text:
        return json.text_;
      case Json::Kind::array: {
        Tree array = Tree::array();
        for (const Json& item : json.items_) array.push_back(tree(item));
        return array;
      }
      case Json::Kind::object:
        break;
    }
    Tree object = Tree::object();
    for (std::size_t i = 0; i < json.items_.size(); ++i) object[json.names_[i]] = tree(json.items_[i]);
    return object;
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
  return JsonPrinter::tree(*this).dump(-1, ' ', false, JsonPrinter::Tree::error_handler_t::replace);
}

std::string Json::lines() const {
  return JsonPrinter::tree(*this).dump(2, ' ', false, JsonPrinter::Tree::error_handler_t::replace) + "\n";
}

}  // namespace ocm::generate
