// What a robot or a server may hear: a sentence is taken exactly as it would be written; each opening brace
// has one outcome; after any noise the next sentence is heard; and in blocks all is as character by
// character.
#include "ocm/mapper/link/sentence_reader.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using mapper::link::Direction;
using mapper::link::Kind;

namespace {

template <class T>
bool is_as_written(const mapper::link::Sentence& sentence, std::string_view text) {
  const auto value = sentence.as<T>();
  if (!value) return false;
  if constexpr (requires { value->given; })
    if (value->given > T::fields.size()) return true;  // more than we write
  const auto written = mapper::link::write(*value);
  return written.ok() && written->view().substr(0, written->view().size() - 1) == text;
}

bool is_as_written(const mapper::link::Sentence& sentence, std::string_view text) {
  switch (sentence.kind) {
    case Kind::update:
      return is_as_written<mapper::link::Update>(sentence, text);
    case Kind::set_point:
      return is_as_written<mapper::link::SetPoint>(sentence, text);
    case Kind::calibrate:
      return is_as_written<mapper::link::Calibrate>(sentence, text);
    case Kind::calibration:
      return is_as_written<mapper::link::Calibration>(sentence, text);
    case Kind::handshake:
      return is_as_written<mapper::link::Handshake>(sentence, text);
    case Kind::ping:
      return text.size() >= 2 &&
             text.substr(1, text.size() - 2).find_first_not_of(' ') == std::string_view::npos;
    default:
      break;
  }
  const auto written = mapper::link::write(sentence.kind);
  return written.ok() && written->view().substr(0, written->view().size() - 1) == text;
}

void check(Direction direction, std::string_view stream) {
  mapper::link::Reader reader{direction};
  std::uint32_t opened = 0;
  std::uint32_t pongs = 0;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < stream.size(); ++i) {
    if (stream[i] == '{') begin = i, ++opened;
    const Kind kind = reader.feed(stream[i]);
    if (kind == Kind::pong) ++pongs;
    if (kind != Kind::none && kind != Kind::pong)
      fuzz::expect(is_as_written(reader.sentence(), stream.substr(begin, i + 1 - begin)),
                   "a sentence that is heard is as it would be written");
    fuzz::expect(opened == reader.heard() - pongs + reader.faults().total() - reader.faults().headless +
                               (reader.mid_sentence() ? 1U : 0U),
                 "each opening brace is a sentence, a fault or still open");
  }
  const auto last = *mapper::link::write(direction == Direction::to_robot ? Kind::pause : Kind::idle);
  bool heard = false;
  for (const char c : last.view()) heard = reader.feed(c) != Kind::none || heard;
  fuzz::expect(heard, "after any noise the next sentence is heard");
}

/// Blocks of `size`, so that sentences lie within and across them.
void check_blocks(Direction direction, std::string_view stream, std::size_t size) {
  mapper::link::Reader blocks{direction};
  mapper::link::Reader characters{direction};
  while (!stream.empty()) {
    std::string_view block = stream.substr(0, size);
    stream.remove_prefix(block.size());
    while (!block.empty()) {
      const std::string_view before = block;
      const Kind kind = blocks.feed(block);
      Kind same = Kind::none;
      for (const char c : before.substr(0, before.size() - block.size())) {
        fuzz::expect(same == Kind::none, "a block ends where a sentence does");
        same = characters.feed(c);
      }
      fuzz::expect(kind == same, "a block completes what its characters do");
      if (kind != Kind::none)
        fuzz::expect(blocks.sentence().count == characters.sentence().count &&
                         blocks.sentence().integers == characters.sentence().integers,
                     "with the same integers");
      fuzz::expect(blocks.faults() == characters.faults() && blocks.heard() == characters.heard() &&
                       blocks.stray() == characters.stray() &&
                       blocks.mid_sentence() == characters.mid_sentence(),
                   "and the same counts");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(Direction::to_robot, fuzz::text_of(data, size));
  check(Direction::from_robot, fuzz::text_of(data, size));
  check_blocks(Direction::from_robot, fuzz::text_of(data, size), size);
  check_blocks(Direction::from_robot, fuzz::text_of(data, size), 61);
  check_blocks(Direction::to_robot, fuzz::text_of(data, size), size);
  return 0;
}
