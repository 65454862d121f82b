#include "generator/spec/sentences.hpp"

#include <algorithm>
#include <tuple>

#include "generator/spec/file.hpp"
#include "generator/spec/node_reader.hpp"
#include "generator/spec/schema.hpp"

namespace ocm::spec {
namespace {

constexpr Document document{.what = "a file of sentences",
                            .members = "robot, description, integer, packet, sentences and packed",
                            .schema = "sentences.schema.json",
                            .levels = 7};

constexpr std::int64_t least = INT16_MIN;
constexpr std::int64_t most = INT16_MAX;
constexpr std::int64_t most_integers = 16;

/// Bytes of a packed sentence's packet that are no bits of fields: its tag, and the CRC. The others hold
/// seven each.
constexpr std::int64_t packed_overhead = 4;

constexpr std::string_view sorts = R"(either "letter" and "word", or "letter" and "fields", or "text" alone)";

class SentencesReader : private NodeReader {
 public:
  using NodeReader::NodeReader;

  SentencesModel read(const Node& node) {
    const At root{&node, ""};
    SentencesModel model;
    if (!is_object(root, "an object with " + std::string{document.members})) return model;
    check_keys(root, {"$schema", "robot", "description", "integer", "packet", "sentences", "packed"});
    if (const auto at = require(root, "robot", "what the robot is called")) model.robot = line(*at, false);
    if (const auto at = require(root, "description", "what is said here, and by whom"))
      model.description = line(*at, false);
    if (const auto at = require(root, "integer", "what any integer of a sentence can be")) read_integer(*at);
    if (const auto at = require(root, "packet", "the radio's packet, in bytes")) read_packet(*at, model);
    if (const auto at = require(root, "sentences", "a list of all sentences")) read_sentences(*at, model);
    if (const auto at = require(root, "packed", "the sentence that fits one packet of bits"))
      read_packed(*at, model);
    return model;
  }

 private:
  void read_integer(const At& at) {
    if (!is_object(at, R"({"min": -32768, "max": 32767, "source": "..."})")) return;
    check_keys(at, {"min", "max", "source"});
    if (const auto min = require(at, "min", "the least integer"))
      min_ = integer(*min, least, most).value_or(min_);
    if (const auto max = require(at, "max", "the greatest integer"))
      max_ = integer(*max, least, most).value_or(max_);
    if (min_ > max_) tell(at, "min is greater than max", "the smaller one as min");
    (void)sources(at, {});
  }

  void read_packet(const At& at, SentencesModel& model) {
    if (!is_object(at, R"({"bytes": 20, "source": "..."})")) return;
    check_keys(at, {"bytes", "source"});
    if (const auto bytes = require(at, "bytes", "how many a packet has"))
      model.packet_bytes = integer(*bytes, 1, 255).value_or(0);
    model.packet_source = sources(at, {}).general;
  }

  [[nodiscard]] bool is_list(const At& at, std::string_view remedy) {
    if (!is_kind(at, Kind::array, remedy)) return false;
    if (!at.node->items.empty()) return true;
    tell(at, "an empty list", std::string{remedy});
    return false;
  }

  /// One text, or {"default": ..., member: ...} with a text for single members and fields.
  [[nodiscard]] Source sources(const At& object, const std::vector<std::string>& fields) {
    Source source;
    const auto at = require(object, "source", R"(where the facts come from, or "decided: why")");
    if (!at) return source;
    if (at->node->is(Kind::string)) {
      source.general = line(*at, false);
      return source;
    }
    if (!is_object(*at, R"(a line of text, or {"default": "...", "range": "..."} with a text for each fact)"))
      return source;
    if (!at->member("default"))
      tell(*at, R"(no "default")", R"(add "default": the source of all other facts)");
    for (const auto& [key, node] : at->node->members) {
      std::string text = line({&node, at->path + "/" + pointer_step(key)}, false);
      if (key == "default")
        source.general = std::move(text);
      else if (key != "range" && !object.member(key) &&
               std::find(fields.begin(), fields.end(), key) == fields.end())
        tell({&node, at->path + "/" + pointer_step(key)},
             "source for " + spec::quoted(key) + ", which is not a fact of this object",
             fields.empty() ? "default, or range" : "default, range, or one of " + list_of(fields));
      else
        source.particular.emplace_back(key, std::move(text));
    }
    return source;
  }

  void read_sentences(const At& at, SentencesModel& model) {
    if (!is_list(at, "a list of at least one sentence")) return;
    std::vector<At> places;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"name": "idle", "direction": "from_robot", ...})")) continue;
      SentenceModel sentence = read_sentence(item);
      compare(item, sentence, model.sentences);
      model.sentences.push_back(std::move(sentence));
      places.push_back(item);
    }
    // All words are behind one letter, and no integers: a reader knows at the letter what comes.
    const auto first = std::find_if(model.sentences.begin(), model.sentences.end(),
                                    [](const SentenceModel& sentence) { return is_word(sentence); });
    if (first == model.sentences.end()) return;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const SentenceModel& sentence = model.sentences[i];
      if (is_word(sentence) && sentence.letter != first->letter)
        tell(places[i], "a word behind another letter than that of " + spec::quoted(first->name),
             std::string{"all words are behind one letter: \""} + first->letter + "\"");
      if (!sentence.fields.empty() && sentence.letter == first->letter)
        tell(places[i], "integers behind the letter of the word " + spec::quoted(first->name),
             "another letter");
    }
  }

  /// Whose letter is none has been told of it already.
  [[nodiscard]] static bool is_word(const SentenceModel& sentence) noexcept {
    return !sentence.word.empty() && sentence.letter != 0;
  }

  [[nodiscard]] SentenceModel read_sentence(const At& at) {
    static constexpr std::pair<std::string_view, bool> directions[] = {{"to_robot", true},
                                                                       {"from_robot", false}};
    check_keys(
        at, {"name", "direction", "description", "letter", "word", "text", "integers", "fields", "source"});
    SentenceModel sentence;
    if (const auto name_at = require(at, "name", "what the sentence is called"))
      sentence.name = name(*name_at);
    if (sentence.name == "none")
      tell(at, R"("none" is what a reader says when there is no sentence)", "another name");
    if (const auto way = require(at, "direction", "to_robot or from_robot"))
      sentence.to_robot = one_of(*way, directions).value_or(false);
    if (const auto text = require(at, "description", "what the sentence says"))
      sentence.description = line(*text, false);
    const auto letter = at.member("letter");
    const auto word = at.member("word");
    const auto text = at.member("text");
    const auto fields = at.member("fields");
    if ((letter.has_value() == text.has_value()) || (letter && word.has_value() == fields.has_value()) ||
        (text && (word || fields)))
      tell(at, "a sentence must be of one sort", std::string{sorts});
    if (letter) sentence.letter = (capitals(*letter, 1) + '\0').front();
    if (word) sentence.word = capitals(*word, 3);
    if (text) sentence.text = fixed(*text);
    std::vector<std::string> names;
    if (fields) names = read_fields(*fields, sentence);
    if (const auto integers = at.member("integers")) read_integers(*integers, sentence);
    const Source source = sources(at, names);
    sentence.source = source.general;
    for (IntegerModel& field : sentence.fields) {
      const bool ranged = field.min != min_ || field.max != max_;
      for (const auto& [fact, from] : source.particular)
        if (fact == field.name || (fact == "range" && ranged)) field.source = from;
    }
    for (const auto& [fact, from] : source.particular)
      if (fact == "fields")
        sentence.source += (sentence.source.empty() ? "fields" : "; fields") +
                           ((from.starts_with("decided") ? " " : ": ") + from);
    return sentence;
  }

  [[nodiscard]] std::string capitals(const At& at, std::size_t size) {
    const std::string remedy = size == 1 ? "one letter, A to Z" : std::to_string(size) + " letters, A to Z";
    if (!is_kind(at, Kind::string, remedy)) return {};
    const std::string& text = at.node->text;
    if (text.size() == size &&
        std::all_of(text.begin(), text.end(), [](char c) { return c >= 'A' && c <= 'Z'; }))
      return text;
    tell(at, shown(*at.node).substr(0, 40) + " is not " + (size == 1 ? "a letter" : "a word"), remedy);
    return {};
  }

  /// Printable characters and tabs.
  [[nodiscard]] std::string fixed(const At& at) {
    static constexpr std::string_view form =
        "printable ASCII characters and tabs, at least one; the line feed is not typed";
    if (!is_kind(at, Kind::string, form)) return {};
    const std::string& text = at.node->text;
    const auto good = [](char c) { return c == '\t' || (c >= ' ' && c <= '~'); };
    if (!text.empty() && std::all_of(text.begin(), text.end(), good)) return text;
    tell(at, text.empty() ? "the text is empty" : "the text has a character that is none of a sentence",
         std::string{form});
    return {};
  }

  std::vector<std::string> read_fields(const At& at, SentenceModel& sentence) {
    // What the generated struct has already.
    static constexpr std::string_view taken[] = {"kind", "direction", "letter", "fields", "given"};
    std::vector<std::string> names;
    if (!is_list(at, "a list of at least one integer")) return names;
    if (at.node->items.size() > static_cast<std::size_t>(most_integers))
      tell(at, std::to_string(at.node->items.size()) + " integers",
           "at most " + std::to_string(most_integers));
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"name": "x", "unit": "cm", "description": "..."})")) continue;
      check_keys(item, {"name", "unit", "range", "values", "description"});
      IntegerModel field;
      if (const auto text = require(item, "name", "what the integer is called")) {
        field.name = name(*text);
        if (std::find(std::begin(taken), std::end(taken), field.name) != std::end(taken))
          tell(*text, spec::quoted(field.name) + " is a member of every sentence's struct", "another name");
        if (std::find(names.begin(), names.end(), field.name) != names.end() && !field.name.empty())
          tell(*text, "a second integer " + spec::quoted(field.name), "another name");
      }
      static constexpr std::pair<std::string_view, std::string_view> units[] = {
          {"", ""}, {"cm", "cm"}, {"deg", "deg"}, {"ms", "ms"}, {"mG", "mG"}};
      if (const auto unit = require(item, "unit", R"("cm", "deg", "ms", "mG", or "" for a count)"))
        field.unit = one_of(*unit, units).value_or("");
      if (const auto text = require(item, "description", "what the integer says"))
        field.description = line(*text, false);
      std::tie(field.min, field.max) = read_range(item);
      if (const auto values = item.member("values")) read_values(*values, names, field);
      names.push_back(field.name);
      sentence.fields.push_back(std::move(field));
    }
    return names;
  }

  /// Each becomes a constant of the sentence's struct: `names` are members of it already.
  void read_values(const At& at, const std::vector<std::string>& names, IntegerModel& field) {
    if (!is_object(at, R"({"name_of_a_value": 1})")) return;
    for (const auto& [text, node] : at.node->members) {
      const At value{&node, at.path + "/" + pointer_step(text)};
      if (!spec::is_name(text))
        tell(value, spec::quoted(text) + " is not a valid name",
             "small letters, digits and _, such as packed_offer");
      else if (text == field.name || std::find(names.begin(), names.end(), text) != names.end())
        tell(value, spec::quoted(text) + " is an integer of the sentence, too", "another name");
      if (const auto number = integer(value, field.min, field.max)) field.values.emplace_back(text, *number);
    }
  }

  [[nodiscard]] std::pair<std::int64_t, std::int64_t> read_range(const At& field) {
    const std::pair<std::int64_t, std::int64_t> any{min_, max_};
    const auto at = field.member("range");
    return at ? read_pair(*at, min_, max_).value_or(any) : any;
  }
  /// [smaller, greater]
  [[nodiscard]] std::optional<std::pair<std::int64_t, std::int64_t>> read_pair(const At& at, std::int64_t low,
                                                                               std::int64_t high) {
    static constexpr std::string_view form = "two whole numbers, [smallest, greatest]";
    if (!is_kind(at, Kind::array, form)) return std::nullopt;
    if (at.node->items.size() != 2) {
      tell(at, "a list of " + std::to_string(at.node->items.size()), std::string{form});
      return std::nullopt;
    }
    const auto smallest = integer(at.item(0), low, high);
    const auto greatest = integer(at.item(1), low, high);
    if (!smallest || !greatest) return std::nullopt;
    if (*smallest > *greatest) {
      tell(at, std::to_string(*smallest) + " is greater than " + std::to_string(*greatest),
           std::string{form});
      return std::nullopt;
    }
    return std::pair{*smallest, *greatest};
  }

  void read_integers(const At& at, SentenceModel& sentence) {
    if (sentence.fields.empty()) return tell(at, "a number of integers without \"fields\"", "leave it out");
    sentence.integers = read_pair(at, 1, most_integers);
    if (!sentence.integers) return;
    const auto fields = static_cast<std::int64_t>(sentence.fields.size());
    if (sentence.integers->first > fields || sentence.integers->second < fields)
      tell(at, std::to_string(fields) + " fields are outside of it",
           "a number below and one above, or leave it out");
  }

  /// With the sentences before it: a reader must know them apart.
  void compare(const At& at, const SentenceModel& sentence, const std::vector<SentenceModel>& others) {
    for (const SentenceModel& other : others) {
      if (!sentence.name.empty() && sentence.name == other.name)
        tell(at, "a second sentence " + spec::quoted(sentence.name), "another name");
      if (sentence.to_robot == other.to_robot && sentence.letter == other.letter &&
          sentence.word == other.word && sentence.text == other.text)
        return tell(at, "it cannot be distinguished from " + spec::quoted(other.name),
                    "another letter, word or text");
    }
  }

  void read_packed(const At& at, SentencesModel& model) {
    if (!is_object(at, "an object with version, tag, sentence, description, fields and source")) return;
    check_keys(at, {"version", "tag", "sentence", "description", "fields", "source"});
    PackedModel& packed = model.packed;
    if (const auto version = require(at, "version", "1 for the first"))
      packed.version = integer(*version, 1, 255).value_or(0);
    if (const auto tag = require(at, "tag", "the first byte"))
      packed.tag = integer(*tag, 128, 255).value_or(0);
    const SentenceModel* sentence = nullptr;
    if (const auto of = require(at, "sentence", "which sentence it is")) {
      packed.sentence = name(*of);
      for (const SentenceModel& candidate : model.sentences)
        if (candidate.name == packed.sentence && !candidate.fields.empty()) sentence = &candidate;
      if (sentence == nullptr && !packed.sentence.empty())
        tell(*of, "no sentence " + spec::quoted(packed.sentence) + " has integers",
             "the name of one that has");
    }
    if (const auto text = require(at, "description", "how the bits lie in the packet"))
      packed.description = line(*text, false);
    if (const auto fields = require(at, "fields", R"([{"name": "sequence", "bits": 8}, ...])"))
      read_bits(*fields, packed, sentence, model.packet_bytes);
    packed.source = sources(at, {}).general;
  }

  void read_bits(const At& at, PackedModel& packed, const SentenceModel* sentence, std::int64_t bytes) {
    if (!is_list(at, R"(a list that begins with {"name": "sequence", "bits": 8})")) return;
    const std::size_t before = told();
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At item = at.item(i);
      if (!is_object(item, R"({"name": "x", "bits": 16})")) continue;
      check_keys(item, {"name", "bits"});
      std::string called;
      std::int64_t bits = 0;
      if (const auto text = require(item, "name", "a field of the sentence")) called = name(*text);
      if (const auto number = require(item, "bits", "how many it takes"))
        bits = integer(*number, 1, 16).value_or(0);
      sum += bits;
      if (told() == before && sentence != nullptr) compare_bits(item, i, called, bits, *sentence);
      packed.fields.emplace_back(std::move(called), bits);
    }
    if (told() != before || sentence == nullptr || bytes == 0) return;
    if (packed.fields.size() != 1 + sentence->fields.size())
      return tell(at, std::to_string(packed.fields.size()) + " fields",
                  "sequence, and the " + std::to_string(sentence->fields.size()) + " of " +
                      spec::quoted(sentence->name));
    if (const std::int64_t room = 7 * (bytes - packed_overhead); sum != room)
      tell(at, std::to_string(sum) + " bits",
           std::to_string(room) + ": seven for each byte between tag and CRC");
  }

  void compare_bits(const At& at, std::size_t place, const std::string& called, std::int64_t bits,
                    const SentenceModel& sentence) {
    if (place == 0) {
      if (called != "sequence" || bits != 8)
        tell(at, "the first field is the packet's number", R"({"name": "sequence", "bits": 8})");
      return;
    }
    if (place > sentence.fields.size()) return;
    const IntegerModel& field = sentence.fields[place - 1];
    if (called != field.name)
      return tell(at, spec::quoted(called) + " is not the next field of " + spec::quoted(sentence.name),
                  spec::quoted(field.name));
    if (field.min < 0 ? bits != 16 : field.max >= std::int64_t{1} << bits)
      tell(at,
           std::to_string(bits) + " bits are too few for " + std::to_string(field.min) + " to " +
               std::to_string(field.max),
           field.min < 0 ? "16, for integers below 0" : "more");
  }

  std::int64_t min_ = least;
  std::int64_t max_ = most;
};

}  // namespace

LoadedSentences parse_sentences(std::string_view text, std::string_view file_name) {
  static const Schema schema{sentences_schema_text(), document};
  LoadedSentences loaded;
  const Node root = parse_json(text, file_name, loaded.problems, document);
  if (!has_document(loaded.problems)) return loaded;
  SentencesModel model = SentencesReader{file_name, loaded.problems}.read(root);
  schema.validate(root, file_name, loaded.problems);
  sort_by_line(loaded.problems, file_name);
  if (loaded.problems.empty()) loaded.model = std::move(model);
  return loaded;
}

}  // namespace ocm::spec
