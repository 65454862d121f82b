/// candump's log line: `(1436509052.249713) can0 605#00D20000`. Every frame, known or not.
#include "ocm/can/text.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Raw final : public Output {
 public:
  void write(Buffer& out, const Event& event) override {
    append(out, can::to_log_line(event.received.time, event.bus, event.received.frame).view());
    out.push_back('\n');
  }
};

}  // namespace

std::unique_ptr<Output> make_raw() {
  return std::make_unique<Raw>();
}

}  // namespace ocm::cli
