// The error model E(t) against the simulated bus with a disturbed wire, which shares no formula with it.
//
// For each message of a random set the critical instant is played, and each fault that the model allows hits
// the worst there is: the last bit of the longest frame of the level, as soon as one is under way, with error
// flags as long as they can be. And releases, contents and faults at random. What is simulated must never
// exceed what is predicted, and must come so near that analyses which leave something out are caught.
// OCM_EXPLORE=100 plays 80,000 sets.
#include <algorithm>
#include <iostream>

#include <catch2/catch.hpp>

#include "ocm/analysis/can_response.hpp"

#include "unit/analysis/random_bus.hpp"
#include "unit/base/explore.hpp"

namespace analysis_can_response_errors_test {

using namespace ocm;
using namespace ocm::analysis;
using simulation::Disturbance;
using test::Formulas;
using test::RandomSet;
using test::Twister;

/// A node stays error active through 15 faults of its own; what error passive ones do is not in the model.
constexpr std::size_t most_faults = 15;

/// The model, fault by fault: from any one on, `burst` at once and one more each `every`.
class Faults {
 public:
  explicit Faults(const ErrorModel& model) : model_(model) {}

  /// The earliest bit at which the next one may be; never: none any more.
  [[nodiscard]] std::int64_t earliest() const {
    const std::size_t n = at_.size();
    const auto burst = static_cast<std::size_t>(model_.burst);
    if (n >= most_faults || (model_.every == 0 && n >= burst)) return unbounded;
    std::int64_t bit = at_.empty() ? 0 : at_.back().bit() + 1;
    for (std::size_t first = 0; first + burst <= n; ++first)
      bit = std::max(bit, at_[first].bit() + static_cast<std::int64_t>(n - first + 1 - burst) * model_.every);
    return bit;
  }
  void add(std::int64_t bit, unsigned flag_bits) {
    REQUIRE(bit >= earliest());
    at_.push_back({{static_cast<std::uint64_t>(bit), flag_bits}});
  }
  [[nodiscard]] std::size_t size() const { return at_.size(); }
  [[nodiscard]] std::vector<Disturbance> disturbances() const { return {at_.begin(), at_.end()}; }

 private:
  struct Fault : Disturbance {
    [[nodiscard]] std::int64_t bit() const { return static_cast<std::int64_t>(boundary); }
  };
  ErrorModel model_;
  std::vector<Fault> at_;
};

/// Every third set has a burst only; otherwise faults take up to 80 % of what the messages leave.
ErrorModel random_model(const RandomSet& set, Twister& random) {
  ErrorModel model;
  model.burst = 1 + static_cast<std::int64_t>(random() % 4);
  if (random() % 3 == 0) return model;
  double left = 1;
  std::int64_t longest = 0;
  for (const Message& message : set.messages) {
    left -= static_cast<double>(message.cost) / static_cast<double>(message.period);
    longest = std::max(longest, message.cost);
  }
  const double share = std::uniform_real_distribution{0.1, 0.8}(random);
  model.every =
      static_cast<std::int64_t>(static_cast<double>(error_frame_bits + longest) / (share * left)) + 1;
  return model;
}

struct Played {
  std::int64_t response = 0;
  std::size_t faults = 0;
};

/// Longest response of m at its critical instant, where each fault hits the longest frame of the level as
/// soon as it may. The run is played again for each: what comes before a fault does not change by it.
Played worst_run(const RandomSet& set, std::size_t m, const ErrorModel& model, std::int64_t horizon) {
  const auto releases = test::critical_releases(set, m, horizon);
  std::int64_t longest = 0;
  for (std::size_t k = 0; k <= m; ++k) longest = std::max(longest, set.messages[k].cost);
  Faults faults{model};
  for (;;) {
    const std::int64_t earliest = std::max(faults.earliest(), test::critical_start);
    std::int64_t hit = unbounded;
    const auto watch = [&](const simulation::Delivery& delivery) {
      const auto last_bit = static_cast<std::int64_t>(delivery.end) - 1;
      if (delivery.from.index <= m && set.messages[delivery.from.index].cost == longest &&
          last_bit >= earliest && static_cast<std::int64_t>(delivery.start) >= test::critical_start)
        hit = std::min(hit, last_bit);
    };
    const auto responses = test::play(set, releases, {.disturbances = faults.disturbances(), .watch = watch});
    if (hit == unbounded) return {responses[m], faults.size()};
    faults.add(hit, simulation::longest_flag_bits);
  }
}

/// Bursts and single faults, anywhere in the run or just before it.
std::vector<Disturbance> random_faults(const ErrorModel& model, Twister& random, std::int64_t horizon) {
  Faults faults{model};
  const std::int64_t spread = 1 + horizon / 8;
  std::int64_t bit = test::critical_start - 300;
  while ((bit = std::max(bit, faults.earliest())) != unbounded) {
    if (random() % 3 != 0) bit += static_cast<std::int64_t>(random()) % (random() % 2 == 0 ? 150 : spread);
    if (bit > test::critical_start + horizon) break;
    faults.add(bit, 6 + static_cast<unsigned>(random() % 7));
  }
  return faults.disturbances();
}

TEST_CASE("CAN: simulated with faults never exceeds predicted with E(t); mutants of E(t) are caught") {
  Twister random{31};
  CanResponse<8> analysis;
  std::int64_t messages = 0, faults = 0, within_a_frame = 0, reached = 0, reached_at_20 = 0;
  struct Mutant {
    const char* name;
    std::int64_t caught = 0;
  };
  std::array<Mutant, 6> mutants{{{"without E(t)"},
                                 {"the burst only"},
                                 {"no repetition"},
                                 {"repetition of its own frame only"},
                                 {"error frames of 17 bits"},
                                 {"error frames of 19 bits"}}};
  const int rounds = test::explored(800, 200);
  for (int round = 0; round < rounds; ++round) {
    const RandomSet set = test::random_set(random);
    const ErrorModel model = random_model(set, random);
    const auto results = analysis.analyse(set.messages, {.bit = 1, .errors = model});
    std::int64_t horizon = 20'000;
    for (std::size_t m = 0; m < set.messages.size(); ++m) {
      const Explained& result = results[m];
      CAPTURE(round, m, model.burst, model.every);
      REQUIRE(result.bounded());
      horizon = std::min<std::int64_t>(std::max(horizon, 2 * result.response), 100'000);
      const std::int64_t busy = static_cast<std::int64_t>(result.instances) * set.messages[m].period;
      const auto [simulated, hits] = worst_run(set, m, model, std::min<std::int64_t>(busy + 1, 50'000));
      REQUIRE(simulated <= result.response);
      // Flags of 12 and a delimiter of 8: C has the intermission, and no node is error passive here.
      const std::int64_t at_20 = test::by_the_paper(set.messages, m, {.errors = model, .error_frame = 20});
      REQUIRE(simulated <= at_20);

      ++messages;
      faults += static_cast<std::int64_t>(hits);
      std::int64_t longest = 0;
      for (std::size_t k = 0; k <= m; ++k) longest = std::max(longest, set.messages[k].cost);
      within_a_frame += result.response - simulated <= longest ? 1 : 0;
      reached += result.response - simulated <= 1 + 11 * static_cast<std::int64_t>(hits) ? 1 : 0;
      reached_at_20 += at_20 - simulated <= 1 ? 1 : 0;
      const std::array<Formulas, 6> wrong{{{},
                                           {.errors = {.burst = model.burst}},
                                           {.errors = model, .repetition = false},
                                           {.errors = model, .longest_repeated = false},
                                           {.errors = model, .error_frame = 17},
                                           {.errors = model, .error_frame = 19}}};
      for (std::size_t i = 0; i < wrong.size(); ++i)
        mutants[i].caught += simulated > test::by_the_paper(set.messages, m, wrong[i]) ? 1 : 0;
    }
    const auto longest =
        test::play(set, test::random_releases(set, random, horizon),
                   {.contents = &random, .disturbances = random_faults(model, random, horizon)});
    for (std::size_t m = 0; m < set.messages.size(); ++m) {
      CAPTURE(round, m, model.burst, model.every);
      REQUIRE(longest[m] <= results[m].response);
      const auto at_random = test::play(set, test::critical_releases(set, m, 5'000),
                                        {.disturbances = random_faults(model, random, 2'000)});
      REQUIRE(at_random[m] <= results[m].response);
    }
  }
  std::cout << "  " << messages << " messages, " << faults << " faults: within one frame " << within_a_frame
            << ", within 11 bits a fault " << reached << ", with 20 bits an error within one bit "
            << reached_at_20 << "; caught";
  for (const Mutant& mutant : mutants) std::cout << ' ' << mutant.name << ' ' << mutant.caught << ',';
  std::cout << '\n';
  for (const Mutant& mutant : mutants) {
    CAPTURE(mutant.name);
    CHECK(mutant.caught > 0);
  }
}

}  // namespace analysis_can_response_errors_test
