#include "cli/analyse/seen_set.hpp"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "ocm/client/command.hpp"
#include "ocm/client/frame_index.hpp"
#include "ocm/client/refusal_reader.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/analyse/report.hpp"
#include "cli/shared/messages.hpp"
#include "cli/words/topics.hpp"

namespace ocm::cli::analyse {
namespace {

/// How far apart the set points of an actuator come.
class Distances {
 public:
  void add(std::int64_t time, bool rests) {
    if (last_) {
      constexpr std::int64_t period = client::hold_period.count();
      const std::int64_t distance = time - last_->time;
      if (shortest_ == 0 || distance < shortest_) shortest_ = distance;
      const bool pause = last_->rests || distance > period + period / 4;
      if (!pause) ++(distance >= period - period / 4 ? held_ : other_);
    }
    last_ = Last{time, rests};
  }
  /// 0: there was one set point.
  [[nodiscard]] std::int64_t shortest() const { return shortest_; }
  /// Another period than that of a drive is not known well enough to lay a grid by.
  [[nodiscard]] Pace pace() const {
    return held_ > other_ ? Pace{Grid::of_run, client::hold_period.count()} : Pace{Grid::none, 0};
  }

 private:
  struct Last {
    std::int64_t time;
    bool rests;
  };
  std::optional<Last> last_;
  std::int64_t shortest_ = 0;
  std::size_t held_ = 0;   ///< in a run, about as drives are repeated
  std::size_t other_ = 0;  ///< in a run, shorter ones
};

/// What a log says of the topics of a catalogue: which are sent, at which priority, and for which periods
/// they were asked.
class SeenTopics {
 public:
  explicit SeenTopics(const protocol::Catalogue& catalogue)
      : catalogue_(&catalogue), index_(catalogue), receiver_(catalogue), refusals_(catalogue) {}

  void take(const Arrival& arrival) {
    if (arrival.frame.format != can::Format::base && arrival.frame.format != can::Format::base_remote) return;
    const auto id = protocol::Identifier::decode(arrival.frame.id);
    const auto reception = receiver_.take({base::Time{base::Duration{arrival.time}}, arrival.frame});
    if (const auto refused = refusals_.take(reception)) {
      // It was never asked: the newest requests that this refusal can be of.
      const std::int64_t wait = client::RefusalReader::longest_wait(*reception.topic).count();
      auto& asked = seen_[refused->topic].asked;
      for (std::uint32_t i = 0; i < refused->count && !asked.empty(); ++i)
        if (arrival.time - asked.back().time <= wait) asked.pop_back();
    }
    if (const auto* topic = index_.requested(id)) {
      const auto request = protocol::decode_request(arrival.frame);
      const bool publishes = request && request->mode == protocol::Mode::publish;
      const auto period = arrival.frame.dlc == 1 ? topic->period : request.value.period;
      seen_[topic].asked.push_back({arrival.time, publishes ? period.duration().count() : 0});
    } else if (const auto frame = index_.find(id)) {
      Seen& its = seen_[frame.topic];
      its.priority = id.priority;
      its.sent = true;
      if (frame.frame != 0) return;
      its.distances.add(arrival.time, client::is_rest(arrival.frame));
      its.key = can::arbitration_key(arrival.frame);
    }
  }

  /// Of each topic, off where it is not in the log; remarks on those for which no rate is given.
  [[nodiscard]] std::vector<Rate> rates(std::span<const Rate> given, Paces& paces,
                                        std::vector<std::string>& remarks) const {
    std::vector<Rate> rates;
    std::vector<std::string> unsaid;
    for (const auto& topic : catalogue_->topics) {
      if (topic.is_message()) continue;
      const auto its = seen_.find(&topic);
      const bool is_given = std::any_of(given.begin(), given.end(), [&](const Rate& rate) {
        return words::find_topic(*catalogue_, rate.name) == &topic || words::is_in_group(topic, rate.name);
      });
      rates.push_back(its == seen_.end() ? Rate{}
                                         : rate(topic, its->second, paces, is_given ? unsaid : remarks));
      rates.back().name = topic.name;
      rates.back().place = "the log";
      rates.back().off = its == seen_.end() || !its->second.sent;
    }
    return rates;
  }

  /// One that says no priority leaves that of the log; the period that it gives a drive is meant.
  void complete(Rate& given, Paces& paces) const {
    const protocol::Topic* const topic = words::find_topic(*catalogue_, given.name);
    const auto its = seen_.find(topic);
    if (topic == nullptr || its == seen_.end()) return;
    if (!given.has_priority) {
      given.has_priority = its->second.sent;
      given.priority = its->second.priority;
    }
    if (topic->role == protocol::Role::drive && !given.off)
      paces[its->second.key] = {Grid::of_run, given.period.count()};
  }

 private:
  struct Asked {
    std::int64_t time = 0;
    std::int64_t period = 0;  ///< 0: none, or none that can be read
  };
  struct Seen {
    bool sent = false;
    protocol::Priority priority = protocol::default_priority;
    std::vector<Asked> asked;
    std::uint32_t key = 0;
    Distances distances;
  };

  static Rate rate(const protocol::Topic& topic, const Seen& its, Paces& paces,
                   std::vector<std::string>& remarks) {
    const std::int64_t asked = shortest_asked(topic, its.asked, remarks);
    Rate rate;
    if (!its.sent) return rate;
    rate.has_priority = true;
    rate.priority = its.priority;
    rate.period = asked != 0 ? base::Duration{asked} : topic.period.duration();
    if (topic.kind != protocol::Kind::actuator) return rate;
    const std::int64_t shortest = its.distances.shortest();
    rate.period = base::Duration{shortest > 0 ? shortest : 1'000'000'000};
    const std::string counts = time_text(rate.period.count());
    remarks.push_back(
        shortest > 0
            ? fmt::format("{} has no period of its own: the shortest distance in the log, {}, counts.",
                          topic.name, counts)
            : fmt::format("{} has no period of its own, and came once: {} counts.", topic.name, counts));
    const bool drives = topic.role == protocol::Role::drive;
    paces[its.key] = drives ? its.distances.pace() : Pace{Grid::none, 0};
    return rate;
  }

  /// 0: it was not asked for a period.
  static std::int64_t shortest_asked(const protocol::Topic& topic, std::span<const Asked> all,
                                     std::vector<std::string>& remarks) {
    std::int64_t shortest = 0;
    for (const Asked& each : all) {
      if (each.period == 0) continue;
      if (shortest != 0 && shortest != each.period)
        remarks.push_back(fmt::format("{} was asked for every {} and every {}: the shorter one counts.",
                                      topic.name, time_text(shortest), time_text(each.period)));
      if (shortest == 0 || each.period < shortest) shortest = each.period;
    }
    return shortest;
  }

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  client::Receiver receiver_;
  client::RefusalReader refusals_;
  std::map<const protocol::Topic*, Seen> seen_;
};

}  // namespace

BusSet seen_set(const Arrivals& log, const protocol::Catalogue& catalogue, const spec::Model* model,
                std::vector<Rate> given, Paces& paces) {
  SeenTopics seen{catalogue};
  for (const Arrival& arrival : log.all) seen.take(arrival);
  std::vector<std::string> remarks;
  std::vector<Rate> all = seen.rates(given, paces, remarks);
  for (Rate& rate : given) {
    seen.complete(rate, paces);
    all.push_back(std::move(rate));
  }
  const bool any = std::any_of(all.begin(), all.end(), [](const Rate& rate) { return !rate.off; }) ||
                   std::any_of(catalogue.topics.begin(), catalogue.topics.end(),
                               [](const protocol::Topic& topic) { return topic.is_message(); });
  if (!any) fail({"the log has no frame of any topic", "--set FILE.csv gives the messages of another bus"});
  BusSet set = robot_bus(catalogue, model, all);
  set.remarks = std::move(remarks);
  return set;
}

}  // namespace ocm::cli::analyse
