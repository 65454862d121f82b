/// The worst case as a picture: a Gantt chart of the busy period of the one that is late, or else has the
/// least slack for its deadline, from the moment at which it and all that is more urgent are released, just
/// after what blocks it has begun; and a bar for each response against its deadline.
///
/// The chart is one run of that release pattern, not the analysis: first releases as late as jitter lets them
/// be, second ones as early. B of tasks is not drawn, as its origin is not known.
#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "cli/analyse/report.hpp"

namespace ocm::cli::analyse {
namespace {

struct Piece {
  std::size_t row = 0;
  std::int64_t begin = 0;
  std::int64_t end = 0;
  enum class Kind { others, blocking, victim } kind = Kind::others;
  std::size_t job = 0;
};

constexpr std::size_t most_drawn = 60;
constexpr std::size_t most_pieces = 3000;

class Schedule {
 public:
  explicit Schedule(const Study& study) : study_(study), bus_(study.kind == Study::Kind::bus) {
    choose();
    run();
  }
  std::vector<Piece> pieces;
  std::vector<std::vector<std::int64_t>> releases;
  std::int64_t span = 1;
  std::size_t victim = 0;

 private:
  struct Job {
    std::int64_t left = 0;
    std::int64_t next = 0;
    std::int64_t waiting = 0;
    std::size_t number = 0;
  };

  void choose() {
    // What has no bound comes after those that are late, and before those that are in time, be it just so.
    const auto urgency = [this](std::size_t i) {
      const auto& r = study_.rows[i].result;
      const double share =
          r.bounded() ? static_cast<double>(r.response) / static_cast<double>(r.deadline) : 1.0;
      return std::pair{share, !r.bounded()};
    };
    for (std::size_t i = 1; i < study_.rows.size(); ++i)
      if (urgency(i) > urgency(victim)) victim = i;
    // To the end of its worst release; without one, some of its periods.
    const Row& row = study_.rows[victim];
    constexpr std::int64_t shown_periods = 3;
    analysis::Checked end = analysis::Checked{row.period} * shown_periods;
    if (row.result.bounded())
      end = analysis::Checked{row.period} * static_cast<std::int64_t>(row.result.instance) +
            row.result.response;
    span = end.value_or(row.period);
    span += span < INT64_MAX - span / 8 ? span / 8 : 0;
    // What is much shorter could not be seen.
    std::int64_t shortest = INT64_MAX;
    for (const Row& each : study_.rows) shortest = std::min(shortest, each.period);
    constexpr std::int64_t most_periods = 200;
    if (shortest < INT64_MAX / most_periods) span = std::min(span, shortest * most_periods);
    span = std::max<std::int64_t>(span, 1);
  }

  void run() {
    const auto& rows = study_.rows;
    std::vector<Job> jobs(rows.size());
    releases.resize(rows.size());
    std::int64_t now = 0;
    const auto& its = rows[victim].result;
    const std::size_t blocker = its.bounded() && its.blocked_by > victim ? its.blocked_by : rows.size();
    if (blocker < rows.size()) {  // its first release is the one that has just begun
      now = std::min(rows[blocker].cost, span);
      pieces.push_back({blocker, 0, now, Piece::Kind::blocking, 0});
      releases[blocker].push_back(0);
      jobs[blocker].next = rows[blocker].period - std::min(rows[blocker].jitter, rows[blocker].period - 1);
    }
    while (now < span && pieces.size() < most_pieces) {
      std::int64_t soonest = span;
      std::size_t chosen = rows.size();
      for (std::size_t i = 0; i < rows.size(); ++i) {
        Job& job = jobs[i];
        while (job.next <= now) {
          releases[i].push_back(job.next);
          ++job.waiting;
          const std::int64_t early =
              releases[i].size() == 1 ? std::min(rows[i].jitter, rows[i].period - 1) : 0;
          job.next = job.next > INT64_MAX - rows[i].period ? INT64_MAX : job.next + rows[i].period - early;
        }
        if (job.left == 0 && job.waiting > 0) {
          job.left = rows[i].cost;
          --job.waiting;
          ++job.number;
        }
        if (job.left > 0 && chosen == rows.size()) chosen = i;
        if (job.next > now) soonest = std::min(soonest, job.next);
      }
      if (chosen == rows.size()) {
        now = soonest;
        continue;
      }
      Job& job = jobs[chosen];
      const std::int64_t most = span - now;
      const std::int64_t length =
          std::min(bus_ ? job.left : std::min(job.left, std::max<std::int64_t>(soonest - now, 1)), most);
      if (!pieces.empty() && pieces.back().row == chosen && pieces.back().job == job.number)
        pieces.back().end += length;
      else
        pieces.push_back({chosen, now, now + length,
                          chosen == victim ? Piece::Kind::victim : Piece::Kind::others, job.number});
      job.left = length == most ? 0 : job.left - length;
      now += length;
    }
  }

  const Study& study_;
  bool bus_;
};

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      out += c;
  }
  return out;
}

/// The least of 1, 2 or 5 times a power of ten of which no more than ten fit.
std::int64_t grid_step(std::int64_t span) {
  constexpr std::int64_t most = 10;
  std::int64_t step = 1;
  for (;; step *= 10) {
    for (const std::int64_t times : {1, 2, 5})
      if (span / (step * times) <= most) return step * times;
    if (step > INT64_MAX / 100) return span;
  }
}

/// The picture: when each row is released and runs as the worst case unfolds, and below it what is left to
/// each deadline. Lengths are pixels.
class Picture {
 public:
  explicit Picture(const Study& study)
      : study_(study),
        schedule_{study},
        drawn_(std::min(study.rows.size(), most_drawn)),
        left_(room_for_names()),
        rows_height_(row_height * static_cast<double>(drawn_)),
        bars_top_(top + rows_height_ + 74) {}

  [[nodiscard]] std::string draw() {
    add("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"12\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        left_ + chart + right, bars_top_ + rows_height_ + 44);
    title();
    grid();
    for (std::size_t i = 0; i < drawn_; ++i) releases(i);
    for (const Piece& piece : schedule_.pieces)
      if (piece.row < drawn_) runs(piece);
    add("<text x=\"{:.0f}\" y=\"{:.1f}\" fill=\"#555\" font-size=\"11\">arrow: release; red line: first "
        "deadline; grey: what blocks it, has just begun; orange: it</text>\n",
        left_, top + rows_height_ + 32);
    add("<text x=\"10\" y=\"{:.1f}\" font-size=\"15\" font-weight=\"bold\">Response at worst, and what is "
        "left "
        "to the deadline</text>\n",
        bars_top_ - 12);
    for (std::size_t i = 0; i < drawn_; ++i) response(i);
    deadlines();
    svg_ += "</svg>\n";
    return std::move(svg_);
  }

 private:
  static constexpr double chart = 680;
  static constexpr double right = 20;
  static constexpr double row_height = 24;
  static constexpr double top = 66;
  /// All deadlines are at one place, so that what is beyond them can be seen.
  static constexpr double due = chart * 0.5;

  template <class... Values>
  void add(fmt::format_string<Values...> text, Values&&... values) {
    svg_ += fmt::format(text, std::forward<Values>(values)...);
  }
  [[nodiscard]] double room_for_names() const {
    std::size_t longest = 8;
    for (std::size_t i = 0; i < drawn_; ++i) longest = std::max(longest, study_.rows[i].name.size());
    return 24 + 7.4 * static_cast<double>(std::min<std::size_t>(longest, 44));
  }
  [[nodiscard]] double x(std::int64_t t) const {
    return left_ + chart * static_cast<double>(t) / static_cast<double>(schedule_.span);
  }

  void title() {
    const auto ppm = study_.load.parts_per_million();
    add("<text x=\"10\" y=\"22\" font-size=\"15\" font-weight=\"bold\">Worst case of {}</text>\n"
        "<text x=\"10\" y=\"42\" fill=\"#555\">{}.{:02} % of the {}; {}{}</text>\n",
        study_.rows.empty() ? "" : escaped(study_.rows[schedule_.victim].name), ppm / 10'000,
        ppm % 10'000 / 100, study_.kind == Study::Kind::bus ? "bus" : "processor", escaped(study_.head),
        drawn_ < study_.rows.size() ? fmt::format("; the first {} of {}", drawn_, study_.rows.size()) : "");
  }
  void grid() {
    const std::int64_t step = grid_step(schedule_.span);
    for (std::int64_t t = 0; t <= schedule_.span && t <= INT64_MAX - step; t += step)
      add("<line x1=\"{0:.2f}\" y1=\"{1:.1f}\" x2=\"{0:.2f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>"
          "<text x=\"{0:.2f}\" y=\"{3:.1f}\" text-anchor=\"middle\" fill=\"#555\" "
          "font-size=\"10\">{4}</text>\n",
          x(t), top, top + rows_height_, top + rows_height_ + 14, time_text(t));
  }
  void name(const Row& row, double y) {
    add("<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\"{}>{}</text>\n", left_ - 8, y,
        row.result.ok() ? "" : " fill=\"#c22\" font-weight=\"bold\"", escaped(row.name));
  }
  /// A row's line, with its releases and its first deadline.
  void releases(std::size_t i) {
    const Row& row = study_.rows[i];
    const double y = top + row_height * static_cast<double>(i);
    add("<line x1=\"{:.0f}\" y1=\"{:.1f}\" x2=\"{:.0f}\" y2=\"{:.1f}\" stroke=\"#bbb\"/>\n", left_,
        y + row_height - 4, left_ + chart, y + row_height - 4);
    name(row, y + 16);
    for (const std::int64_t t : schedule_.releases[i])
      if (t <= schedule_.span)
        add("<path d=\"M{0:.2f} {1:.1f}V{2:.1f}m-3 5l3 -5l3 5\" fill=\"none\" stroke=\"#444\"/>\n", x(t),
            y + row_height - 4, y + 2);
    // The first release is as late as its jitter lets it be.
    const std::int64_t first = row.result.deadline - std::min(row.jitter, row.result.deadline);
    if (first <= schedule_.span)
      add("<line x1=\"{0:.2f}\" y1=\"{1:.1f}\" x2=\"{0:.2f}\" y2=\"{2:.1f}\" stroke=\"#c22\" "
          "stroke-width=\"2\"/>\n",
          x(first), y, y + row_height - 4);
  }
  void runs(const Piece& piece) {
    const double y = top + row_height * static_cast<double>(piece.row) + 6;
    add("<rect x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"14\" fill=\"{}\" stroke=\"#234\" "
        "stroke-width=\"0.5\"/>\n",
        x(piece.begin), y, std::max(x(piece.end) - x(piece.begin), 0.5),
        piece.kind == Piece::Kind::blocking ? "#bbb"
        : piece.kind == Piece::Kind::victim ? "#e59a3c"
                                            : "#4a8fc7");
  }
  /// A bar as long as its response, and in words what is left.
  void response(std::size_t i) {
    const Row& row = study_.rows[i];
    const auto& r = row.result;
    const double y = bars_top_ + row_height * static_cast<double>(i);
    const double share =
        r.bounded() ? static_cast<double>(r.response) / static_cast<double>(r.deadline) : 1.25;
    const double bar = std::min(share, 1.25) * due;
    name(row, y + 14);
    add("<rect x=\"{:.0f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"16\" fill=\"#e6efe6\"/>\n", left_, y + 2,
        due);
    add("<rect x=\"{:.0f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"16\" fill=\"{}\"/>\n", left_, y + 2,
        std::max(bar, 0.5), r.ok() ? "#4a8fc7" : "#d66");
    add("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", left_ + std::max(bar, due) + 8, y + 14,
        !r.bounded() ? std::string{"no bound"}
        : r.ok()     ? fmt::format("{} of {}, {} left", time_text(r.response), time_text(r.deadline),
                                   time_text(r.slack()))
                     : fmt::format("{} of {}, {} late", time_text(r.response), time_text(r.deadline),
                                   time_text(-r.slack())));
  }
  void deadlines() {
    add("<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"#c22\" "
        "stroke-width=\"2\"/>\n",
        left_ + due, bars_top_ - 2, bars_top_ + rows_height_);
    add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" fill=\"#c22\" "
        "font-size=\"11\">deadline</text>\n",
        left_ + due, bars_top_ + rows_height_ + 14);
  }

  const Study& study_;
  Schedule schedule_;
  std::size_t drawn_;
  double left_;  ///< of the chart; the names end before it
  double rows_height_;
  double bars_top_;
  std::string svg_;
};

}  // namespace

std::string to_svg(const Study& study) {
  return Picture{study}.draw();
}

}  // namespace ocm::cli::analyse
