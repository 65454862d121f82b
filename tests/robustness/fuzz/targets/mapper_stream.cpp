// What a server may hear of a central: prefixes of any kind, text and packed updates of several robots, torn
// anywhere. No sentence is of a robot that is none, none is out of range, the quality is a share, and after
// any noise each robot's next sentence is heard.
#include "ocm/mapper/link/demultiplexer.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using mapper::link::Kind;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::uint8_t robots = 3;
  mapper::link::Demultiplexer<robots> ears;
  for (std::size_t i = 0; i < size; ++i) {
    const auto heard = ears.feed(data[i]);
    if (heard.kind == Kind::none) continue;
    fuzz::expect(heard.robot < robots, "a robot that speaks is one");
    const mapper::link::Sentence& sentence = ears.ear(heard.robot).sentence();
    fuzz::expect(sentence.kind == heard.kind && sentence.count <= mapper::link::max_integers,
                 "what is heard is kept");
    const auto update = sentence.as<mapper::link::Update>();
    fuzz::expect(update.ok() == (heard.kind == Kind::update), "a sentence is what its kind says");
    if (update) fuzz::expect(mapper::link::write(*update).ok(), "an update that is heard can be sent");
    fuzz::expect(ears.ear(heard.robot).quality().per_mille() <= 1000, "a quality is a share");
  }
  for (std::uint8_t robot = 0; robot < robots; ++robot) {
    const auto prefix = mapper::link::write_prefix(robot, "AVR");
    int heard = 0;
    for (const std::string_view text : {prefix.view(), std::string_view{"{S,IDL}\n"}})
      for (const char c : text) {
        const auto what = ears.feed(static_cast<std::uint8_t>(c));
        heard += what.kind == Kind::idle && what.robot == robot ? 1 : 0;
      }
    fuzz::expect(heard == 1, "after any noise each robot's next sentence is heard");
  }
  return 0;
}
