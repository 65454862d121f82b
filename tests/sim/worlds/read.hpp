/// What the tests of worlds share.
#pragma once

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "sim/worlds/reader.hpp"

inline std::string read(const std::string& name) {
  std::ifstream in{std::string{OCM_SOURCE_DIR} + "/" + name, std::ios::binary};
  REQUIRE(in);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

inline std::vector<std::string> printed(const std::vector<ocm::sim::worlds::Problem>& problems) {
  std::vector<std::string> lines;
  for (const auto& p : problems) lines.push_back(p.place + ": " + p.what + "; " + p.remedy);
  return lines;
}
