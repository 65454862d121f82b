// What a viewer of `amiroctl serve` sends: any text or binary message is understood, or refused in words;
// what is published as a command is a frame of its topic within its limits, or is refused in words; whatever
// viewers subscribe to and leave, the count of subscriptions is right.
#include "ocm/topics/amiro.hpp"

#include "cli/serve/commands.hpp"
#include "cli/serve/foxglove.hpp"
#include "cli/serve/viewers.hpp"
#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
using namespace ocm::cli;

namespace {

void take(const serve::foxglove::Request& request, serve::Viewers& viewers, serve::ViewerId viewer) {
  using Op = serve::foxglove::Request::Op;
  if (request.op == Op::subscribe)
    for (const auto& subscription : request.subscriptions)
      static_cast<void>(viewers.subscribe(viewer, subscription));
  if (request.op == Op::unsubscribe)
    for (const std::uint32_t id : request.ids) static_cast<void>(viewers.unsubscribe(viewer, id));
}

void command(std::string_view topic, std::string_view payload) {
  const auto command = serve::command_of(amiro::catalogue, topic, payload);
  fuzz::expect(command.ok() != !command.error.empty(), "a command, or words why not");
  if (!command) return;
  fuzz::expect(!command->repeat, "nothing is repeated");
  for (const can::Frame& frame : command->frames)
    fuzz::expect(can::validate(frame).ok(), "a frame that can exist");
  if (command->hold) fuzz::expect(command->hold->rest.data == can::Payload{}, "its rest is zero");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  serve::Viewers viewers{4};
  const serve::ViewerId viewer = viewers.add();
  // A message a line.
  for (std::string_view rest = fuzz::text_of(data, size); !rest.empty();) {
    const std::string_view message = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(message.size() + 1, rest.size()));
    const auto request = serve::foxglove::parse(message);
    fuzz::expect(request.ok() || !request.error.empty(), "a request, or words why not");
    if (request) take(*request, viewers, viewer);
    if (const auto published = serve::foxglove::parse_binary(message))
      fuzz::expect(published->payload.size() + 5 == message.size(), "the payload is the rest");
    command("/motors", message);
    command("/led_1", message);
    command(serve::line_topic, message);
    if (const auto playback = serve::playback_of(message))
      fuzz::expect((!playback->at || playback->at->count() >= 0) && playback->speed >= 0, "within a log");
    for (std::uint32_t channel = 0; channel < 4; ++channel) viewers.publish_state(channel, 1, "x");
    while (viewers.next(viewer, base::Time{})) {
    }
  }
  viewers.remove(viewer);
  for (std::uint32_t channel = 0; channel < 4; ++channel)
    fuzz::expect(!viewers.wanted(channel), "no subscription is left");
  return 0;
}
