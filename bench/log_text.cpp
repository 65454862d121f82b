// Reading and writing candump's text: nanoseconds of the processor a frame, in memory, over random frames.
//   log_text                 1 M frames; rounds of reading and of writing in turn
//   log_text --write FILE N  only writes such a log of N frames
//   log_text --read N        only reads N frames, once (for callgrind)
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

#include "ocm/log/candump.hpp"

#include "tests/unit/base/random.hpp"

namespace {

using namespace ocm;

/// Classic frames of any length, three of four with 11 bits, on two interfaces, some microseconds apart.
std::vector<log::Entry> random_entries(std::size_t count) {
  test::Random random{1};
  std::vector<log::Entry> entries(count);
  std::int64_t us = 1'436'509'052'249'713;
  for (log::Entry& entry : entries) {
    us += 100 + random.below(500);
    entry.time = base::Time{std::chrono::microseconds{us}};
    entry.interface = static_cast<std::uint16_t>(random.below(2));
    const bool wide = random.below(4) == 0;
    entry.format = wide ? can::Format::extended : can::Format::base;
    entry.id = random() & (wide ? can::max_extended_id : can::max_base_id);
    entry.length = static_cast<std::uint8_t>(random.below(9));
    for (std::size_t i = 0; i < entry.length; ++i) entry.data[i] = static_cast<std::uint8_t>(random());
  }
  return entries;
}

log::Interfaces two_interfaces() {
  log::Interfaces interfaces;
  interfaces.add("can0");
  interfaces.add("can1");
  return interfaces;
}

double processor_ns() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e9 + static_cast<double>(now.tv_nsec);
}

std::size_t read_all(std::string_view text) {
  log::MemorySource source{text};
  log::Input input{source};
  log::CandumpReader reader{input};
  std::array<log::Entry, log::batch> entries;
  std::size_t frames = 0;
  while (const std::size_t count = reader.read(entries)) frames += count;
  return frames;
}

/// As LogFile does: emptied now and then.
std::size_t write_all(const std::vector<log::Entry>& entries, const log::Interfaces& interfaces, FILE* file) {
  log::CandumpWriter writer;
  log::Bytes out;
  std::size_t size = 0;
  for (std::size_t i = 0; i < entries.size(); i += log::batch) {
    writer.write(out, std::span{entries}.subspan(i, std::min(log::batch, entries.size() - i)), interfaces);
    if (out.size() < log::Input::block && i + log::batch < entries.size()) continue;
    if (file != nullptr && std::fwrite(out.view().data(), 1, out.size(), file) != out.size()) return 0;
    size += out.size();
    out.clear();
  }
  return size;
}

std::string text_of(const std::vector<log::Entry>& entries, const log::Interfaces& interfaces) {
  log::CandumpWriter writer;
  log::Bytes out;
  writer.write(out, entries, interfaces);
  return std::string{out.view()};
}

void print(const char* what, std::vector<double> rounds) {
  std::sort(rounds.begin(), rounds.end());
  std::printf("%-16s median %5.1f ns a frame, best %5.1f ns\n", what, rounds[rounds.size() / 2], rounds[0]);
}

int measure() {
  constexpr std::size_t count = 1'000'000;
  const auto entries = random_entries(count);
  const auto interfaces = two_interfaces();
  const std::string text = text_of(entries, interfaces);
  std::vector<double> reading, writing;
  for (int round = 0; round < 9; ++round) {
    const double begin = processor_ns();
    if (read_all(text) != count) return 1;
    const double middle = processor_ns();
    if (write_all(entries, interfaces, nullptr) != text.size()) return 1;
    reading.push_back((middle - begin) / count);
    writing.push_back((processor_ns() - middle) / count);
  }
  print("read candump", reading);
  print("write candump", writing);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 1) return measure();
  if (argc == 4 && std::strcmp(argv[1], "--write") == 0) {
    FILE* const file = std::fopen(argv[2], "w");
    if (file == nullptr) return 1;
    const auto entries = random_entries(std::strtoul(argv[3], nullptr, 10));
    const bool done = write_all(entries, two_interfaces(), file) != 0;
    return std::fclose(file) == 0 && done ? 0 : 1;
  }
  if (argc == 3 && std::strcmp(argv[1], "--read") == 0) {
    const auto entries = random_entries(std::strtoul(argv[2], nullptr, 10));
    return read_all(text_of(entries, two_interfaces())) == entries.size() ? 0 : 1;
  }
  std::fprintf(stderr, "usage: log_text [--write FILE N | --read N]\n");
  return 2;
}
