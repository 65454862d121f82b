/// What response times of CAN messages cost: the exact analysis of all messages of a set of 20 to 2048, at
/// loads of 0.5 to 0.99, the mean of ten sets; and the table of exact frame lengths.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "ocm/analysis/can_response.hpp"
#include "ocm/can/worst_bits.hpp"

#include "bench/best_of.hpp"

using namespace ocm;
using ocm::bench::best_of;

namespace {

constexpr std::size_t most_messages = 2048;
constexpr unsigned sets = 10;  // of each size and load

/// Frames of 0 to 8 bytes at the closed bound, periods over two magnitudes, a tenth of a period of jitter,
/// identifiers by period, in bits.
std::vector<analysis::Message> draw(std::size_t count, double load, unsigned seed) {
  std::mt19937 random{static_cast<std::uint32_t>(count) + seed};
  std::vector<analysis::Message> set(count);
  double sum = 0;
  for (analysis::Message& m : set) {
    m.cost = can::worst_frame_bits(can::Format::base, static_cast<unsigned>(random() % 9));
    m.period = 1'000 + static_cast<std::int64_t>(random() % 99'000);
    sum += static_cast<double>(m.cost) / static_cast<double>(m.period);
  }
  for (analysis::Message& m : set) {
    m.period = static_cast<std::int64_t>(static_cast<double>(m.period) * sum / load) + 1;
    m.jitter = m.period / 10;
    m.key = static_cast<std::uint32_t>(m.period);
  }
  std::sort(set.begin(), set.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  return set;
}

}  // namespace

int main() {
  const auto solver = std::make_unique<analysis::CanResponse<most_messages>>();
  std::printf("%9s %8s %16s %12s %10s\n", "messages", "load", "all of a set, us", "each, us", "in time");
  for (const std::size_t count : {20UL, 100UL, 1'000UL, most_messages})
    for (const double load : {0.5, 0.7, 0.9, 0.99}) {
      double all = 0;
      std::size_t in_time = 0;
      for (unsigned seed = 0; seed < sets; ++seed) {
        const auto set = draw(count, load, seed);
        std::span<const analysis::Explained> results;
        all += best_of(20, [&] { results = solver->analyse(set, {}); }) / sets;
        in_time += static_cast<std::size_t>(
            std::count_if(results.begin(), results.end(), [](const auto& r) { return r.ok(); }));
      }
      std::printf("%9zu %8.2f %16.1f %12.3f %9.1f%%\n", count, load, all, all / static_cast<double>(count),
                  100 * static_cast<double>(in_time) / static_cast<double>(count * sets));
    }
  std::unique_ptr<const can::WorstBits> table;
  const double build = best_of(5, [&] { table = std::make_unique<const can::WorstBits>(); });
  unsigned long sum = 0;
  const double ask = best_of(5, [&] {
    for (std::uint32_t id = 0; id <= can::max_base_id; ++id) sum += table->bits(id, can::Format::base, 8);
  });
  std::printf("exact frame lengths: table %.1f us, one identifier %.3f us\n", build, ask / 2048);
  return sum == 0 ? 1 : 0;
}
