/// CSV with a head line, time in seconds with nine digits. Long, a line a field: time,topic,field,value,unit;
/// fields of topics with several frames are named frame.field. With chosen fields wide, a line a frame that
/// has one of them: time, and a column a field in the order of the choice, named topic.field; the cells of
/// fields of other frames are empty. Where the spec has parameter groups of J1939, four more columns say what
/// the identifier does: priority,pgn,source,destination.
#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "cli/output/digits.hpp"
#include "cli/output/field_text.hpp"
#include "cli/output/output.hpp"

namespace ocm::cli {
namespace {

/// In quotes where that is needed. [RFC 4180]
std::string cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string{text};
  std::string out{'"'};
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out += '"';
}

char* put_text(char* to, std::string_view text) {
  std::memcpy(to, text.data(), text.size());
  return to + text.size();
}

/// The frame's layout and data; nothing when it is no data of a topic.
const protocol::FrameLayout* layout_of(const client::Reception& reception) {
  using client::Meaning;
  const bool data = reception.meaning == Meaning::part || reception.meaning == Meaning::sample ||
                    reception.meaning == Meaning::set_point;
  return data ? &reception.frame.layout() : nullptr;
}

/// The last columns, of J1939; none where the catalogue has no parameter group.
class GroupColumns {
 public:
  explicit GroupColumns(const protocol::Catalogue& catalogue)
      : are_there_(std::any_of(catalogue.topics.begin(), catalogue.topics.end(),
                               [](const protocol::Topic& topic) { return is_group(topic.frames[0]); })) {}

  /// Names, and the end of the line.
  [[nodiscard]] std::string_view head() const noexcept {
    return are_there_ ? ",priority,pgn,source,destination\n" : "\n";
  }
  /// At most so many characters.
  static constexpr std::size_t room = 24;
  char* print(char* to, const Event& event) const {
    const bool of_group = are_there_ && is_group(event.reception.frame.layout());
    if (are_there_ && !of_group) to = put_text(to, ",,,,");
    if (of_group) {
      const auto* const message = event.reception.transported;
      const auto id = message != nullptr ? message->id : j1939::Identifier::decode(event.entry.id);
      *to++ = ',';
      to = put_unsigned(to, id.priority);
      *to++ = ',';
      to = put_hex(to, id.pgn, 5);
      *to++ = ',';
      to = put_unsigned(to, id.source);
      *to++ = ',';
      to = put_unsigned(to, id.destination);
    }
    *to++ = '\n';
    return to;
  }

 private:
  [[nodiscard]] static bool is_group(const protocol::FrameLayout& layout) noexcept {
    return layout.address.by == protocol::Address::By::pgn;
  }
  bool are_there_;
};

/// By number of a topic's frame, in an array that all topics share: what is made once for a frame.
template <class T>
class PerFrame {
 public:
  explicit PerFrame(const protocol::Catalogue& catalogue) : first_of_(catalogue.topics.data()) {
    for (const auto& topic : catalogue.topics) {
      begins_.push_back(items_.size());
      items_.resize(items_.size() + topic.frames.size());
    }
  }
  [[nodiscard]] T& operator[](protocol::FrameRef frame) {
    return items_[begins_[static_cast<std::size_t>(frame.topic - first_of_)] + frame.frame];
  }

 private:
  const protocol::Topic* first_of_;
  std::vector<std::size_t> begins_;
  std::vector<T> items_;
};

class LongCsv final : public Output {
 public:
  explicit LongCsv(const protocol::Catalogue& catalogue) : lines_(catalogue), group_(catalogue) {
    for (const auto& topic : catalogue.topics)
      for (std::size_t i = 0; i < topic.frames.size(); ++i) {
        const auto& layout = topic.frames[i];
        const std::string frame = layout.name.empty() ? std::string{} : std::string{layout.name} + '.';
        for (const auto& field : layout.values())
          lines_[{&topic, static_cast<std::uint8_t>(i)}].push_back(
              {FieldText{field}, ',' + cell(topic.name) + ',' + cell(frame + std::string{field.name}) + ',',
               ',' + cell(field.unit), layout.may_lack(field)});
      }
  }

  void begin(Buffer& out) override {
    out.append("time,topic,field,value,unit");
    out.append(group_.head());
  }

  bool write(Buffer& out, const Event& event) override {
    if (layout_of(event.reception) == nullptr) return false;
    char time[40];
    const auto time_size =
        static_cast<std::size_t>(put_seconds(time, event.entry.time.time_since_epoch().count()) - time);
    char end[GroupColumns::room];
    const auto end_size = static_cast<std::size_t>(group_.print(end, event) - end);
    const auto& layout = event.reception.frame.layout();
    const auto bytes = bytes_of(event);
    for (const Line& line : lines_[event.reception.frame]) {
      if (line.varies && !layout.has(line.value.field(), bytes)) continue;
      char* to = out.room(time_size + line.before.size() + FieldText::room + line.after.size() + end_size);
      to = put_text(to, {time, time_size});
      to = put_text(to, line.before);
      to = line.value.print(to, bytes.data());
      to = put_text(to, line.after);
      out.grow_to(put_text(to, {end, end_size}));
    }
    return true;
  }

 private:
  struct Line {
    FieldText value;
    std::string before, after;
    bool varies;  // not every frame has it
  };
  PerFrame<std::vector<Line>> lines_;
  GroupColumns group_;
};

class WideCsv final : public Output {
 public:
  WideCsv(const protocol::Catalogue& catalogue, const Selection& selection)
      : cells_(catalogue), columns_(selection.fields().size()), group_(catalogue) {
    for (std::size_t i = 0; i < columns_; ++i) {
      const auto& chosen = selection.fields()[i];
      head_ += ',' + cell(chosen.name);
      const auto number = static_cast<std::uint8_t>(chosen.layout - chosen.topic->frames.data());
      cells_[{chosen.topic, number}].push_back(
          {FieldText{*chosen.field}, i, chosen.layout->may_lack(*chosen.field)});
    }
  }

  void begin(Buffer& out) override {
    out.append("time");
    out.append(head_);
    out.append(group_.head());
  }

  bool write(Buffer& out, const Event& event) override {
    if (layout_of(event.reception) == nullptr) return false;
    const auto& cells = cells_[event.reception.frame];  // in the order of the columns
    const auto& layout = event.reception.frame.layout();
    const auto bytes = bytes_of(event);
    const bool may_lack_any = event.reception.transported != nullptr;  // of any length
    const auto is_there = [&](const Cell& cell) {
      return !(cell.varies || may_lack_any) || layout.has(cell.value.field(), bytes);
    };
    if (std::none_of(cells.begin(), cells.end(), is_there)) return false;
    char* to = out.room(40 + cells.size() * FieldText::room + columns_ + GroupColumns::room);
    to = put_seconds(to, event.entry.time.time_since_epoch().count());
    std::size_t column = 0;
    const auto put_commas = [&](std::size_t count) {
      std::memset(to, ',', count);
      to += count;
    };
    for (const Cell& cell : cells) {
      put_commas(cell.column + 1 - column);
      column = cell.column + 1;
      if (!is_there(cell)) continue;
      to = cell.value.print(to, bytes.data());
    }
    put_commas(columns_ - column);
    out.grow_to(group_.print(to, event));
    return true;
  }

 private:
  struct Cell {
    FieldText value;
    std::size_t column;
    bool varies;
  };
  PerFrame<std::vector<Cell>> cells_;
  std::size_t columns_;
  std::string head_;
  GroupColumns group_;
};

}  // namespace

std::unique_ptr<Output> make_csv(const protocol::Catalogue& catalogue, const Selection& selection) {
  if (selection.everything()) return std::make_unique<LongCsv>(catalogue);
  return std::make_unique<WideCsv>(catalogue, selection);
}

}  // namespace ocm::cli
