/// The server's ear: the stream of a central, in which packets of several robots follow each other in any
/// order, taken apart again: prefixes out, a reader of text and one of packed updates a robot, and the
/// quality of each link.
///
/// No heap, constexpr; O(1) a byte; 216 bytes a robot. What belongs to no robot is counted, and given to
/// none.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ocm/mapper/link/packed.hpp"
#include "ocm/mapper/link/prefix.hpp"
#include "ocm/mapper/link/quality.hpp"
#include "ocm/mapper/link/sentence.hpp"
#include "ocm/mapper/link/sentence_reader.hpp"

namespace ocm::mapper::link {

/// One robot as the server hears it.
class Ear {
 public:
  /// Kind::none unless the byte completes a sentence or a packed update, which is an update like others.
  constexpr Kind feed(std::uint8_t byte) noexcept {
    Kind kind = Kind::none;
    if (is_packed(byte)) {
      if (text_.mid_sentence()) text_.restart();
      if (packed_.feed(byte)) kind = Kind::update;
    } else {
      packed_.interrupt();
      kind = text_.feed(static_cast<char>(byte));
    }
    if (kind != Kind::none)
      sentence_ = is_packed(byte) ? sentence_of(packed_.packed().update) : text_.sentence();
    if (kind == Kind::handshake) packed_.restart();
    quality_.observe(text_.heard() + packed_.heard(), text_.faults().total() + packed_.faults().total());
    return kind;
  }
  /// The link is a new one; counters go on.
  constexpr void restart() noexcept {
    text_.restart();
    packed_.restart();
    quality_.observe(text_.heard() + packed_.heard(), text_.faults().total() + packed_.faults().total());
    quality_.restart();
  }
  /// The last that came whole.
  [[nodiscard]] constexpr const Sentence& sentence() const noexcept { return sentence_; }
  [[nodiscard]] constexpr const LinkQuality& quality() const noexcept { return quality_; }
  [[nodiscard]] constexpr const Reader& text() const noexcept { return text_; }
  [[nodiscard]] constexpr const PackedReader& packed() const noexcept { return packed_; }

 private:
  [[nodiscard]] static constexpr Sentence sentence_of(const Update& update) noexcept {
    Sentence sentence{.kind = Kind::update, .count = Update::fields.size(), .integers = {}};
    for (std::size_t i = 0; i < Update::fields.size(); ++i)
      sentence.integers[i] = update.*Update::fields[i].member;
    return sentence;
  }

  Reader text_{Direction::from_robot};
  PackedReader packed_;
  LinkQuality quality_;
  Sentence sentence_{};
};

template <std::size_t Robots>
class Demultiplexer {
 public:
  struct Heard {
    Kind kind = Kind::none;  ///< none: nothing is complete
    std::uint8_t robot = 0;  ///< the central's index
  };

  constexpr Heard feed(std::uint8_t byte) noexcept {
    switch (filter_.feed(static_cast<char>(byte))) {
      case PrefixFilter::Step::prefix:
      case PrefixFilter::Step::source:
        return {};
      case PrefixFilter::Step::no_robot:
        ++of_no_robot_;
        return {};
      case PrefixFilter::Step::text:
        break;
    }
    const std::uint8_t robot = filter_.source();
    if (robot >= Robots) return ++of_no_robot_, Heard{};
    return {ears_[robot].feed(byte), robot};
  }
  /// robot < Robots
  [[nodiscard]] constexpr const Ear& ear(std::size_t robot) const noexcept { return ears_[robot]; }
  /// The robot has connected again.
  constexpr void restart(std::size_t robot) noexcept { ears_[robot].restart(); }
  /// Bytes behind a broken prefix, before the first one, or of a robot beyond the last; it wraps.
  [[nodiscard]] constexpr std::uint32_t of_no_robot() const noexcept { return of_no_robot_; }
  [[nodiscard]] constexpr std::uint32_t broken_prefixes() const noexcept { return filter_.broken(); }

 private:
  PrefixFilter filter_;
  std::array<Ear, Robots> ears_{};
  std::uint32_t of_no_robot_ = 0;
};

}  // namespace ocm::mapper::link
