// Requests: any frame decodes or is refused; what decodes, encodes to the same frame; every request survives
// the way there and back.
#include "ocm/protocol/request.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  const can::Frame frame = input.any_frame();
  if (const auto request = protocol::decode_request(frame)) {
    const bool default_publish = request->mode == protocol::Mode::publish && frame.dlc == 1;
    const can::Frame encoded = default_publish
                                   ? protocol::encode_default_publish(request->topic, request->priority)
                                   : protocol::encode(*request);
    can::Frame expected = frame;
    std::fill(expected.data.begin() + expected.dlc, expected.data.end(), std::uint8_t{0});
    fuzz::expect(encoded == expected, "a frame that decodes encodes to itself");
    const auto again = protocol::decode_request(encoded);
    fuzz::expect(again.ok() && *again == *request, "decode(encode(decoded)) is the request");
  }

  // The same bytes as a request.
  protocol::Request request;
  request.topic = protocol::TopicId{static_cast<std::uint8_t>(frame.id)};
  request.priority = static_cast<protocol::Priority>(frame.id >> 8 & 3);
  request.mode = static_cast<protocol::Mode>(frame.data[0] % 3);
  if (request.mode == protocol::Mode::publish) {
    const auto count = static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
    request.period = {count, static_cast<protocol::PeriodUnit>(frame.data[3] % 3)};
  }
  const auto decoded = protocol::decode_request(protocol::encode(request));
  if (request.period.count == 0)
    fuzz::expect(decoded.error == base::Error::bad_period, "a period of zero is refused");
  else
    fuzz::expect(decoded.ok() && *decoded == request, "decode(encode(request)) is the request");
  return 0;
}
