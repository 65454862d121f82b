/// A client of the virtual bus: what `--bus sim` is. docs/virtual-bus.md has the whole picture. Host only.
///
///     auto bus = VirtualBus::open();
///     if (!bus) { /* bus.error.what, bus.error.remedy */ }
///     (*bus)->send(frame);
///
/// A node of its own on the bus, like a board: it does not hear its own frames. One system call a frame sent,
/// and one for all that waits to be received. Not thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "ocm/can/any_frame.hpp"
#include "ocm/can/filter.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/local_socket.hpp"
#include "ocm/host/system_time.hpp"
#include "ocm/transport/bus.hpp"
#include "ocm/transport/virtual_bus_protocol.hpp"

namespace ocm::transport {

class VirtualBus final : public Bus {
 public:
  /// The server of the default path, or of `path`. Waits at most `patience`, twice, for its answer.
  [[nodiscard]] static Outcome<std::unique_ptr<VirtualBus>> open(
      std::string path = {}, base::Duration patience = std::chrono::seconds{2}) {
    std::string name = path.empty() ? "sim" : "sim:" + path;
    if (path.empty()) path = virtual_bus::default_path();
    const auto address = host::to_address(path);
    if (!address) return address.error;
    host::Descriptor socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
    if (!socket) return connect_failure(path, errno);
    // A server that is stopped accepts no client, and its queue may be full.
    const timeval limit = host::to_timeval(patience);
    ::setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    while (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) < 0)
      if (errno != EINTR) return connect_failure(path, errno);
    const auto peer = host::peer_of(socket.get());
    if (!peer || peer->uid != ::geteuid())
      return Failure{"the simulator on '" + path + "' belongs to another user" +
                         (peer ? " (uid " + std::to_string(peer->uid) + ")" : ""),
                     "start one of your own", host::Cause::simulator_foreign};
    return on(std::move(socket), std::move(name), path, patience);
  }

  /// On a socket that is connected with a server; `path` is where, for messages.
  [[nodiscard]] static Outcome<std::unique_ptr<VirtualBus>> on(host::Descriptor socket, std::string name,
                                                               const std::string& path,
                                                               base::Duration patience) {
    const auto peer = host::peer_of(socket.get());
    std::unique_ptr<VirtualBus> bus{
        new VirtualBus(std::move(socket), std::move(name), path, host::process_text(peer))};
    if (auto problem = bus->greet(patience)) return std::move(*problem);
    return bus;
  }

  /// Whether a server listens on the default path, or on `path`. Waits for nothing.
  [[nodiscard]] static bool running(const std::string& path = virtual_bus::default_path()) {
    const auto address = host::to_address(path);
    const host::Descriptor socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
    if (!address || !socket) return false;
    return ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) == 0 ||
           errno == EAGAIN;
  }

  /// Says goodbye: frames that wait for the bus are sent. Takes at most 100 ms if the server is stuck.
  ~VirtualBus() override {
    if (ended_) return;
    const virtual_bus::Record record = to_record(virtual_bus::Goodbye{});
    if (!write(&record, 1)) {
      wait(POLLOUT, std::chrono::milliseconds{100});
      write(&record, 1);
    }
  }

  /// "sim", or "sim:PATH".
  [[nodiscard]] std::string_view name() const override { return name_; }
  [[nodiscard]] bool is_simulated() const noexcept override { return true; }
  /// What the server calls its bus or robot.
  [[nodiscard]] std::string_view bus_name() const noexcept { return bus_name_; }
  /// bit/s
  [[nodiscard]] std::uint32_t bit_rate() const noexcept override { return bit_rate_; }
  /// Of the data of CAN FD frames with bit-rate switch, bit/s; 0: the server
  /// does not know CAN FD.
  [[nodiscard]] std::uint32_t data_bit_rate() const noexcept { return data_factor_ * bit_rate_; }
  /// Frames that `send` takes before it has to hear from the server.
  [[nodiscard]] std::uint64_t credit() const noexcept { return credit_; }

  /// Never waits. false: as many frames wait for the bus as the server lets this client have (64 unless
  /// told); `descriptor` becomes readable when there is room again.
  base::Result<bool> send(const can::Frame& frame) override {
    if (closed()) return base::Error::closed;
    if (frame.format == can::Format::error) return base::Error::bad_identifier;
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    const virtual_bus::Record record = virtual_bus::to_record(frame);
    return hand_over({&record, 1});
  }
  base::Result<bool> send_any(const can::AnyFrame& frame) override {
    if (const auto classic = frame.classic()) return send(*classic);
    if (closed()) return base::Error::closed;
    if (const auto valid = can::validate(frame); !valid) return valid.error;
    if (data_factor_ == 0) return base::Error::bad_length;
    return hand_over(virtual_bus::to_fd_records(frame).all());
  }
  [[nodiscard]] Failure fd_obstacle() const override {
    if (data_factor_ != 0 || ended_) return {};
    return {"the simulator" + process_ + " on '" + path_ +
                "' carries no CAN FD frames: it is of an earlier version",
            "start it again, of the version of this program"};
  }

  /// A signal that is caught while this waits ends it at once with Error::timed_out; one that comes just
  /// before does not, so wait no longer than the signal may take. After the end of the server the frames that
  /// still waited come first, then Error::closed.
  base::Result<can::Received> receive(base::Duration timeout) override {
    return receive_next<can::Received>(timeout);
  }
  base::Result<ReceivedAny> receive_any(base::Duration timeout) override {
    return receive_next<ReceivedAny>(timeout);
  }

  /// The server filters, so that what does not pass costs this process nothing. At most 512 filters. May wait
  /// a second for a server that is busy.
  Outcome<void> subscribe(std::span<const can::Filter> filters) override {
    if (closed()) return ending_;
    if (filters.size() > virtual_bus::max_filters)
      return Failure{std::to_string(filters.size()) + " filters for the virtual bus; it takes " +
                         std::to_string(virtual_bus::max_filters),
                     "use fewer filters with wider masks, or none"};
    std::vector<virtual_bus::Record> records{
        to_record(virtual_bus::Count{.type = virtual_bus::Type::filters, .count = filters.size()})};
    for (const can::Filter& filter : filters)
      records.push_back(to_record(virtual_bus::FilterRecord{.id = filter.id, .mask = filter.mask}));
    for (std::size_t at = 0; at < records.size();) {
      const std::size_t count = std::min(records.size() - at, virtual_bus::max_records);
      if (write(records.data() + at, count)) {
        at += count;
        continue;
      }
      if (closed()) return ending_;
      if (!wait(POLLOUT, std::chrono::seconds{1})) {
        // The server has half a list now and would take what comes next for the rest of it.
        end({"the simulator" + process_ + " does not answer", stuck_remedy(path_)});
        return ending_;
      }
    }
    filters_.assign(filters.begin(), filters.end());
    return {};
  }

  /// Exactly: the server gives credit back for each frame that was on the bus.
  [[nodiscard]] Delivery delivery() override {
    while (credit_ < granted_ && fill()) {
    }
    return {.known = true, .pending = granted_ > credit_ ? granted_ - credit_ : 0};
  }

  [[nodiscard]] int descriptor() const override { return socket_.get(); }
  [[nodiscard]] const BusCounters& counters() const override { return counters_; }
  [[nodiscard]] const Failure& failure() const override { return failure_; }

 private:
  static constexpr std::size_t messages_at_once = 16;
  /// Frames kept for a program that sends and never receives.
  static constexpr std::size_t max_inbox = 65'536;

  VirtualBus(host::Descriptor socket, std::string name, std::string path, std::string process)
      : socket_(std::move(socket)),
        name_(std::move(name)),
        path_(std::move(path)),
        process_(std::move(process)),
        buffer_(messages_at_once * virtual_bus::max_message) {
    for (std::size_t i = 0; i < messages_at_once; ++i) {
      places_[i] = {buffer_.data() + i * virtual_bus::max_message, virtual_bus::max_message};
      messages_[i].msg_hdr.msg_iov = &places_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
    }
  }

  /// A frame, as records. Credit comes first in a message, but many messages
  /// may wait before that.
  base::Result<bool> hand_over(std::span<const virtual_bus::Record> records) {
    while (credit_ == 0 && fill()) {
    }
    if (credit_ != 0 && write(records.data(), records.size())) {
      --credit_;
      ++counters_.sent;
      return true;
    }
    if (closed()) return base::Error::closed;
    ++counters_.refused;
    return false;
  }

  /// `receive` and `receive_any`.
  template <class R>
  base::Result<R> receive_next(base::Duration timeout) {
    R received;
    if (take(received)) return received;
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
      if (closed()) return base::Error::closed;
      const bool filled = fill();
      if (take(received)) return received;
      if (filled) continue;
      if (timeout <= base::Duration::zero()) return base::Error::timed_out;
      const base::Duration rest = timeout - (std::chrono::steady_clock::now() - begin);
      if (rest <= base::Duration::zero() || !wait(POLLIN, rest)) return base::Error::timed_out;
    }
  }

  [[nodiscard]] static std::string stuck_remedy(const std::string& path) {
    return "it may be stopped (Ctrl-Z): continue it (fg) or end it; `fuser " + path + "` names its process";
  }

  [[nodiscard]] static Failure connect_failure(const std::string& path, int error) {
    switch (error) {
      case ENOENT:
      case ENOTDIR:
      case ECONNREFUSED:
        return {"no simulator is running: no program listens on '" + path + "'", "start one",
                host::Cause::simulator_missing};
      case EAGAIN:
        return {"the simulator on '" + path + "' does not answer", stuck_remedy(path)};
      case EACCES:
      case EPERM:
        return {"not allowed to connect to '" + path + "'",
                "a simulator serves its own user only: start one of your own",
                host::Cause::simulator_private};
      case EPROTOTYPE:
        return {"'" + path + "' is a socket, but not of a simulator", "name another path",
                host::Cause::no_simulator};
      default:
        return {"cannot connect to the simulator on '" + path + "': " + std::strerror(error), "start one",
                host::Cause::simulator_missing};
    }
  }

  /// Says hello and waits for the answer.
  [[nodiscard]] std::optional<Failure> greet(base::Duration patience) {
    const virtual_bus::Record hello = to_record(virtual_bus::Hello{.fd = 1});
    bool said = write(&hello, 1);
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (bit_rate_ == 0 && !ended_) {
      if (!said) said = write(&hello, 1);
      if (fill()) continue;
      const base::Duration rest = give_up - std::chrono::steady_clock::now();
      if (rest <= base::Duration::zero()) {
        end({"the simulator" + process_ + " does not answer on '" + path_ + "'", stuck_remedy(path_)});
        break;
      }
      wait(said ? POLLIN : POLLIN | POLLOUT, rest);
    }
    if (!ended_) return std::nullopt;
    return ending_;
  }

  /// Whether the server has gone, and then `failure` says so. Frames may still wait in the inbox.
  [[nodiscard]] bool closed() {
    if (ended_) failure_ = ending_;
    return ended_;
  }

  /// true: handed to the server. false: no room in the socket, or the server is gone.
  bool write(const virtual_bus::Record* records, std::size_t count) {
    if (ended_) return false;
    const std::size_t size = count * virtual_bus::record_size;
    for (;;) {
      if (::send(socket_.get(), records, size, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) return true;
      if (errno == EINTR || errno == ECONNRESET) continue;  // the latter once: reading tells why
      if (errno == EAGAIN || errno == ENOBUFS || errno == ENOMEM) return false;
      break;
    }
    while (fill()) {
    }
    end(gone());
    return false;
  }

  /// true: something happened. false: time is up, or a signal came.
  bool wait(short what, base::Duration time) const noexcept {
    const timespec limit = host::to_timespec(time);
    pollfd entry{socket_.get(), what, 0};
    return ::ppoll(&entry, 1, &limit, nullptr) > 0;
  }

  /// Reads what waits in the socket, in one batch. false: nothing waited.
  bool fill() {
    if (ended_) return false;
    int count = 0;
    do {
      for (mmsghdr& message : messages_) message.msg_hdr.msg_flags = 0;
      count = ::recvmmsg(socket_.get(), messages_.data(), messages_at_once, MSG_DONTWAIT, nullptr);
      // ECONNRESET comes once, before what the server said last.
    } while (count < 0 && (errno == EINTR || errno == ECONNRESET));
    if (count < 0 && errno == EAGAIN) return false;
    if (count < 0) end(gone());
    for (int i = 0; i < count && !ended_; ++i) {
      const mmsghdr& message = messages_[static_cast<std::size_t>(i)];
      const auto* const bytes = static_cast<const std::byte*>(message.msg_hdr.msg_iov->iov_base);
      if (message.msg_len == 0) {
        end(gone());
      } else if ((message.msg_hdr.msg_flags & MSG_TRUNC) != 0 ||
                 message.msg_len % virtual_bus::record_size != 0) {
        end(not_understood());
      }
      for (std::size_t at = 0; at < message.msg_len && !ended_; at += virtual_bus::record_size) {
        virtual_bus::Record record;
        std::memcpy(record.data(), bytes + at, record.size());
        take_in(record);
      }
    }
    return true;
  }

  void take_in(const virtual_bus::Record& record) {
    using virtual_bus::Type;
    const Type type = virtual_bus::type_of(record);
    // A server greets first, and once.
    const bool greeted = bit_rate_ != 0;
    if (type != Type::goodbye && greeted == (type == Type::hello)) return end(not_understood());
    switch (type) {
      case Type::frame: {
        if (coming_.waits()) return end(not_understood());
        const auto content = virtual_bus::from_record<virtual_bus::FrameRecord>(record);
        const auto frame = virtual_bus::decode(content);
        if (!frame) return end(not_understood());
        keep({{base::Time{base::Duration{content.time_ns}}, *frame}, false});
        return;
      }
      case Type::fd_frame:
      case Type::fd_data: {
        const auto whole = coming_.take(record);
        if (!whole) return end(not_understood());
        if (*whole) keep({{coming_.time(), {}}, true}, &coming_.frame());
        return;
      }
      case Type::credit: {
        const auto back = virtual_bus::from_record<virtual_bus::Count>(record).count;
        if (back > granted_ - credit_) return end(not_understood());  // for frames that were never sent
        credit_ += back;
        return;
      }
      case Type::overrun:
        counters_.lost += virtual_bus::from_record<virtual_bus::Count>(record).count;
        return;
      case Type::goodbye:
        return end(dismissed(virtual_bus::from_record<virtual_bus::Goodbye>(record)));
      case Type::hello: {
        const auto hello = virtual_bus::from_record<virtual_bus::Hello>(record);
        if (hello.magic != virtual_bus::magic || hello.version != virtual_bus::version || hello.bit_rate == 0)
          return end(not_understood());
        bit_rate_ = hello.bit_rate;
        data_factor_ = hello.fd;
        credit_ = granted_ = hello.credit;
        bus_name_.assign(hello.name.data(), ::strnlen(hello.name.data(), hello.name.size()));
        return;
      }
      case Type::filters:
      case Type::filter:
        break;
    }
    end(not_understood());
  }

  /// A frame that was read; the data of CAN FD ones are in a list of their own.
  struct Kept {
    can::Received classic;
    bool fd = false;
  };

  void keep(const Kept& kept, const can::AnyFrame* fd = nullptr) {
    if (next_ == inbox_.size() || inbox_.size() == max_inbox) {
      inbox_.erase(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(next_));
      next_ = 0;
    }
    if (inbox_.size() == max_inbox) {
      ++counters_.lost;
      return;
    }
    inbox_.push_back(kept);
    if (fd != nullptr) fd_inbox_.push_back(*fd);
  }

  /// The next frame of the wanted kind that was read and passes the filters:
  /// what the server sent before it knew them does not.
  template <class R>
  [[nodiscard]] bool take(R& received) {
    while (next_ < inbox_.size()) {
      const Kept& kept = inbox_[next_++];
      received.time = kept.classic.time;
      if (kept.fd) {
        const can::AnyFrame frame = fd_inbox_.front();
        fd_inbox_.pop_front();
        if (!passes(frame.id, frame.format)) continue;
        if constexpr (std::is_same_v<R, ReceivedAny>) {
          received.frame = frame;
        } else {
          ++counters_.passed_over;
          continue;
        }
      } else {
        const can::Frame& frame = kept.classic.frame;
        const bool error = frame.format == can::Format::error;
        if (!error && !passes(frame.id, frame.format)) continue;
        if (error) ++counters_.error_frames;
        received.frame = frame;
      }
      ++counters_.received;
      return true;
    }
    return false;
  }

  [[nodiscard]] bool passes(std::uint32_t id, can::Format format) const noexcept {
    return filters_.empty() || std::any_of(filters_.begin(), filters_.end(), [&](const can::Filter& filter) {
             return filter.accepts(id, format);
           });
  }

  // --- the end ---

  /// The first reason stays.
  void end(Failure failure) {
    if (ended_) return;
    ended_ = true;
    ending_ = std::move(failure);
  }

  [[nodiscard]] Failure gone() const {
    return {"the simulator" + process_ + " on '" + path_ + "' is gone",
            "start it again; if it crashed, please report what it said last", host::Cause::simulator_gone};
  }

  [[nodiscard]] Failure not_understood() const {
    return {"the simulator" + process_ + " on '" + path_ + "' said something that this program does not know",
            "use the simulator and the program of the same version of ocm"};
  }

  [[nodiscard]] Failure dismissed(const virtual_bus::Goodbye& goodbye) const {
    using virtual_bus::Reason;
    const std::string simulator = "the simulator" + process_ + " on '" + path_ + "'";
    switch (goodbye.reason) {
      case Reason::leaving:
      case Reason::ended:
        return {simulator + " was ended", "start it again", host::Cause::simulator_missing};
      case Reason::full:
        return {simulator + " has no file descriptor left for this program",
                "close other programs on the bus, or raise the simulator's limit: ulimit -n"};
      case Reason::other_user:
        return {simulator + " belongs to another user", "start one of your own",
                host::Cause::simulator_foreign};
      case Reason::bad_version:
        return {simulator + " speaks version " + std::to_string(goodbye.version) +
                    " of the virtual bus's protocol, this program version " + std::to_string(goodbye.detail),
                "use the simulator and the program of the same version of ocm"};
      default:
        return {simulator + " disconnected this program: " + virtual_bus::describe(goodbye),
                "this is a fault of this program, or of another version of ocm: please report it"};
    }
  }

  host::Descriptor socket_;
  std::string name_;
  std::string path_;
  std::string process_;
  std::string bus_name_;
  std::uint32_t bit_rate_ = 0;
  std::uint32_t data_factor_ = 0;  ///< of the data of CAN FD frames; 0: the server does not know them
  std::uint64_t credit_ = 0;
  std::uint64_t granted_ = 0;  ///< credit when nothing is under way
  bool ended_ = false;         ///< nothing more comes from the server; frames may still wait in the inbox
  Failure ending_;             ///< why
  Failure failure_;            ///< the same, once the caller knows it
  BusCounters counters_;
  std::vector<can::Filter> filters_;
  std::vector<Kept> inbox_;
  std::deque<can::AnyFrame> fd_inbox_;  ///< those of the inbox that were not taken
  virtual_bus::FdAssembly coming_;
  std::size_t next_ = 0;  ///< in the inbox
  std::vector<std::byte> buffer_;
  std::array<iovec, messages_at_once> places_{};
  std::array<mmsghdr, messages_at_once> messages_{};
};

}  // namespace ocm::transport
