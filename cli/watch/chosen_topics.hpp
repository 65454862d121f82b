/// The topics that the words of a command line name: by name, alias or group.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

/// In the order of the words. A word that is no topic is exit_usage, in words that begin with the verb.
[[nodiscard]] std::vector<const protocol::Topic*> chosen_topics(std::string_view verb,
                                                                const protocol::Catalogue& catalogue,
                                                                std::span<const std::string> words);

/// Where nothing came from a bus: says how to ask for the first sensor of `topics`, or of the catalogue where
/// that is empty. Nothing where there is none.
void tell_to_ask(const protocol::Catalogue& catalogue, std::span<const protocol::Topic* const> topics);

}  // namespace ocm::cli
