#include "generator/spec/spec.hpp"

#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "generator/dbc/reader.hpp"
#include "generator/spec/file.hpp"
#include "generator/spec/from_dbc.hpp"
#include "generator/spec/json.hpp"
#include "generator/spec/reader.hpp"
#include "generator/spec/worst_bits.hpp"

namespace ocm::spec {

/// Deques and strings that nothing changes once the catalogue points to them.
struct Spec::Storage {
  explicit Storage(Model m) : model(std::move(m)) {}
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  Model model;
  std::deque<std::string> texts;
  std::deque<std::vector<protocol::NamedValue>> values;
  std::deque<std::vector<protocol::SelectorRange>> ranges;
  std::deque<std::vector<protocol::Field>> fields;
  std::deque<protocol::Law> laws;
  std::deque<std::vector<protocol::FrameLayout>> frames;
  std::deque<std::vector<std::string_view>> aliases;
  std::vector<protocol::Board> boards;
  std::vector<protocol::Topic> topics;
  protocol::Catalogue catalogue;

  std::string_view keep(std::string text) { return texts.emplace_back(std::move(text)); }

  /// A text of the model, which is UTF-8, as verbs print it: a file from elsewhere does not send commands to
  /// the terminal, and each line of an output is one. Control characters become \x1b. The model keeps them.
  std::string_view shown(const std::string& text) {
    const auto is_control = [&text](std::size_t i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      if (byte == 0xC2 && i + 1 < text.size()) return static_cast<unsigned char>(text[i + 1]) < 0xA0;
      return byte < 0x20 || byte == 0x7F;
    };
    std::string out;
    std::size_t copied = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (!is_control(i)) continue;
      out.append(text, copied, i - copied);
      if (static_cast<unsigned char>(text[i]) == 0xC2) ++i;  // U+0080 to U+009F: \x80 to \x9f
      constexpr std::string_view digits = "0123456789abcdef";
      const auto byte = static_cast<unsigned char>(text[i]);
      out.append("\\x").append(1, digits[byte >> 4]).append(1, digits[byte & 15]);
      copied = i + 1;
    }
    if (copied == 0) return text;
    return keep(out.append(text, copied));
  }

  std::span<const protocol::Field> make_fields(const std::vector<FieldModel>& models) {
    if (models.empty()) return {};
    auto& list = fields.emplace_back();
    list.reserve(models.size());
    // A walk through all for each selected one would take minutes for the 65,535 that there may be.
    std::unordered_map<std::string_view, std::uint16_t> selectors;
    for (const FieldModel& field : models)
      if (!field.selector.empty()) selectors.emplace(field.selector, protocol::no_selector);
    for (std::size_t i = 0; i < models.size() && !selectors.empty(); ++i)
      if (const auto at = selectors.find(models[i].name); at != selectors.end())
        at->second = static_cast<std::uint16_t>(i);
    for (const FieldModel& field : models) {
      std::span<const protocol::NamedValue> names;
      if (!field.values.empty()) {
        auto& named = values.emplace_back();
        named.reserve(field.values.size());
        for (const ValueModel& value : field.values) named.push_back({value.raw, shown(value.name)});
        names = named;
      }
      protocol::Field& out = list.emplace_back(
          protocol::Field{shown(field.name), field.position, field.is_signed, field.scale, field.offset,
                          shown(field.unit), field.raw_min, field.raw_max, names, field.flags, field.number});
      if (!field.selector.empty()) out.selector = selectors.find(field.selector)->second;
      if (!field.selected.empty()) out.selected = ranges.emplace_back(field.selected);
      out.start = field.start.value_or(0);
      if (field.range) out.min = field.range->min, out.max = field.range->max;
    }
    return list;
  }

  /// The fields of a frame, the `number`-th of its count, and what is derived of them.
  std::span<const protocol::Field> make_derived(const FrameModel& frame, std::size_t number,
                                                std::span<const protocol::Field> wire) {
    auto& list = fields.emplace_back(wire.begin(), wire.end());
    for (const DerivedModel& each : frame.derived) {
      const protocol::Law& law = laws.emplace_back(each.law(number));
      const auto index = static_cast<std::uint16_t>(each.of);
      list.push_back(protocol::derived(wire[each.of], index, each.name, each.unit, law, false));
      if (law.noise.digits != 0)
        list.push_back(
            protocol::derived(wire[each.of], index, keep(each.uncertainty_name()), each.unit, law, true));
    }
    return list;
  }

  void add_message(const MessageModel& message) {
    protocol::FrameLayout layout;
    layout.length = message.length;
    layout.fields = make_fields(message.fields);
    layout.address = message.address;
    layout.fd = message.fd;
    for (const AttributeModel& attribute : message.attributes)
      if (attribute.name == "CANFD_BRS" && attribute.text == "0") layout.bit_rate_switch = false;
    protocol::Topic out;
    out.name = shown(message.name);
    out.aliases = aliases.emplace_back(message.aliases.begin(), message.aliases.end());
    out.kind = protocol::Kind::message;
    out.board = message.board;
    out.frames = frames.emplace_back(1, layout);
    out.cycle = message.period;
    out.shortest_period = message.shortest_period;
    out.deadline = message.deadline;
    out.jitter = message.jitter;
    out.bus = message.bus;
    out.source = keep(message.source.joined());
    topics.push_back(out);
  }

  std::span<const protocol::FrameLayout> make_frames(const TopicModel& topic, std::uint8_t instance) {
    auto& list = frames.emplace_back();
    for (const FrameModel& frame : topic.frames) {
      const auto its_fields = make_fields(frame.fields);
      std::span<const protocol::Field> with_derived;
      for (unsigned i = 0; i < frame.count; ++i) {
        const bool numbered = !frame.name.empty() && frame.is_array;
        const std::string_view name =
            numbered ? keep(frame.name + "_" + std::to_string(i + 1)) : std::string_view{frame.name};
        const unsigned id = frame.id + i + (instance == 0 ? 0U : instance - 1U);
        if (!frame.derived.empty()) with_derived = make_derived(frame, i, its_fields);
        list.push_back({name, protocol::TopicId{static_cast<std::uint8_t>(id)}, frame.dlc, its_fields,
                        worst_bits(topic.kind, id, frame.dlc), with_derived});
      }
    }
    return list;
  }

  void add_topic(const TopicModel& topic, std::uint8_t instance) {
    protocol::Topic out;
    out.name =
        instance == 0 ? std::string_view{topic.name} : keep(topic.name + "_" + std::to_string(instance));
    out.aliases = aliases.emplace_back(topic.aliases.begin(), topic.aliases.end());
    out.id = protocol::TopicId{static_cast<std::uint8_t>(topic.id + (instance == 0 ? 0 : instance - 1))};
    out.kind = topic.kind;
    out.role = topic.role;
    out.board = topic.board;
    out.frames = make_frames(topic, instance);
    out.priority = topic.priority;
    out.period = topic.period;
    out.shortest_period = topic.shortest_period;
    out.deadline = topic.deadline;
    out.jitter = topic.jitter;
    out.timeout = topic.timeout;
    out.bus = topic.bus;
    if (instance != 0) out.group = topic.name;
    out.instance = instance;
    out.source = keep(topic.source.joined());
    topics.push_back(out);
  }

  void make_catalogue() {
    topics.reserve(model.topics.size() + model.messages.size());
    for (const BoardModel& board : model.boards) boards.push_back({shown(board.name), board.mcu});
    for (const TopicModel& topic : model.topics) {
      if (!topic.is_group)
        add_topic(topic, 0);
      else
        for (unsigned i = 1; i <= topic.count; ++i) add_topic(topic, static_cast<std::uint8_t>(i));
    }
    for (const MessageModel& message : model.messages) add_message(message);
    catalogue = {model.robot, model.bit_rate, boards, topics};
  }
};

Spec::Spec(Model model) : storage_(std::make_unique<Storage>(std::move(model))) {
  storage_->make_catalogue();
}
Spec::Spec(Spec&&) noexcept = default;
Spec& Spec::operator=(Spec&&) noexcept = default;
Spec::~Spec() = default;

const protocol::Catalogue& Spec::catalogue() const noexcept {
  return storage_->catalogue;
}
Model Spec::take_model() {
  return std::move(std::exchange(storage_, nullptr)->model);
}
const Model& Spec::model() const noexcept {
  return storage_->model;
}

namespace {

Loaded parse_dbc(std::string_view text, std::string_view file_name) {
  Loaded loaded;
  const auto told = [&](const std::vector<dbc::Finding>& findings) {
    std::vector<Problem> problems;
    for (const dbc::Finding& finding : findings)
      problems.push_back(
          {std::string{file_name} + ':' + std::to_string(finding.line), finding.what, finding.remedy});
    return problems;
  };
  dbc::Reading reading = dbc::read(text);
  loaded.problems = told(reading.problems);
  loaded.doubts = told(reading.doubts);
  if (!reading.document) return loaded;
  Model model = model_of(std::move(*reading.document), file_name, loaded.doubts);
  if (model.messages.empty())
    loaded.doubts.push_back(
        {std::string{file_name}, "the file has no message", "BO_ 257 Engine: 8 Gateway begins one"});
  loaded.spec = std::make_unique<Spec>(std::move(model));
  return loaded;
}

}  // namespace

Loaded parse(std::string_view text, std::string_view file_name) {
  Loaded loaded;
  if (text.size() > max_spec_bytes) {
    loaded.problems.push_back({std::string{file_name},
                               "the file has " + std::to_string(text.size()) + " bytes",
                               "a spec has at most " + std::to_string(max_spec_bytes)});
    return loaded;
  }
  if (const std::string encoding{wide_encoding(text)}; !encoding.empty()) {
    loaded.problems.push_back({std::string{file_name}, "the file is " + encoding,
                               "UTF-8, or code page 1252 for a DBC file: iconv -f " + encoding +
                                   " -t UTF-8 -o NEW " + std::string{file_name}});
    return loaded;
  }
  if (is_dbc(text, file_name)) return parse_dbc(text, file_name);
  const Node root = parse_json(text, file_name, loaded.problems, {.max_text = max_spec_text});
  if (!has_document(loaded.problems)) return loaded;
  Model model = read_model(root, file_name, loaded.problems, loaded.doubts);
  validate_by_schema(root, file_name, loaded.problems);
  sort_by_line(loaded.problems, file_name);
  sort_by_line(loaded.doubts, file_name);
  if (loaded.problems.empty()) loaded.spec = std::make_unique<Spec>(std::move(model));
  return loaded;
}

Loaded load(const std::filesystem::path& file) {
  Loaded loaded;
  const auto text = read_document(file, "a spec", "spec/topics.json", loaded.problems);
  return text ? parse(*text, file.string()) : std::move(loaded);
}

}  // namespace ocm::spec
