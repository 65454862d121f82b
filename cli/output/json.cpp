/// JSON lines, one object a frame with stable keys: time_ns (a string: it has more digits than a double),
/// bus, id, priority, topic, frame, fields, units, data. What is the same in every frame of a kind is made
/// once.
#include <string>
#include <unordered_map>
#include <vector>

#include <nlohmann/json.hpp>

#include "ocm/can/error_frame.hpp"
#include "ocm/can/text.hpp"
#include "ocm/protocol/request.hpp"

#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

class Json final : public Output {
 public:
  explicit Json(const protocol::Catalogue& catalogue) {
    for (const auto& topic : catalogue.topics)
      for (std::size_t i = 0; i < topic.frames.size(); ++i)
        texts_.emplace(&topic.frames[i], texts_of({&topic, static_cast<std::uint8_t>(i)}));
  }

  void write(Buffer& out, const Event& event) override {
    const auto& frame = event.received.frame;
    const auto id = protocol::Identifier::decode(frame.id);
    const auto frame_text = can::to_text(frame);
    const std::size_t hash = frame_text.view().find('#');
    append(out, R"({"time_ns":")");
    append(out, fmt::format_int{event.received.time.time_since_epoch().count()}.c_str());
    append(out, R"(","bus":")");
    append(out, event.bus);
    append(out, R"(","id":")");
    append(out, frame_text.view().substr(0, hash));
    out.push_back('"');
    using reflective::Meaning;
    switch (event.reception.meaning) {
      case Meaning::part:
      case Meaning::sample:
      case Meaning::set_point:
        fields(out, id.priority, event.reception.frame.layout(), frame.data);
        break;
      case Meaning::request:
        request(out, id, *event.reception.topic, frame);
        break;
      case Meaning::wrong_dlc:
        fmt::format_to(std::back_inserter(out),
                       R"(,"priority":"{}","topic":"{}","frame":"{}","error":"DLC {} instead of {}")",
                       name(id.priority), event.reception.topic->name, frame_name(event.reception.frame),
                       frame.dlc, event.reception.frame.layout().dlc);
        break;
      case Meaning::unknown:
        append(out, R"(,"error":"unknown identifier")");
        break;
      case Meaning::error:
        fmt::format_to(std::back_inserter(out), R"(,"error":"error frame: {}")", can::describe(frame).view());
        break;
    }
    append(out, R"(,"data":")");
    append(out, frame_text.view().substr(hash + 1));
    append(out, "\"}\n");
  }

 private:
  struct Texts {
    std::string head;                 // ,"topic":"...","frame":"...","fields":
    std::vector<std::string> fields;  // "name": with what stands before it
    std::string units;                // the end of the fields, and the units
  };

  static Texts texts_of(protocol::FrameRef frame) {
    Texts texts;
    texts.head =
        fmt::format(R"(","topic":"{}","frame":"{}","fields":)", frame.topic->name, frame_name(frame));
    nlohmann::ordered_json units = nlohmann::ordered_json::object();
    for (const auto& field : frame.layout().fields) {
      texts.fields.push_back(fmt::format(R"({}"{}":)", texts.fields.empty() ? "{" : ",", field.name));
      units[std::string{field.name}] = field.unit;
    }
    texts.units = (texts.fields.empty() ? "{}" : "}") + std::string{R"(,"units":)"} + units.dump();
    return texts;
  }

  void fields(Buffer& out, protocol::Priority priority, const protocol::FrameLayout& layout,
              const can::Payload& data) const {
    const Texts& texts = texts_.at(&layout);
    append(out, R"(,"priority":")");
    append(out, name(priority));
    append(out, texts.head);
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      append(out, texts.fields[i]);
      append(out, physical(layout.fields[i], data));
    }
    append(out, texts.units);
  }

  static void request(Buffer& out, protocol::Identifier id, const protocol::Topic& topic,
                      const can::Frame& frame) {
    const auto to = std::back_inserter(out);
    fmt::format_to(to, R"(,"priority":"{}","topic":"{}","frame":"request")", name(id.priority), topic.name);
    const auto request = protocol::decode_request(frame);
    if (!request) {
      fmt::format_to(to, R"(,"error":"{}")", base::describe(request.error));
      return;
    }
    constexpr std::string_view modes[] = {"stop", "publish", "once"};
    fmt::format_to(to, R"(,"fields":{{"mode":"{}")", modes[static_cast<std::size_t>(request->mode)]);
    if (request->mode == protocol::Mode::publish) {
      const auto period = frame.dlc == 1 ? topic.period : request->period;
      append(out, R"(,"period":)");
      append(out, base::normalised(period.duration().count(), -9));
    }
    append(out, R"(},"units":{"period":"s"})");
  }

  std::unordered_map<const protocol::FrameLayout*, Texts> texts_;
};

}  // namespace

std::unique_ptr<Output> make_json(const protocol::Catalogue& catalogue) {
  return std::make_unique<Json>(catalogue);
}

}  // namespace ocm::cli
