#include "generator/targets/message_fields.hpp"

#include <map>

#include "ocm/base/text.hpp"

#include "generator/spec/names.hpp"
#include "generator/targets/cpp_messages.hpp"
#include "generator/text/words.hpp"

namespace ocm::generate {
namespace {

using spec::FieldModel;
using spec::MessageModel;

/// The fields of a message that its length holds, each with what selects it.
class Selection {
 public:
  explicit Selection(const MessageModel& message) : fields_(fields_within(message)) {
    std::map<std::string_view, std::size_t> places;
    for (std::size_t i = 0; i < fields_.size(); ++i) places.emplace(fields_[i]->name, i);
    for (const auto* const field : fields_) {
      const auto found = places.find(field->selector);
      selectors_.push_back(field->selector.empty() || found == places.end() ? none : found->second);
    }
  }
  [[nodiscard]] const std::vector<const FieldModel*>& fields() const { return fields_; }
  /// How many selectors stand before a field. A circle cannot be.
  [[nodiscard]] std::size_t level(std::size_t field) const {
    std::size_t count = 0;
    for (std::size_t at = field; at != none && !fields_[at]->selector.empty(); at = selectors_[at]) ++count;
    return count;
  }
  [[nodiscard]] bool is_there(std::size_t field, const std::vector<std::uint8_t>& bytes) const {
    for (std::size_t at = field; !fields_[at]->selector.empty(); at = selectors_[at]) {
      if (selectors_[at] == none) return false;
      const auto raw = static_cast<std::uint64_t>(
          protocol::get(std::span<const std::uint8_t>{bytes}, fields_[selectors_[at]]->position, false));
      const auto has = [raw](const auto& range) { return range.first <= raw && raw <= range.last; };
      if (std::none_of(fields_[at]->selected.begin(), fields_[at]->selected.end(), has)) return false;
    }
    return true;
  }

 private:
  static constexpr std::size_t none = SIZE_MAX;
  std::vector<const FieldModel*> fields_;
  std::vector<std::size_t> selectors_;
};

}  // namespace

std::map<const FieldModel*, std::size_t> selection_levels(const MessageModel& message) {
  const Selection selection{message};
  std::map<const FieldModel*, std::size_t> levels;
  for (std::size_t i = 0; i < selection.fields().size(); ++i)
    levels.emplace(selection.fields()[i], selection.level(i));
  return levels;
}

std::vector<std::uint8_t> start_bytes(const MessageModel& message) {
  std::vector<std::uint8_t> bytes(held_bytes(message));
  const Selection selection{message};
  // Selectors before what they select, however deep.
  std::map<std::size_t, std::vector<std::size_t>> by_level;
  for (std::size_t i = 0; i < selection.fields().size(); ++i) by_level[selection.level(i)].push_back(i);
  for (const auto& [level, fields] : by_level)
    for (const std::size_t i : fields)
      if (selection.is_there(i, bytes))
        protocol::put(std::span<std::uint8_t>{bytes}, selection.fields()[i]->position,
                      selection.fields()[i]->start.value_or(0));
  return bytes;
}

std::string name_space_of(const spec::Model& model) {
  if (!model.name_space.empty()) return model.name_space;
  std::string name = cpp_name(model.robot);
  for (char& c : name)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return spec::is_reserved(name) || name == "ocm" || name == "std" ? name + "_" : name;
}

std::string hexadecimal(std::uint64_t number, int digits) {
  base::Text<20> text;
  text << "0x";
  text.hex(number, digits);
  return std::string{text.view()};
}

std::string address_text(const MessageModel& message) {
  std::string text = std::to_string(message.length) + (message.length == 1 ? " byte" : " bytes");
  if (message.fd) text += " of CAN FD";
  if (message.is_j1939())
    text += ", parameter group " + hexadecimal(group_of(message.address), 5);
  else
    text += ", identifier " + hexadecimal(message.address.number, message.address.extended ? 8 : 3);
  if (message.period.count() != 0)
    text += ", every " + print(base::normalised(message.period.count(), -6)) + " ms";
  return text + ".";
}

}  // namespace ocm::generate
