#include "ocm/client/presence.hpp"

#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "ocm/client/command.hpp"
#include "ocm/protocol/message.hpp"
#include "ocm/protocol/request.hpp"
#include "ocm/topics/amiro.hpp"

namespace client_presence_test {

using namespace ocm;
using namespace ocm::client;

const can::Frame drive = protocol::command(amiro::Motors{1, 0});
const can::Frame light = set_point(*amiro::catalogue.find("led_4"), {});

std::vector<std::string> names(const Presence& presence) {
  std::vector<std::string> all;
  for (const auto* topic : presence.unheard()) all.emplace_back(topic->name);
  return all;
}

can::Frame sample_of_gyroscope() {
  return protocol::sample_frame(amiro::Gyroscope{}, protocol::Priority::low, 0);
}

TEST_CASE("presence: nothing was commanded") {
  Presence presence{amiro::catalogue};
  CHECK(presence.unheard().empty());
  presence.sent(*protocol::publish_every(amiro::Gyroscope::id, base::Duration{1'000'000}));
  CHECK(presence.unheard().empty());  // its samples answer
}

TEST_CASE("presence: each board that a set point is for, once") {
  Presence presence{amiro::catalogue};
  presence.sent(light);
  presence.sent(drive);
  presence.sent(drive);
  CHECK(names(presence) == std::vector<std::string>{"di_wheel_drive_status", "light_ring_status"});
  presence.take(drive);  // another program's, too, shows no board
  presence.take(*protocol::publish_every(amiro::Gyroscope::id, base::Duration{1'000'000}));
  CHECK(presence.unheard().size() == 2);
  presence.take(sample_of_gyroscope());
  CHECK(names(presence) == std::vector<std::string>{"light_ring_status"});
  presence.take(protocol::sample_frame(amiro::LightRingStatus{}, protocol::Priority::low, 0));
  CHECK(presence.unheard().empty());
}

TEST_CASE("presence: any sensor of a commanded board is a sign of it") {
  Presence presence{amiro::catalogue};
  CHECK(presence.signs().empty());
  presence.sent(light);
  std::vector<std::string> signs;
  for (const auto* topic : presence.signs()) signs.emplace_back(topic->name);
  CHECK(signs == std::vector<std::string>{"light_ring_status", "light_ring_refusal"});
}

TEST_CASE("presence: what came before the command counts") {
  Presence presence{amiro::catalogue};
  presence.take(sample_of_gyroscope());
  presence.sent(drive);
  CHECK(presence.unheard().empty());
}

TEST_CASE("presence: a frame of another format is none of a board's") {
  Presence presence{amiro::catalogue};
  can::Frame sample = sample_of_gyroscope();
  sample.format = can::Format::extended;
  presence.sent(drive);
  presence.take(sample);
  CHECK(presence.unheard().size() == 1);
}

TEST_CASE("presence: what is no set point commands no board") {
  Presence presence{amiro::catalogue};
  presence.sent(sample_of_gyroscope());
  presence.sent({.id = 0x7FF});
  presence.take({.id = 0x7FF});
  CHECK(presence.signs().empty());
  CHECK(presence.unheard().empty());
}

TEST_CASE("presence: a board without a status is not asked") {
  const auto without = [](protocol::Role role) {
    std::vector<protocol::Topic> topics{amiro::catalogue.topics.begin(), amiro::catalogue.topics.end()};
    std::erase_if(topics, [role](const protocol::Topic& topic) { return topic.role == role; });
    return topics;
  };
  for (const auto& [role, count] : {std::pair{protocol::Role::status, 0U}, {protocol::Role::refusal, 1U}}) {
    const auto topics = without(role);
    protocol::Catalogue catalogue = amiro::catalogue;
    catalogue.topics = topics;
    Presence presence{catalogue};
    presence.sent(drive);
    CHECK(presence.unheard().size() == count);
  }
}

TEST_CASE("presence: of a board that the catalogue lacks nothing is known") {
  protocol::Catalogue lacking = amiro::catalogue;
  lacking.boards = lacking.boards.first(2);
  Presence presence{lacking};
  presence.sent(light);  // of the third board
  presence.take(protocol::sample_frame(amiro::LightRingStatus{}, protocol::Priority::low, 0));
  CHECK(presence.signs().empty());
  CHECK(presence.unheard().empty());
  presence.sent(drive);
  CHECK(names(presence) == std::vector<std::string>{"di_wheel_drive_status"});
}

}  // namespace client_presence_test
