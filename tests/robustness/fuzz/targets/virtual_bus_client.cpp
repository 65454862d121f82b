// The client of the virtual bus, with a server that says anything, torn, late, twice or in any order, and
// hangs up when it likes: the client takes what a server may say, in order, leaves at the first that it may
// not, and itself says only what a client says. What it should have made of it, the target works out by
// itself.
#include <deque>
#include <optional>
#include <vector>

#include "ocm/transport/virtual_bus.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
namespace vb = transport::virtual_bus;

namespace {

/// The server's end, and what a client that reads all of it must know.
class Server {
 public:
  explicit Server(host::Descriptor socket) : socket_(std::move(socket)) {}

  void add(const vb::Record& record) { records_.push_back(record); }
  [[nodiscard]] bool full() const { return records_.size() == vb::max_records; }
  /// In this message, or the next.
  void add_whole(const vb::Record& record) {
    if (full()) flush();
    add(record);
  }
  void flush() {
    if (records_.empty()) return;
    send(records_.data(), records_.size() * vb::record_size);
    records_.clear();
  }
  void send(const void* bytes, std::size_t size) {
    if (!socket_) return;
    if (::send(socket_.get(), bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT) < 0) return;  // no room
    if (size == 0 || size % vb::record_size != 0 || size > vb::max_message) ended = true;
    for (std::size_t at = 0; at < size && !ended; at += vb::record_size) {
      vb::Record record;
      std::memcpy(record.data(), static_cast<const std::byte*>(bytes) + at, record.size());
      take(record);
    }
  }
  void hang_up() {
    listen();
    socket_.reset();
    ended = true;
  }

  /// All that the client has said.
  void listen() {
    static std::array<vb::Record, vb::max_records> message;
    while (socket_) {
      const ssize_t size = ::recv(socket_.get(), message.data(), sizeof message, MSG_DONTWAIT);
      if (size <= 0) return;
      fuzz::expect(static_cast<std::size_t>(size) % vb::record_size == 0,
                   "a message of the client is whole records");
      for (std::size_t i = 0; i < static_cast<std::size_t>(size) / vb::record_size; ++i) hear(message[i]);
    }
  }

  bool greeted = false;  ///< before the end
  bool ended = false;
  bool excess = false;  ///< it ended by credit for what was not sent
  std::uint64_t bit_rate = 0;
  std::uint64_t granted = 0;
  std::uint64_t credit = 0;  ///< what the client has left once it has read all
  std::uint64_t overruns = 0;
  std::deque<transport::ReceivedAny> frames{};  ///< that the client has not received
  std::vector<can::Filter> filters{};           ///< that the client has told
  std::deque<can::AnyFrame> expected{};         ///< that the client has sent, and the server has not heard
  bool knows_fd = false;
  bool greeting_heard = false, goodbye_heard = false;

 private:
  void take(const vb::Record& record) {
    const auto content = vb::from_record<vb::Count>(record);
    const vb::Type type = vb::type_of(record);
    if (type != vb::Type::goodbye && greeted == (type == vb::Type::hello)) {
      ended = true;
      return;
    }
    switch (type) {
      case vb::Type::hello: {
        const auto hello = vb::from_record<vb::Hello>(record);
        greeted = hello.magic == vb::magic && hello.version == vb::version && hello.bit_rate != 0;
        ended = !greeted;
        bit_rate = hello.bit_rate;
        knows_fd = hello.fd != 0;
        granted = credit = hello.credit;
        return;
      }
      case vb::Type::frame: {
        const auto said = vb::from_record<vb::FrameRecord>(record);
        const auto frame = vb::decode(said);
        ended = !frame.ok() || said_.waits();
        if (!ended) frames.push_back({base::Time{base::Duration{said.time_ns}}, *frame});
        return;
      }
      case vb::Type::fd_frame:
      case vb::Type::fd_data: {
        const auto whole = said_.take(record);
        ended = !whole.ok();
        if (!ended && *whole) frames.push_back({said_.time(), said_.frame()});
        return;
      }
      case vb::Type::credit:
        ended = excess = content.count > granted - credit;
        if (!ended) credit += content.count;
        return;
      case vb::Type::overrun:
        overruns += content.count;
        return;
      default:
        ended = true;
    }
  }
  void hear(const vb::Record& record) {
    fuzz::expect(!goodbye_heard, "nothing follows a goodbye");
    const vb::Type type = vb::type_of(record);
    fuzz::expect(greeting_heard == (type != vb::Type::hello), "a client greets first, and once");
    switch (type) {
      case vb::Type::hello: {
        const auto hello = vb::from_record<vb::Hello>(record);
        fuzz::expect(hello.magic == vb::magic && hello.version == vb::version && hello.fd == 1,
                     "its greeting is one");
        greeting_heard = true;
        return;
      }
      case vb::Type::frame: {
        const auto frame = vb::decode(vb::from_record<vb::FrameRecord>(record));
        fuzz::expect(frame.ok() && !expected.empty() && expected.front() == *frame,
                     "the frames that it took for sent come, in order");
        expected.pop_front();
        return;
      }
      case vb::Type::fd_frame:
      case vb::Type::fd_data: {
        const auto whole = of_client_.take(record);
        fuzz::expect(whole.ok(), "the records of a CAN FD frame are one");
        if (!*whole) return;
        fuzz::expect(!expected.empty() && expected.front() == of_client_.frame(),
                     "the CAN FD frames that it took for sent come, in order");
        expected.pop_front();
        return;
      }
      case vb::Type::filters:
        fuzz::expect(left_ == 0, "a list of filters is whole");
        left_ = vb::from_record<vb::Count>(record).count;
        fuzz::expect(left_ <= vb::max_filters, "it has no more filters than may be");
        heard_.clear();
        return;
      case vb::Type::filter: {
        fuzz::expect(left_-- != 0, "as many filters come as were announced");
        const auto filter = vb::from_record<vb::FilterRecord>(record);
        fuzz::expect(
            heard_.size() < filters.size() && filters[heard_.size()] == can::Filter{filter.id, filter.mask},
            "a filter is one that it was sent");
        heard_.push_back({filter.id, filter.mask});
        return;
      }
      case vb::Type::goodbye:
        goodbye_heard = true;
        return;
      default:
        fuzz::expect(false, "a client says only what a client says");
    }
  }

  host::Descriptor socket_;
  std::vector<vb::Record> records_{};
  std::vector<can::Filter> heard_{};
  vb::FdAssembly said_, of_client_;
  std::uint64_t left_ = 0;
};

class ClientScene {
 public:
  ClientScene() {
    std::array<int, 2> ends{};
    fuzz::expect(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) == 0,
                 "there are sockets");
    server_.emplace(host::Descriptor{ends[0]});
    ours_ = host::Descriptor{ends[1]};
  }

  void run(fuzz::Input input) {
    for (int i = 0; i < 200 && !input.empty() && !refused_; ++i) {
      const std::uint8_t what = input.byte();
      if (what % 16 >= 10 && what % 16 < 14) {
        server_->flush();
        if (!bus_) open();
        read_excess();
        if (bus_) act(what % 16, input);
      } else {
        say(what % 16, input);
        if ((what & 0x80) != 0 || server_->full()) server_->flush();
        read_excess();
      }
    }
    if (refused_) return;
    server_->flush();
    if (!bus_) open();
    if (bus_) finish();
  }

 private:
  void say(unsigned what, fuzz::Input& input) {
    switch (what) {
      case 0:
      case 1:
        return server_->add(vb::to_record(vb::Hello{
            .fd = static_cast<std::uint8_t>(what * 4), .bit_rate = 1000, .credit = input.byte() % 8U}));
      case 2:
      case 3: {
        const base::Time time{base::Duration{input.number<std::int64_t>()}};
        if (what == 2) return server_->add(vb::to_record(input.frame(), time));
        // The last record may be missing, or another one may come in its place.
        const auto records = vb::to_fd_records(fd_frame(input), time);
        const std::size_t missing = input.byte() % 16U == 0 ? 1 : 0;
        for (const auto& record : records.all().first(records.count - missing)) server_->add_whole(record);
        return;
      }
      case 4:
        return server_->add(vb::to_record(vb::Count{.type = vb::Type::credit, .count = input.byte() % 4U}));
      case 5:
        return server_->add(
            vb::to_record(vb::Count{.type = vb::Type::overrun, .count = input.number<std::uint64_t>()}));
      case 6:
        return server_->add(vb::to_record(vb::Goodbye{.reason = static_cast<vb::Reason>(input.byte()),
                                                      .detail = input.number<std::uint32_t>()}));
      case 7: {  // any bytes as one message
        server_->flush();
        const auto bytes = input.bytes(input.byte());
        return server_->send(bytes.data(), bytes.size());
      }
      case 8: {  // larger than any message may be
        static const std::vector<std::byte> large(vb::max_message + vb::record_size, std::byte{4});
        server_->flush();
        return server_->send(large.data(), large.size());
      }
      case 14:
        server_->flush();
        return server_->hang_up();
      case 15: {  // many at once
        for (int count = input.byte(); count > 0; --count) {
          server_->add(vb::to_record(can::Frame{.id = static_cast<std::uint32_t>(count)}));
          if (server_->full()) server_->flush();
        }
        return;
      }
      default: {  // any record, of which the front says all
        vb::Record record{};
        const auto front = input.number<std::array<std::byte, 16>>();
        std::copy(front.begin(), front.end(), record.begin());
        return server_->add(record);
      }
    }
  }

  /// Mostly one that can exist.
  static can::AnyFrame fd_frame(fuzz::Input& input) {
    can::AnyFrame frame{input.frame()};
    frame.flags = static_cast<std::uint8_t>((input.byte() % 4U) | can::frame_flag::fd);
    if (can::is_remote(frame.format)) return frame;
    frame.length = can::fd_length(input.byte() % 16U);
    frame.data = {};
    const auto data = input.bytes(frame.length);
    std::copy(data.begin(), data.end(), frame.data.begin());
    return frame;
  }

  void open() {
    auto opened = transport::VirtualBus::on(std::move(ours_), "sim", "/tmp/sim.sock", base::Duration{0});
    server_->listen();
    if (opened) {
      fuzz::expect(server_->greeted, "a server that has greeted is one");
      bus_ = std::move(opened.value);
      fuzz::expect(bus_->bit_rate() == server_->bit_rate, "the bus is the server's");
      return;
    }
    refused_ = true;
    fuzz::expect(!server_->greeted || server_->ended, "a server that greets in time is not refused");
    fuzz::expect(!opened.error.what.empty() && !opened.error.remedy.empty(),
                 "a refusal has words and a remedy");
  }

  /// Credit for what was not sent becomes credit for something by a frame that is sent before it is read.
  void read_excess() {
    while (bus_ && server_->excess && receive()) {
    }
    server_->excess = false;
  }

  void act(unsigned what, fuzz::Input& input) {
    switch (what) {
      case 10:
        if (input.byte() % 2U == 0)
          send(input.frame());
        else
          send(fd_frame(input));
        break;
      case 11: {
        const std::uint8_t how = input.byte();
        for (int count = how % 8; count > 0 && receive((how & 0x80) == 0); --count) {
        }
        break;
      }
      case 12: {
        std::vector<can::Filter> filters(input.byte() % 4U);
        for (auto& filter : filters) filter = {input.number<std::uint16_t>(), input.number<std::uint16_t>()};
        const auto before = std::exchange(server_->filters, filters);
        if (!bus_->subscribe(filters)) {
          fuzz::expect(server_->ended, "filters are taken as long as there is a server");
          server_->filters = before;
        }
        break;
      }
      default: {
        const auto delivery = bus_->delivery();
        if (!server_->ended)
          fuzz::expect(delivery.known && delivery.pending == server_->granted - server_->credit,
                       "what is under way is what was sent and has not come back");
        fuzz::expect(delivery.pending <= server_->granted, "no more is under way than there was room for");
      }
    }
    server_->listen();
    fuzz::expect(server_->ended || server_->expected.empty(), "what was sent has come");
  }

  void send(const can::AnyFrame& frame) {
    const bool valid = frame.format != can::Format::error && can::validate(frame).ok() &&
                       (!frame.is_fd() || server_->knows_fd);
    server_->expected.push_back(frame);
    const auto sent = bus_->send_any(frame);
    const bool taken = sent.ok() && *sent;
    if (!taken) server_->expected.pop_back();
    if (taken) ++sent_;
    fuzz::expect(!taken || valid, "only frames that can exist are sent");
    if (server_->ended) return;  // which the client need not know yet
    fuzz::expect(sent.ok() == valid, "a frame that can exist is no error");
    if (!valid) return;
    fuzz::expect(taken == (server_->credit != 0), "a frame is taken exactly when there is credit");
    if (taken) --server_->credit;
  }

  /// The next frame that passes the filters, or none, exactly when there is one; not `any`: classic frames
  /// alone.
  bool receive(bool any = true) {
    auto& frames = server_->frames;
    const auto& filters = server_->filters;
    const auto passes = [&](const can::AnyFrame& frame) {
      return frame.format == can::Format::error || filters.empty() ||
             std::any_of(filters.begin(), filters.end(),
                         [&](const auto& each) { return each.accepts(frame.id, frame.format); });
    };
    while (!frames.empty() && (!passes(frames.front().frame) || (!any && frames.front().frame.is_fd()))) {
      passed_over_ += passes(frames.front().frame) ? 1 : 0;
      frames.pop_front();
    }
    const auto received = next(any);
    fuzz::expect(received.ok() == !frames.empty(), "a frame comes exactly when one was said");
    if (received) {
      fuzz::expect(received->time == frames.front().time && received->frame == frames.front().frame,
                   "frames come as they were said, in order");
      ++received_;
      frames.pop_front();
      return true;
    }
    fuzz::expect(received.error == (server_->ended ? base::Error::closed : base::Error::timed_out),
                 "the bus is closed exactly when the server has ended or said what no server says");
    return false;
  }

  base::Result<transport::ReceivedAny> next(bool any) {
    if (any) return bus_->receive_any(base::Duration{0});
    const auto classic = bus_->receive(base::Duration{0});
    if (!classic) return classic.error;
    return transport::ReceivedAny{classic->time, classic->frame};
  }

  void finish() {
    while (receive()) {
    }
    const auto& c = bus_->counters();
    fuzz::expect(c.received == received_ && c.sent == sent_ && c.lost == server_->overruns &&
                     c.passed_over == passed_over_,
                 "every frame is counted once");
    const bool closed = bus_->state() == transport::BusState::closed;
    fuzz::expect(closed == server_->ended, "the end is seen");
    fuzz::expect(closed != bus_->failure().what.empty() && closed != bus_->failure().remedy.empty(),
                 "an end has words and a remedy");
    if (closed) {
      const auto first = bus_->failure();
      fuzz::expect(bus_->send({.id = 1}).error == base::Error::closed && !bus_->subscribe({}),
                   "nothing is taken after the end");
      fuzz::expect(bus_->failure() == first, "the first reason stays");
    }
    bus_.reset();
    server_->listen();
    fuzz::expect(server_->ended || server_->goodbye_heard, "a client that leaves says so");
  }

  std::optional<Server> server_;
  host::Descriptor ours_;
  std::unique_ptr<transport::VirtualBus> bus_;
  bool refused_ = false;
  std::uint64_t sent_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t passed_over_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ClientScene{}.run({data, size});
  return 0;
}
