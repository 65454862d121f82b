/// What is on the bus, as it was heard for a while, and what may be there although it was not: the messages
/// that a stream is judged against before it is asked for. docs/admission.md says what is assumed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ocm/analysis/board_check.hpp"
#include "ocm/analysis/bus_check.hpp"
#include "ocm/base/time.hpp"
#include "ocm/can/bus.hpp"
#include "ocm/can/frame.hpp"
#include "ocm/client/diagnosis.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/protocol/identifier.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli {

/// More than any robot of this protocol has at a time: its boards have 256 numbers.
inline constexpr std::size_t most_identifiers = 512;
using BusCheck = analysis::BusCheck<most_identifiers>;
using BoardCheck = analysis::BoardCheck<64>;

/// A stream of samples.
struct Stream {
  const protocol::Topic* topic = nullptr;
  protocol::Priority priority = protocol::default_priority;
  base::Duration period{};
};

class Traffic {
 public:
  /// What is counted in.
  enum class Unheard : bool {
    left_out,    ///< what was heard, and what a status names
    may_be_late  ///< whatever could run without having been heard, too
  };

  explicit Traffic(const protocol::Catalogue& catalogue)
      : catalogue_(catalogue), receiver_(catalogue), diagnosis_(catalogue) {}

  void take(const can::Received& received);
  /// That is enough: so long was listened.
  void end(base::Duration window) { window_ = window; }

  /// Hands all that runs besides `asked`, and that, to a check of the bus.
  void fill(BusCheck& check, const Stream& asked, Unheard unheard);
  /// The same of the asked board's own streams.
  void fill(BoardCheck& check, const Stream& asked, Unheard unheard) const;
  /// Topics that may run although they were not heard: no status says that they do not.
  [[nodiscard]] std::vector<const protocol::Topic*> unheard(const Stream& asked) const;

  /// The key of the message that stands for everything that was not heard.
  static constexpr std::uint32_t any_other = UINT32_MAX;

  struct Line {
    std::string name;
    std::uint32_t id = 0;
    unsigned bits = 0;
  };
  [[nodiscard]] const Line& line(std::uint32_t key) const { return lines_.at(key); }
  [[nodiscard]] std::size_t identifiers() const { return heard_.size(); }
  [[nodiscard]] base::Duration window() const { return window_; }

 private:
  struct Heard {
    can::Frame frame;
    protocol::FrameRef ref;
    base::Time first;
    base::Time last;
    std::int64_t count = 0;
  };

  [[nodiscard]] static unsigned bits_of(const Heard& heard);
  [[nodiscard]] base::Duration period_of(const Heard& heard) const;
  [[nodiscard]] bool heard_of(const protocol::Topic& topic) const;
  void put_stream(BusCheck& check, const Stream& stream, bool asked);
  void put(BusCheck& check, std::uint32_t key, unsigned bits, base::Duration period, base::Duration deadline,
           const protocol::FrameRef& ref, std::uint32_t id, bool asked = false);

  const protocol::Catalogue& catalogue_;
  client::Receiver receiver_;
  client::Diagnosis diagnosis_;
  base::Duration window_{};
  std::map<std::uint32_t, Heard> heard_;
  std::map<std::uint32_t, Line> lines_;
};

}  // namespace ocm::cli
