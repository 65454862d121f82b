// A board fed with any frames at any times: every frame is counted once, no sample is read without a request
// for one, and what goes out is whole samples, with their frames in order and the priority asked for.
#include "ocm/controller/controller.hpp"

#include <array>
#include <type_traits>

#include "ocm/client/frame_index.hpp"
#include "ocm/topics/amiro.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

namespace {

/// What the board was asked for, topic by topic: an independent account of what it may send.
class Account {
 public:
  /// `frame` was handed to the board, which serves `topic`.
  void request(const protocol::Topic& topic, const can::Frame& frame, base::Time now) {
    const auto request = protocol::decode_request(frame);
    if (!request) return;
    Stream& stream = streams_[topic.id.value];
    stream.may = request->mode;
    stream.priority = request->priority;
    stream.begin = now;
    stream.last = -1;
    stream.period = (frame.dlc == 1 ? topic.period : request->period).duration();
  }
  /// The board reads a sample.
  void read(protocol::TopicId topic, base::Time now) {
    Stream& stream = streams_[topic.value];
    if (tells_refusals(topic)) return;  // unasked, too: whenever the board has refused a request
    fuzz::expect(stream.may != protocol::Mode::stop, "a sensor is read only when it was asked for");
    fuzz::expect(stream.next == 0, "a sensor is read when its last sample is gone");
    if (stream.may == protocol::Mode::once) {
      stream.may = protocol::Mode::stop;
    } else {
      const std::int64_t cell = (now - stream.begin) / stream.period;
      fuzz::expect(cell > stream.last, "a sensor is read at most once a period");
      stream.last = cell;
    }
  }
  void sampled(protocol::TopicId topic) {
    streams_[topic.value].pending = true;
    streams_[topic.value].sampled = streams_[topic.value].priority;
  }
  /// The bus is offered a frame, and takes it, or never will.
  void sent(const can::Frame& frame, bool taken) {
    const auto id = protocol::Identifier::decode(frame.id);
    const protocol::FrameRef ref = index_.find(id);
    fuzz::expect(
        frame.format == can::Format::base && id.direction == protocol::Direction::sensor && bool{ref},
        "a board sends sensor data");
    Stream& stream = streams_[ref.topic->id.value];
    fuzz::expect(stream.pending, "a board sends what it has read");
    fuzz::expect(frame.dlc == ref.layout().dlc() && ref.frame == stream.next,
                 "a sample's frames come in order");
    fuzz::expect(id.priority == stream.sampled || tells_refusals(ref.topic->id),
                 "a sample has the priority asked for");
    stream.next = static_cast<std::uint8_t>(stream.next + 1);
    if (taken && stream.next != ref.topic->frames.size()) return;
    stream.next = 0;
    stream.pending = false;
  }

 private:
  struct Stream {
    protocol::Mode may = protocol::Mode::stop;
    protocol::Priority priority = protocol::default_priority;
    base::Time begin{};
    base::Duration period{};
    std::int64_t last = -1;  ///< period of the last reading, counted from `begin`
    bool pending = false;    ///< a sample was read and is not gone yet
    std::uint8_t next = 0;   ///< frame of it
    protocol::Priority sampled = protocol::default_priority;
  };
  [[nodiscard]] static bool tells_refusals(protocol::TopicId topic) {
    return amiro::catalogue.find(topic)->role == protocol::Role::refusal;
  }

  client::FrameIndex index_{amiro::catalogue};
  std::array<Stream, 256> streams_{};
};

struct BoardBus {
  Account& account;
  std::size_t room = 3;
  bool broken = false;
  std::uint32_t taken = 0;

  base::Result<bool> send(const can::Frame& frame) {
    if (broken) {
      account.sent(frame, false);
      return base::Error::closed;
    }
    if (room == 0) return false;
    account.sent(frame, true);
    --room;
    ++taken;
    return true;
  }
};

template <class Board>
class Fuzzed {
 public:
  /// `left_out`: bits of the topics that are not served.
  explicit Fuzzed(std::uint8_t left_out) : left_out_(left_out) {
    serve(typename Board::sensors{});
    accept(typename Board::actuators{});
  }

  void run(fuzz::Input input) {
    while (!input.empty()) {
      const std::uint8_t what = input.byte();
      // From 1 ns to 73 years; never backwards.
      const base::Duration step{static_cast<std::int64_t>(input.byte()) << (what >> 2) % 54};
      if (now_.time_since_epoch() + step < latest) now_ += step;
      switch (what & 3) {
        case 0:
        case 1:
          receive(input.frame());
          break;
        case 2: {
          const std::uint8_t room = input.byte();
          bus_.broken = room == 255;
          bus_.room = room % 16;
          break;
        }
        default:
          if (controller_.next_event() != base::never) now_ = std::max(now_, controller_.next_event());
          break;
      }
      if ((what & 3) != 1) poll();
    }
  }

 private:
  static constexpr base::Duration latest{std::int64_t{1} << 62};

  static bool reports(protocol::Role role) {
    return role == protocol::Role::status || role == protocol::Role::refusal;
  }

  template <class... Topics>
  void serve(protocol::TopicList<Topics...>) {
    std::uint8_t bit = 1;
    [[maybe_unused]] const auto one = [&]<class Topic>(std::type_identity<Topic>) {
      // What a controller says of itself it serves in any case: here, too, so that the account hears of it.
      if ((left_out_ & bit) == 0 || reports(amiro::catalogue.find(Topic::id)->role))
        controller_.template serve<Topic>([this](base::Time now) -> base::Result<Topic> {
          account_.read(Topic::id, now);
          if (++reads_ % 5 == 0) return base::Error::not_sampled;
          account_.sampled(Topic::id);
          return Topic{};
        });
      bit = static_cast<std::uint8_t>(bit << 1);
    };
    (one(std::type_identity<Topics>{}), ...);
  }
  template <class... Topics>
  void accept(protocol::TopicList<Topics...>) {
    [[maybe_unused]] const auto one = [&]<class Topic>(std::type_identity<Topic>) {
      if ((left_out_ & 0x80) != 0) return;
      controller_.template accept<Topic>(
          [this](std::uint8_t instance, const Topic&) {
            fuzz::expect(instance >= 1 && instance <= Topic::instances, "a set point is for one that exists");
            ++applied_;
          },
          base::Duration{500'000'000});
    };
    (one(std::type_identity<Topics>{}), ...);
  }

  void receive(const can::Frame& frame) {
    const auto before = controller_.counters();
    controller_.receive(frame, now_);
    const auto& c = controller_.counters();
    fuzz::expect(c.received == before.received + 1, "a frame is received once");
    fuzz::expect(c.received == c.foreign + c.requests + c.set_points + c.refused(),
                 "a frame is counted once");
    fuzz::expect(frame.format == can::Format::base || c.foreign == before.foreign + 1,
                 "only base data frames are for a board");
    if (c.requests != before.requests) {
      const auto* topic = amiro::catalogue.find(protocol::Identifier::decode(frame.id).topic);
      fuzz::expect(topic != nullptr, "a request is for a topic");
      account_.request(*topic, frame, now_);
    }
  }
  void poll() {
    controller_.poll(now_);
    const auto& c = controller_.counters();
    fuzz::expect(c.sent == bus_.taken, "every frame sent is counted");
    fuzz::expect(c.samples + c.not_sampled == reads_, "every reading is counted");
    fuzz::expect(c.set_points + c.timeouts == applied_, "every set point is counted");
    fuzz::expect(controller_.next_event() > now_, "after a poll nothing is due");
    fuzz::expect(!controller_.waiting() || (bus_.room == 0 && !bus_.broken),
                 "frames wait for a full bus only");
  }

  std::uint8_t left_out_;
  base::Time now_{};
  Account account_;
  BoardBus bus_{account_};
  controller::Controller<Board, BoardBus> controller_{bus_};
  std::uint32_t reads_ = 0;
  std::uint32_t applied_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  const std::uint8_t board = input.byte();
  const std::uint8_t left_out = input.byte();
  switch (board % 3) {
    case 0:
      Fuzzed<amiro::DiWheelDrive>{left_out}.run(input);
      break;
    case 1:
      Fuzzed<amiro::PowerManagement>{left_out}.run(input);
      break;
    default:
      Fuzzed<amiro::LightRing>{left_out}.run(input);
      break;
  }
  return 0;
}
