/// All mistakes of a kind in a JSON file, made one by one, and what is reported of each: for tests that
/// compare it with a file.
///
/// OCM_WRITE_GOLDEN=1 before the program writes the files again; read the difference before you commit it.
#pragma once

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "generator/spec/problem.hpp"

namespace mistakes {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;

inline const std::string folder = std::string{OCM_SOURCE_DIR} + "/tests/";

inline std::string read(const std::string& path) {
  std::ifstream in{path, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Line by line, the first that differ.
inline void compare(const std::string& name, const std::string& made) {
  const std::string path = folder + name;
  if (std::getenv("OCM_WRITE_GOLDEN") != nullptr) std::ofstream{path, std::ios::binary} << made;
  const std::string expected = read(path);
  std::istringstream a{expected}, b{made};
  std::string one, other;
  int shown = 0;
  for (int line = 1; shown < 5; ++line) {
    const bool more_a = !std::getline(a, one).fail(), more_b = !std::getline(b, other).fail();
    if (!more_a && !more_b) break;
    if (more_a && more_b && one == other) continue;
    UNSCOPED_INFO(name << ':' << line << "\n  expected: " << (more_a ? one : "")
                       << "\n  reported: " << (more_b ? other : ""));
    ++shown;
  }
  CHECK(shown == 0);
  CHECK(expected == made);
}

/// All that is reported, in one line.
template <class Loaded>
std::string told(const Loaded& loaded) {
  std::string text;
  const auto add = [&text](const ocm::spec::Problem& problem) {
    text +=
        (text.empty() ? "" : " | ") + problem.place.substr(2) + ": " + problem.what + "; " + problem.remedy;
  };
  for (const auto& problem : loaded.problems) add(problem);
  if constexpr (requires { loaded.doubts; }) {
    if (!loaded.doubts.empty()) text += " | doubtful";
    for (const auto& doubt : loaded.doubts) add(doubt);
  }
  return text.empty() ? "good" : text;
}

inline void find_all(const Json& json, const Pointer& at, std::vector<Pointer>& all) {
  if (!at.empty()) all.push_back(at);
  if (json.is_object())
    for (const auto& [key, value] : json.items()) find_all(value, at / key, all);
  if (json.is_array())
    for (std::size_t i = 0; i < json.size(); ++i) find_all(json[i], at / i, all);
}

/// Other values at a place, each with a name.
inline std::vector<std::pair<std::string, Json>> others(const Json& value) {
  std::vector<std::pair<std::string, Json>> all{{"\"x\"", "x"}};
  if (value.is_number() || value.is_string()) all.emplace_back("-1", -1);
  if (value.is_number()) all.emplace_back("1e30", 1e30);
  if (value.is_array())
    all.emplace_back("{}", Json::object());
  else
    all.emplace_back("[]", Json::array());
  if (value.is_structured()) {
    all.emplace_back("null", nullptr);
    if (!value.empty()) all.emplace_back("empty", value.is_array() ? Json::array() : Json::object());
  } else {
    all.emplace_back("0", 0);
  }
  if (value.is_number_integer()) {
    all.emplace_back("one more", value.get<std::int64_t>() + 1);
    all.emplace_back("one less", value.get<std::int64_t>() - 1);
  }
  if (value.is_number_float()) all.emplace_back("negative", -value.get<double>());
  if (value.is_string()) {
    all.emplace_back("\"\"", "");
    all.emplace_back("longer", value.get<std::string>() + "_");
  }
  if (value.is_boolean()) all.emplace_back("the other", !value.get<bool>());
  if (value.is_array() && !value.empty()) {
    Json more = value;
    more.push_back(value.back());
    all.emplace_back("the last twice", more);
  }
  return all;
}

template <class Parse>
std::string mistakes_of(const std::string& name, Parse parse) {
  const Json good = Json::parse(read(folder + name));
  std::string text = "== " + name + "\n";
  std::vector<Pointer> all;
  find_all(good, Pointer{}, all);
  for (const Pointer& at : all) {
    text += at.to_string() + "\n";
    std::string before;
    const auto put = [&](const std::string& what, const Json& changed) {
      const std::string now = told(parse(changed.dump(1)));
      text += "  " + what + ": " + (now == before ? "the same" : now) + "\n";
      before = now;
    };
    Json without = good;
    Json& parent = without[at.parent_pointer()];
    if (parent.is_array())
      parent.erase(std::stoul(at.back()));
    else
      parent.erase(at.back());
    put("missing", without);
    for (const auto& [what, value] : others(good[at])) {
      Json changed = good;
      changed[at] = value;
      put(what, changed);
    }
  }
  return text;
}

}  // namespace mistakes
