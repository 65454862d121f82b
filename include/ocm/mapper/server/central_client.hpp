/// Turns requests into a central's commands: scan, connect, say this to that robot, drop. Bytes in,
/// bytes out, time handed in; no I/O.
///
/// A request at a time, in their order. Before a word goes to a robot the central is in data mode with that
/// robot, and has said so; a command is only given in command mode. What mode a central is in at the
/// beginning, or after an answer was lost, it is not known: then `*` and `stop` settle it, for they are
/// harmless in any state, and the request is restarted. An answer that does not come, or is `error: ...`,
/// ends a request with words that say so. Reports of links are taken at any time.
///
/// O(1) a byte; the queue of requests is bounded. Host only.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/mapper/server/central_stream.hpp"

namespace ocm::mapper::server {

struct CentralClientOptions {
  base::Duration answer = std::chrono::seconds{1};        ///< how long a command may take to be answered
  base::Duration connect = std::chrono::seconds{10};      ///< and a link to come or go
  base::Duration again = std::chrono::milliseconds{300};  ///< before a busy central is asked again
  unsigned most_attempts = 3;
  unsigned most_robots = 256;  ///< indexes on its list are below; a list with others is refused
  std::size_t most_requests = 64;
};

/// A robot on the central's list.
struct Peer {
  unsigned index = 0;
  std::string address;
  std::string name;
  bool linked = false;
  friend bool operator==(const Peer&, const Peer&) = default;
};

/// What has become of requests, and of links.
struct CentralEvent {
  enum class Kind : std::uint8_t {
    listed,     ///< the list is there: `peers()`
    connected,  ///< a link is there, requested or not
    lost,       ///< a link is gone, requested or not
    said,       ///< the words went out; whether they were heard the robot shows
    failed,     ///< a request failed; `words` say why
  };
  Kind kind = Kind::failed;
  unsigned index = 0;  ///< the robot's; of `listed`: how many there are
  std::string words{};
  bool saying = false;  ///< of `failed`: words to a robot, which did not go out
};

/// What a client met. They wrap.
struct CentralClientCounters {
  std::uint32_t settled = 0;   ///< times that the mode had to be settled
  std::uint32_t timeouts = 0;  ///< answers that did not come
  std::uint32_t refused = 0;   ///< `error: ...`
  std::uint32_t strays = 0;    ///< lines that answer nothing
};

class CentralClient {
 public:
  using Options = CentralClientOptions;
  explicit CentralClient(const Options& options = {}) : options_(options) {}

  // --- requests. False when the queue is full. ---

  /// Looks for robots so long, then lists them. Zero: lists those that are known.
  bool scan(base::Duration time) { return request({Request::Kind::scan, 0, {}, time}); }
  /// A link to a robot of the list; one that is there stays.
  bool connect(unsigned index) { return request({Request::Kind::connect, index, {}, {}}); }
  /// Words to a robot with a link.
  bool say(unsigned index, std::string words) {
    return request({Request::Kind::say, index, std::move(words), {}});
  }
  bool drop(unsigned index) { return request({Request::Kind::drop, index, {}, {}}); }
  /// Command mode, for the next program.
  bool leave() { return request({Request::Kind::leave, 0, {}, {}}); }

  // --- the line ---

  /// Bytes from the central.
  void feed(std::string_view bytes, base::Time now) {
    for (const char c : bytes)
      stream_.feed(
          c, [this](char robots) { robots_ += robots; },
          [this, now](const CentralLine& line) { hear(line, now); });
    advance(now);
  }
  /// To be called at `deadline()`, and whenever there is a new request.
  void expire(base::Time now) {
    if (now >= deadline_) late(now);
    advance(now);
  }
  [[nodiscard]] base::Time deadline() const noexcept { return deadline_; }
  /// What goes to the central.
  [[nodiscard]] std::string take() { return std::exchange(out_, {}); }
  /// The robots' packets and prefixes since the last call.
  [[nodiscard]] std::string take_robots() { return std::exchange(robots_, {}); }
  [[nodiscard]] std::optional<CentralEvent> next_event() {
    if (events_.empty()) return std::nullopt;
    CentralEvent event = std::move(events_.front());
    events_.pop_front();
    return event;
  }

  /// No request waits, and none is on its way.
  [[nodiscard]] bool idle() const noexcept { return requests_.empty(); }
  [[nodiscard]] const std::vector<Peer>& peers() const noexcept { return peers_; }
  [[nodiscard]] const Peer* peer(unsigned index) const noexcept {
    for (const Peer& peer : peers_)
      if (peer.index == index) return &peer;
    return nullptr;
  }
  [[nodiscard]] const CentralClientCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const CentralStream& stream() const noexcept { return stream_; }

 private:
  using Line = CentralLine::Kind;
  using Event = CentralEvent::Kind;

  struct Request {
    enum class Kind : std::uint8_t { scan, connect, say, drop, leave };
    Kind kind = Kind::leave;
    unsigned index = 0;
    std::string words{};
    base::Duration time{};
  };
  /// What is waited for.
  enum class Stage : std::uint8_t {
    begin,      ///< nothing: the request's next command can be given
    settling,   ///< found, after `*` and `stop`
    leaving,    ///< command
    starting,   ///< scanning
    scanning,   ///< the end of the time to scan
    stopping,   ///< found
    listing,    ///< end of list
    joining,    ///< connecting or data, after conn
    linking,    ///< connected
    switching,  ///< data
    dropping,   ///< closing
    closing,    ///< closed
    pausing,    ///< a while, then the request is restarted
  };
  enum class Mode : std::uint8_t { unsure, command, data };

  bool request(Request request) {
    if (requests_.size() >= options_.most_requests) return false;
    if (requests_.empty()) attempts_ = 0;
    requests_.push_back(std::move(request));
    return true;
  }
  void await(Stage stage, base::Time now, base::Duration time) {
    stage_ = stage;
    deadline_ = now + time;
  }
  void command(std::string_view text, Stage stage, base::Time now) {
    out_ += text;
    await(stage, now, options_.answer);
  }
  void command(std::string_view word, unsigned index, Stage stage, base::Time now) {
    command(std::string{word} + std::to_string(index) + "\n", stage, now);
  }
  void report(Event kind, unsigned index, std::string words = {}) {
    events_.push_back({kind, index, std::move(words), false});
  }
  void done() {
    requests_.pop_front();
    attempts_ = 0;
    waits_ = 0;
    stage_ = Stage::begin;
    deadline_ = base::never;
  }
  void fail(std::string words) {
    report(Event::failed, requests_.front().index, std::move(words));
    events_.back().saying = requests_.front().kind == Request::Kind::say;
    done();
  }
  [[nodiscard]] std::string name_of(unsigned index) const {
    const Peer* const found = peer(index);
    return found != nullptr ? found->name : "robot " + std::to_string(index);
  }
  void link(unsigned index, bool linked) {
    for (Peer& peer : peers_)
      if (peer.index == index) peer.linked = linked;
  }

  /// Gives commands until there is something to wait for, or nothing to do.
  void advance(base::Time now) {
    while (!requests_.empty() && stage_ == Stage::begin) begin(now);
  }
  void begin(base::Time now) {
    const Request& request = requests_.front();
    if (mode_ == Mode::unsure) {
      ++counters_.settled;
      return command("*\nstop\n", Stage::settling, now);
    }
    if (request.kind == Request::Kind::say) {
      if (mode_ != Mode::data || target_ != request.index) return switch_to(request.index, now);
      out_ += request.words;
      report(Event::said, request.index);
      return done();
    }
    if (mode_ == Mode::data) return command("*", Stage::leaving, now);
    switch (request.kind) {
      case Request::Kind::scan:
        // `found` ends whatever line was begun: those of the list are whole.
        return request.time > base::Duration::zero() ? command("start\n", Stage::starting, now)
                                                     : command("stop\nlist\n", Stage::stopping, now);
      case Request::Kind::connect:
        return command("conn ", request.index, Stage::joining, now);
      case Request::Kind::drop:
        return command("drop ", request.index, Stage::dropping, now);
      case Request::Kind::leave:
      case Request::Kind::say:
        return done();
    }
  }
  void switch_to(unsigned index, base::Time now) {
    if (mode_ == Mode::data) return command("*", Stage::leaving, now);
    command("switch ", index, Stage::switching, now);
  }
  void enter_data(unsigned index) {
    mode_ = Mode::data;
    target_ = index;
  }

  // --- what the central says ---

  void hear(const CentralLine& line, base::Time now) {
    switch (line.kind) {
      case Line::connected:
        link(line.index, true);
        report(Event::connected, line.index);
        if (awaits(Stage::linking, line.index)) done();
        return;
      case Line::lost:
      case Line::closed:
        link(line.index, false);
        report(Event::lost, line.index);
        if (awaits(Stage::closing, line.index)) done();
        if (awaits(Stage::linking, line.index)) fail("no link to " + name_of(line.index));
        return;
      case Line::reset:
        return reset();
      case Line::error:
        return refused(line, now);
      default:
        return answer(line, now);
    }
  }
  [[nodiscard]] bool awaits(Stage stage, unsigned index) const noexcept {
    return stage_ == stage && !requests_.empty() && requests_.front().index == index;
  }
  /// It was reset: no link is left.
  void reset() {
    for (Peer& peer : peers_) {
      if (peer.linked) report(Event::lost, peer.index);
      peer.linked = false;
    }
    mode_ = Mode::unsure;
    stage_ = Stage::begin;
    deadline_ = base::never;
  }

  void answer(const CentralLine& line, base::Time now) {
    const bool own = !requests_.empty() && line.index == requests_.front().index;
    if (stage_ == Stage::settling && line.kind == Line::found) return settled();
    if (stage_ == Stage::leaving && line.kind == Line::command) return settled();
    if (stage_ == Stage::starting && line.kind == Line::scanning)
      return await(Stage::scanning, now, requests_.front().time);
    if (stage_ == Stage::stopping && line.kind == Line::found) {
      expected_ = line.index;
      heard_.clear();
      return await(Stage::listing, now, options_.answer);
    }
    if (stage_ == Stage::listing && line.kind == Line::listed)
      return heard_.push_back({line.index, std::string{line.address}, std::string{line.text}, false});
    if (stage_ == Stage::listing && line.kind == Line::end_of_list) return list(now);
    if (stage_ == Stage::joining && own && line.kind == Line::connecting) {
      enter_data(line.index);
      return await(Stage::linking, now, options_.connect);
    }
    if (stage_ == Stage::joining && own && line.kind == Line::data) {
      enter_data(line.index);
      link(line.index, true);
      report(Event::connected, line.index);
      return done();
    }
    if (stage_ == Stage::switching && own && line.kind == Line::data) {
      enter_data(line.index);
      stage_ = Stage::begin;
      deadline_ = base::never;
      return;
    }
    if (stage_ == Stage::dropping && own && line.kind == Line::closing)
      return await(Stage::closing, now, options_.connect);
    ++counters_.strays;
  }
  void settled() {
    mode_ = Mode::command;
    stage_ = Stage::begin;
    deadline_ = base::never;
  }
  /// As many as were found, or the list is asked for again.
  void list(base::Time now) {
    if (heard_.size() != expected_) return late(now);
    for (const Peer& entry : heard_)
      if (entry.index >= options_.most_robots)
        return fail("the central lists robot " + std::to_string(entry.index) + ", and " +
                    std::to_string(options_.most_robots) + " is the most");
    for (Peer& entry : heard_)
      for (const Peer& known : peers_)
        if (known.address == entry.address && known.index == entry.index) entry.linked = known.linked;
    peers_ = std::exchange(heard_, {});
    report(Event::listed, static_cast<unsigned>(peers_.size()));
    done();
  }

  void refused(const CentralLine& line, base::Time now) {
    const auto says = [&line](std::string_view what) { return line.text.starts_with(what); };
    switch (stage_) {
      case Stage::starting:
        if (says("scans already")) return await(Stage::scanning, now, requests_.front().time);
        break;
      case Stage::linking:
        if (!says("no link to ") || line.index != requests_.front().index) return void(++counters_.strays);
        link(line.index, false);
        break;
      case Stage::joining:
        if (says("still ")) return again(now);
        break;
      case Stage::switching:
        if (says("no link to ")) link(requests_.front().index, false);
        break;
      case Stage::dropping:
        break;
      default:  // an answer to another program, or an attempt of before that failed
        return void(++counters_.strays);
    }
    ++counters_.refused;
    fail("the central refuses " + name_of(requests_.front().index) + ": " + std::string{line.text});
  }
  /// The central is busy with another link: later.
  void again(base::Time now) {
    if (++waits_ * options_.again > options_.connect)
      return fail("the central is still busy with another link");
    await(Stage::pausing, now, options_.again);
  }

  /// What was waited for did not come.
  void late(base::Time now) {
    switch (stage_) {
      case Stage::scanning:
        return command("stop\nlist\n", Stage::stopping, now);
      case Stage::pausing:
        stage_ = Stage::begin;
        deadline_ = base::never;
        return;
      case Stage::begin:
        deadline_ = base::never;
        return;
      case Stage::linking: {
        ++counters_.timeouts;
        const unsigned index = requests_.front().index;
        fail("no link to " + name_of(index) + " came");
        requests_.push_front({Request::Kind::drop, index, {}, {}});
        return;
      }
      case Stage::closing:
        ++counters_.timeouts;
        return fail("the link to " + name_of(requests_.front().index) + " does not end");
      default:
        break;
    }
    ++counters_.timeouts;
    mode_ = Mode::unsure;
    if (++attempts_ >= options_.most_attempts) return fail("the central does not answer");
    // The list of a scan that is over does not need another one.
    if (stage_ == Stage::stopping || stage_ == Stage::listing) requests_.front().time = {};
    stage_ = Stage::begin;
    deadline_ = base::never;
  }

  Options options_;
  CentralStream stream_;
  std::deque<Request> requests_;
  std::deque<CentralEvent> events_;
  std::vector<Peer> peers_;
  std::vector<Peer> heard_;  ///< of a list that has begun
  std::string out_;
  std::string robots_;
  CentralClientCounters counters_{};
  base::Time deadline_ = base::never;
  unsigned attempts_ = 0;
  unsigned waits_ = 0;
  unsigned expected_ = 0;
  unsigned target_ = 0;
  Stage stage_ = Stage::begin;
  Mode mode_ = Mode::unsure;
};

}  // namespace ocm::mapper::server
