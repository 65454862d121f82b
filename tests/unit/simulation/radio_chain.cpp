/// From a robot's update to the server's ear, all of it in virtual time: what a sentence goes through, and
/// what is left of it at the edge of the radio's reach.
#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "ocm/mapper/link/central.hpp"
#include "ocm/mapper/link/demultiplexer.hpp"
#include "ocm/mapper/link/format.hpp"
#include "ocm/simulation/dongle.hpp"
#include "ocm/simulation/radio.hpp"

#include "unit/base/random.hpp"

namespace simulation_radio_chain_test {

using namespace ocm;
using namespace std::chrono_literals;
using simulation::Radio;
using simulation::RadioModel;

/// One robot that sends an update each 200 ms as soon as it has a link, its dongle, the radio, the central
/// and the server.
class Chain {
 public:
  explicit Chain(const RadioModel& model, bool packed = false) : radio_(model), packed_(packed) {
    radio_.add();
    radio_.advertise(0, true, now_);
    type("start\n");
    run(1s);
    type("stop\nconn 0\n");
    run(1s);
    if (packed_) type("{S,BIN}\n");
  }
  void go_to(double distance_m) { radio_.move(0, {distance_m, 0}); }
  void type(std::string_view text) {
    for (const char c : text) central_.feed(c, *this);
  }
  void run(base::Duration time) {
    for (const base::Time end = now_ + time; now_ < end;) {
      now_ += 10ms;
      radio_.advance(now_, *this);
      if (dongle_.linked() && now_ >= due_) send_update();
    }
  }

  std::uint64_t sent = 0, heard = 0, idle = 0;
  base::Duration longest_silence{};
  std::string server;  ///< all that the server has got
  std::string robot;   ///< all that the robot has

  [[nodiscard]] const mapper::link::Ear& ear() const { return ears_.ear(0); }
  [[nodiscard]] const Radio& radio() const { return radio_; }
  [[nodiscard]] const simulation::Dongle<>& dongle() const { return dongle_; }
  [[nodiscard]] bool linked() const { return dongle_.linked(); }

  // CentralPort
  void say(std::string_view text) {
    server += text;
    for (const char c : text) {
      const auto got = ears_.feed(static_cast<std::uint8_t>(c));
      if (got.kind == mapper::link::Kind::idle) ++idle;
      if (got.kind != mapper::link::Kind::update) continue;
      ++heard;
      longest_silence = std::max(longest_silence, now_ - last_);
      last_ = now_;
    }
  }
  void start_scan() { radio_.start_scan(now_); }
  void stop_scan() { radio_.stop_scan(); }
  void connect(const mapper::link::Address&) { radio_.connect(0, now_); }
  void disconnect(const mapper::link::Address&) { radio_.disconnect(0, now_); }
  void restart() { radio_.restart(); }

  // RadioUser
  base::Result<mapper::link::Packet> next_for_robot(std::size_t) { return central_.take(address); }
  base::Result<mapper::link::Packet> next_for_central(std::size_t) { return dongle_.take(radio_.time()); }
  void at_robot(std::size_t, const mapper::link::Packet& packet) {
    for (const std::uint8_t byte : packet.bytes()) {
      robot += static_cast<char>(byte);
      const mapper::link::Kind kind = reader_.feed(static_cast<char>(byte));
      writer_.hear(kind);
    }
  }
  void at_central(std::size_t, const mapper::link::Packet& packet) {
    central_.heard(address, packet.bytes(), *this);
  }
  void found(std::size_t) { central_.found(address, "AVR", *this); }
  void connected(std::size_t) { central_.connected(address, *this); }
  void closed(std::size_t) { central_.closed(address, *this); }
  void linked(std::size_t, bool on) {
    dongle_.link(on, radio_.time());
    if (on) {
      writer_.restart();
      last_ = due_ = radio_.time();
    }
  }

 private:
  static constexpr mapper::link::Address address{0xC0, 0, 0, 0, 0, 1};

  void send_update() {
    due_ += 200ms;
    const mapper::link::Update update{-177, -61, static_cast<std::int16_t>(sent % 360), 49, 0, 17, 58, 0};
    mapper::link::Outbox<4> lines;
    REQUIRE(writer_.send(update, lines));
    while (const auto packet = lines.take()) (void)dongle_.write(packet->bytes(), now_);
    if (sent % 20 == 19) (void)dongle_.write(std::span{idle_, sizeof idle_}, now_);
    ++sent;
  }

  static constexpr std::uint8_t idle_[] = {'{', 'S', ',', 'I', 'D', 'L', '}', '\n'};
  base::Time now_{};
  base::Time due_{};
  base::Time last_{};
  Radio radio_;
  simulation::Dongle<> dongle_;
  mapper::link::UpdateWriter writer_{true};
  mapper::link::Reader reader_{mapper::link::Direction::to_robot};
  mapper::link::Central<> central_;
  mapper::link::Demultiplexer<8> ears_;
  bool packed_;
};

struct Degraded {
  double whole;    ///< share of updates that the server has heard
  double quality;  ///< the mean of what `LinkQuality` says
  base::Duration silence;
};
Degraded at_distance(double distance_m, RadioModel model, bool packed, base::Duration time) {
  Chain chain{model, packed};
  chain.run(5s);
  chain.go_to(distance_m);
  const auto sent = chain.sent;
  const auto heard = chain.heard;
  chain.longest_silence = {};
  double quality = 0;
  const auto steps = time / 1s;
  for (auto i = 0 * steps; i < steps; ++i) {
    chain.run(1s);
    quality += chain.ear().quality().per_mille() / 1000.0;
  }
  return {static_cast<double>(chain.heard - heard) / static_cast<double>(chain.sent - sent),
          quality / static_cast<double>(steps), chain.longest_silence};
}

TEST_CASE("radio chain: near the central nothing is lost, either way, text or packed") {
  for (const bool packed : {false, true}) {
    Chain chain{RadioModel{}, packed};
    CHECK(chain.server.starts_with("scanning\nfound 1\nconnecting 0\nconnected 0\n"));
    chain.type("{U,90,130}\n{S,PAU}\n");
    chain.run(60s);
    CHECK(chain.sent > 295);
    CHECK(chain.heard + 1 >= chain.sent);
    CHECK(chain.idle > 10);
    CHECK(chain.ear().quality().per_mille() == 1000);
    CHECK(chain.robot == std::string{packed ? "{S,BIN}\n" : ""} + "{U,90,130}\n{S,PAU}\n");
    CHECK((chain.ear().packed().heard() > 290) == packed);
    CHECK(chain.longest_silence <= 250ms);
    CHECK(chain.dongle().outbox().refused == 0);
  }
}

TEST_CASE("radio chain: at the edge the server reads a log like listing 15.1, and calls back by a packet") {
  Chain chain{RadioModel{.seed = 3}};
  chain.go_to(7.9);
  chain.server.clear();
  chain.run(60s);
  const auto has = [&](std::string_view text) { return chain.server.find(text) != std::string::npos; };
  CHECK(has("[0]:AVR:{U,-177,-61,"));
  CHECK(has("[0]:AVR:,17,58,0}\n[0]:AVR:,17,58,0}\n"));  // the beginning of the second is lost
  CHECK(has("[0]:AVR:{S,IDL}\n"));                       // whole, for it is one packet
  CHECK(chain.ear().text().faults().torn > 10);          // the end is lost
  CHECK(chain.ear().text().faults().headless > 10);
  CHECK(chain.ear().quality().below(700));
  CHECK(chain.linked());  // and yet there is a link: time to call the robot back
  for (int i = 0; i < 10 && chain.robot.empty(); ++i) {
    chain.type("{U,180,300}\n");
    chain.run(200ms);
  }
  CHECK(chain.robot.starts_with("{U,180,300}\n"));
  chain.go_to(3);
  chain.run(10s);
  CHECK(chain.ear().quality().per_mille() > 950);
}

TEST_CASE("radio chain: beyond the range the link dies, and nothing of it is heard when there is a new one") {
  Chain chain{RadioModel{}};
  chain.run(5s);
  chain.go_to(9);
  chain.run(200ms);
  chain.type("{U,1,1}\n");
  chain.run(10s);
  CHECK_FALSE(chain.linked());
  CHECK(chain.server.ends_with("lost 0\n"));
  chain.type("*conn 0\n{U,2,2}\n");
  chain.go_to(1);
  chain.server.clear();
  chain.run(10s);
  CHECK(chain.robot == "{U,2,2}\n");
  // The next connection begins with a whole sentence.
  const auto first = chain.server.find("[0]:AVR:");
  CHECK(chain.server.substr(first, 12) == "[0]:AVR:{U,-");
  CHECK(chain.ear().text().faults().total() <= 1);  // the one that the dead link tore
}

TEST_CASE("radio chain: the farther, the less comes whole; packed updates stand more; repeats lose nothing") {
  double last_text = 1.1;
  double last_packed = 1.1;
  for (const double distance : {4.0, 5.0, 6.0, 7.0, 8.0}) {
    const auto text = at_distance(distance, RadioModel{}, false, 120s);
    const auto packed = at_distance(distance, RadioModel{}, true, 120s);
    CAPTURE(distance);
    CHECK(text.whole < last_text);
    CHECK(packed.whole < last_packed);
    CHECK(packed.whole >= text.whole);
    last_text = text.whole;
    last_packed = packed.whole;
    const double share = simulation::loss(RadioModel{}, distance);
    CHECK(packed.whole == Approx(1 - share).margin(0.1));                // one packet
    CHECK(text.whole == Approx((1 - share) * (1 - share)).margin(0.1));  // two
    CHECK(at_distance(distance, RadioModel{.repeats = true}, false, 120s).whole > 0.995);
  }
}

// unit_simulation "[.measure]" prints the table of docs/mapper-link.md.
TEST_CASE("radio chain: measured degradation", "[.measure]") {
  std::printf(
      "| distance | packets lost | text | quality | longest silence | packed | repeats: longest silence |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const double distance : {2.0, 4.0, 5.0, 6.0, 7.0, 7.5, 8.0}) {
    const auto text = at_distance(distance, RadioModel{}, false, 3600s);
    const auto packed = at_distance(distance, RadioModel{}, true, 3600s);
    const auto repeats = at_distance(distance, RadioModel{.repeats = true}, false, 3600s);
    const auto seconds = [](base::Duration d) { return static_cast<double>(d.count()) * 1e-9; };
    std::printf("| %.1f m | %.1f %% | %.1f %% | %.2f | %.1f s | %.1f %% | %.2f s |\n", distance,
                100 * simulation::loss(RadioModel{}, distance), 100 * text.whole, text.quality,
                seconds(text.silence), 100 * packed.whole, seconds(repeats.silence));
  }
}

}  // namespace simulation_radio_chain_test
