/// JSON lines, as JsonText makes them.
#include "cli/output/json_text.hpp"
#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Json final : public Output {
 public:
  Json(const protocol::Catalogue& catalogue, const Selection& selection) : text_(catalogue, selection) {}
  bool write(Buffer& out, const Event& event) override { return text_.write(out, event.bus, event.entry); }

 private:
  JsonText text_;
};

}  // namespace

std::unique_ptr<Output> make_json(const protocol::Catalogue& catalogue, const Selection& selection) {
  return std::make_unique<Json>(catalogue, selection);
}

}  // namespace ocm::cli
