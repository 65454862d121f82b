#include "cli/serve/errands.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

namespace serve_errands_test {

using namespace std::chrono_literals;
using namespace ocm;
using cli::fleet::RobotNow;
using cli::serve::Errands;
using cli::serve::FleetOrder;
using cli::serve::foxglove::Level;
using mapper::link::SetPoint;
using mapper::server::Progress;
using Kind = FleetOrder::Kind;

/// A line with two robots that do what the test says, and what was said to them.
class Line final : public cli::fleet::LineEnd {
 public:
  explicit Line(const std::string& second = "two") {
    for (unsigned i = 0; i < 2; ++i) {
      RobotNow& robot = robots[i];
      robot.index = i;
      robot.name = i == 0 ? "one" : second;
      robot.linked = robot.confirmed = robot.idle = robot.located = robot.origin_known = true;
      robot.update.emplace();
      peers_.push_back({i, "C" + std::to_string(i), robot.name, true});
    }
  }
  void exchange() override {}
  void scan(base::Duration) override {}
  void connect(unsigned) override {}
  [[nodiscard]] bool idle() const override { return true; }
  [[nodiscard]] std::vector<std::string> take_failed() override { return {}; }
  [[nodiscard]] Refused go(unsigned robot, const SetPoint& to) override {
    if (!refuses.empty() && to != SetPoint{}) return transport::Failure{refuses, "wait"};
    if (!refuses_stop.empty() && to == SetPoint{}) return transport::Failure{refuses_stop, "wait"};
    said.emplace_back(robot, to);
    robots[robot].progress = to == SetPoint{} ? Progress::stopping : Progress::said;
    robots[robot].located = false;
    robots[robot].order = ++orders;
    ours[robot] = orders;
    return std::nullopt;
  }
  [[nodiscard]] Refused calibrate(unsigned, bool) override { return std::nullopt; }
  void pause(unsigned robot) override { pauses.emplace_back(robot, true); }
  void unpause(unsigned robot) override { pauses.emplace_back(robot, false); }
  void ping(unsigned) override {}
  void ask_who(unsigned) override {}
  void leave(unsigned) override {}
  [[nodiscard]] const std::vector<mapper::server::Peer>& peers() const override { return peers_; }
  [[nodiscard]] RobotNow robot(unsigned index) const override { return robots[index]; }
  [[nodiscard]] bool is_ours(unsigned robot) const override {
    return ours[robot] != 0 && robots[robot].order == ours[robot];
  }
  [[nodiscard]] const std::string& path() const override { return path_; }

  /// Another program's order, which is not over.
  void by_other(unsigned robot, std::string who) {
    robots[robot].order = ++orders;
    robots[robot].by = std::move(who);
    robots[robot].progress = Progress::heard;
    robots[robot].located = false;
  }
  /// The central finds no robot.
  void finds_none() { peers_.clear(); }
  void stands(unsigned robot, Progress progress, std::int16_t x_cm, std::int16_t y_cm) {
    robots[robot].progress = progress;
    robots[robot].located = true;
    robots[robot].update->x = x_cm;
    robots[robot].update->y = y_cm;
  }

  RobotNow robots[2];
  std::vector<std::pair<unsigned, SetPoint>> said;
  std::vector<std::pair<unsigned, bool>> pauses;
  std::string refuses, refuses_stop;
  std::uint64_t orders = 0;
  std::uint64_t ours[2] = {0, 0};

 private:
  std::vector<mapper::server::Peer> peers_;
  std::string path_ = "line";
};

struct Desk {
  explicit Desk(const std::string& second = "two") : line(second) {}

  Line line;
  std::vector<std::string> told;
  std::vector<Level> levels;
  std::vector<cli::serve::ViewerId> to;
  base::Time now{1h};
  Errands errands{[this](cli::serve::ViewerId viewer, Level level, const std::string& words) {
                    told.push_back(words);
                    levels.push_back(level);
                    to.push_back(viewer);
                  },
                  [this](unsigned index) { return line.robot(index); }};

  void take(Kind kind, std::string robot = "one", motion::Point place = {}, bool explores = false,
            cli::serve::ViewerId viewer = 7) {
    errands.take(line, viewer, {kind, std::move(robot), place}, explores, now);
  }
  void step(base::Duration time = 50ms) {
    now += time;
    errands.step(line, now);
  }
  bool says(std::string_view words) const {
    return !told.empty() && told.back().find(words) != std::string::npos;
  }
};

TEST_CASE(
    "errands: a robot that stands is sent straight to a place in the map, and it is said when it is there") {
  Desk desk;
  desk.line.robots[0].origin = {1, 0, 0};
  desk.take(Kind::go, "one", {1, 0.5F});
  REQUIRE(desk.line.said.size() == 1);
  CHECK(desk.line.said[0] == std::pair{0U, SetPoint{90, 50}});
  CHECK(desk.errands.target(0) == motion::Point{1, 0.5F});
  CHECK_FALSE(desk.errands.target(1));
  desk.step();
  CHECK(desk.told.empty());
  desk.line.stands(0, Progress::reached, 0, 50);
  desk.step();
  desk.step();
  CHECK(desk.says("one is there"));
  CHECK_FALSE(desk.errands.busy());
  CHECK(desk.line.said.size() == 1);
}

TEST_CASE("errands: a long way goes in pieces") {
  Desk desk;
  desk.take(Kind::go, "one", {5, 0});
  CHECK(desk.line.said.back().second == SetPoint{0, 300});
  desk.line.stands(0, Progress::reached, 300, 0);
  desk.step();
  desk.step();
  REQUIRE(desk.line.said.size() == 2);
  CHECK(desk.line.said.back().second == SetPoint{0, 200});
  desk.line.stands(0, Progress::reached, 500, 0);
  desk.step();
  desk.step();
  CHECK(desk.says("is there"));
}

TEST_CASE("errands: a robot that drives is stopped first, and sent from where it stands") {
  Desk desk;
  desk.take(Kind::go, "one", {1, 0});
  desk.take(Kind::go, "one", {0, 1});  // another place, on the way
  REQUIRE(desk.line.said.size() == 2);
  CHECK(desk.line.said[1].second == SetPoint{});
  desk.step();
  CHECK(desk.line.said.size() == 2);
  desk.line.stands(0, Progress::stopped, 50, 0);
  desk.step();
  REQUIRE(desk.line.said.size() == 3);
  CHECK(desk.line.said[2].second == SetPoint{117, 111});
  // One that shows nothing of the stop is not sent.
  desk.take(Kind::go, "one", {0, 0});
  desk.step(21s);
  CHECK(desk.says("nothing shows that one stands"));
  CHECK(desk.line.said.size() == 4);
}

TEST_CASE("errands: it is sent straight only where it is known to stand, and nothing is asked of it") {
  Desk desk;
  desk.line.robots[0].located = false;  // nothing is asked of it, and where it stands it has not said yet
  desk.take(Kind::go, "one", {1, 0});
  REQUIRE(desk.line.said.size() == 1);
  CHECK(desk.line.said[0].second == SetPoint{});
  desk.line.stands(0, Progress::stopped, 0, 0);
  desk.step();
  REQUIRE(desk.line.said.size() == 2);
  CHECK(desk.line.said[1].second == SetPoint{0, 100});
  desk.line.robots[0].located = true;  // it rests, and is about to drive
  desk.take(Kind::go, "one", {0, 1});
  REQUIRE(desk.line.said.size() == 3);
  CHECK(desk.line.said[2].second == SetPoint{});
  CHECK(desk.told.empty());
}

TEST_CASE("errands: a stop that the line does not take is said, and the robot is not sent") {
  Desk desk;
  desk.line.refuses_stop = "there is no robot 0";
  desk.take(Kind::stop);
  CHECK(desk.told == std::vector<std::string>{"there is no robot 0"});
  desk.line.robots[0].located = false;
  desk.take(Kind::go, "one", {1, 0});
  CHECK(desk.told == std::vector<std::string>(2, "there is no robot 0"));
  CHECK(desk.levels == std::vector<Level>(2, Level::error));
  CHECK_FALSE(desk.errands.busy());
  CHECK(desk.line.said.empty());
}

TEST_CASE("errands: what another program drives is not taken from it, and what explores is") {
  Desk desk;
  desk.line.by_other(0, "goto (process 12)");
  desk.take(Kind::go, "one", {1, 0});
  CHECK(desk.says("one is driven by goto (process 12); stop it first"));
  CHECK(desk.line.said.empty());
  desk.take(Kind::stop);
  CHECK(desk.line.said.back().second == SetPoint{});
  desk.line.stands(0, Progress::stopped, 0, 0);

  desk.line.by_other(1, "");
  desk.take(Kind::go, "two", {1, 0}, true);
  CHECK(desk.line.said.back() == std::pair{1U, SetPoint{}});
  desk.line.robots[1].held = true;
  desk.line.by_other(1, "goto (process 13)");
  desk.take(Kind::go, "two", {1, 0}, true);
  CHECK(desk.says("goto (process 13)"));
}

TEST_CASE("errands: how a drive may end otherwise") {
  Desk desk;
  desk.take(Kind::go, "one", {1, 0});
  desk.line.stands(0, Progress::ended, 20, 0);
  desk.line.robots[0].blocked = true;
  desk.step();
  CHECK(desk.says("one stopped 80 cm away from there: is something in front of it?"));
  desk.take(Kind::go, "one", {1, 0});
  desk.line.by_other(0, "goto (process 12)");
  desk.step();
  CHECK(desk.says("stopped or sent by goto (process 12)"));
  desk.line.stands(0, Progress::stopped, 20, 0);
  desk.take(Kind::go, "one", {1, 0});
  desk.line.robots[0].lost = true;
  desk.step();
  CHECK(desk.says("one is lost"));
  CHECK_FALSE(desk.errands.busy());
  desk.take(Kind::go, "one", {1, 0});
  CHECK(desk.says("has no link, or says nothing"));
  desk.line.robots[0].lost = false;
  desk.line.stands(0, Progress::stopped, 20, 0);
  desk.line.refuses = "the line is full";
  desk.take(Kind::go, "one", {1, 0});
  CHECK(desk.says("the line is full; wait"));
  CHECK_FALSE(desk.errands.busy());
}

TEST_CASE("errands: who is meant, and where it is") {
  Desk desk;
  desk.take(Kind::stop, "three");
  CHECK(desk.says("no robot 'three'; it has one, two"));
  desk.take(Kind::stop, "1");
  CHECK(desk.line.said.back().first == 1);
  desk.take(Kind::stop, "C0");
  CHECK(desk.line.said.back().first == 0);
  desk.line.stands(0, Progress::stopped, 0, 0);
  desk.line.robots[0].origin_known = false;
  desk.take(Kind::go, "one", {1, 0});
  CHECK(desk.says("--start one=X,Y,DEG"));
  desk.line.robots[0].update.reset();
  desk.take(Kind::call_back);
  CHECK(desk.says("does not say where it is"));
}

TEST_CASE("errands: called back it goes to where it was switched on, known or not") {
  Desk desk;
  desk.line.robots[0].origin_known = false;
  desk.line.stands(0, Progress::stopped, 40, 0);
  desk.take(Kind::call_back);
  CHECK(desk.line.said.back().second == SetPoint{180, 40});
}

TEST_CASE("errands: a viewer that goes away stops what it has sent, and nothing else") {
  Desk desk;
  desk.take(Kind::go, "one", {1, 0});
  desk.take(Kind::go, "two", {1, 0}, false, 8);
  desk.errands.gone(desk.line, 7);
  CHECK(desk.line.said.size() == 3);
  CHECK(desk.line.said.back() == std::pair{0U, SetPoint{}});
  CHECK(desk.errands.target(1));
  // Another program has it by now.
  desk.line.by_other(1, "goto (process 12)");
  desk.errands.gone(desk.line, 8);
  CHECK(desk.line.said.size() == 3);
  // One that paused it on its way is still who has sent it.
  desk.line.stands(0, Progress::stopped, 0, 0);
  desk.take(Kind::go, "one", {1, 0});
  desk.take(Kind::pause);
  desk.errands.gone(desk.line, 7);
  CHECK(desk.line.said.back() == std::pair{0U, SetPoint{}});
}

TEST_CASE("errands: for whom robots drive") {
  Desk desk;
  const auto driving = [&] { return desk.errands.driving(desk.line); };
  CHECK(driving().empty());
  desk.take(Kind::pause, "two");
  CHECK(driving().empty());
  desk.take(Kind::go, "one", {1, 0});
  CHECK(driving() == std::vector<cli::serve::ViewerId>{7});
  desk.take(Kind::go, "two", {1, 0}, false, 8);
  CHECK(driving() == std::vector<cli::serve::ViewerId>{7, 8});
  desk.line.stands(0, Progress::reached, 100, 0);
  for (int i = 0; i < 2; ++i) desk.step();
  CHECK(desk.says("one is there"));
  CHECK(driving() == std::vector<cli::serve::ViewerId>{8});
  // Paused on its way it may go on.
  desk.take(Kind::pause, "two", {}, false, 9);
  CHECK(driving() == std::vector<cli::serve::ViewerId>{8});
  desk.line.by_other(1, "goto (process 12)");
  CHECK(driving().empty());
}

TEST_CASE("errands: a pause is said until it shows") {
  Desk desk;
  desk.take(Kind::pause);
  desk.step();
  desk.step();
  CHECK(desk.line.pauses.size() == 1);
  desk.step(500ms);
  CHECK(desk.line.pauses.size() == 2);
  for (int i = 0; i < 40 && desk.told.empty(); ++i) {  // heard, but no updates
    desk.line.robots[0].heard = desk.now;
    desk.step(100ms);
  }
  CHECK(desk.says("one is paused"));
  desk.take(Kind::go_on);
  desk.step();
  CHECK(desk.line.pauses.back() == std::pair{0U, false});
  desk.line.robots[0].updated = desk.now;
  desk.step();
  CHECK(desk.says("one goes on"));
  desk.take(Kind::pause);
  desk.step(11s);
  CHECK(desk.says("nothing shows that one is paused"));
}

TEST_CASE("errands: how serious it is that an errand ends") {
  Desk desk;
  const auto ends = [&](Progress progress) {
    desk.levels.clear();
    desk.line.stands(0, Progress::reached, 0, 0);
    desk.take(Kind::go, "one", {1, 0});
    desk.line.stands(0, progress, progress == Progress::reached ? 100 : 20, 0);
    for (int i = 0; i < 2; ++i) desk.step();
    return desk.levels;
  };
  using Levels = std::vector<Level>;
  CHECK(ends(Progress::reached) == Levels{Level::info});
  CHECK(ends(Progress::ended) == Levels{Level::warning});
  CHECK(desk.says("one stopped 80 cm away from there"));
  CHECK_FALSE(desk.says("in front of it"));
  CHECK(ends(Progress::stopped) == Levels{Level::warning});
  CHECK(desk.says("one was stopped"));
  CHECK(ends(Progress::stopping) == Levels{Level::warning});
  CHECK(ends(Progress::none) == Levels{Level::error});
  CHECK(desk.says("the link to one was gone for a while"));
  for (const Progress on : {Progress::waiting, Progress::said, Progress::heard}) {
    CHECK(ends(on).empty());
    CHECK(desk.errands.busy());
  }
}

TEST_CASE(
    "errands: a robot that gets no nearer is given up, and one that stands two centimetres off is there") {
  Desk desk;
  desk.take(Kind::go, "one", {100, 0});
  for (int i = 0; i < 200 && desk.told.empty(); ++i) {
    desk.line.stands(0, Progress::reached, 0, 0);
    desk.step();
  }
  CHECK(desk.says("one does not get there"));
  CHECK(desk.line.said.size() == 50);
  for (const std::int16_t cm : {std::int16_t{98}, std::int16_t{96}}) {
    desk.line.said.clear();
    desk.line.stands(0, Progress::reached, cm, 0);
    desk.take(Kind::go, "one", {1, 0});
    CHECK(desk.line.said.size() == (cm == 98 ? 0U : 1U));
  }
}

TEST_CASE("errands: how long a robot may take to stand, and to say where") {
  Desk desk;
  desk.take(Kind::go, "one", {1, 0});
  desk.take(Kind::go, "one", {0, 1});  // it is to stop first
  desk.step(19'999ms);
  CHECK(desk.errands.busy());
  desk.step(1ms);
  CHECK(desk.says("nothing shows that one stands"));
  CHECK_FALSE(desk.errands.busy());

  Desk other;
  other.take(Kind::go, "one", {5, 0});
  other.line.robots[0].progress = Progress::reached;
  other.step();
  other.step(4'999ms);
  CHECK(other.errands.busy());
  CHECK(other.told.empty());
  other.step(1ms);
  CHECK(other.says("nothing shows that one stands"));
}

TEST_CASE("errands: robots of one name, and those that cannot be sent") {
  Desk desk;
  desk.line.robots[0].linked = false;
  desk.take(Kind::pause);
  CHECK(desk.says("one has no link"));
  CHECK_FALSE(desk.errands.busy());
  desk.take(Kind::go, "one", {1, 0});
  CHECK(desk.says("one has no link, or says nothing"));
  desk.take(Kind::look);
  CHECK(desk.line.said.empty());
  desk.take(Kind::stop, "C9");
  CHECK(desk.says("the central has no robot 'C9'"));
  Desk same{"one"};
  same.take(Kind::stop);
  CHECK(same.says("2 robots are called 'one': name one by its index"));
  same.take(Kind::stop, "0");
  CHECK(same.line.said.size() == 1);
}

TEST_CASE("errands: a central without robots has none") {
  Desk desk;
  desk.line.finds_none();
  desk.take(Kind::stop, "0");
  CHECK(desk.told == std::vector<std::string>{"the central has no robot '0'; it has none"});
  CHECK(desk.levels == std::vector<Level>{Level::error});
  CHECK(desk.line.said.empty());
}

TEST_CASE("errands: how a pause ends, how serious that is, and who hears of it") {
  Desk desk;
  const auto ends = [&](Kind kind, cli::serve::ViewerId viewer, base::Duration time) {
    desk.told.clear();
    desk.take(kind, "one", {}, false, viewer);
    CHECK_FALSE(desk.errands.target(0));
    desk.step(time);
  };
  desk.line.robots[0].lost = true;
  ends(Kind::pause, 7, 50ms);
  CHECK(desk.says("one is lost"));
  desk.line.robots[0].lost = false;
  ends(Kind::go_on, 8, 50ms);
  CHECK(desk.told.empty());
  CHECK(desk.errands.busy());
  desk.line.robots[0].updated = desk.now;
  desk.step();
  CHECK(desk.says("one goes on"));
  ends(Kind::go_on, 9, 11s);
  CHECK(desk.says("nothing shows that one goes on"));
  CHECK(desk.levels == std::vector<Level>{Level::error, Level::info, Level::error});
  CHECK(desk.to == std::vector<cli::serve::ViewerId>{7, 8, 9});
  CHECK_FALSE(desk.errands.busy());
}

TEST_CASE("errands: a robot that stands where it was sent is not stopped when its viewer goes away") {
  Desk desk;
  desk.take(Kind::go, "one", {1, 0});
  desk.line.stands(0, Progress::reached, 100, 0);
  for (int i = 0; i < 2; ++i) desk.step();
  CHECK(desk.says("one is there"));
  desk.errands.gone(desk.line, 7);
  CHECK(desk.line.said.size() == 1);
}

TEST_CASE("errands: one order a robot at a time, the newest") {
  Desk desk;
  desk.take(Kind::go, "one", {1, 0});
  desk.take(Kind::stop);
  CHECK_FALSE(desk.errands.busy());
  CHECK_FALSE(desk.errands.target(0));
  desk.line.stands(0, Progress::stopped, 0, 0);
  desk.take(Kind::go, "one", {2, 0});
  CHECK(desk.errands.target(0) == motion::Point{2, 0});
  desk.errands.forget();
  CHECK_FALSE(desk.errands.busy());
  const auto said = desk.line.said.size();
  desk.errands.gone(desk.line, 7);
  CHECK(desk.line.said.size() == said);
}

}  // namespace serve_errands_test
