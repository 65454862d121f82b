/// A serial CAN adapter that speaks SLCAN (can/slcan_host.hpp) as a bus: a device such as /dev/ttyACM0, a
/// pty, or a local stream socket (a board in QEMU). No kernel part, no root. Host only.
///
/// - Frames carry the adapter's milliseconds, mapped to Unix time, where it has them (command Z1), else the
///   time of reading.
/// - An adapter that answers has at most `window` frames unanswered. One that it refuses (BEL: its buffer is
///   full) is sent again, before anything else; of one identifier only one frame is under way, so the order
///   within an identifier stays. Until there is room again `send` answers false.
/// - Adapters that never answer are taken as they are: dropped frames cannot be counted.
/// - Errors of the bus come as error frames: from the status flags, asked for once a second, and from the
///   lines that linux's driver understands too.
/// - What is not a line of the protocol is counted (`line_faults`), and never becomes a frame.
/// - One system call for up to 4 KiB of text. Filters are applied here.
#pragma once

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <poll.h>
#include <span>
#include <string>
#include <string_view>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <vector>

#include "ocm/can/slcan_codec.hpp"
#include "ocm/can/slcan_host.hpp"
#include "ocm/host/descriptor.hpp"
#include "ocm/host/system_time.hpp"
#include "ocm/transport/bus.hpp"
#include "ocm/transport/serial_port.hpp"
#include "ocm/transport/slcan_address.hpp"
#include "ocm/transport/slcan_stamps.hpp"

namespace ocm::transport {

/// What happened between this program and the adapter.
struct SlcanCounters {
  std::uint64_t sent_again = 0;  ///< frames that the adapter had refused
  std::uint64_t unanswered = 0;  ///< commands without an answer: it is not known whether the frame went out
  std::uint64_t strays = 0;      ///< answers to nothing
};

class Slcan final : public Bus {
 public:
  /// `name` as parse_slcan_address has it. The failure says what is wrong, where, and what to do.
  [[nodiscard]] static Outcome<std::unique_ptr<Slcan>> open(std::string_view name) {
    auto address = parse_slcan_address(name);
    if (!address) return address.error;
    return open(address->path, address->options);
  }

  /// Takes the adapter for this program alone, closes its channel, sets the bit rate and opens it again.
  /// Takes a few round trips; `first_answer` once for an adapter that never answers.
  [[nodiscard]] static Outcome<std::unique_ptr<Slcan>> open(const std::string& path,
                                                            const SlcanOptions& options) {
    if (!can::slcan::bit_rate_code(options.bit_rate)) {
      auto wrong = parse_slcan_address(path + "@" + std::to_string(options.bit_rate));
      return wrong.error;
    }
    struct stat status {};
    if (::stat(path.c_str(), &status) < 0) return detail::open_failure(path, errno);
    const bool is_socket = S_ISSOCK(status.st_mode);
    if (!is_socket && !S_ISCHR(status.st_mode)) return detail::no_serial_device(path, "a socket");
    auto bus = std::unique_ptr<Slcan>(new Slcan(path, options));
    if (auto problem = is_socket ? bus->connect() : bus->open_device()) return std::move(*problem);
    if (auto problem = bus->start()) return std::move(*problem);
    return bus;
  }

  /// Waits, at most `options.farewell`, until what was sent has been answered; then closes the adapter's
  /// channel and gives the line its settings back.
  ~Slcan() override {
    if (state() == BusState::up && started_) finish();
  }

  /// "slcan:" and the path.
  [[nodiscard]] std::string_view name() const override { return name_; }
  /// Whether the adapter answers commands. If not, it is not known whether frames are sent.
  [[nodiscard]] bool answers() const noexcept { return answers_; }
  /// What it says of itself after command V; empty when it does not.
  [[nodiscard]] const std::string& version() const noexcept { return version_; }
  [[nodiscard]] const can::slcan::LineFaults& line_faults() const noexcept { return reader_.faults(); }
  [[nodiscard]] const SlcanCounters& adapter_counters() const noexcept { return adapter_; }

  /// Never waits. false: the line has no room, or the adapter has not answered yet; `descriptor` becomes
  /// readable when it does.
  base::Result<bool> send(const can::Frame& frame) override {
    if (state() == BusState::closed) return base::Error::closed;
    const auto line = can::slcan::encode(frame);
    if (!line) return line.error;
    work();
    if (state() == BusState::closed) return base::Error::closed;
    if (!has_room(frame) || !write(line->view())) {
      if (state() == BusState::closed) return base::Error::closed;
      ++counters_.refused;
      return false;
    }
    ++counters_.sent;
    if (tracks()) under_way_.push_back({false, frame, now()});
    return true;
  }

  /// A signal that is caught while this waits ends it with Error::timed_out. After the adapter has gone the
  /// frames that were complete come first, then Error::closed.
  base::Result<can::Received> receive(base::Duration timeout) override {
    const base::Time begin = now();
    for (;;) {
      if (inbox_.empty()) work();
      if (!inbox_.empty()) {
        const can::Received received = inbox_.front();
        inbox_.pop_front();
        ++counters_.received;
        if (received.frame.format == can::Format::error) ++counters_.error_frames;
        return received;
      }
      if (state() == BusState::closed) return base::Error::closed;
      const base::Duration rest = timeout - (now() - begin);
      if (timeout <= base::Duration::zero() || rest <= base::Duration::zero()) return base::Error::timed_out;
      if (!wait(std::min(rest, until_due())) && errno == EINTR) return base::Error::timed_out;
    }
  }

  /// Filters here: the text of every frame is read either way. Frames that wait are filtered too.
  Outcome<void> subscribe(std::span<const can::Filter> filters) override {
    filters_.assign(filters.begin(), filters.end());
    std::erase_if(inbox_, [this](const can::Received& received) { return !passes(received.frame); });
    return {};
  }

  /// By the adapter's answers. An adapter that gives none to frames tells nothing.
  [[nodiscard]] Delivery delivery() override {
    work();
    if (!tracks() && out_.empty()) return {};
    const auto asked = [](const UnderWay& each) { return !each.status; };
    const auto waiting = std::count_if(under_way_.begin(), under_way_.end(), asked);
    // A frame that the line has taken in part is under way, where answers are awaited.
    const bool in_part = !tracks() && !out_.empty();
    return {.known = true,
            .pending =
                static_cast<std::uint64_t>(waiting) + again_.size() + never_answered_ + (in_part ? 1U : 0U)};
  }

  [[nodiscard]] int descriptor() const override { return port_ ? port_.descriptor() : socket_.get(); }
  [[nodiscard]] const BusCounters& counters() const override { return counters_; }
  [[nodiscard]] const Failure& failure() const override { return failure_; }

 private:
  using Answer = can::slcan::Answer;
  static constexpr std::size_t max_inbox =
      65'536;  ///< frames kept for a program that sends and never receives
  static constexpr base::Duration quiet = std::chrono::milliseconds{100};
  static constexpr base::Duration pause_before_again = std::chrono::milliseconds{2};

  /// A command whose answer is awaited.
  struct UnderWay {
    bool status = false;
    can::Frame frame{};
    base::Time since{};
  };
  enum class Confirms : std::uint8_t { unknown, yes, no };

  Slcan(const std::string& path, const SlcanOptions& options)
      : path_(path), name_("slcan:" + path), options_(options) {}

  [[nodiscard]] static base::Time now() noexcept {
    return base::Time{
        std::chrono::duration_cast<base::Duration>(std::chrono::steady_clock::now().time_since_epoch())};
  }
  [[nodiscard]] static base::Duration unix_minus_steady() noexcept {
    return std::chrono::duration_cast<base::Duration>(std::chrono::system_clock::now().time_since_epoch()) -
           now().time_since_epoch();
  }

  // --- opening ---

  [[nodiscard]] std::optional<Failure> connect() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path)
      return Failure{"the path '" + path_ + "' is too long for a socket",
                     "use one of at most 107 characters"};
    std::copy(path_.begin(), path_.end(), std::begin(address.sun_path));
    socket_ = host::Descriptor{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
    if (!socket_ || ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) < 0)
      return errno == EAGAIN ? detail::open_failure(path_, EBUSY) : detail::open_failure(path_, errno);
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Failure> open_device() {
    auto opened = SerialPort::open(path_, options_.baud);
    if (!opened) return std::move(opened.error);
    port_ = std::move(*opened);
    return std::nullopt;
  }

  /// From any state of the adapter, also in the middle of a line and with its channel open, to an open
  /// channel. [CAN232 manual: begin with CRs, then close]
  [[nodiscard]] std::optional<Failure> start() {
    tell("\rC\rV\r");
    const base::Time begin = now();
    base::Time last = begin;
    const base::Duration longest = std::max(options_.first_answer, 3 * options_.patience);
    for (std::size_t heard = 0; version_.empty() && now() - begin < longest;) {
      if (now() - last >= (answers_ ? quiet : options_.first_answer)) break;
      wait(std::chrono::milliseconds{10});
      read();
      if (state() == BusState::closed) return failure_;
      if (answers_heard_ != heard) last = now();
      heard = answers_heard_;
    }
    if (!answers_ && version_.empty() && line_faults().total() != 0) {
      return Failure{"what comes from '" + path_ + "' is not SLCAN (" +
                         std::to_string(line_faults().total()) + " lines of something else)",
                     "is this the adapter? Another speed of the serial line is written slcan:" + path_ + "@" +
                         detail::rate_text(options_.bit_rate) + ",57600"};
    }
    const auto code = can::slcan::bit_rate_code(options_.bit_rate);
    const auto digit = static_cast<char>('0' + *code);
    if (auto problem =
            demand(std::string{'S', digit, '\r'}, "the bit rate " + detail::rate_text(options_.bit_rate),
                   "it may serve others only, or be in use: unplug it and plug it in again"))
      return problem;
    if (answers_) (void)ask("Z1\r");  // one without a clock refuses: the time of reading does
    inbox_.clear();                   // of the channel as another program left it
    if (auto problem = demand("O\r", "to open the channel",
                              "unplug it and plug it in again; is its firmware one for SLCAN?"))
      return problem;
    if (answers_) {
      answer_to_status_ = false;
      (void)ask("F\r");
      asks_status_ = answer_to_status_;
    }
    opening_ = false;
    started_ = true;
    next_status_ = now() + options_.status_period;
    return failure_ == Failure{} ? std::nullopt : std::optional<Failure>{failure_};
  }

  /// Writes a command while opening.
  void tell(std::string_view command) {
    const base::Time begin = now();
    (void)write(command);
    while (!out_.empty() && state() == BusState::up && now() - begin < options_.patience) {
      pollfd line{descriptor(), POLLOUT, 0};
      ::poll(&line, 1, 10);
      flush();
    }
  }
  /// Writes a command while opening; the answer, none if there was none in time.
  [[nodiscard]] Answer::Kind ask(std::string_view command) {
    read();
    last_answer_ = Answer::Kind::none;
    tell(command);
    const base::Time begin = now();
    while (last_answer_ == Answer::Kind::none && state() == BusState::up &&
           now() - begin < options_.patience) {
      wait(std::chrono::milliseconds{10});
      read();
    }
    return last_answer_;
  }
  [[nodiscard]] std::optional<Failure> demand(std::string_view command, const std::string& what,
                                              const std::string& remedy) {
    if (!answers_) {
      tell(command);
    } else {
      const std::string quoted = " (command " + std::string(command.substr(0, command.size() - 1)) + ")";
      switch (ask(command)) {
        case Answer::Kind::refused:
          return Failure{"the adapter on '" + path_ + "' refuses " + what + quoted, remedy};
        case Answer::Kind::none:
          if (state() == BusState::closed) break;
          return Failure{
              "the adapter on '" + path_ + "' has stopped to answer when asked for " + what + quoted,
              "unplug it and plug it in again"};
        default:
          break;
      }
    }
    return state() == BusState::closed ? std::optional<Failure>{failure_} : std::nullopt;
  }

  // --- the line ---

  /// true: all of `text` is on its way. false: no room, nothing was written. A part that the kernel did not
  /// take waits in `out_`, and goes first.
  bool write(std::string_view text) {
    if (!flush()) return false;
    out_ = text;
    flush();
    if (state() == BusState::closed) return false;
    if (out_.size() != text.size()) return true;
    out_.clear();
    return false;
  }
  /// true when nothing waits.
  bool flush() {
    while (!out_.empty() && state() == BusState::up) {
      const ssize_t written = port_ ? ::write(descriptor(), out_.data(), out_.size())
                                    : ::send(descriptor(), out_.data(), out_.size(), MSG_NOSIGNAL);
      if (written > 0) {
        out_.erase(0, static_cast<std::size_t>(written));
        continue;
      }
      if (written < 0 && errno == EINTR) continue;
      if (written < 0 && errno != EAGAIN) lose(errno);
      break;
    }
    return out_.empty();
  }
  /// All that has come.
  void read() {
    std::array<char, 4096> text;  // NOLINT: filled by the kernel
    while (state() == BusState::up) {
      const ssize_t size = ::read(descriptor(), text.data(), text.size());
      if (size < 0 && errno == EINTR) continue;
      if (size < 0 && errno == EAGAIN) break;
      if (size <= 0) {
        lose(size < 0 ? errno : 0);
        break;
      }
      const base::Time arrival = now();
      for (const char c : std::string_view{text.data(), static_cast<std::size_t>(size)})
        handle(reader_.feed(c), arrival);
      if (inbox_.size() >= max_inbox || static_cast<std::size_t>(size) < text.size()) break;
    }
  }
  /// true: there is something to read, or to hear that the line is gone.
  bool wait(base::Duration limit) {
    const short events = out_.empty() ? POLLIN : POLLIN | POLLOUT;
    pollfd line{descriptor(), events, 0};
    const timespec time = host::to_timespec(limit);
    errno = 0;
    return ::ppoll(&line, 1, &time, nullptr) > 0;
  }
  void lose(int error) {
    if (state() == BusState::closed) return;
    failure_ = detail::line_gone("the adapter on '" + path_ + "'", error);
    if (reader_.mid_line()) failure_.what += ", in the middle of a line";
  }

  // --- the protocol ---

  [[nodiscard]] bool tracks() const noexcept { return answers_ && confirms_ != Confirms::no; }
  [[nodiscard]] bool has_room(const can::Frame& frame) const {
    if (!out_.empty()) return false;
    if (!tracks()) return true;
    const auto same = [&frame](const can::Frame& other) {
      return other.id == frame.id && can::is_extended(other.format) == can::is_extended(frame.format);
    };
    return again_.empty() && under_way_.size() < options_.window &&
           std::none_of(under_way_.begin(), under_way_.end(),
                        [&](const UnderWay& other) { return !other.status && same(other.frame); });
  }

  /// Reads, repeats what was refused, asks for the status, forgets what is never answered.
  void work() {
    if (state() == BusState::closed) return;
    read();
    flush();
    const base::Time time = now();
    while (!under_way_.empty() && time - under_way_.front().since >= options_.answer_limit) {
      const bool status = under_way_.front().status;
      under_way_.pop_front();
      ++adapter_.unanswered;
      if (!status) ++never_answered_;
      // One that has answered commands, but never a frame, does not answer frames.
      if (!status && confirms_ == Confirms::unknown) {
        confirms_ = Confirms::no;
        never_answered_ = 0;
        std::erase_if(under_way_, [](const UnderWay& other) { return !other.status; });
      }
    }
    while (!again_.empty() && time >= again_at_ && under_way_.size() < options_.window && out_.empty()) {
      const auto line = can::slcan::encode(again_.front());
      if (!write(line->view())) break;
      under_way_.push_back({false, again_.front(), time});
      again_.pop_front();
      ++adapter_.sent_again;
    }
    if (asks_status_ && time >= next_status_ && out_.empty() && write("F\r")) {
      under_way_.push_back({true, {}, time});
      next_status_ = time + options_.status_period;
    }
  }
  /// How long `work` has nothing to do unless something comes.
  [[nodiscard]] base::Duration until_due() const {
    base::Time due = base::never;
    if (asks_status_) due = std::min(due, next_status_);
    if (!again_.empty()) due = std::min(due, again_at_);
    if (!under_way_.empty()) due = std::min(due, under_way_.front().since + options_.answer_limit);
    const base::Time time = now();
    return due <= time ? base::Duration{std::chrono::milliseconds{1}} : due - time;
  }

  void handle(const Answer& answer, base::Time arrival) {
    switch (answer.kind) {
      case Answer::Kind::none:
        return;
      case Answer::Kind::frame:
        take(answer, arrival);
        return;
      case Answer::Kind::version:
        version_ = answer.text.empty() ? "?" : std::string(answer.text);
        break;
      case Answer::Kind::status_flags:
        take_status(answer.flags, arrival);
        break;
      case Answer::Kind::done:
      case Answer::Kind::taken:
      case Answer::Kind::refused:
        if (opening_) answers_ = true;
        break;
      case Answer::Kind::serial:
        break;
    }
    ++answers_heard_;
    last_answer_ = answer.kind;
    if (!opening_) settle(answer.kind);
  }

  /// Which command this answers: the oldest. A status question that something else answers was not answered.
  void settle(Answer::Kind kind) {
    const bool to_status = kind == Answer::Kind::status_flags;
    if (!to_status && kind != Answer::Kind::done && kind != Answer::Kind::taken &&
        kind != Answer::Kind::refused)
      return;
    while (!under_way_.empty() && under_way_.front().status != to_status) {
      if (kind == Answer::Kind::refused) {  // F is refused by one that has closed its channel by itself
        under_way_.pop_front();
        return;
      }
      ++adapter_.unanswered;
      under_way_.pop_front();
    }
    if (under_way_.empty()) {
      if (tracks()) ++adapter_.strays;
      return;
    }
    const UnderWay settled = under_way_.front();
    under_way_.pop_front();
    if (to_status) return;
    confirms_ = Confirms::yes;
    if (kind != Answer::Kind::refused) return;
    again_.push_back(settled.frame);
    again_at_ = now() + pause_before_again;
  }

  void take(const Answer& answer, base::Time arrival) {
    base::Time time = arrival;
    if (answer.stamped) time = clock_.map(answer.stamp, arrival);
    put({time + unix_minus_steady(), answer.frame});
  }
  void take_status(std::uint8_t flags, base::Time arrival) {
    answer_to_status_ = true;
    // A full transmit queue shows in refused frames, and these are sent again.
    if (confirms_ == Confirms::yes)
      flags &= static_cast<std::uint8_t>(~can::slcan::status::transmit_queue_full);
    const can::Frame frame = can::slcan::to_error_frame(flags, flags_);
    flags_ = flags;
    if (frame.id != 0) put({arrival + unix_minus_steady(), frame});
  }
  void put(const can::Received& received) {
    if (!passes(received.frame)) return;
    if (inbox_.size() >= max_inbox)
      ++counters_.lost;
    else
      inbox_.push_back(received);
  }
  [[nodiscard]] bool passes(const can::Frame& frame) const {
    return filters_.empty() || frame.format == can::Format::error ||
           std::any_of(filters_.begin(), filters_.end(),
                       [&frame](const can::Filter& filter) { return filter.accepts(frame); });
  }

  void finish() {
    asks_status_ = false;
    const base::Time begin = now();
    const auto in_time = [&] { return state() == BusState::up && now() - begin < options_.farewell; };
    while (in_time()) {
      work();
      if (out_.empty() && under_way_.empty() && again_.empty() && unsent() == 0) break;
      wait(std::min(until_due(), base::Duration{std::chrono::milliseconds{2}}));
    }
    if (state() != BusState::up || !write("C\r")) return;
    last_answer_ = Answer::Kind::none;
    const base::Time end = now() + std::chrono::milliseconds{50};
    do {
      wait(std::chrono::milliseconds{2});
      read();
    } while (state() == BusState::up && now() < end &&
             (answers_ ? last_answer_ == Answer::Kind::none : unsent() != 0));
  }
  /// A socket's bytes are gone when they are sent.
  [[nodiscard]] std::size_t unsent() const noexcept { return port_ ? port_.unsent() : 0; }

  std::string path_;
  std::string name_;
  SlcanOptions options_;
  SerialPort port_;  ///< one of the two
  host::Descriptor socket_;

  can::slcan::AnswerReader reader_;
  std::string out_;
  std::deque<can::Received> inbox_;
  std::deque<UnderWay> under_way_;
  std::deque<can::Frame> again_;
  base::Time again_at_{};
  base::Time next_status_{};
  std::vector<can::Filter> filters_;
  StampClock clock_;

  bool opening_ = true;
  bool started_ = false;
  bool answers_ = false;
  bool asks_status_ = false;
  bool answer_to_status_ = false;
  Confirms confirms_ = Confirms::unknown;
  std::uint8_t flags_ = 0;
  std::size_t answers_heard_ = 0;
  Answer::Kind last_answer_ = Answer::Kind::none;
  std::string version_;

  BusCounters counters_;
  SlcanCounters adapter_;
  std::uint64_t never_answered_ = 0;  ///< frames among the unanswered
  Failure failure_;
};

}  // namespace ocm::transport
