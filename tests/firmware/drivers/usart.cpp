// The line's driver against a model of the USART that follows the reference manual.
#include "firmware/drivers/usart.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <string_view>

#include <catch2/catch.hpp>

#include "sim/parts/usart_model.hpp"

namespace ocm::usart_tests {

namespace usart = firmware::drivers::usart;
using sim::UsartModel;
using sim::UsartModelRegisters;

namespace {

template <std::size_t In = 16, std::size_t Out = 16>
struct Bench {
  UsartModel model;
  usart::Line<UsartModelRegisters, In, Out> line{UsartModelRegisters{model}};
  std::string heeded;
  unsigned interrupts = 0;
  usart::News news;  ///< all since it was last cleared

  Bench() { line.start(72'000'000, 115'200); }

  /// All interrupts that are due.
  void serve() {
    while (model.interrupt()) interrupt();
  }
  void interrupt() {
    ++interrupts;
    REQUIRE(interrupts < 100'000);
    const auto last = line.on_interrupt([this](std::uint8_t byte) { heeded += static_cast<char>(byte); });
    news.received |= last.received;
    news.room |= last.room;
  }
  void arrive(std::string_view text) {
    for (const char character : text) {
      model.arrive(static_cast<std::uint8_t>(character));
      serve();
    }
  }
  std::string read() {
    std::string text;
    for (char character = 0; line.read(character);) text += character;
    return text;
  }
  /// Until the wire is silent.
  void send_all() {
    serve();
    while (model.shift()) serve();
  }
};

}  // namespace

TEST_CASE("usart: 115200 bit/s of 72 MHz, and not a word before it is asked for") {
  Bench bench;
  CHECK(bench.model.divider == 625);  // 39.0625 in sixteenths [RM0008 table 192]
  CHECK_FALSE(bench.model.interrupt());
  bench.arrive("x");
  CHECK(bench.model.sent.empty());
  CHECK(bench.model.violations.empty());
}

TEST_CASE("usart: what arrives is read in order, each byte is heeded, a complete line is news") {
  Bench bench;
  bench.arrive("S6");
  CHECK_FALSE(bench.news.received);
  bench.arrive("\r");
  CHECK(bench.news.received);
  CHECK(bench.read() == "S6\r");
  CHECK(bench.heeded == "S6\r");
  bench.news = {};
  bench.arrive("1234567");
  CHECK_FALSE(bench.news.received);
  bench.arrive("8");  // half full, and no end of a line
  CHECK(bench.news.received);
  CHECK(bench.line.counters() == usart::Counters{.received = 11});
  CHECK(bench.line.lost() == 0);
}

TEST_CASE("usart: a full ring loses what is newest, and the next character says so") {
  Bench bench;
  bench.arrive("0123456789abcdefXY");
  CHECK(bench.line.counters().full == 2);
  CHECK(bench.heeded.size() == 18);  // CONNECT is heard however full the ring is
  CHECK(bench.read() == "0123456789abcdef");
  bench.arrive("zt1230\r");
  CHECK(bench.read() == std::string{"\0t1230\r", 7});
  bench.arrive("ok\r");
  CHECK(bench.read() == "ok\r");
}

TEST_CASE("usart: an interrupt that comes too late keeps the first character and marks the next") {
  Bench bench;
  bench.model.arrive('a');
  bench.model.arrive('b');
  bench.model.arrive('c');
  bench.serve();
  bench.arrive("de\r");
  CHECK(bench.read() == std::string{"a\0e\r", 4});
  CHECK(bench.line.counters().overruns == 1);
  CHECK(bench.line.lost() == 1);
  CHECK(bench.model.overwritten == 2);
  CHECK(bench.model.violations.empty());
}

TEST_CASE("usart: an overrun without a character is counted, ends its interrupt, and marks what comes next") {
  Bench bench;
  bench.model.arrive('a');
  unsigned accesses = 0;
  bench.model.on_access = [&] {  // between SR and DR
    if (++accesses == 2) bench.model.arrive('b');
  };
  bench.serve();
  CHECK_FALSE(bench.model.interrupt());
  CHECK(bench.line.counters().overruns == 1);
  bench.arrive("cd\r");
  CHECK(bench.read() == std::string{"a\0d\r", 4});
  CHECK(bench.heeded == "acd\r");
}

TEST_CASE("usart: a broken character is not taken for what it looks like") {
  Bench bench;
  bench.model.arrive('4', true);
  bench.serve();
  bench.model.arrive(0, false, true);  // a break
  bench.serve();
  bench.arrive("\r");
  CHECK(bench.read() == std::string{"\0\0\r", 3});
  CHECK(bench.line.counters().broken == 2);
}

TEST_CASE("usart: what is written leaves in order; half of it gone is news; then there are no interrupts") {
  Bench bench;
  bench.line.write("0123456789");
  CHECK(bench.line.room() == 6);
  bench.serve();
  CHECK(bench.line.room() == 8);  // one in each of the two registers
  CHECK(bench.news.room);
  bench.send_all();
  CHECK(bench.model.sent == "0123456789");
  CHECK(bench.line.room() == 16);
  CHECK_FALSE(bench.model.interrupt());
  CHECK(bench.line.counters().sent == 10);
  bench.line.write("");
  CHECK_FALSE(bench.model.interrupt());
  CHECK(bench.model.violations.empty());
}

TEST_CASE("usart: what has no room is counted") {
  Bench bench;
  bench.line.write("0123456789abcdefXY");
  CHECK(bench.line.room() == 0);
  bench.send_all();
  CHECK(bench.model.sent == "0123456789abcdef");
  CHECK(bench.line.counters().unsent == 2);
}

TEST_CASE("usart: a transmit interrupt reads no character away that comes meanwhile") {
  for (unsigned at = 0; at < 6; ++at) {
    Bench bench;
    bench.line.write("ab");
    unsigned accesses = 0;
    bench.model.on_access = [&] {
      if (accesses++ == at) bench.model.arrive('!');
    };
    bench.send_all();
    bench.model.on_access = nullptr;
    if (accesses <= at) bench.arrive("!");
    bench.serve();
    CAPTURE(at);
    CHECK(bench.model.sent == "ab");
    CHECK(bench.read() == "!");
    CHECK(bench.line.lost() == 0);
  }
}

TEST_CASE("usart: any schedule: nothing is lost without a count, added, or out of order") {
  for (unsigned seed = 0; seed < 300; ++seed) {
    CAPTURE(seed);
    std::mt19937 random{seed};
    const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
    Bench<32, 32> bench;
    std::string written;
    std::string arrived;
    std::string read;
    unsigned refused = 0;
    char next = 'a';
    for (unsigned step = 0; step < 2000; ++step) {
      switch (below(5)) {
        case 0:
          next = next == 'z' ? 'a' : static_cast<char>(next + 1);
          arrived += next;
          bench.model.arrive(static_cast<std::uint8_t>(next));
          break;
        case 1:
          if (bench.model.interrupt()) bench.interrupt();
          break;
        case 2:
          bench.model.shift();
          break;
        case 3: {
          char character = 0;
          if (bench.line.read(character)) read += character;
          break;
        }
        default: {
          const std::string text(1 + below(6), static_cast<char>('A' + step % 26));
          const std::size_t room = std::min(bench.line.room(), text.size());
          bench.line.write(text);
          written += text.substr(0, room);
          refused += static_cast<unsigned>(text.size() - room);
        }
      }
    }
    bench.send_all();
    read += bench.read();
    const usart::Counters& counters = bench.line.counters();
    CHECK(bench.model.sent == written);
    CHECK(counters.unsent == refused);
    CHECK(arrived.size() == counters.received + bench.model.overwritten);
    CHECK(read.size() == counters.received - counters.full);
    // What is read is what arrived, with gaps, each of them marked.
    std::size_t at = 0;
    bool gap = false;
    unsigned wrong = 0;
    for (const char character : read) {
      if (character == usart::spoilt) {
        gap = true;
        continue;
      }
      const std::size_t found = arrived.find(character, at);
      if (found == std::string::npos || (found != at && !gap)) ++wrong;
      at = found + 1;
      gap = false;
    }
    CHECK(wrong == 0);
    CHECK(bench.model.violations.empty());
  }
}

}  // namespace ocm::usart_tests
