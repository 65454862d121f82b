/// A JSON schema as a judge of documents. Reading one takes longer than using it: keep it.
#pragma once

#include <string_view>
#include <vector>

#include "generator/spec/json.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// Each is static and stays to the end of the program: what it has parsed is never destroyed, since
/// nlohmann::json takes memory for that, and ends a program that has none.
class Schema {
 public:
  /// `text` is a schema that is compiled in; one that is none throws.
  Schema(std::string_view text, const Document& document);

  /// Appends what the schema finds where `problems` has nothing yet: a reader says the same of a document's
  /// form, but says it better.
  void validate(const Node& root, std::string_view file_name, std::vector<Problem>& problems) const;

 private:
  struct Parsed;
  Document document_;
  Parsed* parsed_;
};

}  // namespace ocm::spec
