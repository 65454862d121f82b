#include "cli/plot/curves.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace ocm::cli::plot {
namespace {

using Chosen = std::vector<ChosenField>;

/// As Selection, and `*` is all.
transport::Outcome<Chosen> choose(const protocol::Catalogue& catalogue, std::string_view word) {
  if (word.ends_with(".*")) word.remove_suffix(2);
  const std::vector<std::string> words{std::string{word}};
  auto selection = Selection::of(catalogue, words);
  if (!selection) return selection.error;
  return Chosen{selection->fields().begin(), selection->fields().end()};
}

/// The pair that is meant: of one frame, if that is clear; otherwise the only one.
std::optional<Wanted> pair_of(const Chosen& xs, const Chosen& ys) {
  std::vector<Wanted> pairs;
  for (const auto& x : xs)
    for (const auto& y : ys)
      if (x.layout == y.layout) pairs.push_back({x, y});
  if (pairs.empty() && xs.size() == 1 && ys.size() == 1) pairs.push_back({xs[0], ys[0]});
  return pairs.size() == 1 ? std::optional{pairs[0]} : std::nullopt;
}

/// Of a topic or message, as it should be.
bool carries_values(client::Meaning meaning) {
  return meaning == client::Meaning::part || meaning == client::Meaning::sample ||
         meaning == client::Meaning::set_point;
}

std::string names(const Chosen& fields) {
  std::string text;
  for (const auto& field : fields) text += (text.empty() ? "" : ", ") + field.name;
  return text;
}

}  // namespace

transport::Outcome<std::vector<Wanted>> parse_fields(const protocol::Catalogue& catalogue,
                                                     std::string_view word) {
  const std::size_t colon = word.find(':');
  const auto ys = choose(catalogue, colon == std::string_view::npos ? word : word.substr(colon + 1));
  if (!ys) return ys.error;
  std::vector<Wanted> wanted;
  if (colon == std::string_view::npos) {
    for (const auto& y : *ys) wanted.push_back({std::nullopt, y});
    return wanted;
  }
  const auto xs = choose(catalogue, word.substr(0, colon));
  if (!xs) return xs.error;
  const auto pair = pair_of(*xs, *ys);
  if (!pair)
    return transport::Failure{fmt::format("'{}' may mean several paths", word),
                              fmt::format("name the frames: {} against {}", names(*xs), names(*ys))};
  wanted.push_back(*pair);
  return wanted;
}

Curves::Curves(const protocol::Catalogue& catalogue, const std::vector<Wanted>& wanted)
    : receiver_(catalogue, client::Transport::together) {
  for (const auto& each : wanted) curves_.push_back({each, {}, {}});
  for (std::size_t i = 0; i < curves_.size(); ++i)
    if (const auto& x = curves_[i].wanted.x) uses_[x->layout].push_back({i, x->field, true});
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    const auto& y = curves_[i].wanted.y;
    uses_[y.layout].push_back({i, y.field, false});
  }
}

void Curves::take(std::span<const log::Entry> entries, const log::Interfaces& interfaces) {
  for (std::size_t i = 0; i < interfaces.size() && receiver_.has_buses(); ++i)
    receiver_.on_interface(static_cast<std::uint16_t>(i), interfaces.name(static_cast<std::uint16_t>(i)));
  for (const log::Entry& entry : entries) {
    begin_ = begin_ ? std::min(*begin_, entry.time) : entry.time;
    end_ = std::max(end_, entry.time);
    const auto reception =
        receiver_.take({entry.id, entry.format, entry.is_fd(), entry.bytes()}, entry.time, entry.interface);
    if (!carries_values(reception.meaning)) continue;
    // A frame of a sample has its values, whether or not the others come.
    const auto data = reception.transported != nullptr ? reception.transported->data : entry.bytes();
    const auto& layout = reception.frame.layout();
    const auto uses = uses_.find(&layout);
    if (uses == uses_.end()) continue;
    for (const Use& use : uses->second) {
      if (!layout.has(*use.field, data)) continue;
      Curve& curve = curves_[use.curve];
      const double value = use.field->value(use.field->raw(data));
      if (use.is_x)
        curve.x = value;
      else if (!curve.wanted.x)
        curve.envelope.add(entry.time, 0, value);
      else if (curve.x)
        curve.envelope.add(entry.time, *curve.x, value);
    }
  }
}

std::uint64_t Curves::points() const noexcept {
  std::uint64_t sum = 0;
  for (const Curve& curve : curves_) sum += curve.envelope.count();
  return sum;
}

}  // namespace ocm::cli::plot
