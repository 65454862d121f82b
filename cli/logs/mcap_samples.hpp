/// Samples and set points as messages of an MCAP file: a channel /gyroscope a topic and interface, messages
/// in JSON with the numbers that `decode --json` prints, and their units in the schema. Of a topic of several
/// frames a message has an object a frame: {"velocity":{"x":0.1,"z":0},"pose":{"x":2.5}}.
///
/// A sample of which a frame is missing makes no message. Interfaces from the 64th on are not decoded.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "ocm/client/sample.hpp"
#include "ocm/log/bytes.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/log/mcap_container.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/output/sample_text.hpp"

namespace ocm::cli::logs {

class McapSamples {
 public:
  static constexpr std::size_t most_interfaces = 64;

  /// The catalogue must outlive this.
  explicit McapSamples(const protocol::Catalogue& catalogue);

  /// Appends what the entry completes, if anything.
  void put(log::Bytes& out, log::mcap::Container& container, const log::Entry& entry, std::uint64_t time_ns,
           const log::Interfaces& interfaces);

 private:
  struct TopicText {
    SampleText sample;
    std::uint16_t schema = 0;  // 0: not written yet
  };
  /// What is known of an interface.
  struct Heard {
    explicit Heard(const protocol::Catalogue& catalogue)
        : receiver(catalogue), channels(catalogue.topics.size()) {}
    client::Receiver receiver;
    std::vector<std::uint16_t> channels;  // by number of the topic; 0: not written yet
  };

  std::uint16_t channel(log::Bytes& out, log::mcap::Container& container, Heard& heard,
                        const protocol::Topic& topic, std::string_view interface);

  const protocol::Catalogue* catalogue_;
  std::vector<TopicText> topics_;
  std::vector<std::unique_ptr<Heard>> heard_;  // by number of the interface
};

}  // namespace ocm::cli::logs
