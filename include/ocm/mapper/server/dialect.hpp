/// A real dongle behind the words of our own central (mapper/link/central.hpp): what CentralClient says goes
/// in and comes out as the dongle's commands, the dongle's answers come out as our central's. Three kinds:
///
/// - `words`: our central. Nothing is changed.
/// - `at`: the base firmware of the thesis's dongle, nrf51_multi_nus_central: `AT+SCAN+.`, `OK.`, commands,
///   answers and data end with a dot.
/// - `thesis`: the thesis's own: our commands, and answers in words that no source gives. Only lines of
/// `list`
///   are read; that a link is there is proved by a packet of the robot, that a command was heard by nothing.
///   [Thesis 2, table 4.2]
///
/// Where the base firmware has not answered in time, its answer may still come, and in which mode it is, is
/// not known: before the next command it is brought into command mode, and all that it answers to that is
/// waited for.
///
/// Where the base firmware writes no prefixes, what comes belongs to the robot of the last link or switch. A
/// link that ends is not reported by these dongles: a robot that is silent for its deadline is lost.
///
/// Bytes in, bytes out, time handed in; no I/O. O(1) a byte. Host only.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ocm/base/text.hpp"
#include "ocm/base/time.hpp"
#include "ocm/mapper/link/prefix.hpp"

namespace ocm::mapper::server {

enum class Dialect : std::uint8_t { words, at, thesis };

/// A robot as a dongle lists it.
struct ListedRobot {
  unsigned index = 0;
  std::string address{};  ///< twelve hexadecimal digits
  std::string name{};
};

namespace detail {

/// Twelve hexadecimal digits, with or without colons between them; empty: none.
[[nodiscard]] inline std::string address_in(std::string_view text) {
  std::string digits;
  for (const char c : text) {
    if (c == ':') continue;
    if (base::hex_digit(c) < 0) return {};
    digits += c;
  }
  return digits.size() == 12 ? digits : std::string{};
}

/// The end of `text` as `index:address:name`, whatever a robot has said before it on the same line. False: it
/// is none.
[[nodiscard]] inline bool parse_listed(std::string_view text, ListedRobot& robot) {
  const std::size_t last = text.rfind(':');
  if (last == std::string_view::npos || last + 1 == text.size()) return false;
  for (const std::size_t address_size : {std::size_t{12}, std::size_t{17}}) {
    if (last < address_size + 2 || text[last - address_size - 1] != ':') continue;
    std::string address = address_in(text.substr(last - address_size, address_size));
    if (address.empty()) continue;
    const std::size_t colon = last - address_size - 1;
    std::size_t begin = colon;
    while (begin > 0 && colon - begin < 3 && base::is_digit(text[begin - 1])) --begin;
    const auto index = base::parse_unsigned(text.substr(begin, colon - begin));
    if (!index || *index > 255) continue;
    robot = {static_cast<unsigned>(*index), std::move(address), std::string{text.substr(last + 1)}};
    return true;
  }
  return false;
}

}  // namespace detail

class Translator {
 public:
  explicit Translator(Dialect dialect) noexcept : dialect_(dialect) {}

  /// What the client says, to our central as it thinks.
  void from_client(std::string_view bytes, base::Time now) {
    if (dialect_ == Dialect::words) return void(to_dongle_ += bytes);
    for (const char c : bytes) hear_client(c);
    advance(now);
  }
  void from_dongle(std::string_view bytes, base::Time now) {
    if (dialect_ == Dialect::words) return void(to_client_ += bytes);
    for (const char c : bytes) dialect_ == Dialect::at ? hear_at(c, now) : hear_thesis(c, now);
    advance(now);
  }
  /// To be called each 50 ms.
  void expire(base::Time now) {
    if (busy_ && now >= deadline_) late(now);
    advance(now);
  }
  [[nodiscard]] std::string take_for_dongle() { return std::exchange(to_dongle_, {}); }
  [[nodiscard]] std::string take_for_client() { return std::exchange(to_client_, {}); }
  /// Nothing waits for the dongle.
  [[nodiscard]] bool idle() const noexcept { return !busy_ && jobs_.empty(); }
  [[nodiscard]] Dialect dialect() const noexcept { return dialect_; }

 private:
  static constexpr unsigned most_robots = 32;  ///< asked for, of a list whose length is not known
  static constexpr base::Duration answer = std::chrono::milliseconds{800};
  /// To be in command mode: an answer, and then none for so long. Less than CentralClient waits.
  static constexpr base::Duration settling = std::chrono::milliseconds{600};
  static constexpr base::Duration settled = std::chrono::milliseconds{200};
  static constexpr base::Duration listing =
      std::chrono::milliseconds{500};  ///< between lines, of the thesis's dongle
  /// To the first line behind a scan: the dongle may still end that, or have no robot to list.
  static constexpr base::Duration scanned = std::chrono::seconds{2};
  static constexpr base::Duration linking = std::chrono::seconds{9};
  static constexpr base::Duration fresh =
      std::chrono::milliseconds{2500};  ///< a robot that has a link speaks

  struct Job {
    enum class Kind : std::uint8_t { leave, say, start, stop, list, connect, turn_to, drop, reset };
    Kind kind{};
    unsigned index = 0;
    std::string words{};
  };
  using Kind = Job::Kind;

  // --- the client ---

  void hear_client(char c) {
    if (client_in_data_) {
      if (c == '*') {
        typed_.clear();
        client_in_data_ = false;
        return jobs_.push_back({Kind::leave});
      }
      typed_ += c;
      if (c == '\n') jobs_.push_back({Kind::say, 0, std::exchange(typed_, {})});
      return;
    }
    if (c == '*' && typed_.empty()) return;
    if (c != '\n') return void(typed_ += c);
    const std::string line = std::exchange(typed_, {});
    if (!line.empty()) request(line);
  }
  void request(std::string_view line) {
    struct Word {
      std::string_view text;
      Kind kind;
    };
    constexpr std::array words{Word{"start", Kind::start},   Word{"stop", Kind::stop},
                               Word{"list", Kind::list},     Word{"reset", Kind::reset},
                               Word{"conn ", Kind::connect}, Word{"switch ", Kind::turn_to},
                               Word{"drop ", Kind::drop}};
    for (const Word& word : words) {
      if (!line.starts_with(word.text)) continue;
      const auto index = base::parse_unsigned(line.substr(word.text.size()));
      jobs_.push_back({word.kind, index ? static_cast<unsigned>(*index) : 0U});
      return;
    }
  }
  /// Behind a line of the central the client does not know whose the next byte is: the prefix is put in
  /// again.
  void tell(std::string_view words) {
    (to_client_ += words) += '\n';
    told_ = true;
  }
  void tell(std::string_view words, unsigned number) { tell(std::string{words} + std::to_string(number)); }
  /// Data mode, as the client now believes.
  void tell_data(std::string_view words, unsigned index) {
    tell(words, index);
    client_in_data_ = true;
    target_ = index;
  }
  void tell_list() {
    for (const ListedRobot& robot : list_)
      tell(std::to_string(robot.index) + ":" + robot.address + ":" + robot.name);
    tell("end of list");
  }

  // --- one job after the other ---

  void advance(base::Time now) {
    while (!busy_ && !jobs_.empty()) {
      busy_ = true;
      step_ = 0;
      if (dialect_ == Dialect::thesis)
        begin_thesis(now);
      else if (unsure_ && speaks_at())
        settle_at(now);
      else
        begin_at(now);
    }
  }
  void done() {
    busy_ = false;
    deadline_ = base::never;
    jobs_.pop_front();
  }
  void send(std::string_view words, base::Time now, base::Duration time) {
    to_dongle_ += words;
    deadline_ = now + time;
  }
  void late(base::Time now) { dialect_ == Dialect::at ? late_at(now) : late_thesis(now); }

  // --- the base firmware ---

  static std::string at(std::string_view command, unsigned index) {
    return "AT+" + std::string{command} + "=" + std::to_string(index) + ".";
  }
  /// Whether the first job says something to the dongle.
  [[nodiscard]] bool speaks_at() const {
    const Kind kind = jobs_.front().kind;
    return kind != Kind::list && (kind != Kind::stop || scanning_ || !list_known_);
  }
  void settle_at(base::Time now) {
    settling_ = true;
    settled_ = false;
    send("*.AT?.", now, settling);
  }
  void begin_at(base::Time now) {
    const Job& job = jobs_.front();
    switch (job.kind) {
      case Kind::leave:
        if (dongle_in_data_) return send("*", now, answer);
        tell("command");
        return done();
      case Kind::say:
        if (dongle_in_data_) to_dongle_ += job.words + ".";
        return done();
      case Kind::start:
        return send("AT+SCAN+.", now, answer);
      case Kind::stop:
        if (scanning_) return send("AT+SCAN-.", now, answer);
        if (list_known_) return tell_found();
        return ask_at(now);
      case Kind::list:
        tell_list();
        return done();
      case Kind::connect:
      case Kind::turn_to:
        return send(at("SWITCH", job.index), now, answer);
      case Kind::drop:
        return send(at("DROP", job.index), now, answer);
      case Kind::reset:
        return send("AT+RESET.", now, answer);
    }
  }
  void tell_found() {
    tell("found ", static_cast<unsigned>(list_.size()));
    done();
  }
  /// For each robot of its list, until it has no more.
  void ask_at(base::Time now) {
    list_.clear();
    step_ = 1;
    expected_ = most_robots;
    send(at("FOUND", 0), now, answer);
  }
  void hear_at(char c, base::Time now) {
    if (in_prefix_ || c == '[') {
      give_back();
      prefixed_ = true;
      return of_prefix(c, now);
    }
    // No robot says O, W or E: an answer begins.
    if (held_.empty() && c != 'O' && c != 'W' && c != 'E') return of_robot(c);
    held_ += c;
    if (c == '.') return answered_at(std::exchange(held_, {}), now);
    constexpr std::size_t longest = 64;
    if (c == '\n' || held_.size() > longest) give_back();
  }
  void give_back() {
    for (const char c : std::exchange(held_, {})) of_robot(c);
  }
  void of_robot(char c) {
    if (dialect_ == Dialect::at && !prefixed_ && (prefix_.empty() || announced_ != target_)) {
      announced_ = target_;
      const auto at = std::find_if(list_.begin(), list_.end(),
                                   [this](const ListedRobot& robot) { return robot.index == target_; });
      prefix_ = link::write_prefix(static_cast<std::uint8_t>(target_),
                                   at == list_.end() ? std::string_view{} : std::string_view{at->name})
                    .view();
      told_ = true;
    }
    if (told_) to_client_ += prefix_;
    told_ = false;
    to_client_ += c;
  }
  /// Handed on as a whole, for what it proves is reported before it.
  void of_prefix(char c, base::Time now) {
    if (c == '[') prefix_.clear();
    prefix_ += c;
    const auto step = filter_.feed(c);
    in_prefix_ = step == link::PrefixFilter::Step::prefix;
    if (in_prefix_) return;
    if (step == link::PrefixFilter::Step::source) spoken(filter_.source(), now);
    to_client_ += prefix_;
    told_ = false;
    if (step != link::PrefixFilter::Step::source) prefix_.clear();
  }
  void answered_at(std::string_view text, base::Time now) {
    if (!busy_) return;
    text.remove_suffix(1);
    const bool ok = text.starts_with("OK");
    const bool waits = text == "WAIT";
    const bool error = text.starts_with("ERROR");
    if (!ok && !waits && !error) return;
    if (settling_) {
      settled_ = settled_ || ok;
      if (settled_) deadline_ = now + settled;
      return;
    }
    const unsigned index = jobs_.front().index;
    switch (jobs_.front().kind) {
      case Kind::leave:
        dongle_in_data_ = false;
        tell("command");
        return done();
      case Kind::start:
        scanning_ = ok;
        tell(ok ? "scanning" : "error: the dongle does not scan");
        return done();
      case Kind::stop:
        return stopped_at(text, ok, now);
      case Kind::connect:
        return connected_at(ok, waits, now);
      case Kind::turn_to:
        dongle_in_data_ = dongle_in_data_ || ok;
        if (ok)
          tell_data("data ", index);
        else
          tell("error: no link to " + std::to_string(index) + "; conn first");
        return done();
      case Kind::drop:
        if (waits) return void(deadline_ = now + linking);
        if (ok) tell("closing ", index);
        tell(ok ? "closed " : "error: no link to ", index);
        return done();
      case Kind::reset:
        scanning_ = list_known_ = dongle_in_data_ = false;
        tell("reset");
        return done();
      case Kind::say:
      case Kind::list:
        return;
    }
  }
  void stopped_at(std::string_view text, bool ok, base::Time now) {
    if (step_ == 0) {
      const auto count = base::parse_unsigned(text.substr(std::min(text.size(), text.find('-') + 1)));
      scanning_ = false;
      ask_at(now);
      if (ok && count && *count < most_robots) expected_ = static_cast<unsigned>(*count);
      if (expected_ == 0) return listed_at();
      return;
    }
    const auto index = static_cast<unsigned>(list_.size());
    const std::size_t dash = text.find('-', 3);
    if (ok && text.starts_with("OK-") && dash != std::string_view::npos) {
      std::string address = detail::address_in(text.substr(3, dash - 3));
      if (!address.empty()) {
        const std::string_view name = text.substr(dash + 1);
        list_.push_back({index, std::move(address), std::string{name.empty() ? "?" : name}});
        if (list_.size() < expected_) return send(at("FOUND", index + 1), now, answer);
      }
    }
    listed_at();
  }
  void listed_at() {
    list_known_ = true;
    tell_found();
  }
  void connected_at(bool ok, bool waits, base::Time now) {
    const unsigned index = jobs_.front().index;
    if (step_ == 0) {  // SWITCH: the link is there already, or not
      if (ok) {
        dongle_in_data_ = true;
        tell_data("data ", index);
        return done();
      }
      step_ = 1;
      return send(at("CONN", index), now, answer);
    }
    if (step_ == 1) {
      tell_data("connecting ", index);
      step_ = 2;
    }
    if (waits) return void(deadline_ = now + linking);
    dongle_in_data_ = ok;
    tell(ok ? "connected " : "error: no link to ", index);
    done();
  }
  void late_at(base::Time now) {
    if (std::exchange(settling_, false)) {
      if (!settled_) return done();
      unsure_ = dongle_in_data_ = false;
      return begin_at(now);
    }
    if (jobs_.front().kind == Kind::stop && step_ == 1 && !list_.empty()) return listed_at();  // its end
    unsure_ = true;
    if (jobs_.front().kind == Kind::connect && step_ == 2) tell("error: no link to ", jobs_.front().index);
    done();  // the client waits for its answer, and says that none came
  }

  // --- the thesis's own ---

  void begin_thesis(base::Time now) {
    const Job& job = jobs_.front();
    const auto command = [&job](std::string_view word) {
      return std::string{word} + " " + std::to_string(job.index) + "\n";
    };
    switch (job.kind) {
      case Kind::leave:
        to_dongle_ += "*";
        tell("command");
        return done();
      case Kind::say:
        to_dongle_ += job.words;
        return done();
      case Kind::start:
        to_dongle_ += "start\n";
        scanning_ = true;
        tell("scanning");
        return done();
      case Kind::stop:
        if (!scanning_ && list_known_) return tell_found();
        list_.clear();
        line_.clear();
        if (!std::exchange(scanning_, false)) return send("list\n", now, listing);
        return send("stop\nlist\n", now, scanned);
      case Kind::list:
        tell_list();
        return done();
      case Kind::connect:
        if (is_fresh(job.index, now)) {
          to_dongle_ += command("switch");
          tell_data("data ", job.index);
          return done();
        }
        tell_data("connecting ", job.index);
        return send(command("conn"), now, linking);
      case Kind::turn_to:
        to_dongle_ += command("switch");
        tell_data("data ", job.index);
        return done();
      case Kind::drop:
        to_dongle_ += command("drop");
        tell("closing ", job.index);
        tell("closed ", job.index);
        return done();
      case Kind::reset:
        to_dongle_ += "reset\n";
        tell("reset");
        return done();
    }
  }
  [[nodiscard]] bool is_fresh(unsigned index, base::Time now) const noexcept {
    return index < spoke_.size() && spoke_[index] != base::Time{} && now - spoke_[index] <= fresh;
  }
  void hear_thesis(char c, base::Time now) {
    if (in_prefix_ || c == '[') return of_prefix(c, now);
    if (c == '\n' || c == '\r') {
      ListedRobot robot;
      if (detail::parse_listed(line_, robot)) {
        listed(std::move(robot), now);
        return line_.clear();
      }
      line_.clear();
      return of_robot(c);
    }
    // The end of a line counts: packed updates, which have no line end, may stand before it.
    constexpr std::size_t longest = 96;
    if (line_.size() == longest) line_.erase(0, 1);
    line_ += c;
    // Its words are no robot's: what a robot says has no small letters, and a list's line begins no sentence.
    if (!(c >= 'a' && c <= 'z')) of_robot(c);
  }
  void listed(ListedRobot robot, base::Time now) {
    std::erase_if(list_, [&](const ListedRobot& other) { return other.index == robot.index; });
    list_.push_back(std::move(robot));
    if (busy_ && jobs_.front().kind == Kind::stop) deadline_ = now + listing;
  }
  /// A packet of a robot has come: its link is there.
  void spoken(unsigned index, base::Time now) {
    spoke_[index] = now;
    if (dialect_ != Dialect::thesis || !busy_) return;
    if (jobs_.front().kind != Kind::connect || jobs_.front().index != index) return;
    tell("connected ", index);
    done();
  }
  void late_thesis(base::Time) {
    if (jobs_.front().kind == Kind::connect) {
      tell("error: no link to ", jobs_.front().index);
      return done();
    }
    list_known_ = true;
    tell_found();
  }

  Dialect dialect_;
  std::deque<Job> jobs_;
  std::string to_dongle_;
  std::string to_client_;
  std::string typed_;   ///< by the client
  std::string held_;    ///< an answer of the base firmware, so far
  std::string line_;    ///< of the thesis's dongle, so far
  std::string prefix_;  ///< of the robot whose bytes come, whole or so far
  std::vector<ListedRobot> list_;
  std::array<base::Time, 256> spoke_{};
  link::PrefixFilter filter_;
  base::Time deadline_ = base::never;
  unsigned target_ = 0;
  unsigned announced_ = 256;  ///< whose prefix was put in last
  unsigned expected_ = 0;
  unsigned step_ = 0;
  bool busy_ = false;  ///< the first job is under way
  bool client_in_data_ = false;
  bool dongle_in_data_ = false;
  bool unsure_ = false;    ///< an answer did not come: dongle_in_data_ may be wrong
  bool settling_ = false;  ///< before the first job,
  bool settled_ = false;   ///< and the dongle has answered
  bool scanning_ = false;
  bool list_known_ = false;
  bool prefixed_ = false;  ///< this firmware writes prefixes
  bool in_prefix_ = false;
  bool told_ = false;  ///< a line of the central was the last that the client heard
};

}  // namespace ocm::mapper::server
