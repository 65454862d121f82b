// A client at a central that says anything: no request is waited for without an end, a central that falls
// silent ends them all, and after any noise a real one is heard: its robots are listed, and spoken to.
#include "ocm/mapper/server/central_client.hpp"

#include <string>

#include "ocm/mapper/link/central.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using mapper::server::CentralClient;
using mapper::server::CentralEvent;

namespace {

constexpr std::string_view answers[] = {"scanning\n",
                                        "found 1\n",
                                        "end of list\n",
                                        "connecting 0\n",
                                        "connected 0\n",
                                        "data 0\n",
                                        "closing 0\n",
                                        "closed 0\n",
                                        "lost 0\n",
                                        "command\n",
                                        "reset\n",
                                        "error: no link to 0\n",
                                        "[0]:AVR:{S,IDL}\n",
                                        "error: scans already\n",
                                        "0:C00000000001:AVR\n",
                                        "error: still connecting 0\n"};

/// A central whose radio obeys at once.
class Exchange {
 public:
  explicit Exchange(CentralClient& client, base::Time now) : client_(&client), now_(now) {
    for (const char c : std::string_view{"start\n"}) central_.feed(c, *this);
    for (const mapper::link::Address& address : robots) central_.found(address, "AVR", *this);
    said_.clear();
  }
  /// Until nothing is requested, and nothing said.
  void settle() {
    for (int round = 0; round < 100 && !client_->idle(); ++round) {
      client_->expire(now_);
      for (const char c : client_->take()) central_.feed(c, *this);
      if (joining_ != nullptr) central_.connected(*std::exchange(joining_, nullptr), *this);
      if (said_.empty()) now_ = std::max(now_, client_->deadline());
      client_->feed(std::exchange(said_, {}), now_);
    }
    for (const char c : client_->take()) central_.feed(c, *this);
    fuzz::expect(client_->idle(), "a central that answers ends a request");
  }
  [[nodiscard]] std::string heard_by(const mapper::link::Address& address) {
    std::string text;
    while (const auto packet = central_.take(address))
      text.append(packet->bytes().begin(), packet->bytes().end());
    return text;
  }

  void say(std::string_view text) { said_ += text; }
  void start_scan() {}
  void stop_scan() {}
  void connect(const mapper::link::Address& address) {
    joining_ = &*std::find(std::begin(robots), std::end(robots), address);
  }
  void disconnect(const mapper::link::Address&) {}
  void restart() {}

  static constexpr mapper::link::Address robots[] = {{0xC0, 0, 0, 0, 0, 1}, {0xC0, 0, 0, 0, 0, 2}};

 private:
  CentralClient* client_;
  base::Time now_;
  mapper::link::Central<3, 2, 4> central_;
  const mapper::link::Address* joining_ = nullptr;
  std::string said_;
};

/// How many events of a kind have come.
int drain(CentralClient& client, CentralEvent::Kind kind) {
  int count = 0;
  while (const auto event = client.next_event()) {
    fuzz::expect((event->kind == CentralEvent::Kind::failed) != event->words.empty(),
                 "a failure has words, and nothing else");
    if (event->kind == kind) ++count;
  }
  return count;
}

/// Requests, answers and time, in any order; what time it is then.
base::Time play(CentralClient& client, fuzz::Input input) {
  base::Time now{};
  while (!input.empty()) {
    const std::uint8_t what = input.byte();
    const unsigned index = what >> 6;
    switch (what % 8) {
      case 0:
        (void)client.scan(std::chrono::milliseconds{100 * index});
        break;
      case 1:
        (void)client.connect(index);
        break;
      case 2:
        (void)client.say(index, "{U,90,130}\n");
        break;
      case 3:
        index == 0 ? (void)client.leave() : (void)client.drop(index - 1);
        break;
      case 4:
        now += std::chrono::milliseconds{10 * input.byte()};
        break;
      case 5:
        now = client.deadline() == base::never ? now : std::max(now, client.deadline());
        break;
      case 6:
        client.feed(answers[input.byte() % std::size(answers)], now);
        break;
      default: {
        const auto bytes = input.bytes(what >> 3);
        client.feed(fuzz::text_of(bytes.data(), bytes.size()), now);
      }
    }
    client.expire(now);
    (void)client.take();
    fuzz::expect(client.idle() || client.deadline() > now, "a request that has begun has a deadline");
    fuzz::expect(client.idle() || client.deadline() != base::never,
                 "no request is waited for without an end");
  }
  return now;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  CentralClient client;
  base::Time now = play(client, {data, size});
  for (int i = 0; i < 2000 && !client.idle(); ++i) {
    now = client.deadline();
    client.expire(now);
    (void)client.take();
  }
  fuzz::expect(client.idle(), "a central that is silent ends all requests");
  (void)client.take_robots();
  (void)drain(client, CentralEvent::Kind::listed);

  Exchange exchange{client, now};
  (void)client.scan({});
  exchange.settle();
  fuzz::expect(drain(client, CentralEvent::Kind::listed) == 1 && client.peers().size() == 2,
               "after any noise the robots are listed");
  (void)client.connect(1);
  (void)client.say(1, "{S,CON}\n");
  exchange.settle();
  fuzz::expect(drain(client, CentralEvent::Kind::failed) == 0, "what a central can do it does");
  fuzz::expect(
      exchange.heard_by(Exchange::robots[1]) == "{S,CON}\n" && exchange.heard_by(Exchange::robots[0]).empty(),
      "the words go to their robot");
  return 0;
}
