/// Reads a file of sentences, such as spec/sentences.json: what a robot and its server say to each other as
/// text. Every problem comes with its place, what is wrong and what would be right.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// One integer of a sentence.
struct IntegerModel {
  std::string name;
  std::string unit;  ///< empty: a count
  std::string description;
  std::int64_t min = 0;
  std::int64_t max = 0;
  std::vector<std::pair<std::string, std::int64_t>> values{};  ///< those that have a name
  std::string source;                                          ///< empty: as the sentence's
};

/// What a sentence consists of: fixed text, a letter and a word, or a letter and integers.
struct SentenceModel {
  std::string name;
  std::string description;
  std::string source;
  bool to_robot = false;
  char letter = 0;   ///< 0: fixed text
  std::string word;  ///< empty: integers, or fixed text
  std::string text;
  std::vector<IntegerModel> fields;
  /// Fewest and most integers that are read; nothing: as many as fields.
  std::optional<std::pair<std::int64_t, std::int64_t>> integers{};
};

/// A sentence in one packet of bits: a sequence number, then its fields.
struct PackedModel {
  std::int64_t version = 0;
  std::int64_t tag = 0;
  std::string sentence;
  std::string description;
  std::string source;
  std::vector<std::pair<std::string, std::int64_t>> fields;  ///< name and bits, the sequence number first
};

struct SentencesModel {
  std::string robot;
  std::string description;
  std::int64_t packet_bytes = 0;
  std::string packet_source;
  std::vector<SentenceModel> sentences;
  PackedModel packed;
};

/// There is a model exactly when there are no problems. They are all that were found, in the order of the
/// file.
struct LoadedSentences {
  std::optional<SentencesModel> model{};
  std::vector<Problem> problems{};
};

/// Any bytes are a problem at worst: throws std::bad_alloc only. `file_name` is for the places.
[[nodiscard]] LoadedSentences parse_sentences(std::string_view text, std::string_view file_name);

/// The JSON schema that is compiled in: spec/sentences.schema.json of this release.
[[nodiscard]] std::string_view sentences_schema_text() noexcept;

}  // namespace ocm::spec
