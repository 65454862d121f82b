/// Reads a robot's spec, a JSON file that `topics.schema.json` describes, or a DBC file, into the catalogue
/// that the library works with. Used by the tool at run time and by the generator.
#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"

#include "generator/spec/file.hpp"
#include "generator/spec/model.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// Owns all text and arrays that its catalogue points to. Movable; the catalogue stays where it is.
class Spec {
 public:
  explicit Spec(Model model);
  Spec(Spec&&) noexcept;
  Spec& operator=(Spec&&) noexcept;
  ~Spec();

  [[nodiscard]] const protocol::Catalogue& catalogue() const noexcept;
  [[nodiscard]] const Model& model() const noexcept;
  /// The model for another spec; this one and its catalogue are no more.
  [[nodiscard]] Model take_model();

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

/// `spec` is null exactly when there are problems: all that were found, in the order of the file.
struct Loaded {
  std::unique_ptr<Spec> spec;
  std::vector<Problem> problems;
  std::vector<Problem>
      doubts;  ///< of messages: loaded as other programs load them, and perhaps not as it was meant
};

/// A spec is at most this large.
inline constexpr std::size_t max_spec_bytes = max_document_bytes;
/// A text in it, such as the comment of a message.
inline constexpr std::size_t max_spec_text = 20'000;

/// Any bytes are a problem at worst: throws std::bad_alloc only. `file_name` is for the places.
[[nodiscard]] Loaded parse(std::string_view text, std::string_view file_name);
[[nodiscard]] Loaded load(const std::filesystem::path& file);

/// The JSON schema that is compiled in: what `topics.schema.json` of this release says.
[[nodiscard]] std::string_view schema_text() noexcept;

}  // namespace ocm::spec
