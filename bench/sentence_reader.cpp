// Reading the mapper's sentences: ns a sentence of mapper::link::Reader, given a block of text or a character
// at a time, and of what one would write with strtok and with sscanf, in memory.
//
//   sentence_reader [--check]    --check: compares what they hear of a short stream, and measures nothing
//
// All of them refuse the same of a whole line: a wrong number of integers, one out of its range, one that is
// not as a robot prints it (strtok's way alone; sscanf cannot tell 007 from 7). Only mapper::link::Reader
// counts causes, and finds a sentence behind a torn one; the others give up the line.
#include "ocm/mapper/link/sentence_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/mapper/link/packet.hpp"

#include "tests/unit/mapper/link/link_testing.hpp"

namespace {

using namespace ocm;

/// What was heard: how many sentences, and a sum over their integers that depends on their places.
struct Heard {
  std::uint64_t sentences = 0;
  std::uint64_t sum = 0;
  friend bool operator==(const Heard&, const Heard&) = default;

  void update(const mapper::link::Update& update) {
    ++sentences;
    std::uint64_t place = 1;
    for (const auto& field : mapper::link::Update::fields)
      sum += place++ * static_cast<std::uint64_t>(std::int64_t{update.*field.member});
  }
  void idle() {
    ++sentences;
    sum += 1'000'000;
  }
};

void take(Heard& heard, const mapper::link::Reader& reader, mapper::link::Kind kind) {
  if (kind == mapper::link::Kind::update) heard.update(*reader.sentence().as<mapper::link::Update>());
  if (kind == mapper::link::Kind::idle) heard.idle();
}

Heard with_reader(std::string_view stream) {
  mapper::link::Reader reader;
  Heard heard;
  while (!stream.empty()) take(heard, reader, reader.feed(stream));
  return heard;
}

Heard with_characters(std::string_view stream) {
  mapper::link::Reader reader;
  Heard heard;
  for (const char c : stream) take(heard, reader, reader.feed(c));
  return heard;
}

/// Line by line, copied to where strtok and sscanf want it: with a zero behind it. Longer ones are refused.
template <class Read>
Heard line_by_line(std::string_view stream, Read read) {
  Heard heard;
  char line[64];
  while (!stream.empty()) {
    const std::size_t size = std::min(stream.find('\n'), stream.size());
    if (size < sizeof line) {
      std::memcpy(line, stream.data(), size);
      line[size] = 0;
      read(heard, line, size);
    }
    stream.remove_prefix(std::min(size + 1, stream.size()));
  }
  return heard;
}

bool in_range(const mapper::link::Update& update) {
  for (const auto& field : mapper::link::Update::fields)
    if (update.*field.member < field.min || update.*field.member > field.max) return false;
  return true;
}

/// As `%i` prints it, within 16 bits.
bool number(const char* text, std::int16_t& out) {
  const char* const digits = text + (*text == '-' ? 1 : 0);
  if (!base::is_digit(*digits) || (*digits == '0' && (digits[1] != 0 || digits != text))) return false;
  char* end = nullptr;
  errno = 0;
  const long value = std::strtol(text, &end, 10);
  if (*end != 0 || errno != 0 || value < INT16_MIN || value > INT16_MAX) return false;
  out = static_cast<std::int16_t>(value);
  return true;
}

void with_strtok(Heard& heard, char* line, std::size_t size) {
  if (size < 3 || line[0] != '{' || line[size - 1] != '}') return;
  line[size - 1] = 0;
  char* rest = nullptr;
  const char* const letter = strtok_r(line + 1, ",", &rest);
  if (letter == nullptr) return;
  if (std::strcmp(letter, "S") == 0) {
    const char* const word = strtok_r(nullptr, ",", &rest);
    if (word != nullptr && std::strcmp(word, "IDL") == 0) heard.idle();
    return;
  }
  if (std::strcmp(letter, "U") != 0) return;
  mapper::link::Update update;
  for (const auto& field : mapper::link::Update::fields) {
    const char* const text = strtok_r(nullptr, ",", &rest);
    if (text == nullptr || !number(text, update.*field.member)) return;
  }
  if (strtok_r(nullptr, ",", &rest) == nullptr && in_range(update)) heard.update(update);
}

void with_sscanf(Heard& heard, char* line, std::size_t size) {
  if (std::strcmp(line, "{S,IDL}") == 0) return heard.idle();
  mapper::link::Update u;
  int end = 0;
  const int count = std::sscanf(line, "{U,%hd,%hd,%hd,%hd,%hd,%hd,%hd,%hd}%n", &u.x, &u.y, &u.heading,
                                &u.servo, &u.s1, &u.s2, &u.s3, &u.s4, &end);
  if (count == 8 && end == static_cast<int>(size) && in_range(u)) heard.update(u);
}

/// Updates as a robot in a room sends them, every 20th sentence an idle; of 1000 packets `lost` never come.
std::string make_stream(std::size_t sentences, std::uint32_t lost) {
  test::Random random{20160601};
  std::string stream;
  for (std::size_t i = 0; i < sentences; ++i) {
    const auto line = i % 20 == 19 ? mapper::link::write(mapper::link::Kind::idle)
                                   : mapper::link::write(test::likely_update(random));
    for (std::string_view rest = line->view(); !rest.empty();) {
      const mapper::link::Packet packet = mapper::link::take_packet(rest);
      if (random.below(1000) >= lost) stream.append(packet.bytes().begin(), packet.bytes().end());
    }
  }
  return stream;
}

struct Way {
  const char* name;
  Heard (*run)(std::string_view);
  std::vector<double> ns{};
};

void measure(const char* what, const std::string& stream, std::size_t sentences, int rounds, bool tell) {
  using Clock = std::chrono::steady_clock;
  Way ways[] = {{"mapper::link::Reader", with_reader},
                {"by character", with_characters},
                {"strtok", [](std::string_view s) { return line_by_line(s, with_strtok); }},
                {"sscanf", [](std::string_view s) { return line_by_line(s, with_sscanf); }}};
  Heard heard[std::size(ways)];
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 0; i < std::size(ways); ++i) {
      const auto begin = Clock::now();
      heard[i] = ways[i].run(stream);
      const std::chrono::duration<double, std::nano> took = Clock::now() - begin;
      ways[i].ns.push_back(took.count() / static_cast<double>(sentences));
    }
  // Both ways of mapper::link::Reader hear the same of any stream, the others of one that is whole.
  const bool whole = heard[0].sentences == sentences;
  if (heard[1] != heard[0] || (whole && (heard[2] != heard[0] || heard[3] != heard[0]))) {
    std::fprintf(stderr, "sentence_reader: %s: the ways do not hear the same\n", what);
    std::exit(1);
  }
  if (!tell) return;
  const auto least = [](const std::vector<double>& ns) { return *std::min_element(ns.begin(), ns.end()); };
  for (std::size_t i = 0; i < std::size(ways); ++i) {
    const double best = least(ways[i].ns);
    std::printf(
        "%-8s  %-12s  best %6.1f ns/sentence  %5.2f M sentences/s  %5.2f x mapper::link::Reader  %6.2f %% "
        "whole\n",
        what, ways[i].name, best, 1e3 / best, best / least(ways[0].ns),
        100.0 * static_cast<double>(heard[i].sentences) / static_cast<double>(sentences));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool check = argc == 2 && std::string_view{argv[1]} == "--check";
  if (argc > 1 && !check) {
    std::fputs("usage: sentence_reader [--check]\n", stderr);
    return 2;
  }
  const std::size_t sentences = check ? 2'000 : 20'000;
  const int rounds = check ? 1 : 300;
  const std::string whole = make_stream(sentences, 0);
  if (with_reader(whole).sentences != sentences) {
    std::fputs("sentence_reader: a whole stream is not heard whole\n", stderr);
    return 1;
  }
  measure("whole", whole, sentences, rounds, !check);
  measure("5 % lost", make_stream(sentences, 50), sentences, rounds, !check);
  return 0;
}
