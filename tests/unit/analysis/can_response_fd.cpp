// Buses that carry classic frames and CAN FD: response times by hand, and against a bus that is played here,
// in units of 100 ns, and knows neither a formula nor the longest frame: it counts the bits of each content.
#include <algorithm>
#include <array>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/analysis/can_response.hpp"
#include "ocm/can/fd_worst_bits.hpp"

#include "unit/analysis/random_bus.hpp"
#include "unit/base/explore.hpp"
#include "unit/can/longest_fd.hpp"

namespace analysis_can_response_fd_test {

using namespace ocm;
using namespace ocm::analysis;
using can::FdBits;
using can::Format;
using test::Twister;

// 500 kbit/s and 2 Mbit/s, any identifier. A frame of 64 bytes: 32 nominal bits, 678 of data, so 64 and 339
// us; one of 8 bytes classic: 135 bits, 270 us; one of 8 bytes FD: 32 and 113 bits, 64 and 56.5 us.
constexpr std::int64_t long_fd = bits_ns(can::fd_worst_bits(Format::base, 64, true), 500'000, 2'000'000);
constexpr std::int64_t short_fd = bits_ns(can::fd_worst_bits(Format::base, 8, true), 500'000, 2'000'000);
constexpr std::int64_t classic = bits_ns(can::worst_frame_bits(Format::base, 8), 500'000);
static_assert(long_fd == 64'000 + 339'000 && short_fd == 64'000 + 56'500 && classic == 270'000);

TEST_CASE("CAN FD: three messages by hand") {
  const std::array<Message, 3> set{{{.cost = short_fd, .period = 1'000'000, .key = 1},
                                    {.cost = classic, .period = 1'000'000, .key = 2},
                                    {.cost = long_fd, .period = 1'000'000, .key = 3}}};
  CanResponse<3> analysis;
  const auto results = analysis.analyse(set, {.bit = 2'000});
  // The first waits for the third, the second for both, the third for the two above it: 793.5 us in all, so
  // that none comes twice.
  CHECK(results[0].response == long_fd + short_fd);
  CHECK(results[1].response == long_fd + short_fd + classic);
  CHECK(results[2].response == short_fd + classic + long_fd);
}

struct Kind {
  can::AnyFrame frame;  ///< of any content
  std::int64_t bit = 0;
  std::int64_t data_bit = 0;
  [[nodiscard]] std::int64_t ticks(const FdBits& bits) const {
    return bits.nominal * bit + bits.data * data_bit;
  }
  [[nodiscard]] FdBits bits() const {
    const FdBits plain =
        frame.is_fd() ? can::fd_frame_bits(frame) : FdBits{can::frame_bits(*frame.classic()), 0};
    return {plain.nominal + can::intermission_bits, plain.data};
  }
  [[nodiscard]] bool switches() const { return (frame.flags & can::frame_flag::bit_rate_switch) != 0; }
  [[nodiscard]] FdBits worst() const {
    if (frame.is_fd()) return can::fd_worst_bits(frame.id, frame.format, frame.length, switches());
    return {test::worst_bits().bits(frame.id, frame.format, frame.length), 0};
  }
};

struct FdSet {
  std::vector<Message> messages;
  std::vector<Kind> kinds;
  std::int64_t bit = 0;
};

FdSet random_fd_set(Twister& random) {
  FdSet set;
  set.bit = random() % 2 == 0 ? 20 : 10;  // 500 kbit/s, 1 Mbit/s
  const std::int64_t data_bit = std::array<std::int64_t, 3>{2, 5, set.bit}[random() % 3];
  const std::size_t count = 2 + random() % 6;
  const double load = std::uniform_real_distribution{0.3, 0.97}(random);
  std::uint32_t id = random() % 64;
  for (std::size_t i = 0; i < count; ++i) {
    Kind kind;
    kind.bit = set.bit;
    kind.data_bit = data_bit;
    kind.frame.id = id;
    const bool fd = random() % 3 != 0;
    kind.frame.length = fd ? can::fd_length(random() % 16) : static_cast<std::uint8_t>(random() % 9);
    if (fd) kind.frame.flags = static_cast<std::uint8_t>(can::frame_flag::fd | (random() % 4 != 0 ? 1 : 0));
    Message m;
    m.cost = kind.ticks(kind.worst());
    m.period =
        static_cast<std::int64_t>(static_cast<double>(m.cost * static_cast<std::int64_t>(count)) / load) + 1;
    m.deadline = m.period;
    m.key = id;
    set.messages.push_back(m);
    set.kinds.push_back(kind);
    id += 1 + static_cast<std::uint32_t>(random() % 200);
  }
  return set;
}

/// The longest data that there is, or any.
void fill(can::AnyFrame& frame, bool longest, Twister& random) {
  if (frame.is_fd()) frame.flags = static_cast<std::uint8_t>((frame.flags & ~2U) | (random() % 2) << 1);
  if (longest && !frame.is_fd()) {
    const auto witness = test::worst_bits().witness(frame.id, frame.format, frame.length);
    std::copy(witness.data.begin(), witness.data.end(), frame.data.begin());
    return;
  }
  for (std::size_t i = 0; i < frame.length; ++i) frame.data[i] = static_cast<std::uint8_t>(random());
  if (longest) frame = test::with_longest_data(frame);
}

struct Handover {
  std::int64_t at = 0;
  std::size_t message = 0;
};

/// Each message's longest response. A message that waits during the first bit of an arbitration takes part in
/// it.
std::vector<std::int64_t> play(const FdSet& set, std::vector<Handover> handovers, bool longest_data,
                               Twister& random) {
  std::vector<std::int64_t> longest(set.kinds.size(), 0);
  std::int64_t now = 0;
  while (!handovers.empty()) {
    const auto first = std::min_element(handovers.begin(), handovers.end(),
                                        [](const auto& a, const auto& b) { return a.at < b.at; });
    now = std::max(now, first->at);
    auto winner = handovers.end();
    for (auto it = handovers.begin(); it != handovers.end(); ++it) {
      if (it->at > now && it->at >= now + set.bit) continue;
      if (winner == handovers.end() || it->message < winner->message ||
          (it->message == winner->message && it->at < winner->at))
        winner = it;
    }
    Kind kind = set.kinds[winner->message];
    fill(kind.frame, longest_data, random);
    now += kind.ticks(kind.bits());
    longest[winner->message] = std::max(longest[winner->message], now - winner->at);
    handovers.erase(winner);
  }
  return longest;
}

/// All down to m at once, just after the longest below it has begun; or at any phases.
std::vector<Handover> critical(const FdSet& set, std::size_t m, std::int64_t horizon) {
  std::vector<Handover> all;
  for (std::size_t k = 0; k <= m; ++k)
    for (std::int64_t at = set.bit; at <= set.bit + horizon; at += set.messages[k].period)
      all.push_back({at, k});
  std::size_t below = m;
  for (std::size_t k = m + 1; k < set.messages.size(); ++k)
    if (below == m || set.messages[k].cost > set.messages[below].cost) below = k;
  if (below != m) all.push_back({0, below});
  return all;
}
std::vector<Handover> anyhow(const FdSet& set, std::int64_t horizon, Twister& random) {
  std::vector<Handover> all;
  for (std::size_t k = 0; k < set.messages.size(); ++k)
    for (std::int64_t at = static_cast<std::int64_t>(random()) % set.messages[k].period; at < horizon;
         at += set.messages[k].period + (random() % 8 == 0 ? static_cast<std::int64_t>(random()) % 500 : 0))
      all.push_back({at, k});
  return all;
}

/// The response by the exact test, of costs that forget something.
template <class Cost>
std::int64_t response_with(const FdSet& set, std::size_t m, Cost cost) {
  std::vector<Message> messages = set.messages;
  for (std::size_t k = 0; k < messages.size(); ++k) messages[k].cost = set.kinds[k].ticks(cost(set.kinds[k]));
  static CanResponse<8> analysis;
  const Explained result = analysis.analyse(messages, {.bit = set.bit})[m];
  return result.bounded() ? result.response : unbounded;
}

TEST_CASE("CAN FD: played never exceeds predicted, comes close, and finds costs that forget something") {
  Twister random{2015};
  CanResponse<8> analysis;
  int messages = 0;
  int close = 0;
  std::array<int, 5> caught{};
  const int rounds = test::explored(600, 150);
  for (int round = 0; round < rounds; ++round) {
    const FdSet set = random_fd_set(random);
    const auto results = analysis.analyse(set.messages, {.bit = set.bit});
    const std::vector<Explained> said{results.begin(), results.end()};
    std::int64_t horizon = 20'000;
    for (std::size_t m = 0; m < said.size(); ++m) {
      CAPTURE(round, m);
      if (!said[m].bounded()) continue;
      const std::int64_t busy = static_cast<std::int64_t>(said[m].instances) * set.messages[m].period;
      const std::int64_t played = play(set, critical(set, m, busy), true, random)[m];
      REQUIRE(played <= said[m].response);
      ++messages;
      close += said[m].response - played <= 2 * set.bit ? 1 : 0;
      const auto forgets = [&](std::size_t which, auto cost) {
        caught[which] += played > response_with(set, m, cost) ? 1 : 0;
      };
      forgets(0, [](const Kind& kind) {  // stuff bits of the data
        FdBits bits = kind.worst();
        unsigned& part = kind.switches() ? bits.data : bits.nominal;
        if (kind.frame.is_fd()) part -= kind.frame.length * 2U;
        return bits;
      });
      forgets(1, [](const Kind& kind) {  // the bits at the nominal rate: all at that of the data
        const FdBits bits = kind.worst();
        return kind.switches() ? FdBits{0, bits.nominal + bits.data} : bits;
      });
      forgets(2, [](const Kind& kind) {  // the longer CRC of more than 16 bytes, and its stuff bits
        FdBits bits = kind.worst();
        if (kind.frame.is_fd() && kind.frame.length > 16) (kind.switches() ? bits.data : bits.nominal) -= 5;
        return bits;
      });
      forgets(3, [](const Kind& kind) {  // CAN FD as if it were classic: 8 bytes at the nominal rate
        return kind.frame.is_fd() ? FdBits{can::worst_frame_bits(Format::base, 8), 0} : kind.worst();
      });
      forgets(4, [](const Kind& kind) {  // the intermission
        const FdBits bits = kind.worst();
        return FdBits{bits.nominal - 3, bits.data};
      });
      horizon = std::min<std::int64_t>(std::max(horizon, 2 * said[m].response), 200'000);
    }
    const auto played = play(set, anyhow(set, horizon, random), false, random);
    for (std::size_t m = 0; m < said.size(); ++m)
      if (said[m].bounded()) REQUIRE(played[m] <= said[m].response);
  }
  CAPTURE(messages, close, caught[0], caught[1], caught[2], caught[3], caught[4]);
  CHECK(messages > 2 * rounds);
  CHECK(close > messages * 9 / 10);
  for (const int times : caught) CHECK(times > messages / 3);
}

}  // namespace analysis_can_response_fd_test
