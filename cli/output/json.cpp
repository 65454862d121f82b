/// JSON lines, as JsonText makes them.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cli/output/json_text.hpp"
#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Json final : public Output {
 public:
  Json(const protocol::Catalogue& catalogue, const Selection& selection)
      : catalogue_(&catalogue), has_buses_(catalogue.has_buses()), text_(catalogue, selection) {
    if (has_buses_) selection_ = selection;
  }
  bool write(Buffer& out, const Event& event) override {
    const auto& reception = event.reception;
    JsonText& text = has_buses_ ? text_on(event.bus) : text_;
    if (reception.meaning != client::Meaning::transport && reception.transported == nullptr)
      return text.write(out, event.bus, event.entry);
    return text.write_transport(out, event.bus, event.entry, reception);
  }

 private:
  /// What frames of one interface mean.
  JsonText& text_on(std::string_view interface) {
    for (auto& [name, text] : on_)
      // Not ==: then compare is one function for all its uses, and the one of each frame is not inlined.
      if (std::equal(name.begin(), name.end(), interface.begin(), interface.end())) return *text;
    on_.emplace_back(interface, std::make_unique<JsonText>(*catalogue_, selection_, interface));
    return *on_.back().second;
  }

  const protocol::Catalogue* catalogue_;
  bool has_buses_;
  JsonText text_;
  Selection selection_;
  std::vector<std::pair<std::string, std::unique_ptr<JsonText>>> on_;
};

}  // namespace

std::unique_ptr<Output> make_json(const protocol::Catalogue& catalogue, const Selection& selection) {
  return std::make_unique<Json>(catalogue, selection);
}

}  // namespace ocm::cli
