#include "cli/command/bus_admission.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "ocm/analysis/bus_check.hpp"
#include "ocm/analysis/utilisation.hpp"
#include "ocm/can/length.hpp"
#include "ocm/can/text.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/shared/interrupt.hpp"
#include "cli/shared/live.hpp"
#include "cli/shared/values.hpp"
#include "cli/words/quantity.hpp"

namespace ocm::cli {
namespace {

using analysis::Explained;
using analysis::Message;
using client::Meaning;
using words::to_text;

/// More than any robot of this protocol has at a time: its boards have 256 numbers.
constexpr std::size_t most_identifiers = 512;
using BusCheck = analysis::BusCheck<most_identifiers>;

/// An analysis that takes longer than some tens of milliseconds is not waited for: it counts as a miss.
constexpr analysis::Limits limits{.terms = 1'000'000};

/// What a stream is asked for, by whom.
struct Wish {
  const protocol::Topic* topic = nullptr;
  protocol::Priority priority = protocol::default_priority;
  base::Duration period{};
};

std::optional<Wish> wish_of(const client::Command& command) {
  if (command.answers == nullptr || command.frames.size() != 1) return {};
  const auto request = protocol::decode_request(command.frames[0]);
  if (!request || request->mode != protocol::Mode::publish) return {};
  const bool named = command.frames[0].dlc > 1;
  return Wish{command.answers, request->priority,
              named ? request->period.duration() : command.answers->period.duration()};
}

std::string name_of(const protocol::FrameRef& ref) {
  const auto& frame = ref.layout();
  return frame.name.empty() ? std::string{ref.topic->name}
                            : fmt::format("{}/{}", ref.topic->name, frame.name);
}

/// What is on the bus, as it was heard.
class Traffic {
 public:
  explicit Traffic(const protocol::Catalogue& catalogue)
      : catalogue_(catalogue), receiver_(catalogue), diagnosis_(catalogue) {}

  void take(const can::Received& received) {
    const auto reception = receiver_.take(received);
    diagnosis_.take(reception);
    // A request comes once, when somebody types it.
    if (reception.meaning == Meaning::error || reception.meaning == Meaning::request) return;
    const std::uint32_t key = can::arbitration_key(received.frame);
    auto [place, is_new] = heard_.try_emplace(key);
    Heard& heard = place->second;
    if (is_new) {
      heard.first = received.time;
      heard.frame = received.frame;
      if (reception.meaning != Meaning::wrong_dlc) heard.ref = reception.frame;
    }
    // Of an identifier that comes in several lengths the longest counts.
    if (received.frame.dlc > heard.frame.dlc) heard.frame = received.frame;
    heard.last = received.time;
    ++heard.count;
  }

  /// Hands all that runs besides `wish` to `check`. `window`: how long was listened.
  void fill(BusCheck& check, base::Duration window, const Wish& wish) {
    for (const auto& [key, heard] : heard_) {
      if (heard.ref.topic == wish.topic) continue;
      put(check, key, bits_of(heard), period_of(heard, window),
          heard.ref ? heard.ref.topic->deadline : base::Duration{}, heard.ref, 0);
    }
    // What a status names and was not heard comes less often than what was.
    for (const auto& topic : catalogue_.topics)
      if (&topic != wish.topic && diagnosis_.publishes(topic) && !heard_of(topic))
        put_stream(check, {&topic, topic.priority, window}, false);
    put_stream(check, wish, true);
    // Whatever else there is, a request or what comes so seldom that it was not heard: one frame of it may be
    // on its way when another wants to be. It goes after all, and nobody asks when it arrives.
    static_cast<void>(
        check.runs({.cost = analysis::bits_ns(can::worst_frame_bits(can::Format::base, can::max_dlc),
                                              catalogue_.bit_rate),
                    .period = std::chrono::nanoseconds{std::chrono::hours{1}}.count(),
                    .key = somebody}));
  }
  /// The key of the message that stands for everything that was not heard.
  static constexpr std::uint32_t somebody = UINT32_MAX;

  struct Line {
    std::string name;
    std::uint32_t id = 0;
    unsigned bits = 0;
  };
  [[nodiscard]] const Line& line(std::uint32_t key) const { return lines_.at(key); }
  [[nodiscard]] std::size_t identifiers() const { return heard_.size(); }

 private:
  struct Heard {
    can::Frame frame;
    protocol::FrameRef ref;
    base::Time first;
    base::Time last;
    std::int64_t count = 0;
  };

  static unsigned bits_of(const Heard& heard) {
    if (heard.ref)
      return protocol::worst_bits(heard.ref.layout(), protocol::Identifier::decode(heard.frame.id).priority);
    return can::worst_frame_bits(heard.frame.format, heard.frame.dlc);
  }
  /// What came n times in a window comes at most every (n + 1)th part of it, if it comes regularly, whatever
  /// delayed it here; and where there are two or more, as often as they came.
  static base::Duration period_of(const Heard& heard, base::Duration window) {
    const base::Duration bound = window / (heard.count + 1);
    return heard.count < 2 ? bound : std::max(bound, (heard.last - heard.first) / (heard.count - 1));
  }
  [[nodiscard]] bool heard_of(const protocol::Topic& topic) const {
    return std::any_of(heard_.begin(), heard_.end(),
                       [&topic](const auto& entry) { return entry.second.ref.topic == &topic; });
  }

  void put_stream(BusCheck& check, const Wish& stream, bool asked) {
    for (std::size_t i = 0; i < stream.topic->frames.size(); ++i) {
      const auto& frame = stream.topic->frames[i];
      const std::uint32_t id =
          protocol::Identifier{protocol::Direction::sensor, stream.priority, frame.id}.encode();
      put(check, can::arbitration_key({.id = id}), protocol::worst_bits(frame, stream.priority),
          stream.period, stream.topic->deadline, {stream.topic, static_cast<std::uint8_t>(i)}, id, asked);
    }
  }
  void put(BusCheck& check, std::uint32_t key, unsigned bits, base::Duration period, base::Duration deadline,
           const protocol::FrameRef& ref, std::uint32_t id, bool asked = false) {
    Message message;
    message.cost = analysis::bits_ns(bits, catalogue_.bit_rate);
    message.period = std::max<std::int64_t>(1, period.count());
    if (deadline.count() > 0) message.deadline = deadline.count();
    message.key = key;
    if (id == 0) id = heard_.at(key).frame.id;
    lines_[key] = {ref ? name_of(ref) : "not in the spec", id, bits};
    if (!(asked ? check.asks(message) : check.runs(message)))
      fail({fmt::format("more than {} identifiers on the bus: its load cannot be computed", most_identifiers),
            "is the bit rate right? --force sends the request without asking"});
  }

  const protocol::Catalogue& catalogue_;
  client::Receiver receiver_;
  client::Diagnosis diagnosis_;
  std::map<std::uint32_t, Heard> heard_;
  std::map<std::uint32_t, Line> lines_;
};

/// Returns how long was listened.
base::Duration listen(transport::Bus& bus, Traffic& traffic, base::Duration duration) {
  const auto begin = Live::Clock::now();
  Live{bus}.receive_or_leave(begin + duration, [&](const can::Received& received) {
    traffic.take(received);
    return true;
  });
  return Live::Clock::now() - begin;
}

/// To the microsecond, for people.
std::string us(std::int64_t ns) {
  return to_text(base::Duration{(ns + (ns < 0 ? -500 : 500)) / 1000 * 1000});
}

std::string fate(const Explained& result) {
  if (result.reason == analysis::Reason::misses_deadline)
    return fmt::format("late by {}", us(-result.slack()));
  if (result.reason == analysis::Reason::overloaded) return "never gets through";
  return result.ok() ? "in time" : "no bound found";
}

void print_table(const Traffic& traffic, BusCheck& check, const Wish& wish, base::Duration window,
                 std::uint32_t bit_rate) {
  const auto results = check.explain(wish.period.count());
  const auto messages = check.messages();
  std::size_t width = 7;
  for (const auto& message : messages)
    if (message.key != Traffic::somebody) width = std::max(width, traffic.line(message.key).name.size());
  fmt::print("{:<8}  {:<{}}  {:>9}  {:>9}  {:>4}  {:>9}  {:>9}  {}\n", "ID", "MESSAGE", width, "PERIOD",
             "DEADLINE", "BITS", "RESPONSE", "SLACK", "VERDICT");
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (messages[i].key == Traffic::somebody) continue;
    const auto& line = traffic.line(messages[i].key);
    const auto& result = results[i];
    fmt::print("{:<8}  {:<{}}  {:>9}  {:>9}  {:>4}  {:>9}  {:>9}  {}{}\n", fmt::format("{:03X}", line.id),
               line.name, width, us(messages[i].period), us(result.deadline), line.bits,
               result.bounded() ? us(result.response) : "-", result.bounded() ? us(result.slack()) : "-",
               fate(result), check.is_asked(messages[i].key) ? ", asked for" : "");
  }
  const std::int64_t load = analysis::utilisation(messages).parts_per_million();
  fmt::print("load {}.{} % of {} bit/s at worst; {} identifier{} heard within {}\n", load / 10'000,
             load / 1'000 % 10, bit_rate, traffic.identifiers(), traffic.identifiers() == 1 ? "" : "s",
             us(window.count()));
}

/// The shortest period that passes and that the wire carries; none: there is none below a minute.
std::optional<base::Duration> shortest(BusCheck& check, base::Duration refused) {
  constexpr std::int64_t ms = 1'000'000;
  std::int64_t period = 0;
  const std::int64_t finest = std::int64_t{UINT16_MAX} * 1000;
  if (refused.count() < finest) period = check.shortest(refused.count(), 1000, finest);
  if (period == 0) period = check.shortest(std::max(refused.count(), finest / ms * ms), ms, UINT16_MAX * ms);
  if (period == 0) return {};
  return base::Duration{period};
}

}  // namespace

void add_admission_options(Verb verb, AdmissionOptions& options) {
  verb.add_flag("--force", options.force, "send it even if the bus could not carry it");
  verb.add_flag("--explain", options.explain, "show what is on the bus, and how late each frame can be");
  add_duration(verb, "--listen", options.listen, "how long to listen to what runs, before asking");
}

void admit(Session& session, transport::Bus& bus, const client::Command& command,
           const AdmissionOptions& options) {
  const auto wish = wish_of(command);
  if (!wish || (options.force && !options.explain)) return;
  const auto& catalogue = session.catalogue();
  if (catalogue.bit_rate == 0) return;
  catch_interrupts();
  Traffic traffic{catalogue};
  const base::Duration window = listen(bus, traffic, options.listen);
  const auto check = std::make_unique<BusCheck>(
      analysis::CanBus{.bit = analysis::bits_ns(1, catalogue.bit_rate)}, analysis::CanTest::exact, limits);
  traffic.fill(*check, window, *wish);
  const auto decision = check->decide(wish->period.count());
  std::string who;
  if (decision.late != analysis::nobody) {
    const std::uint32_t key = check->messages()[decision.late].key;
    who = key == Traffic::somebody ? "any other frame" : traffic.line(key).name;
  }
  const bool own = decision.late != analysis::nobody && check->is_asked(check->messages()[decision.late].key);
  if (options.explain) print_table(traffic, *check, *wish, window, catalogue.bit_rate);
  if (decision.admitted || options.force) return;

  const Explained& why = decision.why;
  std::string what = fmt::format("publish: {} every {} at {} does not fit on the bus: {}{} ",
                                 wish->topic->name, to_text(wish->period), protocol::name(wish->priority),
                                 who, own ? "" : ", which runs already,");
  if (why.reason == analysis::Reason::misses_deadline)
    what += fmt::format("would miss its deadline of {} by {}", us(why.deadline), us(-why.slack()));
  else if (why.reason == analysis::Reason::overloaded)
    what += "would never get through: it and what is more urgent ask for all there is, or more";
  else
    what += std::string{analysis::describe(why.reason)};
  const auto better = shortest(*check, wish->period);
  std::string remedy = better ? fmt::format("the shortest period that passes is {}", to_text(*better))
                       : wish->priority == protocol::Priority::low
                           ? "no period passes: stop something first"
                           : "no period passes: ask at a lower priority, or stop something first";
  fail({what, remedy + "; --explain shows all, --force sends it anyway"});
}

}  // namespace ocm::cli
