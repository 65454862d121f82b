/// Sentences as a C++ header: spec/sentences.json to include/ocm/mapper/link/sentences.hpp.
#pragma once

#include <string>
#include <string_view>

#include "generator/spec/sentences.hpp"

namespace ocm::generate {

/// The header's text. The same model gives the same bytes.
[[nodiscard]] std::string sentences_header(const spec::SentencesModel& model, std::string_view spec_name);

}  // namespace ocm::generate
