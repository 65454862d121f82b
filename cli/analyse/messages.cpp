/// Plain messages as entries of a set: what their spec says of when they are sent becomes a period, and what
/// it does not say is counted.
#include <algorithm>
#include <array>
#include <set>
#include <string>

#include <fmt/format.h>

#include "ocm/analysis/sending.hpp"
#include "ocm/base/decimal.hpp"
#include "ocm/j1939/identifier.hpp"

#include "cli/analyse/set.hpp"

namespace ocm::cli::analyse {
namespace {

/// Letters alone, in lower case: files write "CyclicAndSpontaneous", "cyclic_and_spontaneous" and others.
std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') out += static_cast<char>(c - 'A' + 'a');
    if (c >= 'a' && c <= 'z') out += c;
  }
  return out;
}

template <std::size_t N>
bool has_one_of(std::string_view name, const std::array<std::string_view, N>& words) {
  return std::any_of(words.begin(), words.end(),
                     [name](std::string_view word) { return name.find(word) != std::string_view::npos; });
}

/// What the names of GenMsgSendType and GenSigSendType mean, which each file defines itself.
bool sends_on_events(std::string_view type) {
  static constexpr std::array<std::string_view, 8> words{"spontan", "event",   "trigger", "onchange",
                                                         "onwrite", "sporadi", "request", "demand"};
  const std::string name = plain(type);
  return has_one_of(name, words) || name == "ce";  // cyclic and event
}
/// While a signal has a certain value, or a few times after an event: by GenMsgCycleTimeFast.
bool sends_faster(std::string_view type) {
  static constexpr std::array<std::string_view, 2> words{"active", "repeti"};
  const std::string name = plain(type);
  return has_one_of(name, words) || name == "ca";
}

std::string_view attribute(const std::vector<spec::AttributeModel>& attributes, std::string_view name) {
  for (const spec::AttributeModel& each : attributes)
    if (each.name == name) return each.text;
  return {};
}
/// 0: none, or no time.
std::int64_t milliseconds(const std::vector<spec::AttributeModel>& attributes, std::string_view name) {
  const auto number = base::parse_decimal(attribute(attributes, name));
  if (!number) return 0;
  const auto ns = base::divide_rounded(*number, base::Decimal{1, -6});
  return ns ? std::max<std::int64_t>(*ns, 0) : 0;
}

analysis::Sending sending_of(const spec::MessageModel& message) {
  analysis::Sending sending;
  sending.cycle = message.period.count();
  sending.delay = message.shortest_period.count();
  sending.events = sends_on_events(message.send_type);
  bool faster = sends_faster(message.send_type);
  for (const spec::FieldModel& field : message.fields) {
    const std::string_view type = attribute(field.attributes, "GenSigSendType");
    if (type.empty()) continue;
    sending.events = sending.events || sends_on_events(type);
    faster = faster || sends_faster(type);
  }
  if (faster) sending.fast_cycle = milliseconds(message.attributes, "GenMsgCycleTimeFast");
  return sending;
}

can::AnyFrame head_of(const spec::MessageModel& message) {
  can::AnyFrame head;
  head.id = message.address.number;
  head.format = message.address.extended ? can::Format::extended : can::Format::base;
  head.length = static_cast<std::uint8_t>(message.length);
  if (!message.fd) return head;
  head.length = can::fd_length(can::fd_dlc(message.length));  // the frame that it is sent in
  head.flags = can::frame_flag::fd;
  if (attribute(message.attributes, "CANFD_BRS") != "0") head.flags |= can::frame_flag::bit_rate_switch;
  return head;
}

}  // namespace

std::string_view key_of(LeftOut::Reason reason) {
  constexpr std::string_view keys[] = {"no_period", "no_distance", "events", "transport_protocol",
                                       "too_long"};
  return keys[static_cast<std::size_t>(reason)];
}
std::string_view text_of(LeftOut::Reason reason) {
  constexpr std::string_view texts[] = {
      "no cycle time and no shortest distance", "sent on events, without a shortest distance",
      "in the set by the cycle, not with what they send on events",
      "transport protocol of J1939: several frames each", "longer than any frame"};
  return texts[static_cast<std::size_t>(reason)];
}

std::optional<BusEntry> entry_of(const spec::MessageModel& message, std::string_view sender,
                                 std::int64_t period, std::vector<LeftOut>& left_out) {
  using Reason = LeftOut::Reason;
  const auto leave = [&](Reason reason) { left_out.push_back({message.name, reason}); };
  if (!message.fd && message.length > can::max_dlc) {
    leave(message.is_j1939() ? Reason::transport_protocol : Reason::too_long);
    return std::nullopt;
  }
  const analysis::Sending sending = sending_of(message);
  analysis::Distance distance = analysis::distance_of(sending);
  if (period > 0) distance = {period, true, distance.on_grid};
  if (distance.shortest == 0) {
    leave(sending.events ? Reason::no_distance : Reason::no_period);
    return std::nullopt;
  }
  if (!distance.covers_all) leave(Reason::events);
  BusEntry entry;
  entry.name = message.name;
  entry.head = head_of(message);
  if (message.is_j1939())
    entry.any_id = j1939::is_pdu1(j1939::pgn_of(message.address.number)) ? 0xFFFF : 0xFF;
  entry.period = distance.shortest;
  if (message.deadline.count() > 0) entry.deadline = message.deadline.count();
  entry.overwritten = true;
  entry.jitter = message.jitter.count();
  entry.node = sender;
  entry.sporadic = !distance.on_grid;
  if (distance.on_grid) entry.offset = milliseconds(message.attributes, "GenMsgStartDelayTime");
  return entry;
}

void limit_clocks(BusSet& set) {
  std::set<std::string_view> nodes;
  std::size_t clocks = 0;
  bool any = false;
  for (BusEntry& entry : set.entries) {
    if (entry.node.empty()) entry.offset = 0;  // of a clock of its own
    any = any || entry.offset > 0;
    if (entry.node.empty() || entry.sporadic || nodes.insert(entry.node).second) ++clocks;
  }
  if (!any || clocks <= most_clocks) return;
  for (BusEntry& entry : set.entries) entry.offset = 0;
  set.remarks.push_back(fmt::format(
      "The start delays do not count: there are {} clocks, of {} at most. The bounds are safe without them.",
      clocks, most_clocks));
}

}  // namespace ocm::cli::analyse
