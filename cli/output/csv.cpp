/// Long CSV, one line a field: time,topic,field,value,unit. Time in seconds with nanoseconds. Fields of
/// topics with several frames are named frame.field.
#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Csv final : public Output {
 public:
  void begin(Buffer& out) override { append(out, "time,topic,field,value,unit\n"); }

  void write(Buffer& out, const Event& event) override {
    const auto meaning = event.reception.meaning;
    if (meaning != reflective::Meaning::part && meaning != reflective::Meaning::sample &&
        meaning != reflective::Meaning::set_point)
      return;
    const auto& layout = event.reception.frame.layout();
    const std::int64_t ns = event.received.time.time_since_epoch().count();
    for (const auto& field : layout.fields) {
      fmt::format_to(std::back_inserter(out), "{}.{:09},{},", ns / 1'000'000'000, ns % 1'000'000'000,
                     event.reception.topic->name);
      if (!layout.name.empty()) fmt::format_to(std::back_inserter(out), "{}.", layout.name);
      append(out, field.name);
      out.push_back(',');
      append(out, physical(field, event.received.frame.data));
      out.push_back(',');
      append(out, field.unit);
      out.push_back('\n');
    }
  }
};

}  // namespace

std::unique_ptr<Output> make_csv() {
  return std::make_unique<Csv>();
}

}  // namespace ocm::cli
