/// candump's log line: `(1436509052.249713) can0 605#00D20000`. Every frame, known or not.
#include "ocm/log/candump.hpp"
#include "ocm/log/interfaces.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Raw final : public Output {
 public:
  bool write(Buffer& out, const Event& event) override {
    log::Entry entry = event.entry;
    entry.interface = interfaces_.number(event.bus);
    writer_.write(out, {&entry, 1}, interfaces_);
    return true;
  }

 private:
  log::Interfaces interfaces_;
  log::CandumpWriter writer_;
};

}  // namespace

std::unique_ptr<Output> make_raw() {
  return std::make_unique<Raw>();
}

}  // namespace ocm::cli
