#include "cli/command/traffic.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "ocm/analysis/utilisation.hpp"
#include "ocm/can/length.hpp"
#include "ocm/can/text.hpp"

#include "cli/shared/messages.hpp"

namespace ocm::cli {
namespace {

using analysis::Message;
using client::Meaning;

std::string name_of(const protocol::FrameRef& ref) {
  const auto& frame = ref.layout();
  return frame.name.empty() ? std::string{ref.topic->name}
                            : fmt::format("{}/{}", ref.topic->name, frame.name);
}

}  // namespace

void Traffic::take(const can::Received& received) {
  const auto reception = receiver_.take(received);
  diagnosis_.take(reception);
  // A request comes once, when a person types it.
  if (reception.meaning == Meaning::error || reception.meaning == Meaning::request) return;
  const std::uint32_t key = can::arbitration_key(received.frame);
  auto [place, is_new] = heard_.try_emplace(key);
  Heard& heard = place->second;
  if (is_new) {
    heard.first = received.time;
    heard.frame = received.frame;
  }
  if (!heard.ref && reception.meaning != Meaning::wrong_dlc) heard.ref = reception.frame;
  // Of an identifier that comes in several lengths the longest counts.
  if (received.frame.dlc > heard.frame.dlc) heard.frame = received.frame;
  heard.last = received.time;
  ++heard.count;
}

std::vector<const protocol::Topic*> Traffic::unheard(const Stream& asked) const {
  std::vector<const protocol::Topic*> all;
  for (const auto& topic : catalogue_.topics) {
    // A set point is typed once, as a request is, unless its actuator must be sent it again and again.
    if (topic.kind == protocol::Kind::actuator && topic.timeout.count() == 0) continue;
    if (&topic == asked.topic || heard_of(topic)) continue;
    if (topic.kind == protocol::Kind::actuator || !diagnosis_.is_silent(topic)) all.push_back(&topic);
  }
  return all;
}

void Traffic::fill(BusCheck& check, const Stream& asked, Unheard unheard_streams) {
  check.clear();
  for (const auto& [key, heard] : heard_) {
    if (heard.ref.topic == asked.topic) continue;
    put(check, key, bits_of(heard), period_of(heard),
        heard.ref ? heard.ref.topic->deadline : base::Duration{}, heard.ref, 0);
  }
  // What was not heard comes less often than what was; which program asked for it, at which priority, is not
  // known.
  for (const auto* topic : unheard(asked))
    if (unheard_streams == Unheard::may_be_late)
      put_stream(check, {topic, protocol::Priority::urgent, window_}, false);
    else if (diagnosis_.publishes(*topic))
      put_stream(check, {topic, topic->priority, window_}, false);
  put_stream(check, asked, true);
  // Whatever else there is, a request or what comes so seldom that it was not heard: one frame of it may be
  // on its way when another becomes due. It is the least urgent, and has no deadline.
  static_cast<void>(check.runs(
      {.cost = analysis::bits_ns(can::worst_frame_bits(can::Format::base, can::max_dlc), catalogue_.bit_rate),
       .period = std::chrono::nanoseconds{std::chrono::hours{1}}.count(),
       .key = any_other}));
}

void Traffic::fill(BoardCheck& check, const Stream& asked, Unheard unheard_streams) const {
  for (const auto& [key, heard] : heard_)
    if (heard.ref && heard.ref.topic != asked.topic)
      check.runs(*heard.ref.topic, period_of(heard), protocol::Identifier::decode(heard.frame.id).priority);
  for (const auto* topic : unheard(asked))
    if (unheard_streams == Unheard::may_be_late)
      check.runs(*topic, window_, protocol::Priority::urgent);
    else if (diagnosis_.publishes(*topic))
      check.runs(*topic, window_, topic->priority);
  check.runs(*asked.topic, asked.period, asked.priority);
}

unsigned Traffic::bits_of(const Heard& heard) {
  if (heard.ref)
    return protocol::worst_bits(heard.ref.layout(), protocol::Identifier::decode(heard.frame.id).priority);
  return can::worst_frame_bits(heard.frame.format, heard.frame.dlc);
}

/// What came n times in a window comes at most every (n + 1)th part of it, if it comes regularly, whatever
/// delayed it here; and where there are two or more, as often as they came.
base::Duration Traffic::period_of(const Heard& heard) const {
  const base::Duration bound = window_ / (heard.count + 1);
  return heard.count < 2 ? bound : std::max(bound, (heard.last - heard.first) / (heard.count - 1));
}

bool Traffic::heard_of(const protocol::Topic& topic) const {
  return std::any_of(heard_.begin(), heard_.end(),
                     [&topic](const auto& entry) { return entry.second.ref.topic == &topic; });
}

void Traffic::put_stream(BusCheck& check, const Stream& stream, bool asked) {
  for (std::size_t i = 0; i < stream.topic->frames.size(); ++i) {
    const auto& frame = stream.topic->frames[i];
    const std::uint32_t id =
        protocol::identifier_of({stream.topic, static_cast<std::uint8_t>(i)}, stream.priority);
    put(check, can::arbitration_key({.id = id, .format = protocol::format_of(frame)}),
        protocol::worst_bits(frame, stream.priority), stream.period, stream.topic->deadline,
        {stream.topic, static_cast<std::uint8_t>(i)}, id, asked);
  }
}

void Traffic::put(BusCheck& check, std::uint32_t key, unsigned bits, base::Duration period,
                  base::Duration deadline, const protocol::FrameRef& ref, std::uint32_t id, bool asked) {
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

}  // namespace ocm::cli
