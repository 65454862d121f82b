#include "cli/shared/messages.hpp"

#include <cstdio>
#include <string>

#include <fmt/format.h>

#include "cli/shared/remedies.hpp"

namespace ocm::cli {
namespace {

void print(std::string_view before, std::string_view text) {
  std::fprintf(stderr, "%.*s%.*s\n", static_cast<int>(before.size()), before.data(),
               static_cast<int>(text.size()), text.data());
}

}  // namespace

void fail(const transport::Failure& failure, int code) {
  print("amiroctl: ", failure.what);
  if (const std::string what_to_do = remedy(failure); !what_to_do.empty()) print("          ", what_to_do);
  throw Exit{code};
}

void remark(std::string_view text) {
  print("", text);
}

void add_count(std::string& text, std::uint64_t count, std::string_view what) {
  if (count != 0) text += fmt::format(", {} {}", count, what);
}

}  // namespace ocm::cli
