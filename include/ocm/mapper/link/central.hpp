/// The central: a dongle at the server that speaks to several robots' dongles. What the server types
/// (`start`, `list`, `stop`, `conn i`, `switch i`, `drop i`, `*`, `reset`) and what the radio reports go in,
/// in any order; text for the server and calls of the radio come out. [Thesis 2, table 4.2]
///
/// In command mode a line is a command and has an answer: lines of `list`, or one that begins with a word;
/// `error: ` when it was refused, and then nothing has changed. `conn` and `switch` lead into data mode, in
/// which every line goes to that robot until `*`; also when its link dies meanwhile, so that no sentence is
/// taken for a command. Such bytes are dropped and counted, as are packets that wait for a link that dies:
/// never does the next connection hear them.
///
/// No heap, no time, constexpr; O(Robots) a command, O(1) a byte. `Central<8, 3, 8>` takes some 2 kB.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "ocm/base/result.hpp"
#include "ocm/base/text.hpp"
#include "ocm/mapper/link/packet.hpp"
#include "ocm/mapper/link/prefix.hpp"

namespace ocm::mapper::link {

/// Of a dongle, most significant byte first.
using Address = std::array<std::uint8_t, 6>;

/// What a central acts upon. None of it answers at once: the radio reports with `found`, `connected`,
/// `closed`, `heard`.
template <class P>
concept CentralPort = requires(P port, std::string_view text, const Address& address) {
  port.say(text);  ///< to the server
  port.start_scan();
  port.stop_scan();
  port.connect(address);     ///< `connected` or `closed` follows
  port.disconnect(address);  ///< ends a link, or the attempt; `closed` follows
  port.restart();            ///< everything of the radio restarts; no report about before follows
};

/// What was not passed on, and why. They wrap.
struct CentralCounters {
  std::uint32_t refused_commands = 0;  ///< unknown, malformed, or not possible now
  std::uint32_t unsent_bytes = 0;      ///< typed for a link that was gone, or for which the queue was full
  std::uint32_t dropped_packets = 0;   ///< waited for a link that died
  std::uint32_t unlisted = 0;          ///< robots found beyond the room of the list
  std::uint32_t stray_reports = 0;     ///< from the radio about links that are none
  friend constexpr bool operator==(const CentralCounters&, const CentralCounters&) = default;
};

/// `Robots`: room of the list, at most 256. `Links`: as many as the radio holds at once; 3 in thesis 2.
/// `Waiting`: packets a link may have waiting.
template <std::size_t Robots = 8, std::size_t Links = 3, std::size_t Waiting = 8>
class Central {
  static_assert(Robots >= 1 && Robots <= 256 && Links >= 1 && Waiting >= 1);

 public:
  enum class Mode : std::uint8_t { command, data };

  /// A character from the server.
  template <CentralPort P>
  constexpr void feed(char c, P& port) {
    if (mode_ == Mode::data) return data(c, port);
    if (c != '\n' && c != '\r') {
      if (c != '*' || !line_.view().empty()) line_ << c;  // a `*` too many, as in `*drop 0`
      return;
    }
    const Line line = line_;
    line_ = {};
    if (line.overflowed()) return refuse(port, "longer than any command");
    if (!line.view().empty()) execute(line.view(), port);
  }

  // --- reports of the radio ---

  /// A robot advertises. One that is listed keeps its index.
  template <CentralPort P>
  constexpr void found(const Address& address, std::string_view name, P&) noexcept {
    if (!scanning_) return void(++counters_.stray_reports);
    if (find(address) != Robots) return;
    for (Peer& peer : peers_) {
      if (peer.link != Link::free) continue;
      peer.address = address;
      peer.name = safe_name(name);
      peer.link = Link::none;
      return;
    }
    ++counters_.unlisted;
  }
  template <CentralPort P>
  constexpr void connected(const Address& address, P& port) {
    const std::size_t i = find(address);
    if (i == Robots || peers_[i].link == Link::none || peers_[i].link == Link::up) {
      ++counters_.stray_reports;
      if (i == Robots || peers_[i].link == Link::none) port.disconnect(address);  // not needed any more
      return;
    }
    if (peers_[i].link == Link::closing) return port.disconnect(address);  // dropped before it was there
    peers_[i].link = Link::up;
    tell(port, "connected ", i);
  }
  /// A link has ended, or an attempt has failed.
  template <CentralPort P>
  constexpr void closed(const Address& address, P& port) {
    const std::size_t i = find(address);
    if (i == Robots || !taken(peers_[i])) return void(++counters_.stray_reports);
    const Link was = peers_[i].link;
    peers_[i].link = Link::none;
    drop_waiting(i);
    tell(port, was == Link::closing ? "closed " : was == Link::up ? "lost " : "error: no link to ", i);
  }
  /// A packet from a robot goes to the server, with its prefix.
  template <CentralPort P>
  constexpr void heard(const Address& address, std::span<const std::uint8_t> bytes, P& port) {
    const std::size_t i = find(address);
    if (i == Robots || peers_[i].link != Link::up) return void(++counters_.stray_reports);
    port.say(write_prefix(static_cast<std::uint8_t>(i), peers_[i].name.view()).view());
    std::array<char, max_packet> text{};
    while (!bytes.empty()) {
      std::size_t n = 0;
      for (; n < text.size() && n < bytes.size(); ++n) text[n] = static_cast<char>(bytes[n]);
      port.say(std::string_view{text.data(), n});
      bytes = bytes.subspan(n);
    }
  }
  /// The radio has room for a packet to this robot: the oldest that waits, or Error::no_answer.
  constexpr base::Result<Packet> take(const Address& address) noexcept {
    const std::size_t i = find(address);
    if (i == Robots || peers_[i].link != Link::up) return base::Error::no_answer;
    return peers_[i].outbox.take();
  }

  [[nodiscard]] constexpr Mode mode() const noexcept { return mode_; }
  [[nodiscard]] constexpr bool scanning() const noexcept { return scanning_; }
  [[nodiscard]] constexpr const CentralCounters& counters() const noexcept { return counters_; }
  /// Links that are there, begin or end.
  [[nodiscard]] constexpr std::size_t links() const noexcept {
    std::size_t n = 0;
    for (const Peer& peer : peers_) n += taken(peer) ? 1 : 0;
    return n;
  }
  /// Packets that wait for links.
  [[nodiscard]] constexpr std::size_t waiting() const noexcept {
    std::size_t n = 0;
    for (const Peer& peer : peers_) n += peer.outbox.size();
    return n;
  }

 private:
  enum class Link : std::uint8_t { free, none, opening, up, closing };
  struct Peer {
    Address address{};
    Name name{};
    Link link = Link::free;
    Outbox<Waiting> outbox{};
  };
  using Line = base::Text<16>;
  using Answer = base::Text<64>;

  [[nodiscard]] static constexpr bool taken(const Peer& peer) noexcept {
    return peer.link == Link::opening || peer.link == Link::up || peer.link == Link::closing;
  }
  /// Its index, or Robots.
  [[nodiscard]] constexpr std::size_t find(const Address& address) const noexcept {
    for (std::size_t i = 0; i < Robots; ++i)
      if (peers_[i].link != Link::free && peers_[i].address == address) return i;
    return Robots;
  }
  template <class P>
  constexpr void tell(P& port, std::string_view what, std::size_t number, std::string_view rest = "") {
    Answer answer;
    (answer << what).decimal(number) << rest << '\n';
    port.say(answer.view());
  }
  template <class P>
  constexpr void refuse(P& port, std::string_view why) {
    ++counters_.refused_commands;
    port.say((Answer{} << "error: " << why << '\n').view());
  }
  template <class P>
  constexpr void refuse(P& port, std::string_view why, std::size_t number, std::string_view rest = "") {
    ++counters_.refused_commands;
    tell(port, (Answer{} << "error: " << why).view(), number, rest);
  }
  constexpr void drop_waiting(std::size_t i) noexcept {
    counters_.dropped_packets += static_cast<std::uint32_t>(peers_[i].outbox.drop_all());
    if (i == target_) drop_partial();
  }
  constexpr void drop_partial() noexcept {
    counters_.unsent_bytes += partial_.size;
    partial_ = {};
  }

  // --- data mode ---

  template <class P>
  constexpr void data(char c, P& port) {
    if (c == '*') {
      drop_partial();
      mode_ = Mode::command;
      skipping_ = false;
      return port.say("command\n");
    }
    Peer& peer = peers_[target_];
    const bool ends = c == '\n';
    if (skipping_ || (peer.link != Link::up && peer.link != Link::opening)) {
      ++counters_.unsent_bytes;
      if (ends) skipping_ = false;
      return;
    }
    (void)partial_.push(static_cast<std::uint8_t>(c));
    if (!ends && !partial_.full()) return;
    if (!peer.outbox.put(partial_)) {
      counters_.unsent_bytes += partial_.size;
      skipping_ = !ends;
    }
    partial_ = {};
  }
  constexpr void enter_data(std::size_t i) noexcept {
    mode_ = Mode::data;
    target_ = i;
    skipping_ = false;
  }

  // --- command mode ---

  template <class P>
  constexpr void execute(std::string_view line, P& port) {
    const std::size_t blank = line.find(' ');
    const std::string_view word = line.substr(0, blank);
    const bool bare = blank == std::string_view::npos;
    if (bare && word == "start") return start(port);
    if (bare && word == "list") return list(port);
    if (bare && word == "stop") return stop(port);
    if (bare && word == "reset") return reset(port);
    if (word != "conn" && word != "switch" && word != "drop")
      return refuse(port, "start, list, stop, conn i, switch i, drop i, *, reset");
    const auto number = base::parse_unsigned(bare ? std::string_view{} : line.substr(blank + 1));
    if (!number) return refuse(port, "an index is missing, as in conn 0");
    if (*number >= Robots || peers_[static_cast<std::size_t>(*number)].link == Link::free)
      return refuse(port, "not in the list; see list");
    const auto i = static_cast<std::size_t>(*number);
    if (word == "conn") return connect(i, port);
    if (word == "switch") return turn_to(i, port);
    drop(i, port);
  }

  /// Indexes start again, but a robot with a link keeps its own.
  template <class P>
  constexpr void start(P& port) {
    if (scanning_) return refuse(port, "scans already");
    for (Peer& peer : peers_)
      if (!taken(peer)) peer.link = Link::free;
    scanning_ = true;
    port.start_scan();
    port.say("scanning\n");
  }
  template <class P>
  constexpr void list(P& port) {
    for (std::size_t i = 0; i < Robots; ++i) {
      if (peers_[i].link == Link::free) continue;
      Answer entry;
      entry.decimal(i) << ':';
      for (const std::uint8_t byte : peers_[i].address) entry.hex(byte, 2);
      port.say((entry << ':' << peers_[i].name.view() << '\n').view());
    }
    port.say("end of list\n");
  }
  [[nodiscard]] constexpr std::size_t listed() const noexcept {
    std::size_t n = 0;
    for (const Peer& peer : peers_) n += peer.link != Link::free ? 1 : 0;
    return n;
  }
  template <class P>
  constexpr void stop(P& port) {
    if (scanning_) port.stop_scan();
    scanning_ = false;
    tell(port, "found ", listed());
  }
  template <class P>
  constexpr void connect(std::size_t i, P& port) {
    Peer& peer = peers_[i];
    if (peer.link == Link::up || peer.link == Link::opening) return turn_to(i, port);
    if (peer.link == Link::closing) return refuse(port, "still closing ", i);
    if (links() >= Links) return refuse(port, "no more links than ", Links, "; drop one");
    for (std::size_t k = 0; k < Robots; ++k)
      if (peers_[k].link == Link::opening) return refuse(port, "still connecting to ", k);
    if (scanning_) port.stop_scan();  // the radio does one of the two
    scanning_ = false;
    peer.link = Link::opening;
    port.connect(peer.address);
    tell(port, "connecting ", i);
    enter_data(i);
  }
  template <class P>
  constexpr void turn_to(std::size_t i, P& port) {
    if (peers_[i].link != Link::up && peers_[i].link != Link::opening)
      return refuse(port, "no link to ", i, "; conn first");
    tell(port, "data ", i);
    enter_data(i);
  }
  template <class P>
  constexpr void drop(std::size_t i, P& port) {
    Peer& peer = peers_[i];
    if (peer.link != Link::up && peer.link != Link::opening) return refuse(port, "no link to ", i);
    peer.link = Link::closing;
    drop_waiting(i);
    port.disconnect(peer.address);
    tell(port, "closing ", i);
  }
  template <class P>
  constexpr void reset(P& port) {
    for (std::size_t i = 0; i < Robots; ++i) {
      drop_waiting(i);
      peers_[i].link = Link::free;
    }
    scanning_ = false;
    port.restart();
    port.say("reset\n");
  }

  std::array<Peer, Robots> peers_{};
  CentralCounters counters_{};
  Line line_{};
  Packet partial_{};
  std::size_t target_ = 0;
  Mode mode_ = Mode::command;
  bool scanning_ = false;
  bool skipping_ = false;  ///< data mode: the rest of a line whose beginning had no room
};

}  // namespace ocm::mapper::link
