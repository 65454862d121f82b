#include "cli/operate/study.hpp"

#include <algorithm>
#include <memory>
#include <span>

#include <fmt/format.h>

#include "ocm/base/decimal.hpp"

#include "cli/operate/cautions.hpp"
#include "cli/operate/processors.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli::operate {
namespace {

using reflective::Doubt;
using reflective::none;
/// Of the largest operator: 32 streams of 8 frames, requests and refusals, twice in a change.
using Proof = reflective::Proof<1024>;

std::string_view name_of(const OperatorFile& file, std::uint16_t configuration) {
  return configuration == none ? std::string_view{"the start"}
                               : file.tables.configurations[configuration].name;
}

std::string place_of(const OperatorFile& file, std::uint16_t from, std::uint16_t to) {
  return from == none
             ? fmt::format("in \"{}\"", name_of(file, to))
             : fmt::format("in the change from \"{}\" to \"{}\"", name_of(file, from), name_of(file, to));
}

/// Whether the period of the doubt's stream follows a value.
bool adapts(const OperatorFile& file, const Doubt& doubt) {
  const auto& here = file.tables.configurations[doubt.configuration];
  return std::any_of(here.adaptations.begin(), here.adaptations.end(),
                     [&](const auto& each) { return here.streams[each.stream].topic == doubt.topic; });
}

spec::Problem problem_of(const OperatorFile& file, const Doubt& doubt) {
  const auto& tables = file.tables;
  const std::string of = place_of(file, doubt.from, doubt.configuration);
  const std::string& place = file.parts[doubt.configuration].of.place;
  switch (doubt.kind) {
    case Doubt::Kind::too_many:
      return {place, fmt::format("{} there are more frames than the analysis has room for", of),
              "fewer streams, or fewer others"};
    case Doubt::Kind::late: {
      const std::string topic = doubt.topic == none ? std::string{"what others send"}
                                                    : fmt::format("{}", tables.topic(doubt.topic).name);
      const std::string how =
          doubt.why.bounded()
              ? fmt::format("takes up to {}{}, its deadline is {}", milliseconds(doubt.why.response),
                            doubt.sampling == 0
                                ? std::string{}
                                : fmt::format(" ({} of it on its board)", milliseconds(doubt.sampling)),
                            milliseconds(doubt.why.deadline))
              : std::string{"has no bound: the bus is overloaded at its priority"};
      return {place, fmt::format("{} {} {}", of, topic, how),
              "longer periods, fewer streams, or a more urgent priority for it"};
    }
    case Doubt::Kind::unsettled:
      return {
          file.settle_place,
          fmt::format(
              "{} {}",
              doubt.from == none ? fmt::format("the start in \"{}\"", name_of(file, doubt.configuration))
                                 : "the change" + of.substr(std::string_view{"in the change"}.size()),
              doubt.needs == analysis::unbounded
                  ? std::string{"has no bound, and is not over within \"settle\""}
                  : fmt::format("may take {}, which is longer than \"settle\"", milliseconds(doubt.needs))),
          doubt.needs == analysis::unbounded
              ? std::string{"longer periods or fewer streams"}
              : fmt::format("\"settle\": \"{}ms\" or longer", (doubt.needs + 999'999) / 1'000'000)};
    case Doubt::Kind::restless: {
      const bool field = tables.conditions[doubt.condition].watched == reflective::Watched::field;
      return {file.condition_items[doubt.condition].place,
              fmt::format(
                  "{} the samples of {} may be {} apart, so that {}", of, tables.topic(doubt.topic).name,
                  milliseconds(doubt.needs),
                  field ? "its values go stale after three periods" : "it holds although nothing is wrong"),
              field
                  ? adapts(file, doubt)
                        ? std::string{"\"at_from\" and \"at_to\" nearer to each other, or shorter \"settle\" "
                                      "and \"reaction\""}
                        : std::string{"a longer period, or shorter \"settle\" and \"reaction\""}
                  : fmt::format("\"above\": \"{}ms\" or longer", doubt.needs / 1'000'000 + 1)};
    }
  }
  return {place, "unknown", ""};
}

/// Of the frames of one topic that are late the one that takes longest: each would be a reason of its own.
void merge(std::vector<Doubt>& doubts, const Doubt& doubt) {
  const auto same = [&](const Doubt& other) {
    return doubt.kind == Doubt::Kind::late && other.kind == doubt.kind && other.from == doubt.from &&
           other.configuration == doubt.configuration && other.topic == doubt.topic;
  };
  const auto found = std::find_if(doubts.begin(), doubts.end(), same);
  if (found == doubts.end()) return doubts.push_back(doubt);
  if (found->why.bounded() && (!doubt.why.bounded() || doubt.why.response > found->why.response))
    *found = doubt;
}

/// What the board of a stream cannot serve by its processor alone; the proof judges it together with the bus.
spec::Problem problem_of(const OperatorFile& file, std::uint16_t from, std::uint16_t to,
                         const ProcessorBound& bound) {
  const auto& topic = file.tables.topic(bound.topic);
  const auto board = file.tables.catalogue->board_name(topic);
  const std::string of = place_of(file, from, to);
  return {bound.old ? file.parts[to].of.place : file.parts[to].stream_places[bound.stream],
          bound.time.bounded()
              ? fmt::format("{} the processor of {} takes up to {} for a sample of {}, its deadline is {}",
                            of, board, milliseconds(bound.time.response), topic.name,
                            milliseconds(bound.time.deadline))
              : fmt::format("{} the processor of {} cannot serve {}: it is overloaded at its priority", of,
                            board, topic.name),
          "longer periods or fewer streams of that board, or a more urgent priority for it"};
}

/// What samples take on their boards, in each configuration and change, for the proof.
class Boards {
 public:
  explicit Boards(const OperatorFile& file) : file_(file) {
    const auto& tables = file.tables;
    const auto count = static_cast<std::uint16_t>(tables.configurations.size());
    for (std::uint16_t c = 0; c < count; ++c) add(none, c);
    for (std::uint16_t from = 0; from < count; ++from)
      for (std::uint16_t to = 0; to < count; ++to)
        if (leads(tables, from, to)) add(from, to);
  }
  static bool leads(const reflective::Operator& tables, std::uint16_t from, std::uint16_t to) {
    return std::any_of(tables.transitions.begin(), tables.transitions.end(),
                       [&](const auto& t) { return t.to == to && tables.leaves(t, from); });
  }
  [[nodiscard]] std::span<const reflective::Sampling> sampling() const { return sampling_; }
  [[nodiscard]] const std::vector<spec::Problem>& problems() const { return problems_; }
  /// Of a stream in a configuration; 0: not known.
  [[nodiscard]] std::int64_t sampling(std::uint16_t configuration, std::uint16_t topic) const {
    for (const auto& each : sampling_)
      if (each.from == none && each.configuration == configuration && each.topic == topic) return each.time;
    return 0;
  }
  /// The doubt is of what a processor alone cannot serve.
  [[nodiscard]] bool explains(const Doubt& doubt) const {
    return doubt.kind == Doubt::Kind::late && (doubt.sampling == analysis::unbounded ||
                                               (doubt.sampling != 0 && doubt.sampling > doubt.why.deadline));
  }

 private:
  void add(std::uint16_t from, std::uint16_t to) {
    for (const ProcessorBound& bound : on_processors(file_.tables, from, to)) {
      sampling_.push_back({from, to, bound.topic, bound.time.response});
      if (!bound.time.bounded() || bound.time.response > bound.time.deadline)
        problems_.push_back(problem_of(file_, from, to, bound));
    }
  }

  const OperatorFile& file_;
  std::vector<reflective::Sampling> sampling_;
  std::vector<spec::Problem> problems_;
};

}  // namespace

Study study(const OperatorFile& file, std::uint32_t bit_rate) {
  Study result;
  result.file = &file;
  result.bit_rate = bit_rate;
  const auto& tables = file.tables;
  const Boards boards{file};
  const auto proof = std::make_unique<Proof>(tables, bit_rate, boards.sampling());
  const auto count = static_cast<std::uint16_t>(tables.configurations.size());

  for (std::uint16_t c = 0; c < count; ++c) {
    ConfigurationBound bound;
    bound.load = proof->load(c);
    for (const auto& stream : tables.configurations[c].streams) {
      const auto& topic = tables.topic(stream.topic);
      const std::int64_t period = stream.period.count();
      const std::int64_t deadline =
          topic.deadline.count() == 0 ? period : std::min(period, topic.deadline.count());
      bound.streams.push_back({stream.topic, stream.period, stream.priority, proof->response(c, stream.topic),
                               deadline, boards.sampling(c, stream.topic), proof->recovery(c, stream.topic)});
      if (!is_measured(tables, stream.topic) && std::find(result.unmeasured.begin(), result.unmeasured.end(),
                                                          stream.topic) == result.unmeasured.end())
        result.unmeasured.push_back(stream.topic);
    }
    result.configurations.push_back(std::move(bound));
  }

  const auto change = [&](std::uint16_t from, std::uint16_t to) {
    result.changes.push_back({from, to, proof->settling(from, to), proof->load(from, to)});
  };
  change(none, tables.initial);
  for (std::uint16_t from = 0; from < count; ++from)
    for (std::uint16_t to = 0; to < count; ++to)
      if (Boards::leads(tables, from, to)) change(from, to);

  for (std::uint16_t t = 0; t < tables.transitions.size(); ++t) {
    const auto& transition = tables.transitions[t];
    for (std::uint16_t from = 0; from < count; ++from) {
      if (!tables.leaves(transition, from)) continue;
      const bool seen = transition.monitor == reflective::by_request ||
                        reflective::sees(tables, from, tables.monitors[transition.monitor]);
      ReactionBound reaction{
          t, from, seen, !tables.configurations[transition.to].entry.empty(), proof->latency(t, from), {}};
      if (seen && transition.monitor != reflective::by_request) {
        std::vector<std::uint16_t> looked_at;
        for (const auto& term : tables.monitors[transition.monitor].terms)
          if (term.op == reflective::Op::condition &&
              std::find(looked_at.begin(), looked_at.end(), term.condition) == looked_at.end())
            looked_at.push_back(term.condition);
        if (looked_at.size() > 1)
          for (const std::uint16_t c : looked_at) reaction.conditions.push_back(proof->latency(t, from, c));
      }
      result.reactions.push_back(std::move(reaction));
    }
  }
  result.doubts = boards.problems();
  std::vector<Doubt> doubts;
  proof->check([&](const Doubt& doubt) {
    if (!boards.explains(doubt)) merge(doubts, doubt);
  });
  for (const Doubt& doubt : doubts) {
    auto problem = problem_of(file, doubt);
    if (std::find(result.doubts.begin(), result.doubts.end(), problem) == result.doubts.end())
      result.doubts.push_back(std::move(problem));
  }
  result.cautions = cautions(file);
  return result;
}

std::string milliseconds(std::int64_t ns) {
  if (ns == analysis::unbounded) return "no bound";
  return fmt::format("{} ms", base::to_text(base::normalised(ns, -6)).view());
}

namespace {

template <class Bound>
std::string shown(const Bound& bound) {
  if (!bound.bounded) return milliseconds(analysis::unbounded);  // its parts are not all there
  std::string text;
  for (const auto& part : bound.parts())
    if (part.time != 0)
      text += fmt::format("{}{} {}", text.empty() ? " = " : " + ",
                          base::to_text(base::normalised(part.time, -6)).view(), part.name);
  return milliseconds(bound.total()) + text;
}

}  // namespace

std::string sum_of(const reflective::Latency& latency) {
  return shown(latency);
}
std::string sum_of(const reflective::Recovery& recovery) {
  return shown(recovery);
}

}  // namespace ocm::cli::operate
