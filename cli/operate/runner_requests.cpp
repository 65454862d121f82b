// What other programs ask of an operator that runs: what it does and why, another configuration, a set point.
#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ocm/can/text.hpp"
#include "ocm/measure/bus_load.hpp"
#include "ocm/protocol/identifier.hpp"

#include "cli/operate/runner.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/operator_link.hpp"
#include "cli/shared/set_points.hpp"
#include "cli/words/value.hpp"

namespace ocm::cli::operate {
namespace {

/// "motors.x to at most 0.02 m/s": what a configuration makes of a field for which more was asked.
std::string limit_text(std::span<const reflective::Limit> limits, const protocol::Topic& topic,
                       std::uint16_t number, std::size_t field, std::int64_t asked) {
  const auto& layout = topic.frames[0].fields[field];
  const std::string name = fmt::format("{}.{}", topic.name, layout.name);
  const auto with_unit = [&](std::int64_t raw) {
    return fmt::format("{}{}{}", words::physical_text(layout, raw), layout.unit.empty() ? "" : " ",
                       layout.unit);
  };
  for (const reflective::Limit& limit : limits) {
    if (limit.topic != number || limit.field != field) continue;
    if (asked > limit.max) return fmt::format("{} to at most {}", name, with_unit(limit.max));
    if (asked < limit.min) return fmt::format("{} to at least {}", name, with_unit(limit.min));
    return fmt::format("the change of {} to {} in a second", name, with_unit(limit.per_second));
  }
  return name;
}

}  // namespace

std::string Runner::answer(Caller& caller, std::string_view request) {
  const auto line = [](const Json& json) { return json.line() + "\n"; };
  if (request == "status") return yes(answers().status(now()));
  if (request == "status json") return yes(line(answers().status_json(now())));
  if (request == "why") return yes(answers().why());
  if (request == "why json") return yes(line(answers().why_json()));
  if (request == operator_ways) return yes(answers().ways());
  if (request == "hold") return hold(caller, true);
  if (request == "resume") return hold(caller, false);
  if (request == "delivery") {
    const auto delivery = bus_->delivery();
    if (!delivery.obstruction.what.empty()) return no(delivery.obstruction.what, delivery.obstruction.remedy);
    if (!delivery.known) return yes("unknown");
    // What was handed over behind this program's last frame is none of its frames.
    const std::uint64_t behind = handed_over_ - caller.handed_over;
    return yes(std::to_string(delivery.pending > behind ? delivery.pending - behind : 0));
  }
  if (request.starts_with(operator_commands)) return commands(request.substr(operator_commands.size()));
  constexpr std::string_view switches = "switch ", sends = "send ";
  if (request.starts_with(switches)) return switch_to(caller, request.substr(switches.size()));
  if (request.starts_with(sends)) return pass_on(caller, request.substr(sends.size()));
  return no("that is no request to an operator", "status, why, switch, hold, resume");
}

void Runner::look_at_socket(base::Time at) {
  constexpr base::Duration every{200'000'000};
  look_at_socket_at_ = at + every;
  if (control_->is_found()) return;
  const auto back = control_->return_to_path();
  if (back) {
    is_found_ = true;
    return tell("socket", {{"found", true}},
                "its socket was removed, and is there again: what programs commanded meanwhile went past it");
  }
  if (!is_found_) return;
  is_found_ = false;
  tell(
      "socket", {{"found", false}, {"problem", back.error.what}},
      fmt::format("its socket was removed, so that what programs command goes past it: {}", back.error.what));
}

std::string Runner::switch_to(const Caller& caller, std::string_view name) {
  const auto& tables = file_->tables;
  const auto& configurations = tables.configurations;
  const auto found = std::find_if(configurations.begin(), configurations.end(),
                                  [&](const auto& each) { return each.name == name; });
  if (found == configurations.end()) {
    std::string names;
    for (const auto& each : configurations)
      names += fmt::format("{}{}", names.empty() ? "" : ", ", each.name);
    return no(fmt::format("operator {} has no configuration \"{}\"", tables.name, printable(name)),
              fmt::format("one of {}", names));
  }
  const auto to = static_cast<std::uint16_t>(found - configurations.begin());
  const auto from = supervisor_.configuration();
  if (to == from) {
    step({.kind = Event::Kind::request, .value = to}, now());  // in place of one that waits
    return yes(fmt::format("operator {} is in {} already\n", tables.name, name));
  }
  if (!supervisor_.leads_to(to))
    return no(fmt::format("no request leads from {} to {}", configurations[from].name, name),
              "`amiroctl operator why` shows what leads from here");
  tell("requested", {{"configuration", name}, {"by", caller.verb}, {"process", caller.process}},
       fmt::format("{} (process {}) asks for {}", caller.verb, caller.process, name));
  const base::Time at = now();
  step({.kind = Event::Kind::request, .value = to}, at);
  if (supervisor_.configuration() == to)
    return yes(fmt::format("{} -> {}\n", configurations[from].name, name));
  if (supervisor_.requested() == to)
    return yes(fmt::format("{} follows when the last change is over, unless another transition comes first\n",
                           name));
  return no(fmt::format("another transition came first: it is in {}",
                        configurations[supervisor_.configuration()].name),
            "`amiroctl operator why` says which");
}

std::string Runner::hold(const Caller& caller, bool held) {
  const auto& tables = file_->tables;
  const bool was = supervisor_.on_hold();
  supervisor_.hold(held);
  if (was != held)
    tell(held ? "held" : "resumed", {{"by", caller.verb}, {"process", caller.process}},
         fmt::format("{} (process {}) {}", caller.verb, caller.process,
                     held ? "holds it: monitors lead to the fall-back only" : "lets it go on"));
  step({}, now());
  return yes(fmt::format("operator {} {}{}: it is in {}\n", tables.name, was == held ? "already " : "",
                         held ? "is on hold, and guards the robot" : "goes on",
                         tables.configurations[supervisor_.configuration()].name));
}

bool Runner::may_command(const Caller& caller) const {
  const auto& commanders = file_->parts[supervisor_.configuration()].commanders;
  return !commanders || std::find(commanders->begin(), commanders->end(), caller.verb) != commanders->end();
}

const reflective::SetPoint* Runner::own_set_point(std::uint16_t topic) const {
  for (const auto& set_point : file_->configurations[supervisor_.configuration()].entry)
    if (set_point.topic == topic) return &set_point;
  return nullptr;
}

std::string Runner::commands(std::string_view text) const {
  const auto frame = can::parse_frame(text);
  const auto found = frame ? index_.subject(frame->id, frame->format) : client::Subject{};
  if (!found.frame) return no(fmt::format("{} commands no actuator", printable(text)), "a frame of the spec");
  const auto* const own = own_set_point(static_cast<std::uint16_t>(found.topic - catalogue_->topics.data()));
  if (own == nullptr) return yes();
  return yes(fmt::format("{}\n{}", own->repeat.count() > 0 ? operator_repeats : "once",
                         file_->configurations[supervisor_.configuration()].name));
}

std::string Runner::pass_on(Caller& caller, std::string_view text) {
  auto frame = can::parse_frame(text);
  const auto found = frame ? index_.subject(frame->id, frame->format) : client::Subject{};
  if (!found.frame || found.topic->kind != protocol::Kind::actuator)
    return no(fmt::format("{} commands no actuator", printable(text)), "it goes to the bus itself");
  const auto& tables = file_->tables;
  const auto& topic = *found.topic;
  const auto number = static_cast<std::uint16_t>(&topic - catalogue_->topics.data());
  const auto& layout = found.frame.layout();
  if (frame->dlc != layout.dlc()) {
    ++commands_.refused;
    return no(fmt::format("{} has {}, and {} takes {}", text, counted(frame->dlc, "byte"), topic.name,
                          layout.dlc()),
              "is --spec that of the robot?");
  }
  const bool rests = ends_motion(topic, *frame);
  if (!rests && !may_command(caller)) {
    ++commands_.refused;
    return no(fmt::format("operator {} is in {}, where {} may not command {}", tables.name,
                          tables.configurations[supervisor_.configuration()].name, caller.verb, topic.name),
              "`amiroctl operator why` says why it is there");
  }
  // The board would follow the two in turns.
  const auto* const own = own_set_point(number);
  if (!rests && own != nullptr && own->repeat.count() > 0) {
    ++commands_.refused;
    return no(fmt::format("operator {} is in {}, where it commands {} itself", tables.name,
                          tables.configurations[supervisor_.configuration()].name, topic.name),
              "`amiroctl operator why` says why it is there");
  }
  if (!queue_.empty()) return wait();
  std::vector<std::int64_t> raw;
  for (const auto& field : layout.fields) raw.push_back(field.raw(frame->data));
  const auto asked = raw;
  Limited limited;
  if (rests) {
    supervisor_.commanded(number, raw, now());
  } else if (supervisor_.permit(number, raw, now()) != 0) {
    for (std::size_t i = 0; i < raw.size(); ++i) {
      if (raw[i] == asked[i]) continue;
      const auto& field = layout.fields[i];
      protocol::put(frame->data, field.position, raw[i]);
      limited.fields.push_back(fmt::format("{}.{}", topic.name, field.name));
      limited.texts.push_back(
          limit_text(tables.configurations[supervisor_.configuration()].limits, topic, number, i, asked[i]));
    }
  }
  const auto taken = bus_->send(*frame);
  if (!taken || !*taken) {
    supervisor_.not_sent();
    return wait();
  }
  ++commands_.passed;
  caller.handed_over = ++handed_over_;
  if (!limited.fields.empty()) ++commands_.limited;
  const bool beyond = !counted_.take(supervisor_.configuration(), number,
                                     protocol::Identifier::decode(frame->id).priority, now());
  if (beyond) ++commands_.beyond;
  bits_ += measure::bits_on_bus(*frame);
  log::Entry entry{unix_time(), *frame};
  entry.direction = log::Direction::sent;
  box_.add(entry, Clock::now());
  tell_command(caller, number, limited, beyond);
  return yes(fmt::format("{}\n{}", can::to_text(*frame).view(), fmt::join(limited.texts, "\n")));
}

void Runner::tell_command(Caller& caller, std::uint16_t topic, const Limited& limited, bool beyond) {
  const auto first = [topic](std::vector<std::uint16_t>& told) {
    if (std::find(told.begin(), told.end(), topic) != told.end()) return false;
    told.push_back(topic);
    return true;
  };
  const auto name = file_->tables.topic(topic).name;
  if (first(caller.commanded))
    tell("commanded", {{"topic", name}, {"by", caller.verb}, {"process", caller.process}},
         fmt::format("{} (process {}) commands {}", caller.verb, caller.process, name));
  if (!limited.fields.empty() && first(caller.limited))
    tell("limited",
         {{"fields", fmt::format("{}", fmt::join(limited.fields, ", "))},
          {"by", caller.verb},
          {"process", caller.process}},
         fmt::format("{} (process {}) is limited: {}", caller.verb, caller.process,
                     fmt::join(limited.texts, ", ")));
  if (beyond && first(caller.beyond))
    tell("beyond_proof", {{"topic", name}, {"by", caller.verb}, {"process", caller.process}},
         fmt::format("{} (process {}) commands {} more often, or more urgently, than the proof counts: the "
                     "bounds do not hold meanwhile",
                     caller.verb, caller.process, name));
}

}  // namespace ocm::cli::operate
