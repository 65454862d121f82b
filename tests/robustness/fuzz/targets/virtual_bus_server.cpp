// The server of the virtual bus, with three clients on real sockets that send any messages, and one that
// behaves: nothing of what the others do harms it or the server, and everything that happens is counted. Time
// is handed in.
#include "ocm/simulation/virtual_bus_server.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <poll.h>
#include <string>

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
namespace vb = transport::virtual_bus;

namespace {

/// One for the whole run, removed at its end.
class Directory {
 public:
  Directory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "ocm-fuzz-XXXXXX").string();
    fuzz::expect(::mkdtemp(pattern.data()) != nullptr, "a temporary directory can be made");
    path_ = pattern;
  }
  Directory(const Directory&) = delete;
  Directory& operator=(const Directory&) = delete;
  ~Directory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::string socket() const { return path_ + "/sim.sock"; }

 private:
  std::string path_;
};

class Peer {
 public:
  explicit Peer(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)) {
    const auto address = host::to_address(path);
    fuzz::expect(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0,
                 "a client can connect");
  }
  void send(const void* bytes, std::size_t size) const {
    ::send(socket_.get(), bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }
  template <class T>
  void say(const T& content) const {
    const vb::Record record = vb::to_record(content);
    send(record.data(), record.size());
  }
  /// Checks all that the server has said, and counts it.
  void listen() {
    static std::array<vb::Record, vb::max_records> message;
    for (;;) {
      const ssize_t size = ::recv(socket_.get(), message.data(), sizeof message, MSG_DONTWAIT);
      if (size < 0 && errno == ECONNRESET) continue;  // it hung up with our messages unread
      if (size == 0) closed = true;
      if (size <= 0) return;
      const auto bytes = static_cast<std::size_t>(size);
      fuzz::expect(bytes % vb::record_size == 0, "a message of the server is whole records");
      for (std::size_t i = 0; i < bytes / vb::record_size; ++i) take(message[i]);
    }
  }

  [[nodiscard]] int descriptor() const { return socket_.get(); }

  std::uint64_t frames = 0;
  std::uint64_t overruns = 0;
  std::uint64_t credit = 0;
  bool dismissed = false;
  bool closed = false;

 private:
  void take(const vb::Record& record) {
    const vb::Type type = vb::type_of(record);
    fuzz::expect(!dismissed, "nothing follows a goodbye");
    fuzz::expect(greeted_ || type == vb::Type::hello || type == vb::Type::goodbye, "the server greets first");
    switch (type) {
      case vb::Type::hello:
        fuzz::expect(!greeted_, "the server greets once");
        greeted_ = true;
        return;
      case vb::Type::frame:
        fuzz::expect(vb::decode(vb::from_record<vb::FrameRecord>(record)).ok(),
                     "a frame on the bus can exist");
        fuzz::expect(!assembly_.waits(), "no frame comes before the one before it is whole");
        ++frames;
        return;
      case vb::Type::fd_frame:
      case vb::Type::fd_data: {
        const auto whole = assembly_.take(record);
        fuzz::expect(whole.ok(), "the records of a CAN FD frame are one");
        if (*whole) {
          fuzz::expect(can::validate(assembly_.frame()).ok(), "a CAN FD frame on the bus can exist");
          ++frames;
        }
        return;
      }
      case vb::Type::credit:
        credit += vb::from_record<vb::Count>(record).count;
        return;
      case vb::Type::overrun:
        overruns += vb::from_record<vb::Count>(record).count;
        return;
      case vb::Type::goodbye:
        dismissed = true;
        return;
      case vb::Type::filters:
      case vb::Type::filter:
        break;
    }
    fuzz::expect(false, "the server says only what a server says");
  }

  host::Descriptor socket_;
  bool greeted_ = false;
  vb::FdAssembly assembly_;
};

class ServerScene {
 public:
  ServerScene() {
    simulation::VirtualBusOptions options;
    options.path = directory().socket();
    options.transmit_queue = 4;
    options.data_bit_rate = 4 * options.bit_rate;
    options.raise_descriptor_limit = false;
    options.report = [](std::string_view text) { fuzz::expect(!text.empty(), "a report has words"); };
    auto opened = simulation::VirtualBusServer::open(std::move(options));
    fuzz::expect(opened.ok(), "the server opens");
    server_ = std::move(opened.value);
    witness_ = std::make_unique<Peer>(server_->path());
    witness_->say(vb::Hello{.fd = 1});
    poll();
  }

  void run(fuzz::Input input) {
    for (int i = 0; i < 64 && !input.empty(); ++i) {
      const std::uint8_t what = input.byte();
      std::optional<Peer>& peer = peers_[what % peers_.size()];
      switch (what >> 5) {
        case 0:
          peer.reset();
          break;
        case 1:
          now_ += base::Duration{std::int64_t{input.byte()} << 12};  // to 1 ms: 8 frames
          poll();
          break;
        case 2:  // of any size, torn ones too
          if (peer) {
            const auto bytes = input.bytes(input.byte());
            peer->send(bytes.data(), bytes.size());
          }
          break;
        case 3:
          witness_->say(vb::FrameRecord{.dlc = 8, .id = 0x100});
          poll();
          ++own_;
          settle();
          break;
        case 4:
          if (!peer) peer.emplace(server_->path());
          peer->say(vb::Hello{.fd = static_cast<std::uint8_t>(what >> 3 & 1)});
          break;
        default:  // whole records
          if (!peer) peer.emplace(server_->path());
          send_records(*peer, input, what >> 5 == 5 ? std::size_t{1} : 1 + input.byte() % std::size_t{8});
          break;
      }
      poll();
    }
    finish();
  }

 private:
  static const Directory& directory() {
    static const Directory one;
    return one;
  }

  static void send_records(const Peer& peer, fuzz::Input& input, std::size_t count) {
    std::array<vb::Record, 8> records{};
    for (std::size_t i = 0; i < count; ++i) {
      // The front of a record says all: what follows is mostly unused.
      const auto front = input.number<std::array<std::byte, 16>>();
      std::copy(front.begin(), front.end(), records[i].begin());
    }
    peer.send(records.data(), count * vb::record_size);
  }

  void poll() {
    server_->poll(now_, [this](const simulation::Delivery& delivery) {
      fuzz::expect(can::validate(delivery.frame).ok() && delivery.frame.format != can::Format::error,
                   "what is on the bus can be there");
      if (delivery.fd != nullptr)
        fuzz::expect(
            delivery.fd->is_fd() && can::validate(*delivery.fd).ok() && delivery.fd->id == delivery.frame.id,
            "a CAN FD frame on the bus can be there");
      fuzz::expect(delivery.time <= now_, "nothing is delivered before its time");
      ++delivered_;
    });
    listen();
    fuzz::expect(!witness_->dismissed && !witness_->closed, "who behaves stays connected");
  }
  /// Reads what the server has said to any of them: one question to the kernel for all, which mostly says no.
  void listen() {
    std::array<pollfd, 4> sockets{};
    for (std::size_t i = 0; i < peers_.size(); ++i)  // a negative one is passed over
      sockets[i] = {peers_[i] && !peers_[i]->closed ? peers_[i]->descriptor() : -1, POLLIN, 0};
    sockets.back() = {witness_->descriptor(), POLLIN, 0};
    if (::poll(sockets.data(), sockets.size(), 0) <= 0) return;
    for (std::size_t i = 0; i < peers_.size(); ++i)
      if (sockets[i].revents != 0) peers_[i]->listen();
    if (sockets.back().revents != 0) witness_->listen();
  }
  /// Until the bus is idle.
  void settle() {
    for (int i = 0; server_->next_event() != base::never; ++i) {
      fuzz::expect(i < 1000, "the bus comes to rest");
      now_ = std::max(now_, server_->next_event());
      poll();
    }
  }
  void finish() {
    for (auto& peer : peers_) peer.reset();
    poll();
    settle();
    poll();
    const auto& c = server_->counters();
    fuzz::expect(server_->clients() == 1, "who is gone is forgotten");
    fuzz::expect(c.welcomed == c.left + c.died + c.misbehaved + 1, "every end of a client is counted once");
    fuzz::expect(server_->arbiter().totals().frames == delivered_, "every frame on the bus is delivered");
    fuzz::expect(witness_->frames + witness_->overruns + own_ == delivered_, "who behaves hears every frame");
    fuzz::expect(witness_->credit == own_, "who behaves gets the credit back");
  }

  std::unique_ptr<simulation::VirtualBusServer> server_;
  std::array<std::optional<Peer>, 3> peers_;
  std::unique_ptr<Peer> witness_;
  base::Time now_{base::Duration{1'000'000'000}};
  std::uint64_t delivered_ = 0;
  std::uint64_t own_ = 0;  ///< frames of the witness
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ServerScene{}.run({data, size});
  return 0;
}
