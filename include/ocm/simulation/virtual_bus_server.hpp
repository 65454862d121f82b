/// Serves a simulated CAN bus to other programs of the same user, on a local socket: each client is a node,
/// frames take their bit times and arbitrate. docs/virtual-bus.md has the whole picture. Host only.
///
///     auto server = VirtualBusServer::open({.bit_rate = 500'000});
///     Port board{(*server)->arbiter(), {QueueOrder::by_identifier, 3}};
///     for (;;) {
///       ... wait until next_event(), or until descriptor() is readable ...
///       (*server)->poll(now, [&](const Delivery& d) { ... the board hears d.frame at d.time ...
///       });
///     }
///
/// Time is handed in and no call waits, so that a slow, dead or hostile client costs the others nothing but
/// its share of work. Not thread-safe.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <memory>
#include <poll.h>
#include <string>
#include <string_view>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <utility>
#include <vector>

#include "ocm/can/filter.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/failure.hpp"
#include "ocm/host/local_listener.hpp"
#include "ocm/host/local_socket.hpp"
#include "ocm/host/system_time.hpp"
#include "ocm/simulation/arbiter.hpp"
#include "ocm/simulation/error_report.hpp"
#include "ocm/simulation/record_queue.hpp"
#include "ocm/transport/virtual_bus_protocol.hpp"

namespace ocm::simulation {

namespace virtual_bus = transport::virtual_bus;

struct VirtualBusOptions {
  std::string path{};                  ///< of the socket; empty: virtual_bus::default_path()
  std::string name = "sim";            ///< of the bus or robot, for clients to show; 11 bytes are kept
  std::uint32_t bit_rate = 500'000;    ///< 1 to 1'000'000'000 bit/s
  std::uint32_t data_bit_rate = 0;     ///< of CAN FD frames with bit-rate switch: `bit_rate` or a multiple of
                                       ///< it, up to 255 times; 0: `bit_rate`
  base::Time epoch{};                  ///< the first boundary of a bit, in the time handed to `poll`
  base::Duration to_unix_time{};       ///< added to the bus's time in the stamps that
                                       ///< clients get
  std::size_t transmit_queue = 64;     ///< frames of a client that may wait for the bus, at least 1
  std::size_t output_queue = 4096;     ///< frames that may wait for a client to read them, besides 200 KiB
                                       ///< in the kernel; at least 1
  bool raise_descriptor_limit = true;  ///< to the hard limit of the process, so that more clients fit
  base::Duration patience = std::chrono::seconds{1};  ///< with another server that starts just now
  /// At its end the server waits so long for clients that are behind; what they have not read by then is
  /// counted.
  base::Duration last_flush = std::chrono::milliseconds{500};
  std::function<void(std::string_view)> report{};  ///< told a sentence when a client is turned away
};

/// What happened to clients and their frames. What happened on the bus is in `arbiter().totals()`.
struct VirtualBusCounters {
  std::uint64_t welcomed = 0;         ///< clients that said hello
  std::uint64_t left = 0;             ///< in order; their waiting frames are sent
  std::uint64_t died = 0;             ///< without a word; their waiting frames are withdrawn
  std::uint64_t turned_away = 0;      ///< instead of welcomed: another user, another version, no greeting
  std::uint64_t misbehaved = 0;       ///< disconnected for what they sent; their
                                      ///< waiting frames are withdrawn
  std::uint64_t accept_failures = 0;  ///< connections that found no file descriptor or memory
  std::uint64_t overruns = 0;         ///< frames dropped for clients that read too slowly; each was informed
  std::uint64_t withdrawn = 0;        ///< frames
  std::uint64_t fd_withheld = 0;      ///< CAN FD frames that a client of an earlier version does not know
};

class VirtualBusServer {
 public:
  /// Replaces the socket of a server that has died; refuses when one is running, or when others could reach
  /// the socket. Creates the default directory. Waits at most `patience` for another server that starts just
  /// now.
  [[nodiscard]] static host::Outcome<std::unique_ptr<VirtualBusServer>> open(VirtualBusOptions options = {}) {
    if (options.bit_rate < 1 || options.bit_rate > BitClock::max_bit_rate)
      return host::Failure{"no bus runs at " + std::to_string(options.bit_rate) + " bit/s",
                           "choose a bit rate from 1 to 1000000000; the robot's is 500000"};
    if (options.data_bit_rate == 0) options.data_bit_rate = options.bit_rate;
    if (options.data_bit_rate % options.bit_rate != 0 ||
        options.data_bit_rate / options.bit_rate > most_faster ||
        options.data_bit_rate > BitClock::max_bit_rate)
      return host::Failure{"no data of CAN FD runs at " + std::to_string(options.data_bit_rate) +
                               " bit/s on a bus of " + std::to_string(options.bit_rate),
                           "choose the bit rate of the bus, or a whole multiple of it, such "
                           "as " +
                               std::to_string(std::min(4 * std::uint64_t{options.bit_rate},
                                                       std::uint64_t{BitClock::max_bit_rate} /
                                                           options.bit_rate * options.bit_rate)) +
                               "; at most " + std::to_string(most_faster) + " times"};
    std::string path = options.path.empty() ? virtual_bus::default_path() : options.path;
    auto socket = host::LocalListener::open(std::move(path), options.patience, service);
    if (!socket) return std::move(socket.error);
    host::Descriptor events{::epoll_create1(EPOLL_CLOEXEC)};
    host::Descriptor spare{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.ptr = nullptr;
    if (!events || !spare || ::epoll_ctl(events.get(), EPOLL_CTL_ADD, socket->descriptor(), &event) < 0)
      return host::LocalListener::failure(socket->path(), errno, service);
    if (options.raise_descriptor_limit) raise_limit();
    return std::unique_ptr<VirtualBusServer>(new VirtualBusServer(std::move(options), std::move(socket.value),
                                                                  std::move(events), std::move(spare)));
  }

  VirtualBusServer(const VirtualBusServer&) = delete;
  VirtualBusServer& operator=(const VirtualBusServer&) = delete;

  /// As `end`; the socket goes with it.
  ~VirtualBusServer() { end(); }

  /// Hands out what waits for the clients, at most for `last_flush`, and disconnects them. What each of them
  /// lost is reported to it, and in `counters().overruns`.
  void end() {
    flush_all(options_.last_flush);
    for (auto& client : clients_) dismiss(*client, {.reason = virtual_bus::Reason::ended});
    clients_.clear();
  }

  [[nodiscard]] const std::string& path() const noexcept { return socket_.path(); }
  /// Readable when a client has something to say. An epoll descriptor; owned by the server.
  [[nodiscard]] int descriptor() const noexcept { return events_.get(); }
  /// When to call `poll` at the latest: at the end of the frame on the bus. base::never when it is idle.
  /// Whatever it is, it lies in the future after `advance` to that time.
  [[nodiscard]] base::Time next_event() const noexcept {
    return std::min(arbiter_.next_event(), accept_again_);
  }
  /// The bus: attach boards, send their frames, read its load.
  [[nodiscard]] Arbiter& arbiter() noexcept { return arbiter_; }
  [[nodiscard]] const Arbiter& arbiter() const noexcept { return arbiter_; }
  [[nodiscard]] const VirtualBusCounters& counters() const noexcept { return counters_; }
  /// Connections, those that have not said hello yet included.
  [[nodiscard]] std::size_t clients() const noexcept { return clients_.size(); }

  /// Lets the bus go on until `now`; no system call. `deliver(const Delivery&)` is called for
  /// every frame that is complete by then, as Arbiter::advance does; clients get an error frame for every
  /// error on the bus. For boards that act at times of their
  /// own: advance to each of these, and `poll` at the end.
  template <class Deliver>
  void advance(base::Time now, Deliver&& deliver) {
    if (accept_again_ <= now) accept_again_ = base::never;  // at the next `poll`
    arbiter_.advance(
        now,
        [&](const Delivery& delivery) {
          distribute(delivery);
          deliver(delivery);
        },
        [&](const BusError& error) { distribute(error); });
  }

  /// Advances the bus, then takes what clients sent (their frames are handed over at `now`), accepts new
  /// ones and hands out what is complete. Waits for nothing.
  template <class Deliver>
  void poll(base::Time now, Deliver&& deliver) {
    advance(now, deliver);
    serve(now);
  }
  void poll(base::Time now) {
    poll(now, [](const Delivery&) {});
  }

  /// Gives every client an error frame (can::Format::error), as a controller's driver would report it. At the
  /// next `poll` it is on its way. Not on the bus: boards do not hear it. Other frames are refused.
  base::Status report_error(const can::Frame& frame, base::Time time) {
    if (frame.format != can::Format::error) return base::Error::bad_identifier;
    if (const auto valid = can::validate(frame); !valid) return valid;
    const virtual_bus::Record record = virtual_bus::to_record(frame, time + options_.to_unix_time);
    for (auto& client : clients_)
      if (client->welcome) push(*client, {&record, 1});
    return {};
  }

 private:
  static constexpr std::size_t messages_at_once = 64;
  static constexpr std::uint32_t most_faster = 255;
  static constexpr base::Duration accept_pause = std::chrono::milliseconds{100};

  struct Client {
    host::Descriptor socket;
    std::optional<ucred> peer;
    NodeId node{};         ///< from its hello on
    bool welcome = false;  ///< it said hello
    bool blocked = false;  ///< its socket is full: wait for EPOLLOUT
    bool deaf = false;     ///< nothing can be sent to it any more
    bool gone = false;     ///< to be forgotten at the end of this poll
    RecordQueue output;
    std::uint64_t credit = 0;  ///< owed
    std::uint64_t lost = 0;    ///< and not told yet
    std::vector<can::Filter> filters;
    std::vector<can::Filter> coming_filters;
    std::size_t missing_filters = 0;
    bool fd = false;  ///< it knows CAN FD
    virtual_bus::FdAssembly coming;

    /// Something waits for it.
    [[nodiscard]] bool owed() const noexcept { return output.size() != 0 || credit != 0 || lost != 0; }
  };

  /// What a client has to know beside frames: how many of its own are sent, and how many it missed. Room for
  /// a goodbye.
  struct Accounts {
    explicit Accounts(const Client& client) {
      add(virtual_bus::Type::credit, client.credit);
      add(virtual_bus::Type::overrun, client.lost);
    }
    void add(virtual_bus::Type type, std::uint64_t number) {
      if (number != 0) records[count++] = to_record(virtual_bus::Count{.type = type, .count = number});
    }
    std::array<virtual_bus::Record, 3> records;
    std::size_t count = 0;
  };

  static constexpr host::LocalService service{"a virtual bus", "a simulator", host::Cause::simulator_running};

  VirtualBusServer(VirtualBusOptions options, host::LocalListener socket, host::Descriptor events,
                   host::Descriptor spare)
      : options_(std::move(options)),
        socket_(std::move(socket)),
        events_(std::move(events)),
        spare_(std::move(spare)),
        arbiter_(options_.bit_rate, options_.epoch, options_.data_bit_rate / options_.bit_rate),
        buffer_(messages_at_once * virtual_bus::max_message) {
    options_.transmit_queue = std::clamp<std::size_t>(options_.transmit_queue, 1, UINT32_MAX);
    options_.output_queue = std::max<std::size_t>(options_.output_queue, 1);
    for (std::size_t i = 0; i < messages_at_once; ++i) {
      places_[i] = {buffer_.data() + i * virtual_bus::max_message, virtual_bus::max_message};
      messages_[i].msg_hdr.msg_iov = &places_[i];
      messages_[i].msg_hdr.msg_iovlen = 1;
    }
  }

  static void raise_limit() noexcept {
    rlimit limit{};
    if (::getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur < limit.rlim_max) {
      limit.rlim_cur = limit.rlim_max;
      ::setrlimit(RLIMIT_NOFILE, &limit);
    }
  }

  // --- from the bus to the clients ---

  void distribute(const Delivery& delivery) {
    if (delivery.fd != nullptr) return distribute_fd(delivery);
    const virtual_bus::Record record =
        virtual_bus::to_record(delivery.frame, delivery.time + options_.to_unix_time);
    for (auto& client : clients_) {
      if (!client->welcome || client->gone) continue;
      if (client->node == delivery.from)
        client->credit += delivery.sent ? 1 : 0;
      else if (passes(*client, delivery.frame))
        push(*client, {&record, 1});
    }
  }

  void distribute_fd(const Delivery& delivery) {
    const auto records = virtual_bus::to_fd_records(*delivery.fd, delivery.time + options_.to_unix_time);
    for (auto& client : clients_) {
      if (!client->welcome || client->gone) continue;
      if (client->node == delivery.from)
        client->credit += delivery.sent ? 1 : 0;
      else if (!passes(*client, delivery.frame))
        continue;
      else if (client->fd)
        push(*client, records.all());
      else
        ++counters_.fd_withheld;
    }
  }

  /// As each client's own controller would report it.
  void distribute(const BusError& error) {
    for (auto& client : clients_) {
      if (!client->welcome || client->gone) continue;
      const can::Frame frame = error_report(arbiter_.faults(client->node), client->node == error.sender);
      const virtual_bus::Record record = virtual_bus::to_record(frame, error.time + options_.to_unix_time);
      push(*client, {&record, 1});
    }
  }

  [[nodiscard]] static bool passes(const Client& client, const can::Frame& frame) noexcept {
    return client.filters.empty() ||
           std::any_of(client.filters.begin(), client.filters.end(),
                       [&](const can::Filter& filter) { return filter.accepts(frame); });
  }

  /// The records of one frame.
  void push(Client& client, std::span<const virtual_bus::Record> records) {
    if (client.deaf || client.output.push(records, options_.output_queue)) return;
    ++client.lost;
    ++counters_.overruns;
  }

  void flush(Client& client) {
    while (!client.deaf && !client.blocked && client.owed()) {
      // Credit and losses go first and need no place in the queue: they always get through.
      Accounts accounts{client};
      const std::size_t records = std::min(client.output.size(), virtual_bus::max_records - accounts.count);
      const auto pieces = client.output.front(records);
      std::array<iovec, 3> all{iovec{accounts.records.data(), accounts.count * virtual_bus::record_size},
                               pieces[0], pieces[1]};
      msghdr message{};
      message.msg_iov = all.data();
      message.msg_iovlen = all.size();
      if (::sendmsg(client.socket.get(), &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0) {
        client.output.pop(records);
        client.credit = 0;
        client.lost = 0;
      } else if (errno == EAGAIN || errno == ENOBUFS || errno == ENOMEM) {
        client.blocked = true;
        watch(client);
      } else if (errno != EINTR) {
        client.deaf = true;  // what it sent before it died is still to be read
        client.output.clear();
      }
    }
  }

  /// Until nothing waits for any client, or the time is over: a client that is stopped does not keep us.
  void flush_all(base::Duration limit) {
    const auto end = std::chrono::steady_clock::now() + limit;
    for (;;) {
      std::vector<pollfd> behind;
      for (auto& client : clients_) {
        if (client->gone) continue;
        flush(*client);
        if (!client->deaf && client->owed()) behind.push_back({client->socket.get(), POLLOUT, 0});
      }
      const base::Duration rest = end - std::chrono::steady_clock::now();
      if (behind.empty() || rest <= base::Duration::zero()) return;
      const timespec wait = host::to_timespec(rest);
      if (::ppoll(behind.data(), behind.size(), &wait, nullptr) < 0 && errno != EINTR) return;
      // Who has room again is tried again; a socket that is still full says so at once.
      for (auto& client : clients_) client->blocked = false;
    }
  }

  // --- from the clients ---

  void serve(base::Time now) {
    if (paused_ && accept_again_ == base::never) accept(now);
    ready_.resize(clients_.size() + 1);
    const int count = ::epoll_wait(events_.get(), ready_.data(), static_cast<int>(ready_.size()), 0);
    bool knocking = false;
    for (int i = 0; i < count; ++i) {
      const epoll_event& event = ready_[static_cast<std::size_t>(i)];
      auto* const client = static_cast<Client*>(event.data.ptr);
      if (client == nullptr) {
        knocking = true;
        continue;
      }
      if ((event.events & EPOLLOUT) != 0) {
        client->blocked = false;
        watch(*client);
      }
      if ((event.events & ~static_cast<std::uint32_t>(EPOLLOUT)) != 0) read(*client, now);
    }
    if (knocking && !paused_) accept(now);
    for (auto& client : clients_)
      if (!client->gone) flush(*client);
    std::erase_if(clients_, [](const auto& client) { return client->gone; });
  }

  /// One batch: what is left makes the descriptor readable again.
  void read(Client& client, base::Time now) {
    int count = 0;
    do {
      for (mmsghdr& message : messages_) message.msg_hdr.msg_flags = 0;
      count = ::recvmmsg(client.socket.get(), messages_.data(), messages_at_once, MSG_DONTWAIT, nullptr);
      // ECONNRESET: it closed its end with frames unread. What it sent before is still there.
    } while (count < 0 && (errno == EINTR || errno == ECONNRESET));
    if (count < 0 && errno != EAGAIN) return lose(client);
    for (int i = 0; i < count && !client.gone; ++i) {
      const mmsghdr& message = messages_[static_cast<std::size_t>(i)];
      if (message.msg_len == 0) return lose(client);
      if ((message.msg_hdr.msg_flags & MSG_TRUNC) != 0 || message.msg_len % virtual_bus::record_size != 0)
        return refuse(client, {.reason = virtual_bus::Reason::bad_size, .detail = message.msg_len});
      const auto* const bytes = static_cast<const std::byte*>(message.msg_hdr.msg_iov->iov_base);
      for (std::size_t at = 0; at < message.msg_len && !client.gone; at += virtual_bus::record_size) {
        virtual_bus::Record record;
        std::memcpy(record.data(), bytes + at, record.size());
        take(client, record, now);
      }
    }
  }

  void take(Client& client, const virtual_bus::Record& record, base::Time now) {
    using virtual_bus::Reason;
    using virtual_bus::Type;
    const Type type = virtual_bus::type_of(record);
    const auto number = static_cast<std::uint64_t>(type);
    if (!client.welcome) {
      const auto hello = virtual_bus::from_record<virtual_bus::Hello>(record);
      if (type != Type::hello || hello.magic != virtual_bus::magic)
        return refuse(client, {.reason = Reason::no_hello, .detail = number});
      if (hello.version != virtual_bus::version)
        return refuse(client, {.reason = Reason::bad_version, .detail = hello.version});
      client.fd = hello.fd != 0;
      return welcome(client);
    }
    if (client.coming.waits() && type != Type::fd_data)
      return refuse(client, {.reason = Reason::torn_fd_frame, .detail = number});
    switch (type) {
      case Type::fd_frame:
      case Type::fd_data: {
        if (!client.fd) break;
        const auto whole = client.coming.take(record);
        if (!whole) return refuse(client, whole.error);
        if (!*whole) return;
        const auto taken = arbiter_.send_any(client.node, client.coming.frame(), now);
        if (!taken || !*taken) refuse(client, {.reason = Reason::no_credit});
        return;
      }
      case Type::frame: {
        const auto frame = virtual_bus::decode(virtual_bus::from_record<virtual_bus::FrameRecord>(record));
        if (!frame) return refuse(client, frame.error);
        const auto taken = arbiter_.send(client.node, *frame, now);
        if (!taken)  // an error frame: all else was looked at
          return refuse(client,
                        {.reason = Reason::bad_format, .detail = static_cast<std::uint8_t>(frame->format)});
        if (!*taken) refuse(client, {.reason = Reason::no_credit});
        return;
      }
      case Type::filters: {
        const auto count = virtual_bus::from_record<virtual_bus::Count>(record).count;
        if (count > virtual_bus::max_filters || client.missing_filters != 0)
          return refuse(client, {.reason = Reason::bad_filters, .detail = count});
        client.coming_filters.clear();
        client.missing_filters = static_cast<std::size_t>(count);
        if (count == 0) client.filters.clear();
        return;
      }
      case Type::filter: {
        if (client.missing_filters == 0) return refuse(client, {.reason = Reason::bad_filters, .detail = 1});
        const auto filter = virtual_bus::from_record<virtual_bus::FilterRecord>(record);
        client.coming_filters.push_back({filter.id, filter.mask});
        if (--client.missing_filters == 0) client.filters.swap(client.coming_filters);
        return;
      }
      case Type::goodbye:
        ++counters_.left;
        arbiter_.detach(client.node, Leftovers::send);
        client.gone = true;
        return;
      case Type::hello:
      case Type::credit:
      case Type::overrun:
        break;
    }
    refuse(client, {.reason = Reason::unknown_record, .detail = number});
  }

  void welcome(Client& client) {
    client.welcome = true;
    client.node = arbiter_.attach({QueueOrder::fifo, options_.transmit_queue});
    virtual_bus::Hello hello;
    hello.fd = static_cast<std::uint8_t>(arbiter_.data_factor());
    hello.bit_rate = options_.bit_rate;
    hello.credit = static_cast<std::uint32_t>(options_.transmit_queue);
    std::copy_n(options_.name.begin(), std::min(options_.name.size(), hello.name.size() - 1),
                hello.name.begin());
    client.output.push(to_record(hello), 1);
    ++counters_.welcomed;
  }

  /// The client's end is closed.
  void lose(Client& client) {
    client.gone = true;
    if (!client.welcome) return;  // a program that only checked whether a server runs
    ++counters_.died;
    counters_.withdrawn += arbiter_.detach(client.node, Leftovers::withdraw);
  }

  void refuse(Client& client, const virtual_bus::Goodbye& goodbye) {
    ++(client.welcome ? counters_.misbehaved : counters_.turned_away);
    report(client, goodbye);
    flush(client);
    dismiss(client, goodbye);
    counters_.withdrawn += arbiter_.detach(client.node, Leftovers::withdraw);
    client.gone = true;
  }

  void report(const Client& client, const virtual_bus::Goodbye& goodbye) const {
    if (options_.report)
      options_.report("a client" + host::process_text(client.peer) +
                      " was disconnected: " + virtual_bus::describe(goodbye));
  }

  /// The last message: the frames that still wait are lost to the client, and it learns how many. It gets
  /// through to a client whose socket is full, because the socket is made larger for it.
  void dismiss(Client& client, const virtual_bus::Goodbye& goodbye) {
    const std::uint64_t unread = frames_in(client.output);
    client.lost += unread;
    counters_.overruns += unread;
    client.output.clear();
    Accounts accounts{client};
    accounts.records[accounts.count++] = to_record(goodbye);
    const std::size_t size = accounts.count * virtual_bus::record_size;
    for (const int option : {0, SO_SNDBUF, SO_SNDBUFFORCE}) {
      // The kernel takes twice its limit (net.core.wmem_max), and a socket begins with once.
      constexpr int more = 1 << 24;
      if (option != 0) ::setsockopt(client.socket.get(), SOL_SOCKET, option, &more, sizeof more);
      if (::send(client.socket.get(), accounts.records.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0)
        return;
    }
  }

  /// A frame of CAN FD whose first record is on its way counts, too: without
  /// its rest it is lost.
  [[nodiscard]] static std::uint64_t frames_in(const RecordQueue& queue) noexcept {
    std::uint64_t frames = 0;
    for (std::size_t i = 0; i < queue.size(); ++i)
      if (i == 0 || virtual_bus::type_of(queue[i]) != virtual_bus::Type::fd_data) ++frames;
    return frames;
  }

  // --- connections ---

  void watch(Client& client) noexcept {
    epoll_event event{};
    event.events = EPOLLIN;
    if (client.blocked) event.events |= EPOLLOUT;
    event.data.ptr = &client;
    ::epoll_ctl(events_.get(), EPOLL_CTL_MOD, client.socket.get(), &event);
  }

  void pause_accepting(bool on) noexcept {
    if (on == paused_) return;
    paused_ = on;
    epoll_event event{};
    event.events = on ? 0U : EPOLLIN;
    event.data.ptr = nullptr;
    ::epoll_ctl(events_.get(), EPOLL_CTL_MOD, socket_.descriptor(), &event);
  }

  /// All who wait, up to as many as the kernel lets wait.
  void accept(base::Time now) {
    pause_accepting(false);
    for (int i = 0; i < SOMAXCONN; ++i) {
      if (!spare_) spare_ = host::Descriptor{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
      auto client = std::make_unique<Client>();
      client->socket = accept_one();
      if (!client->socket) {
        if (errno == EAGAIN) return;
        if (errno == EINTR || errno == ECONNABORTED) continue;
        const Turned turned = turn_away_one();
        if (turned == Turned::none) return;
        ++counters_.accept_failures;
        if (turned == Turned::away) continue;
        // Nothing helps now. The listener would stay readable and keep the owner busy: look again later.
        pause_accepting(true);
        accept_again_ = now + accept_pause;
        return;
      }
      client->peer = host::peer_of(client->socket.get());
      if (!client->peer || client->peer->uid != ::geteuid()) {
        refuse(*client, {.reason = virtual_bus::Reason::other_user,
                         .detail = client->peer ? client->peer->uid : UINT32_MAX});
        continue;  // it is gone: nothing of it is kept
      }
      epoll_event event{};
      event.events = EPOLLIN;
      event.data.ptr = client.get();
      if (::epoll_ctl(events_.get(), EPOLL_CTL_ADD, client->socket.get(), &event) < 0) {
        ++counters_.accept_failures;
        dismiss(*client, {.reason = virtual_bus::Reason::full});
        continue;
      }
      clients_.push_back(std::move(client));
    }
  }

  [[nodiscard]] host::Descriptor accept_one() const noexcept {
    return host::Descriptor{::accept4(socket_.descriptor(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)};
  }

  enum class Turned : std::uint8_t { away, none, failed };

  /// With no descriptor left, the spare one gives room to tell a client so. The kernel says that there is
  /// none also when no client waits.
  Turned turn_away_one() {
    spare_.reset();
    Client client;
    client.socket = accept_one();
    const Turned turned = client.socket ? Turned::away : errno == EAGAIN ? Turned::none : Turned::failed;
    if (turned == Turned::away) {
      client.peer = host::peer_of(client.socket.get());
      report(client, {.reason = virtual_bus::Reason::full});
      dismiss(client, {.reason = virtual_bus::Reason::full});
    }
    client.socket.reset();
    spare_ = host::Descriptor{::open("/dev/null", O_RDONLY | O_CLOEXEC)};
    return turned;
  }

  VirtualBusOptions options_;
  host::LocalListener socket_;
  host::Descriptor events_;
  host::Descriptor spare_;
  Arbiter arbiter_;
  VirtualBusCounters counters_;
  bool paused_ = false;                    ///< the listener is left alone, until `poll` at or after
  base::Time accept_again_ = base::never;  ///< which passes in `advance`
  std::vector<std::unique_ptr<Client>> clients_;
  std::vector<epoll_event> ready_;
  std::vector<std::byte> buffer_;
  std::array<iovec, messages_at_once> places_{};
  std::array<mmsghdr, messages_at_once> messages_{};
};

}  // namespace ocm::simulation
