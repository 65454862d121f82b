/// Several specs of one bus as one.
#pragma once

#include <string>
#include <vector>

#include "generator/spec/model.hpp"
#include "generator/spec/problem.hpp"

namespace ocm::spec {

/// Adds what `from` says to `into`, which keeps its name. Two with one name or one identifier, and different
/// bit rates, are problems, whose place is `place`, where `from` comes from. Boards of one name are one
/// board.
void merge(Model& into, Model from, const std::string& place, std::vector<Problem>& problems);

}  // namespace ocm::spec
