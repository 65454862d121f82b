// Replays kept inputs through every target, with any compiler: fuzz_replay FOLDER..., each with a folder per
// target. A target aborts on an input that breaks a property; its name is on stderr by then. Exit code: 0 all
// were replayed, 1 a target has no input or a folder no target, 2 usage.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/robustness/fuzz/fuzz.hpp"

// One function a target: LLVMFuzzerTestOneInput, renamed when it was compiled.
#define OCM_TARGET(name) extern "C" int fuzz_##name(const std::uint8_t*, std::size_t);
#include "fuzz_targets.inc"
#undef OCM_TARGET

namespace {

struct Target {
  std::string_view name;
  int (*run)(const std::uint8_t*, std::size_t);
  std::size_t inputs = 0;
};

#define OCM_TARGET(name) {#name, fuzz_##name},
Target targets[] = {
#include "fuzz_targets.inc"
};
#undef OCM_TARGET

void replay(Target& target, const std::filesystem::path& file) {
  std::ifstream in{file, std::ios::binary};
  const std::string text{std::istreambuf_iterator<char>{in}, {}};
  if (!in) throw std::runtime_error("cannot read '" + file.string() + "'");
  std::fprintf(stderr, "%s\n", file.c_str());  // the last one named is the one that breaks it
  target.run(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  ++target.inputs;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    std::fprintf(stderr, "usage: %s FOLDER...\n", arguments[0]);
    return 2;
  }
  try {
    int result = 0;
    for (int i = 1; i < count; ++i) {
      for (const auto& folder : std::filesystem::directory_iterator{arguments[i]}) {
        if (!folder.is_directory()) continue;
        const auto target = std::find_if(
            std::begin(targets), std::end(targets),
            [&](const Target& candidate) { return candidate.name == folder.path().filename().string(); });
        if (target == std::end(targets)) {
          std::fprintf(stderr, "fuzz_replay: '%s' is the name of no target\n", folder.path().c_str());
          result = 1;
          continue;
        }
        target->run(nullptr, 0);
        std::vector<std::filesystem::path> files;
        for (const auto& file : std::filesystem::directory_iterator{folder}) files.push_back(file.path());
        std::sort(files.begin(), files.end());
        for (const auto& file : files) replay(*target, file);
      }
    }
    for (const Target& target : targets) {
      std::printf("%-20s %zu inputs\n", std::string{target.name}.c_str(), target.inputs);
      if (target.inputs != 0) continue;
      std::fprintf(stderr, "fuzz_replay: target '%s' has no input: write a seed into its corpus\n",
                   std::string{target.name}.c_str());
      result = 1;
    }
    return result;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fuzz_replay: %s\n", error.what());
    return 1;
  }
}
