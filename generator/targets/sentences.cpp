#include "generator/targets/sentences.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "generator/spec/names.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {
namespace {

using spec::IntegerModel;
using spec::SentenceModel;
using Remarked = std::vector<std::pair<std::string, std::string>>;

std::string upper_first(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string direction_of(const SentenceModel& sentence) {
  return sentence.to_robot ? "Direction::to_robot" : "Direction::from_robot";
}

/// As a C++ literal writes it, without the quotes.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\t') {
      out += "\\t";
      continue;
    }
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

/// `{U,angle,distance}`
std::string form_of(const SentenceModel& sentence) {
  if (sentence.letter == 0) return "`" + escaped(sentence.text) + "`";
  std::string form = std::string{"`{"} + sentence.letter;
  if (!sentence.word.empty()) form += "," + sentence.word;
  if (sentence.integers)
    form += ",...";
  else
    for (const IntegerModel& field : sentence.fields) form += "," + field.name;
  return form + "}`";
}

bool is_any(const IntegerModel& field) {
  return field.min == INT16_MIN && field.max == INT16_MAX;
}

/// "cm, from the start; [0, 255] [source]"
std::string remark_of(const IntegerModel& field) {
  std::string text = field.unit.empty() ? field.description : field.unit + ", " + field.description;
  if (!is_any(field)) text += "; [" + std::to_string(field.min) + ", " + std::to_string(field.max) + "]";
  return with_source(text, field.source);
}

void write_struct(Writer& out, const SentenceModel& sentence) {
  const std::string type = spec::pascal_case(sentence.name);
  const std::string count = std::to_string(sentence.fields.size());
  out.comment(with_source(form_of(sentence) + " " + sentence.description + ".", sentence.source));
  out.open("struct " + type + " {");
  Remarked members;
  for (const IntegerModel& field : sentence.fields)
    members.emplace_back("std::int16_t " + field.name + " = 0;", remark_of(field));
  out.remarked(members);
  if (sentence.integers) {
    out.comment("integers in the sentence, " + std::to_string(sentence.integers->first) + " to " +
                std::to_string(sentence.integers->second) +
                ": fields that were not given are 0, integers beyond the last field are let go");
    out.line("std::uint8_t given = " + count + ";");
  }
  out.line();
  out.line("static constexpr Kind kind = Kind::" + sentence.name + ";");
  out.line("static constexpr Direction direction = " + direction_of(sentence) + ";");
  out.line(std::string{"static constexpr char letter = '"} + sentence.letter + "';");
  if (sentence.integers)
    out.line("static constexpr std::size_t fewest_integers = " + std::to_string(sentence.integers->first) +
             ", most_integers = " + std::to_string(sentence.integers->second) + ";");
  Remarked values;
  for (const IntegerModel& field : sentence.fields)
    for (const auto& [name, value] : field.values)
      values.emplace_back("static constexpr std::int16_t " + name + " = " + std::to_string(value) + ";",
                          "of " + field.name);
  out.remarked(values);
  out.open("static constexpr std::array<Field<" + type + ">, " + count + "> fields{{");
  for (const IntegerModel& field : sentence.fields) {
    std::string row = "  {&" + type + "::" + field.name + ", \"" + field.name + "\", \"" + field.unit + "\"";
    if (!is_any(field)) row += ", " + std::to_string(field.min) + ", " + std::to_string(field.max);
    out.line(row + "},");
  }
  out.close("}};");
  out.line("friend constexpr bool operator==(const " + type + "&, const " + type + "&) = default;");
  out.undent();
  out.line("};");
  out.line();
}

void write_kinds(Writer& out, const std::vector<SentenceModel>& sentences) {
  out.comment("Which sentence; none: not one, or not yet.");
  out.open("enum class Kind : std::uint8_t {");
  out.line("none,");
  Remarked rows;
  for (const SentenceModel& sentence : sentences)
    rows.emplace_back(sentence.name + ",", form_of(sentence) + " " + sentence.description);
  out.remarked(rows);
  out.close("};");
  out.line();
  out.comment("As the spec calls it.");
  out.open("[[nodiscard]] constexpr std::string_view name(Kind kind) noexcept {");
  for (const SentenceModel& sentence : sentences)
    out.line("if (kind == Kind::" + sentence.name + ") return \"" + sentence.name + "\";");
  out.line("return \"none\";");
  out.close("}");
  out.line();
}

void write_words(Writer& out, const std::vector<SentenceModel>& sentences) {
  out.comment("A sentence of a word behind `word_letter`.");
  out.open("struct Word {");
  out.line("Kind kind;");
  out.line("Direction direction;");
  out.line("std::string_view text;");
  out.close("};");
  const auto word = std::find_if(sentences.begin(), sentences.end(),
                                 [](const SentenceModel& sentence) { return !sentence.word.empty(); });
  if (word != sentences.end()) {
    out.line(std::string{"inline constexpr char word_letter = '"} + word->letter + "';");
    out.line("inline constexpr std::size_t word_length = " + std::to_string(word->word.size()) + ";");
  }
  std::vector<std::string> rows;
  for (const SentenceModel& sentence : sentences)
    if (!sentence.word.empty())
      rows.push_back("    {Kind::" + sentence.name + ", " + direction_of(sentence) + ", \"" + sentence.word +
                     "\"},");
  out.line("inline constexpr std::array<Word, " + std::to_string(rows.size()) + "> words{{");
  for (const std::string& row : rows) out.line(row);
  out.line("}};");
  out.line();
  // A function, where a table would take RAM on a processor that cannot read its flash as memory.
  out.comment("Of a sentence that is fixed text: all of it but its line feed. Empty for others.");
  out.open("[[nodiscard]] constexpr std::string_view fixed_text(Kind kind) noexcept {");
  for (const SentenceModel& sentence : sentences)
    if (sentence.letter == 0)
      out.line("if (kind == Kind::" + sentence.name + ") return \"" + escaped(sentence.text) + "\";");
  out.line("return {};");
  out.close("}");
  out.line();
}

void write_packed(Writer& out, const spec::PackedModel& packed) {
  const std::string type = spec::pascal_case(packed.sentence);
  out.comment(with_source(upper_first(packed.description) + ".", packed.source));
  out.line("inline constexpr std::uint8_t packed_version = " + std::to_string(packed.version) + ";");
  out.comment("Its first byte.");
  out.line("inline constexpr std::uint8_t packed_tag = " + hex(static_cast<unsigned>(packed.tag)) + ";");
  out.comment("Bits of the sequence number in front of the fields, and of each of " + type + "::fields.");
  out.line("inline constexpr std::uint8_t packed_sequence_bits = " + std::to_string(packed.fields[0].second) +
           ";");
  std::vector<std::string> widths;
  for (std::size_t i = 1; i < packed.fields.size(); ++i)
    widths.push_back(std::to_string(packed.fields[i].second));
  out.list("inline constexpr std::array<std::uint8_t, " + std::to_string(widths.size()) + "> packed_widths{",
           widths, "};");
  out.line();
}

}  // namespace

std::string sentences_header(const spec::SentencesModel& model, std::string_view spec_name) {
  Writer out;
  out.line("// Made by ocm-generate from " + std::string{spec_name} +
           ". Do not edit: change the spec, and generate again.");
  out.line();
  out.comment(upper_first(model.description) + ".");
  out.line("///");
  out.comment(
      "The facts: which sentences there are, their fields with unit and range, their letters and words. "
      "ocm/mapper/link/sentence.hpp writes them, sentence_reader.hpp reads them. No heap; everything is "
      "constexpr.");
  for (const char* text : {"#pragma once", "", "#include <array>", "#include <cstddef>", "#include <cstdint>",
                           "#include <string_view>", "", "#include \"ocm/mapper/link/field.hpp\"", "",
                           "namespace ocm::mapper::link {", ""})
    out.line(text);

  std::int64_t longest = 0;
  for (const SentenceModel& sentence : model.sentences)
    longest = std::max({longest, static_cast<std::int64_t>(sentence.fields.size()),
                        sentence.integers ? sentence.integers->second : 0});
  out.comment(with_source("Bytes of a packet, at most.", model.packet_source));
  out.line("inline constexpr std::size_t max_packet = " + std::to_string(model.packet_bytes) + ";");
  out.comment("Integers of a sentence, at most.");
  out.line("inline constexpr std::size_t max_integers = " + std::to_string(longest) + ";");
  out.line();
  write_kinds(out, model.sentences);
  for (const SentenceModel& sentence : model.sentences)
    if (!sentence.fields.empty()) write_struct(out, sentence);
  write_words(out, model.sentences);
  write_packed(out, model.packed);
  out.line("}  // namespace ocm::mapper::link");
  return out.take();
}

}  // namespace ocm::generate
