/// Requests: what an operator asks of a sensor, and what a board reads of it.
#include <cstdio>

#include "ocm/can/text.hpp"
#include "ocm/protocol/request.hpp"

using namespace ocm;
using namespace std::chrono_literals;

int main() {
  // snippet: request-magnetometer
  const auto frame = protocol::publish_every(protocol::TopicId{0x05}, 900us, protocol::Priority::medium);
  // endsnippet
  if (!frame) return 1;
  const auto text = can::to_text(*frame);
  std::printf("%.*s\n", static_cast<int>(text.view().size()), text.view().data());

  // What the wire cannot carry is an error, and nearest() says what could be asked for.
  const auto impossible = protocol::publish_every(protocol::TopicId{0x05}, 65'536ms);
  if (impossible) return 1;
  const auto instead = protocol::Period::nearest(65'536ms);
  std::printf("65.536 s: %s; nearest %lld us\n", base::describe(impossible.error).data(),
              static_cast<long long>(instead.duration() / 1us));
}
