/// Figures of a bus and of each topic on it, from its frames in the order in which they came: how regularly
/// samples come and whether as asked, what is missing, wrong or unknown, and how much of the bus it takes.
///
/// Pure: reads no clock. One pass, the same memory however long the log: about 500 bytes a topic, allocated
/// once. O(1) a frame, and O(requests) of the last second.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/error_frame.hpp"
#include "ocm/client/refusal_reader.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/measure/bus_load.hpp"
#include "ocm/measure/recent_requests.hpp"
#include "ocm/measure/timing.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::measure {

/// What is known of a topic. A sensor's samples, an actuator's set points.
struct TopicFigures {
  const protocol::Topic* topic = nullptr;
  std::array<std::uint64_t, protocol::priority_levels> by_priority{};  ///< samples, by what they were sent at
  Timing timing;
  std::uint64_t incomplete = 0;    ///< samples that lack a frame
  std::uint64_t wrong_dlc = 0;     ///< frames
  std::uint64_t requests = 0;      ///< to a sensor
  std::uint64_t bad_requests = 0;  ///< of these, such as a board must refuse
  std::uint64_t refused = 0;       ///< of these, such as its board did refuse: they ask for nothing
  double load = 0;                 ///< share of the bus that its samples take, 0..1
};

/// Frames of one identifier that no topic has.
struct Stranger {
  std::uint32_t id = 0;
  can::Format format = can::Format::base;
  std::uint64_t count = 0;
};

/// A frame with a topic's identifier and a length that the topic has not.
struct WrongLength {
  std::uint32_t id = 0;
  std::size_t length = 0;
  std::size_t right = 0;
};

struct BusFigures {
  std::vector<TopicFigures> topics;         ///< those of which anything came, in the order of the catalogue
  std::vector<Stranger> strangers;          ///< the first BusStatistics::most_strangers
  client::ReceiverCounters counters;        ///< `frames` with error frames and CAN FD
  std::optional<WrongLength> wrong_length;  ///< the first; counters.wrong_dlc has how many
  j1939::TransportCounters transport;       ///< of J1939's transport protocol; zeros where it is not read
  std::uint64_t fd_frames = 0;              ///< CAN FD, of messages or not
  std::uint64_t not_in_load = 0;            ///< of these, those whose data go at a bit rate that is not known
  std::uint64_t overflows = 0;  ///< error frames that say that frames were lost in the CAN controller
  base::Time first{};           ///< frame of any kind
  base::Time last{};
  BitRates bit_rates;
  double rate_hz = 0;        ///< frames, error frames not counted
  double load = 0;           ///< share of time from the first frame's end to the last's, 0..1
  double request_load = 0;   ///< of these, requests
  double stranger_load = 0;  ///< of these, frames that no topic has, or not so: remote, of another length
  double worst_load = 0;     ///< in the worst BusLoad::window
  base::Time worst_until{};  ///< when that ended; `first` where no frame is in the load
  [[nodiscard]] base::Duration span() const noexcept { return last - first; }
};

class BusStatistics {
 public:
  static constexpr std::size_t most_strangers = 32;

  /// The catalogue must outlive it. `transport`: whether a message of several frames of J1939's transport
  /// protocol is a sample, which needs 60 KiB more where the catalogue has J1939. `interface`: the name of
  /// the bus, of which topics that are on another are unknown.
  BusStatistics(const protocol::Catalogue& catalogue, BitRates rates,
                client::Transport transport = client::Transport::as_frames, std::string_view interface = {})
      : rates_(rates), receiver_(catalogue, transport), refusals_(catalogue) {
    if (!interface.empty()) receiver_.on_interface(0, interface);
    topics_.reserve(catalogue.topics.size());
    for (const auto& topic : catalogue.topics) {
      const Usual usual = topic.is_message() ? Usual::stated : Usual::if_seen;
      topics_.push_back({{.topic = &topic, .timing = {}}, Stream{topic.usual_period(), usual}});
    }
  }

  /// What the frame turned out to be.
  client::Reception take(const can::Received& received) {
    begin(received.time);
    const auto incomplete = receiver_.counters().incomplete;
    const client::Reception reception = receiver_.take(received);
    if (reception.meaning == client::Meaning::error) {
      if (can::lost_in_controller(received.frame)) ++overflows_;
      return reception;
    }
    const unsigned bits = count_bits(received.time, bits_on_bus(received.frame));
    if (reception.meaning == client::Meaning::transport) return reception;
    if (reception.meaning == client::Meaning::remote) {
      stranger_bits_ += bits;
      return reception;
    }
    if (reception.topic == nullptr) {
      stranger_bits_ += bits;
      if (reception.transported != nullptr)
        note_stranger(reception.transported->id.encode(), can::Format::extended);
      else
        note_stranger(received.frame.id, received.frame.format);
      return reception;
    }
    const std::size_t index = index_of(*reception.topic);
    Entry& entry = topics_[index];
    entry.figures.incomplete += receiver_.counters().incomplete - incomplete;
    switch (reception.meaning) {
      case client::Meaning::request:
        request_bits_ += bits;
        take_request(index, received);
        return reception;
      case client::Meaning::wrong_dlc:
        stranger_bits_ += bits;
        note_length(entry, can::FrameView{received.frame}, reception);
        return reception;
      case client::Meaning::sample:
      case client::Meaning::set_point: {
        if (!reception.topic->is_message()) {
          const auto id = protocol::Identifier::decode(received.frame.id);
          ++entry.figures.by_priority[static_cast<std::size_t>(id.priority)];
        }
        entry.stream.sample(received.time);
        requests_.sample(index, received.time);
        take_refusal(reception, received.time);
        break;
      }
      default:
        break;
    }
    entry.bits += bits;
    return reception;
  }
  /// A CAN FD frame came.
  client::Reception take_fd(const can::AnyFrame& frame, base::Time time) {
    begin(time);
    ++fd_frames_;
    const auto known = bits_on_bus(frame, rates_);
    if (!known) ++not_in_load_;
    const unsigned bits = count_bits(time, known.value_or(0));
    const client::Reception reception = receiver_.take(frame.view(), time);
    if (reception.topic == nullptr) {
      stranger_bits_ += bits;
      note_stranger(frame.id, frame.format);
      return reception;
    }
    Entry& entry = topics_[index_of(*reception.topic)];
    if (reception.meaning == client::Meaning::sample) {
      entry.stream.sample(time);
      entry.bits += bits;
    } else {
      stranger_bits_ += bits;
      note_length(entry, frame.view(), reception);
    }
    return reception;
  }

  /// Whether any frame came.
  [[nodiscard]] bool any() const noexcept { return any_; }
  [[nodiscard]] const client::ReceiverCounters& counters() const noexcept { return receiver_.counters(); }
  /// As of the last frame, or of `now` if that is later: a bus that fell silent.
  [[nodiscard]] BusFigures figures(std::optional<base::Time> now = {}) const {
    BusFigures out;
    out.counters = receiver_.counters();
    out.transport = receiver_.transport_counters();
    out.strangers = strangers_;
    out.wrong_length = wrong_length_;
    out.fd_frames = fd_frames_;
    out.not_in_load = not_in_load_;
    out.overflows = overflows_;
    out.first = first_;
    out.last = now ? std::max(*now, last_) : last_;
    out.bit_rates = rates_;
    const auto load = [&](std::uint64_t bits) { return share(bits, out.span(), rates_.nominal); };
    out.load = load(bits_);
    out.request_load = load(request_bits_);
    out.stranger_load = load(stranger_bits_);
    out.worst_load = share(load_.worst_bits(), BusLoad::window, rates_.nominal);
    out.worst_until = load_.worst_bits() == 0 ? first_ : load_.worst_until();
    if (frames_ > 0 && out.span().count() > 0)
      out.rate_hz = static_cast<double>(frames_ - 1) * 1e9 / static_cast<double>(out.span().count());
    for (const Entry& entry : topics_) {
      TopicFigures figures = entry.figures;
      figures.timing = entry.stream.timing(out.last);
      figures.load = load(entry.bits);
      if (figures.timing.count + figures.incomplete + figures.wrong_dlc + figures.requests + entry.bits > 0)
        out.topics.push_back(figures);
    }
    return out;
  }

 private:
  struct Entry {
    TopicFigures figures;
    Stream stream;
    std::uint64_t bits = 0;
  };

  void begin(base::Time time) noexcept {
    if (!any_) first_ = last_ = time;
    any_ = true;
    first_ = std::min(first_, time);
    last_ = std::max(last_, time);
  }
  /// Those that count for the average: the first frame had begun before the time that is looked at.
  unsigned count_bits(base::Time time, unsigned bits) noexcept {
    load_.add(time, bits);
    if (frames_++ == 0) return 0;
    bits_ += bits;
    return bits;
  }
  [[nodiscard]] std::size_t index_of(const protocol::Topic& topic) const noexcept {
    return static_cast<std::size_t>(&topic - receiver_.catalogue().topics.data());
  }
  void take_request(std::size_t index, const can::Received& received) {
    Entry& entry = topics_[index];
    ++entry.figures.requests;
    // The answer of a refusal topic looks like a refusal.
    const auto* const refusals = refusals_.refusal_topic(entry.figures.topic->board);
    if (refusals != nullptr && refusals != entry.figures.topic)
      requests_.asked(index, received.time, client::RefusalReader::longest_wait(*refusals), entry.stream);
    const auto request = protocol::decode_request(received.frame);
    if (!request) {
      ++entry.figures.bad_requests;
      return;
    }
    if (request->mode != protocol::Mode::publish) return entry.stream.stopped(received.time);
    const auto& topic = *entry.figures.topic;
    // Without a period it is the topic's own.
    const auto period = received.frame.dlc == 1 ? topic.period : request->period;
    entry.stream.asked(received.time, period.duration());
  }
  /// What was refused was never asked: the stream is as it was before.
  void take_refusal(const client::Reception& reception, base::Time time) {
    const auto refused = refusals_.take(reception);
    // The first that is heard may be an old one that was asked for.
    if (!refused || (refused->first && topics_[index_of(*reception.topic)].figures.requests != 0)) return;
    const std::size_t index = index_of(*refused->topic);
    topics_[index].figures.refused += requests_.refused(index, time, refused->count, topics_[index].stream);
  }
  void note_length(Entry& entry, const can::FrameView& frame, const client::Reception& reception) {
    ++entry.figures.wrong_dlc;
    if (!wrong_length_) wrong_length_ = {frame.id, frame.bytes.size(), reception.frame.layout().length};
  }
  void note_stranger(std::uint32_t id, can::Format format) {
    for (Stranger& stranger : strangers_)
      if (stranger.id == id && stranger.format == format) {
        ++stranger.count;
        return;
      }
    if (strangers_.size() < most_strangers) strangers_.push_back({id, format, 1});
  }

  BitRates rates_;
  client::Receiver receiver_;
  client::RefusalReader refusals_;
  RecentRequests requests_;
  std::vector<Entry> topics_;
  std::vector<Stranger> strangers_;
  std::optional<WrongLength> wrong_length_;
  BusLoad load_;
  bool any_ = false;
  base::Time first_{};
  base::Time last_{};
  std::uint64_t frames_ = 0;
  std::uint64_t fd_frames_ = 0;
  std::uint64_t not_in_load_ = 0;
  std::uint64_t overflows_ = 0;
  std::uint64_t bits_ = 0;
  std::uint64_t request_bits_ = 0;
  std::uint64_t stranger_bits_ = 0;
};

}  // namespace ocm::measure
