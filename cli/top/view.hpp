/// What `top` shows, and what its keys do: a picture of lines for a terminal of any size. Pure: it knows no
/// terminal, so that a test can press keys and read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"

#include "cli/bus_model/model.hpp"
#include "cli/bus_model/models.hpp"
#include "cli/bus_model/playing.hpp"
#include "cli/shared/terminal.hpp"
#include "cli/top/line.hpp"
#include "cli/top/sort.hpp"

namespace ocm::cli::top {

using bus_model::Bus;
using bus_model::FieldKey;
using bus_model::Health;
using bus_model::Model;
using bus_model::Models;
using bus_model::Playing;
using bus_model::Row;
using bus_model::Summary;

/// What a person pressed.
struct Key {
  enum class Kind : std::uint8_t {
    character,  ///< `text` has it, in UTF-8
    up,
    down,
    left,
    right,
    page_up,
    page_down,
    home,
    end,
    enter,
    tabulator,
    escape,
    backspace,
    function,  ///< `number` says which
    click,     ///< of the mouse, in line `number`
  };
  Kind kind = Kind::character;
  std::string text{};
  unsigned number = 0;
};

/// What a key asks of the program.
struct Effect {
  enum class Kind : std::uint8_t {
    none,
    quit,
    pause,   ///< or go on
    move,    ///< in a log, by `by`
    rewind,  ///< to the log's beginning
    faster,  ///< a log, twice
    slower,  ///< a log, half
  };
  Kind kind = Kind::none;
  base::Duration by{};
};

/// What is drawn.
struct Scene {
  std::string_view robot;
  std::string source;
  std::span<const Bus> buses;
  base::Time now{};
  bool paused = false;
  bool waiting = false;  ///< the bus is down
  std::optional<Playing> playing;
  std::string message;  ///< for the last line; empty: the keys
};

class View {
 public:
  /// Without `unicode` a graph has letters of ASCII.
  explicit View(bool unicode) : unicode_(unicode) {}

  [[nodiscard]] Picture draw(const Scene& scene, TerminalSize size);
  /// Of the picture that was drawn last.
  Effect press(const Key& key);
  /// Fields that are to be followed, of each bus; of the picture that was drawn last.
  [[nodiscard]] std::set<FieldKey> graphs(std::size_t bus) const;

  /// Shows these only, also while nothing comes of them.
  void only(const std::vector<const protocol::Topic*>& topics) { only_ = {topics.begin(), topics.end()}; }

 private:
  /// A row, or one of its fields.
  struct ItemKey {
    std::size_t bus = 0;
    std::size_t row = 0;
    int frame = -1;
    int field = -1;
    [[nodiscard]] bool is_row() const noexcept { return field < 0; }
    friend auto operator<=>(const ItemKey&, const ItemKey&) = default;
  };
  struct Item {
    ItemKey key;
    const Row* row = nullptr;
  };
  /// What a key can be pressed on.
  struct Place {
    ItemKey key;
    const protocol::Topic* topic = nullptr;
  };
  using Rows = std::vector<std::pair<std::size_t, Row>>;  ///< with the number of their bus
  /// Which columns a width has room for; 0: none of that.
  struct Columns {
    std::size_t name = 12;
    std::size_t rate = 6, age = 0, jitter = 0, share = 0, changed = 0, faults = 0, count = 0;

    Columns(std::size_t width, std::size_t longest_name);
  };
  /// A field's value when it was last there: a multiplexer's other pages keep theirs.
  struct Seen {
    std::int64_t raw = 0;
    std::string text;  ///< empty: it was not there yet
    base::Time changed{};
  };

  [[nodiscard]] Rows chosen_rows(const Scene& scene) const;
  [[nodiscard]] bool matches(std::string_view bus, const Row& row) const;
  [[nodiscard]] std::vector<Item> items(const Rows& rows) const;
  void keep_cursor_in_sight(std::size_t lines);
  void heads(Picture& picture, const Scene& scene, const Rows& rows, std::size_t width) const;
  [[nodiscard]] Line heading(const Columns& columns, std::size_t width) const;
  [[nodiscard]] Line row_line(const Columns& columns, const Scene& scene, const Item& item,
                              std::size_t width);
  [[nodiscard]] Line field_line(const Columns& columns, const Scene& scene, const Item& item,
                                std::size_t width);
  [[nodiscard]] std::string graph(const std::vector<double>& values, std::size_t width) const;
  [[nodiscard]] Line foot(const Scene& scene, std::size_t width) const;
  [[nodiscard]] Line time_bar(const Playing& playing, bool paused, std::size_t width) const;
  [[nodiscard]] Picture help(TerminalSize size) const;
  Effect type(const Key& key);
  void move_to(std::size_t item);
  void move_by(std::ptrdiff_t items);
  void pick(const Place& place);
  [[nodiscard]] std::size_t cursor_index() const;

  bool unicode_;
  Sort sort_ = Sort::spec;
  bool reversed_ = false;
  bool all_ = false;
  bool help_ = false;
  bool typing_ = false;
  std::set<const protocol::Topic*> only_;
  std::string filter_;
  std::string filter_before_;
  std::set<std::pair<std::size_t, std::size_t>> open_;  ///< bus and row
  std::set<ItemKey> graphs_;
  std::optional<ItemKey> cursor_;
  std::size_t first_ = 0;                  ///< item in the first line of the list
  std::vector<Place> order_;               ///< of the last picture
  std::size_t list_at_ = 0;                ///< its first line
  std::size_t list_lines_ = 0;             ///< room for items
  std::map<ItemKey, std::size_t> widths_;  ///< of values: they only grow, so that nothing jumps
  std::map<ItemKey, Seen> seen_;
};

}  // namespace ocm::cli::top
