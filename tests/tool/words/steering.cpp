#include "cli/words/steering.hpp"

#include <random>
#include <string>

#include <catch2/catch.hpp>

namespace words_steering_test {

using namespace std::chrono_literals;
using namespace ocm::cli::words;
using Ask = Steering::Ask;
using ocm::base::Duration;

Ask press(Steering& steering, std::string_view key, Duration now) {
  return steering.take(key, now);
}

TEST_CASE("steering: arrows and letters") {
  struct Row {
    std::string_view key;
    Direction direction;
  };
  for (const Row& row : {Row{"\x1b[A", {1, 0}}, Row{"\x1bOA", {1, 0}}, Row{"\x1b[B", {-1, 0}},
                         Row{"\x1b[C", {0, -1}}, Row{"\x1b[D", {0, 1}}, Row{"i", {1, 0}}, Row{",", {-1, 0}},
                         Row{"j", {0, 1}}, Row{"l", {0, -1}}, Row{"u", {1, 1}}, Row{"o", {1, -1}},
                         Row{"m", {-1, 1}}, Row{".", {-1, -1}}, Row{"x", {}}, Row{"\x1b[5~", {}}}) {
    Steering steering;
    CHECK(steering.direction(0s) == Direction{});
    CHECK(press(steering, row.key, 1s) == Ask::nothing);
    CHECK(steering.direction(1s) == row.direction);
  }
}

TEST_CASE("steering: the beginning of a sequence is no key, and neither is what follows lost") {
  for (const std::string_view begun : {"\x1b[", "\x1bO", "\x1b[1;"}) {
    Steering steering;
    std::string_view keys = begun;
    CHECK(steering.take(keys, 1s) == Ask::nothing);
    CHECK(keys.empty());
    const std::string both = std::string{begun} + "\x1b[D";
    keys = both;
    CHECK(steering.take(keys, 1s) == Ask::nothing);
    CHECK(keys == "\x1b[D");
    CHECK(steering.take(keys, 1s) == Ask::nothing);
    CHECK(steering.direction(1s) == Direction{0, 1});
  }
}

TEST_CASE(
    "steering: a tap ends after a terminal's first wait, a key that was held soon after it was released") {
  Steering steering;
  press(steering, "i", 1s);
  CHECK(steering.direction(1699ms) == Direction{1, 0});
  CHECK(steering.direction(1700ms) == Direction{});
  // Held from 10 s on: again after 660 ms, then every 40 ms until 11.98 s.
  press(steering, "i", 10s);
  for (auto now = 10'660ms; now <= 12s; now += 40ms) {
    CHECK(steering.direction(now) == Direction{1, 0});
    press(steering, "i", now);
  }
  CHECK(steering.direction(12'229ms) == Direction{1, 0});
  CHECK(steering.direction(12'230ms) == Direction{});
  // After that a press is a first one again.
  press(steering, "i", 20s);
  CHECK(steering.direction(20'699ms) == Direction{1, 0});
}

TEST_CASE("steering: a key that comes again sooner than a person presses twice is not held yet") {
  Steering steering;
  press(steering, "i", 1s);
  press(steering, "i", 1150ms);
  CHECK(steering.direction(1849ms) == Direction{1, 0});
  CHECK(steering.direction(1850ms) == Direction{});
  press(steering, "i", 3s);
  press(steering, "i", 3151ms);
  CHECK(steering.direction(3400ms) == Direction{1, 0});
  CHECK(steering.direction(3401ms) == Direction{});
  // What was held in one direction is not held in another.
  press(steering, "i", 5s);
  press(steering, "i", 5400ms);
  press(steering, "j", 5500ms);
  CHECK(steering.direction(6199ms) == Direction{0, 1});
}

TEST_CASE("steering: another direction takes over at once, and space stops") {
  Steering steering;
  press(steering, "i", 1s);
  press(steering, "j", 1100ms);
  CHECK(steering.direction(1100ms) == Direction{0, 1});
  CHECK(steering.direction(1799ms) == Direction{0, 1});  // a first press
  CHECK(press(steering, " ", 1200ms) == Ask::stop);
  CHECK(steering.direction(1200ms) == Direction{});
  CHECK(press(steering, "k", 1300ms) == Ask::stop);
}

TEST_CASE("steering: keys that came together are taken one by one") {
  Steering steering;
  std::string_view bytes = "\x1b[A\x1b[D+-q";
  CHECK(steering.take(bytes, 1s) == Ask::nothing);
  CHECK(steering.direction(1s) == Direction{1, 0});
  CHECK(steering.take(bytes, 1s) == Ask::nothing);
  CHECK(steering.direction(1s) == Direction{0, 1});
  CHECK(steering.take(bytes, 1s) == Ask::faster);
  CHECK(steering.take(bytes, 1s) == Ask::slower);
  CHECK(steering.take(bytes, 1s) == Ask::quit);
  CHECK(bytes.empty());
  // Escape alone leaves; so does the end of input.
  bytes = "\x1b\x04";
  CHECK(steering.take(bytes, 1s) == Ask::quit);
  CHECK(steering.take(bytes, 1s) == Ask::quit);
}

TEST_CASE("steering: whatever a terminal sends, each key ends, and so does each direction") {
  std::mt19937 random{3};
  Steering steering;
  Duration now{};
  for (int i = 0; i < 20'000; ++i) {
    std::string text(1 + random() % 12, ' ');
    for (char& c : text)
      c = random() % 4 == 0 ? "\x1b[OAij"[random() % 6] : static_cast<char>(random() % 256);
    std::string_view bytes = text;
    while (!bytes.empty()) {
      const std::size_t before = bytes.size();
      steering.take(bytes, now);
      REQUIRE(bytes.size() < before);
    }
    REQUIRE(steering.direction(now + Steering::first_repeat) == Direction{});
    now += std::chrono::milliseconds{random() % 900};
  }
}

TEST_CASE("steering: speeds") {
  auto speed = *KeySpeed::parse("10cm/s");
  CHECK(speed.text() == "10cm/s");
  CHECK(speed.text(-1) == "-10cm/s");
  CHECK(speed.text(0) == "0cm/s");
  speed.change(1);
  CHECK(speed.text() == "12.5cm/s");
  speed.change(-2);
  CHECK(speed.text() == "8cm/s");
  speed.change(100);
  CHECK(speed.steps() == KeySpeed::most_steps);
  CHECK(speed.text() == "145.519cm/s");  // 14 times as fast
  CHECK(speed.shown() == "146cm/s");
  CHECK(speed.shown(-0.5) == "-72.8cm/s");
  speed.change(-100);
  CHECK(speed.text() == "0.687195cm/s");
  CHECK(speed.shown() == "0.687cm/s");
  for (const auto typed : {"28.9855rad/s", "28.985507rad/s", "1661deg/s"})
    CHECK(KeySpeed::parse(typed)->text() == typed);
  CHECK(KeySpeed::parse("1661deg/s")->shown() == "1661deg/s");
  CHECK(KeySpeed::parse("999.6deg/s")->shown() == "1000deg/s");
  for (const auto bad : {"", "fast", "5", "0cm/s", "-5cm/s", "1e999m/s"})
    CHECK_FALSE(KeySpeed::parse(bad).ok());
}

}  // namespace words_steering_test
