/// JSON lines, as JsonText makes them.
#include "cli/output/json_text.hpp"
#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Json final : public Output {
 public:
  Json(const protocol::Catalogue& catalogue, const Selection& selection) : text_(catalogue, selection) {}
  bool write(Buffer& out, const Event& event) override {
    const auto& reception = event.reception;
    if (reception.meaning != client::Meaning::transport && reception.transported == nullptr)
      return text_.write(out, event.bus, event.entry);
    return text_.write_transport(out, event.bus, event.entry, reception);
  }

 private:
  JsonText text_;
};

}  // namespace

std::unique_ptr<Output> make_json(const protocol::Catalogue& catalogue, const Selection& selection) {
  return std::make_unique<Json>(catalogue, selection);
}

}  // namespace ocm::cli
