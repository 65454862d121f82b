// Specs: any text is a spec or has problems in words; what is a spec can be worked with.
#include "generator/spec/spec.hpp"

#include <algorithm>

#include "ocm/client/sample.hpp"

#include "cli/words/command.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto loaded = spec::parse(fuzz::text_of(data, size), "fuzzed.json");
  fuzz::expect((loaded.spec != nullptr) == loaded.problems.empty(), "a text is a spec or has problems");
  for (const auto& problem : loaded.problems)
    fuzz::expect(!problem.place.empty() && !problem.what.empty() && !problem.remedy.empty(),
                 "a problem has a place, words and a remedy");
  if (!loaded.spec) return 0;

  const protocol::Catalogue& catalogue = loaded.spec->catalogue();
  fuzz::expect(!catalogue.robot.empty(), "a spec has a robot");
  if (catalogue.topics.empty()) {  // a DBC file of nodes alone: no frame means anything
    fuzz::expect(!loaded.doubts.empty(), "a spec without topics and messages is doubtful");
    return 0;
  }
  client::Receiver receiver{catalogue};
  const cli::words::CommandParser parser{catalogue};
  std::size_t topics = 0;
  for (const auto& topic : catalogue.topics) {
    if (topic.is_message()) continue;  // the target `catalogue` looks at them
    ++topics;
    fuzz::expect(topic.board < catalogue.boards.size(), "a topic has a board");
    fuzz::expect(!topic.frames.empty(), "a topic has frames");
    fuzz::expect(catalogue.find(topic.name) == &topic && catalogue.find(topic.id) == &topic,
                 "a topic is found by its name and by its id");
    for (const auto& layout : topic.frames) {
      fuzz::expect(layout.length <= can::max_dlc, "a frame has at most 8 bytes");
      can::Payload payload;
      payload.fill(0xA5);
      for (const auto& field : layout.fields) {
        fuzz::expect(!field.name.empty() && field.raw_min <= field.raw_max, "a field has a name and a range");
        (void)field.physical(field.raw(payload));
        if (const auto physical = field.physical(field.raw_min)) (void)field.raw_from(*physical);
      }
      const auto id = protocol::Identifier{protocol::Direction::sensor, topic.priority, layout.id}.encode();
      (void)receiver.take({base::Time{}, can::Frame{.id = id, .dlc = layout.dlc(), .data = payload}});
    }
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const std::string_view ask[] = {sensor ? "publish" : "stop", topic.name};
    fuzz::expect(parser.parse(ask, {}).ok(), "every topic can be commanded");
  }
  fuzz::expect(!parser.stop_all(protocol::Priority::urgent).frames.empty() ||
                   catalogue.topics[0].kind != protocol::Kind::sensor,
               "what can run can be stopped");
  fuzz::expect(topics == loaded.spec->model().topics.size() ||
                   std::any_of(loaded.spec->model().topics.begin(), loaded.spec->model().topics.end(),
                               [](const auto& topic) { return topic.is_group; }),
               "every topic is in the catalogue");
  return 0;
}
