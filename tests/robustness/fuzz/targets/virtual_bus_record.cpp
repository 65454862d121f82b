// Records of the virtual bus: any 32 bytes decode to a frame that can exist, or to a reason in words.
#include "ocm/transport/virtual_bus_protocol.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;
namespace vb = transport::virtual_bus;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  while (!input.empty()) {
    const auto record = input.number<vb::Record>();
    fuzz::expect(!vb::describe(vb::from_record<vb::Goodbye>(record)).empty(), "every reason has words");
    const auto frame = vb::decode(vb::from_record<vb::FrameRecord>(record));
    if (!frame) {
      fuzz::expect(!vb::describe(frame.error).empty(), "a refused frame has a reason");
      continue;
    }
    fuzz::expect(can::validate(*frame).ok(), "a frame that decodes can exist");
    const auto again = vb::decode(vb::from_record<vb::FrameRecord>(vb::to_record(*frame)));
    fuzz::expect(again.ok() && *again == *frame, "a frame survives the way there and back");
  }
  return 0;
}
