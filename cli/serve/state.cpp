#include "cli/serve/state.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "ocm/protocol/wire_hash.hpp"

#include "cli/serve/scenes.hpp"
#include "cli/shared/json.hpp"
#include "generator/spec/model.hpp"

namespace ocm::cli::serve {
namespace {

double seconds(base::Duration duration) {
  return static_cast<double>(duration.count()) / 1e9;
}
Json seconds(const std::optional<base::Duration>& duration) {
  return duration ? Json(seconds(*duration)) : Json();
}

std::string_view health_name(bus_model::Health health) {
  constexpr std::string_view names[] = {"fine", "late", "missing"};
  return names[static_cast<std::size_t>(health)];
}

Json field_json(const protocol::Field& field) {
  Json json{{"name", field.name}, {"unit", field.unit}};
  if (!field.is_float()) {
    json["min"] = field.value(field.raw_min);
    json["max"] = field.value(field.raw_max);
  }
  if (field.flags) json["flags"] = true;
  for (const protocol::NamedValue& value : field.values)
    json["values"].push_back(
        {{"name", value.name},
         field.flags ? Json::Member{"bit", value.raw} : Json::Member{"value", field.value(value.raw)}});
  return json;
}

Json topic_json(const protocol::Catalogue& catalogue, const protocol::Topic& topic, std::string_view channel,
                std::string_view interface, const spec::RingGeometry* geometry) {
  Json frames = Json::array();
  for (const protocol::FrameLayout& frame : topic.frames) {
    Json fields = Json::array();
    for (const protocol::Field& field : frame.fields) fields.push_back(field_json(field));
    frames.push_back({{"name", frame.name}, {"fields", std::move(fields)}});
  }
  Json json{{"channel", channel},
            {"name", topic.name},
            {"interface", interface},
            {"kind", protocol::name(topic.kind)},
            {"role", topic.role == protocol::Role::none ? std::string_view{} : protocol::name(topic.role)},
            {"board", catalogue.board_name(topic)},
            {"frames", std::move(frames)}};
  if (topic.instance != 0) {
    json["group"] = topic.group;
    json["instance"] = topic.instance;
  }
  const protocol::Law* const law = geometry != nullptr ? law_of(topic) : nullptr;
  if (law != nullptr)
    json["geometry"] = {{"radius_m", geometry->radius.as_double()},
                        {"first_rad", geometry->first.as_double()},
                        {"step_rad", geometry->step.as_double()},
                        {"counts_at_one_metre", law->at_one.as_double()},
                        {"range_m", law->max.as_double()}};
  if (topic.kind == protocol::Kind::sensor) {
    json["period_ms"] = seconds(topic.period.duration()) * 1e3;
    json["shortest_period_ms"] = seconds(topic.shortest_period) * 1e3;
  }
  return json;
}

Json row_json(const bus_model::Row& row) {
  const bool timed = row.recent.distances != 0;
  return {{"name", row.name},
          {"known", row.topic != nullptr},
          {"count", row.count},
          {"frames", row.frames},
          {"incomplete", row.incomplete},
          {"wrong_length", row.wrong_length},
          {"faults", row.faults},
          {"rate_hz", timed ? Json(row.recent.rate_hz) : Json()},
          {"jitter_ms", timed ? Json(row.recent.jitter_ns / 1e6) : Json()},
          {"share", row.share ? Json(*row.share) : Json()},
          {"age_s", seconds(row.age)},
          {"period_s", seconds(row.period)},
          {"health", health_name(row.health)}};
}

}  // namespace

std::string robot_state(const protocol::Catalogue& catalogue, const spec::Model& model,
                        const Channels& channels, const Source& source) {
  const auto geometry = [&model](const protocol::Topic& topic) -> const spec::RingGeometry* {
    for (const spec::TopicModel& each : model.topics)
      if (each.name == topic.name && each.geometry) return &*each.geometry;
    return nullptr;
  };
  Json topics = Json::array();
  const auto interfaces = channels.interfaces();
  for (std::size_t i = 0; i < interfaces.size(); ++i)
    for (std::size_t t = 0; t < catalogue.topics.size(); ++t)
      topics.push_back(topic_json(catalogue, catalogue.topics[t], channels.topic(channels.of(i, t)),
                                  interfaces[i], geometry(catalogue.topics[t])));
  Json boards = Json::array();
  for (const protocol::Board& board : catalogue.boards) boards.push_back(board.name);
  return Json{{"robot", catalogue.robot},    {"source", source.name},       {"live", source.live},
              {"commands", source.commands}, {"boards", std::move(boards)}, {"topics", std::move(topics)}}
      .line();
}

std::string bus_state(std::span<const bus_model::Bus> buses, base::Time now, const ServerFigures& figures) {
  Json all = Json::array();
  for (const bus_model::Bus& bus : buses) {
    const bus_model::Summary sum = bus.model->summary(now);
    Json rows = Json::array();
    for (const bus_model::Row& row : bus.model->rows(now, false)) rows.push_back(row_json(row));
    all.push_back({{"name", bus.name},
                   {"load", sum.load_known ? Json(sum.load) : Json()},
                   {"worst_load", sum.load_known ? Json(sum.worst_load) : Json()},
                   {"rate_hz", sum.rate_hz},
                   {"frames", sum.frames},
                   {"errors", sum.errors},
                   {"lost", sum.lost},
                   {"incomplete", sum.incomplete},
                   {"wrong_length", sum.wrong_length},
                   {"unknown", sum.unknown},
                   {"transport", sum.transport},
                   {"transport_lost", sum.transport_lost},
                   {"not_in_load", sum.not_in_load},
                   {"not_shown", sum.not_shown},
                   {"rows", std::move(rows)}});
  }
  return Json{{"buses", std::move(all)},
              {"viewers", figures.viewers},
              {"lost", figures.lost},
              {"refused", figures.refused}}
      .line();
}

std::string boards_state(const protocol::Catalogue& catalogue, const client::Diagnosis& diagnosis,
                         const client::StatusRequests& asked, std::span<const client::Finding> findings) {
  Json boards = Json::array();
  for (std::size_t i = 0; i < catalogue.boards.size(); ++i) {
    const client::BoardReport& board = diagnosis.boards()[i];
    Json json{{"board", catalogue.boards[i].name},
              {"answers", board.answered},
              {"heard", board.heard},
              {"asked", asked.any(i)},
              {"has_status", board.status != nullptr}};
    if (board.answered) {
      json["uptime_s"] = board.uptime_s;
      json["reset"] = board.reset;
      json["same_spec"] = static_cast<std::uint32_t>(board.wire_hash) == protocol::wire_hash(catalogue);
      json["load_percent"] = board.load ? Json(*board.load) : Json();
      json["bus"] = board.bus;
      json["publishing"] = diagnosis.sensors_of(i, board.publishing);
      json["faults"] = diagnosis.sensors_of(i, board.faults);
      json["bus_errors"] = board.bus_errors;
      json["refused"] = board.refused;
      json["line_lost"] = board.line_lost;
    }
    boards.push_back(std::move(json));
  }
  const client::BatteryReport& battery = diagnosis.battery();
  Json list = Json::array();
  for (const client::Finding& finding : findings)
    list.push_back({{"severity", name(finding.severity)},
                    {"board", finding.board},
                    {"what", finding.what},
                    {"remedy", finding.remedy}});
  return Json{{"boards", std::move(boards)},
              {"battery_percent", battery.answered ? Json(battery.state_of_charge) : Json()},
              {"plugged", battery.answered && battery.plugged},
              {"findings", std::move(list)}}
      .line();
}

std::string playback_state(const bus_model::Playing& playing, bool paused, std::uint64_t jumps) {
  return Json{{"at_s", seconds(playing.at)}, {"length_s", seconds(playing.length)},
              {"speed", playing.speed},      {"paused", paused},
              {"ended", playing.ended},      {"jumps", jumps}}
      .line();
}

}  // namespace ocm::cli::serve
