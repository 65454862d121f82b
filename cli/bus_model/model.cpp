#include "cli/bus_model/model.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "ocm/measure/bus_load.hpp"
#include "ocm/protocol/identifier.hpp"

namespace ocm::cli::bus_model {
namespace {

using client::Meaning;

/// Of a period that no request asked for and no spec states, only what is far beyond it is said to be
/// missing: it may be no period.
Health health_of(const measure::Timing& timing, base::Time now) {
  if (!timing.due || timing.period_ns <= 0) return Health::fine;
  const auto silence = static_cast<double>((now - timing.since).count());
  // A period of a millisecond is not late because this program woke up late.
  const auto period = static_cast<double>(std::max<std::int64_t>(timing.period_ns, 20'000'000));
  if (timing.period_from == measure::PeriodFrom::measured)
    return silence > 10 * period ? Health::missing : Health::fine;
  if (silence > 3 * period) return Health::missing;
  return silence > 1.5 * period ? Health::late : Health::fine;
}

/// Bytes that a reader of fields may read, of a frame of so many.
std::size_t room_for(std::size_t bytes) {
  return bytes <= sizeof(can::Payload) ? sizeof(can::Payload)
                                       : std::max<std::size_t>(bytes, can::max_fd_length);
}

}  // namespace

Model::Model(const protocol::Catalogue& catalogue, std::uint32_t bit_rate, std::uint32_t data_bit_rate,
             std::string_view interface)
    : catalogue_(&catalogue),
      bit_rate_(bit_rate),
      rates_{std::max(bit_rate, 1U), data_bit_rate},
      statistics_(catalogue, rates_, client::Transport::together, interface),
      subjects_(catalogue.topics.size()) {}

void Model::take_sample(Subject& subject, base::Time time, std::span<const std::uint8_t> bytes) {
  const bool same = subject.count > 0 && bytes.size() == subject.size &&
                    std::equal(bytes.begin(), bytes.end(), subject.bytes.begin());
  if (!same) {
    subject.changed = time;
    subject.bytes.assign(room_for(bytes.size()), 0);
    std::copy(bytes.begin(), bytes.end(), subject.bytes.begin());
    subject.size = bytes.size();
  }
  ++subject.count;
  subject.last = time;
  subject.times.add(time);
}

Model::Subject* Model::find_unknown(std::uint32_t id, can::Format format) {
  const auto key = std::uint64_t{id} << 8 | static_cast<std::uint64_t>(format);
  const auto [at, is_new] = unknown_by_id_.try_emplace(key, unknown_.size());
  if (!is_new) return &unknown_[at->second].subject;
  if (unknown_.size() == most_unknown) {
    unknown_by_id_.erase(at);
    return nullptr;
  }
  unknown_.push_back({id, format, {}});
  return &unknown_.back().subject;
}

void Model::take(const log::Entry& entry) {
  const auto classic = entry.classic();
  const bool goes_back = newest_ && entry.time < *newest_ - std::chrono::seconds{1};
  if (!newest_ || goes_back) begin_ = entry.time;
  newest_ = newest_ && !goes_back ? std::max(*newest_, entry.time) : entry.time;
  const client::Reception reception =
      classic ? statistics_.take({entry.time, *classic}) : statistics_.take_fd(entry.frame(), entry.time);
  if (reception.meaning == Meaning::error) {
    if (const auto state = classic ? can::controller_state(*classic) : std::nullopt) controller_ = state;
    if (const auto counters = classic ? can::error_counters(*classic) : std::nullopt)
      error_counters_ = counters;
    return;
  }
  const unsigned bits =
      classic ? measure::bits_on_bus(*classic) : measure::bits_on_bus(entry.frame(), rates_).value_or(0);
  load_.add(entry.time, bits);
  frames_.add(entry.time, 1);
  if (reception.meaning == Meaning::transport) return;  // a row gets the message, when it is whole
  const j1939::Transported* const whole = reception.transported;
  Subject* const subject =
      reception.topic != nullptr
          ? &subjects_[static_cast<std::size_t>(reception.topic - catalogue_->topics.data())]
      : whole != nullptr ? find_unknown(whole->id.encode(), can::Format::extended)
                         : find_unknown(entry.id, entry.format);
  if (subject == nullptr) {
    ++not_shown_;
    return;
  }
  // Of a message in several frames, its announcement and packets, all about as long as the last.
  subject->load.add(entry.time, whole == nullptr ? bits : bits * (1 + j1939::packets_of(whole->data.size())));
  if (reception.meaning != Meaning::request) ++subject->frames;
  switch (reception.meaning) {
    case Meaning::sample:
      subject->priority = reception.sample.priority;
      take_sample(*subject, entry.time, reception.sample.bytes);
      break;
    case Meaning::set_point: {  // of which each frame is a sample: eight bytes a frame, as sensors have them
      std::vector<std::uint8_t> bytes = subject->bytes;
      bytes.resize(sizeof(can::Payload) * reception.topic->frames.size());
      std::copy_n(entry.data.begin(), sizeof(can::Payload),
                  bytes.begin() + static_cast<std::ptrdiff_t>(sizeof(can::Payload) * reception.frame.frame));
      take_sample(*subject, entry.time, bytes);
      break;
    }
    case Meaning::unknown:
      take_sample(*subject, entry.time, whole != nullptr ? whole->data : entry.bytes());
      break;
    case Meaning::request:
      subject->times.restart();  // from one period to another is no jitter
      break;
    default:
      break;
  }
}

client::Sample Model::sample_of(const protocol::Topic* topic, const Subject& subject) {
  return {topic, subject.priority, subject.last, std::span{subject.bytes}.first(subject.size)};
}

std::optional<client::Sample> Model::newest_of(std::size_t topic) const {
  const Subject& subject = subjects_[topic];
  if (subject.count == 0) return std::nullopt;
  return sample_of(&catalogue_->topics[topic], subject);
}

std::vector<Row> Model::rows(base::Time now, bool all) const {
  std::vector<Row> rows;
  const auto add = [&](std::size_t number, const protocol::Topic* topic, std::string name,
                       const Subject& subject) -> Row& {
    Row& row = rows.emplace_back();
    row.number = number;
    row.topic = topic;
    row.name = std::move(name);
    row.count = subject.count;
    row.frames = subject.frames;
    row.recent = subject.times.figures(now);
    if (bit_rate_ != 0) row.share = subject.load.share(now, begin_, bit_rate_);
    row.newest = sample_of(topic, subject);
    if (subject.count > 0) {
      row.age = now - subject.last;
      row.unchanged = now - subject.changed;
    }
    return row;
  };
  const auto figures = statistics_.figures(now).topics;
  auto known = figures.begin();
  for (std::size_t i = 0; i < subjects_.size(); ++i) {
    const protocol::Topic& topic = catalogue_->topics[i];
    const bool came = known != figures.end() && known->topic == &topic;
    if (came || all || subjects_[i].frames > 0) {
      Row& row = add(i, &topic, std::string{topic.name}, subjects_[i]);
      if (came) {
        row.incomplete = known->incomplete;
        row.wrong_length = known->wrong_dlc;
        row.faults = known->timing.missing + known->incomplete + known->wrong_dlc + known->bad_requests;
        row.health = health_of(known->timing, now);
        if (known->timing.due && known->timing.period_ns > 0)
          row.period = base::Duration{known->timing.period_ns};
      }
    }
    if (came) ++known;
  }
  for (std::size_t i = 0; i < unknown_.size(); ++i) {
    const Unknown& unknown = unknown_[i];
    const bool wide = can::is_extended(unknown.format);
    add(subjects_.size() + i, nullptr, fmt::format("{:0{}X}", unknown.id, wide ? 8 : 3), unknown.subject);
  }
  return rows;
}

Summary Model::summary(base::Time now) const {
  const measure::BusFigures figures = statistics_.figures(now);
  Summary out;
  out.load_known = bit_rate_ != 0;
  out.load = load_.share(now, begin_, bit_rate_);
  out.worst_load = figures.worst_load;
  out.rate_hz = frames_.share(now, begin_, 1);
  out.frames = figures.counters.frames;
  out.errors = figures.counters.errors;
  out.overflows = figures.overflows;
  out.lost = lost_;
  out.incomplete = figures.counters.incomplete;
  out.wrong_length = figures.counters.wrong_dlc;
  out.unknown = figures.counters.unknown + figures.counters.remote + figures.counters.fd;
  out.not_in_load = figures.not_in_load;
  out.transport = figures.transport.complete;
  out.transport_lost = figures.transport.lost();
  out.not_shown = not_shown_;
  out.controller = controller_;
  out.error_counters = error_counters_;
  return out;
}

void Model::tick() {
  for (auto& [key, values] : histories_) {
    double value = std::numeric_limits<double>::quiet_NaN();
    if (key.row < subjects_.size() && subjects_[key.row].count > 0) {
      const protocol::Topic& topic = catalogue_->topics[key.row];
      const protocol::FrameLayout& layout = topic.frames[key.frame];
      const protocol::Field& field = layout.values()[key.field];
      const auto data = sample_of(&topic, subjects_[key.row]).data(key.frame);
      if (layout.has(field, data)) value = field.value(field.raw(data));
    }
    if (values.size() == history_size) values.pop_front();
    values.push_back(value);
  }
}

std::vector<double> Model::history(FieldKey field) const {
  const auto at = histories_.find(field);
  if (at == histories_.end()) return {};
  return {at->second.begin(), at->second.end()};
}

}  // namespace ocm::cli::bus_model
