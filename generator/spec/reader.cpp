#include "generator/spec/reader.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <string>

#include "generator/spec/field_reader.hpp"
#include "generator/spec/message_reader.hpp"
#include "generator/spec/names.hpp"

namespace ocm::spec {

namespace {

// What the generated header needs in its own namespace, and in the one of its tables.
constexpr std::array<std::string_view, 9> namespace_members{
    "bit_rate", "boards", "catalogue", "detail", "ocm", "protocol", "std", "topics", "wire_hash"};

class Reader : private FieldReader {
 public:
  Reader(std::string_view file_name, std::vector<Problem>& problems, std::vector<Problem>& doubts)
      : FieldReader(file_name, problems), messages_(file_name, problems, doubts) {}

  Model read(const Node& node) {
    const At root{&node, ""};
    Model model;
    if (!is_object(root, "a spec is an object with robot, namespace, bus, boards and topics")) return model;
    check_keys(root, {"$schema", "robot", "namespace", "description", "byte_order", "bus", "defaults",
                      "boards", "topics", "messages", "attributes", "attribute_definitions"});
    // A bus of messages has what its DBC file has; a robot's topics become a header, with sources.
    const bool topics = root.member("topics") || !root.member("messages");
    if (const auto at = require(root, "robot", "the robot's name")) model.robot = line(*at, false);
    if (const auto at = topics ? require(root, "namespace", "the C++ namespace of the generated header")
                               : root.member("namespace"))
      read_namespace(*at, model);
    if (const auto at = root.member("description")) model.description = description(*at, topics);
    order_ = read_order(root, protocol::ByteOrder::little);
    if (const auto at =
            topics ? require(root, "bus", R"({"bit_rate": 500000, "source": "..."})") : root.member("bus"))
      read_bus(*at, topics, model);
    if (const auto at = root.member("defaults")) read_defaults(*at, model);
    if (const auto at =
            topics ? require(root, "boards", "the list of the boards on the bus") : root.member("boards"))
      read_boards(*at, topics, model);
    if (const auto at =
            topics ? require(root, "topics", "the list of what is said on the bus") : std::nullopt)
      read_topics(*at, model);
    if (const auto at = root.member("messages")) messages_.read(*at, order_, topic_names_, model);
    model.attributes = messages_.attributes(root);
    if (const auto at = root.member("attribute_definitions"))
      model.definitions = messages_.attribute_definitions(*at);
    return model;
  }

 private:
  // --- robot, bus, boards ---

  void read_namespace(const At& at, Model& model) {
    model.name_space = name(at);
    if (model.name_space == "std" || model.name_space == "ocm")
      tell(at, quoted(model.name_space) + " is a namespace of another library",
           "the robot's own name, such as \"amiro\"");
  }

  /// A comment of a DBC file may have several lines; what goes into a header, one.
  [[nodiscard]] std::string description(const At& at, bool topics) {
    if (topics) return line(at);
    return is_kind(at, Kind::string, "a text in double quotes") ? at.node->text : std::string{};
  }

  void read_bus(const At& at, bool topics, Model& model) {
    if (!is_object(at, R"({"bit_rate": 500000, "source": "..."})")) return;
    check_keys(at, {"bit_rate", "data_bit_rate", "source"});
    model.bus_source = read_source(at, {"bit_rate", "data_bit_rate"}, !topics);
    if (const auto rate = require(at, "bit_rate", "bits per second, such as 500000"))
      model.bit_rate = static_cast<std::uint32_t>(integer(*rate, 1'000, 1'000'000).value_or(0));
    if (const auto rate = at.member("data_bit_rate")) {
      model.data_bit_rate = static_cast<std::uint32_t>(integer(*rate, 1'000, max_data_bit_rate).value_or(0));
      if (model.data_bit_rate != 0 && model.data_bit_rate < model.bit_rate)
        tell(*rate,
             "the data of CAN FD would be slower than the rest, " + std::to_string(model.bit_rate) + " bit/s",
             "at least \"bit_rate\"");
    }
  }

  /// What every topic has that does not say otherwise.
  void read_defaults(const At& at, Model& model) {
    if (!is_object(at, R"({"period": "50ms", "deadline": "50ms", "source": "..."})")) return;
    check_keys(at, {"period", "deadline", "jitter", "priority", "timeout", "source"});
    model.defaults_source = read_source(at, {"period", "deadline", "jitter", "priority", "timeout"}, false);
    if (const auto a = at.member("period")) defaults_.period = period(*a).value_or(defaults_.period);
    if (const auto a = at.member("deadline")) defaults_.deadline = duration(*a).value_or(Duration{});
    if (const auto a = at.member("jitter")) defaults_.jitter = duration(*a).value_or(Duration{});
    if (const auto a = at.member("timeout")) defaults_.timeout = duration(*a).value_or(Duration{});
    if (const auto a = at.member("priority")) defaults_.priority = priority(*a).value_or(defaults_.priority);
  }

  /// A type in the generated namespace; two of the same name are a problem at `at`.
  void claim_type(const At& at, std::string_view name) {
    const std::string type = pascal_case(name);
    const auto [other, is_new] = types_.emplace(type, at.path);
    if (!is_new && other->second != at.path)
      tell(at, "the generated header would have two types " + type + " (see " + other->second + ")",
           "another name for one of them");
  }

  void read_boards(const At& at, bool topics, Model& model) {
    static constexpr std::string_view form =
        R"(a list of boards: [{"name": "main_board", "mcu": "STM32F103", "source": "..."}])";
    if (!is_kind(at, Kind::array, form)) return;
    if (at.node->items.empty() && topics) tell(at, "the list is empty", "at least one board");
    if (at.node->items.size() > 255)
      return tell(at, std::to_string(at.node->items.size()) + " boards",
                  "at most 255: a topic keeps its board in 8 bits");
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At board_at = at.item(i);
      BoardModel board;
      if (is_object(board_at, R"({"name": "main_board", "mcu": "STM32F103", "source": "..."})")) {
        check_keys(board_at,
                   {"name", "description", "mcu", "clock_hz", "can_clock_hz", "source", "attributes"});
        if (const auto a = require(board_at, "name", "what topics call it")) {
          board.name = topics ? name(*a) : messages_.word(*a);
          if (!board.name.empty()) claim_board(*a, board.name, topics);
        }
        if (const auto a = board_at.member("description")) board.description = description(*a, topics);
        if (const auto a = topics ? require(board_at, "mcu", "the microcontroller, such as \"STM32F103\"")
                                  : board_at.member("mcu"))
          board.mcu = line(*a, false);
        board.clock_hz = read_clock(board_at, "clock_hz");
        board.can_clock_hz = read_clock(board_at, "can_clock_hz");
        board.source = read_source(board_at, {"mcu", "clock_hz", "can_clock_hz"}, !topics);
        board.attributes = messages_.attributes(board_at);
      }
      model.boards.push_back(std::move(board));  // also a bad one: the others keep their numbers
    }
    boards_known_ = !boards_.empty();
  }
  void claim_board(const At& at, const std::string& board, bool topics) {
    const auto [other, is_new] = boards_.emplace(board, at.path);
    if (is_new && topics)
      claim_type(at, board);
    else if (!is_new)
      tell(at, "a second board " + quoted(board) + " (see " + other->second + ")",
           "a name of its own for each board");
  }
  [[nodiscard]] std::optional<std::uint32_t> read_clock(const At& board, std::string_view key) {
    const auto at = board.member(key);
    if (!at) return std::nullopt;
    const auto hz = integer(*at, 1, 4'000'000'000);
    if (!hz) return std::nullopt;
    return static_cast<std::uint32_t>(*hz);
  }

  // --- topics ---

  void read_topics(const At& at, Model& model) {
    if (!is_kind(at, Kind::array, "a list of topics")) return;
    if (at.node->items.empty()) tell(at, "the list is empty", "at least one topic");
    if (at.node->items.size() > 256)
      return tell(at, std::to_string(at.node->items.size()) + " topics",
                  "at most 256: a topic's number has 8 bits");
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At topic_at = at.item(i);
      if (!is_object(topic_at, "a topic: an object with name, id, board, frames and source")) continue;
      const std::size_t told_before = told();
      if (const auto like = topic_at.member("like")) {
        if (const auto node = read_like(topic_at, *like))
          model.topics.push_back(read_topic({&*node, topic_at.path}, model));
        continue;
      }
      model.topics.push_back(read_topic(topic_at, model));
      if (const std::string& topic = model.topics.back().name; !topic.empty())
        patterns_.push_back({topic, topic_at.node, told() == told_before});
    }
  }

  /// The topic that `at` stands for: all of the other one but name and alias, its frames' ids moved as far as
  /// the topic's own. Empty when there is nothing to read on with.
  [[nodiscard]] std::optional<Node> read_like(const At& at, const At& like) {
    static constexpr std::array<std::string_view, 7> own{"name", "alias", "description", "like",
                                                         "id",   "board", "source"};
    const auto is_own = [](const std::string& key) {
      return std::find(own.begin(), own.end(), key) != own.end();
    };
    for (const auto& [key, node] : at.node->members)
      if (!is_own(key))
        tell({&node, at.path + "/" + pointer_step(key)}, quoted(key) + " of a topic that is like another",
             "leave it out: it is the other one's; or leave out \"like\", and write the topic out");
    if (!is_kind(like, Kind::string, "the name of a topic before this one")) return std::nullopt;
    std::vector<std::string> names;
    for (const Pattern& pattern : patterns_) names.push_back(pattern.name);
    const auto found = std::find(names.begin(), names.end(), like.node->text);
    if (found == names.end()) {
      const std::string near = nearest_name(like.node->text, names);
      tell(like, "no topic " + quoted(like.node->text) + " before this one",
           !near.empty() ? "did you mean " + quoted(near) + "?" : "a topic that is written out, further up");
      return std::nullopt;
    }
    const Pattern& pattern = patterns_[static_cast<std::size_t>(found - names.begin())];
    const auto own_id = require(at, "id", "the number that requests carry, \"0x39\"");
    if (!pattern.good || !own_id) return std::nullopt;  // told already
    const auto mine = id(*own_id);
    if (!mine) return std::nullopt;
    const int shift = int{*mine} - int{id({pattern.node->find("id"), ""}).value_or(0)};

    Node topic = *at.node;
    std::erase_if(topic.members,
                  [&](const Node::Member& member) { return member.name == "like" || !is_own(member.name); });
    for (const Node::Member& member : pattern.node->members) {
      if (member.name == "alias" || topic.find(member.name) != nullptr) continue;
      topic.members.push_back(member);
      move_to(topic.members.back().node, at.node->line);
      if (member.name != "frames") continue;
      for (Node& frame : topic.members.back().node.items)
        for (Node::Member& part : frame.members) {
          if (part.name != "id") continue;
          const int moved = int{id({&part.node, ""}).value_or(0)} + shift;
          part.node.kind = Kind::number;
          part.node.text = std::to_string(moved);
        }
    }
    return topic;
  }
  /// Problems of what was taken over are those of the topic that took it.
  static void move_to(Node& node, std::size_t line) {
    node.line = line;
    for (Node& item : node.items) move_to(item, line);
    for (Node::Member& member : node.members) move_to(member.node, line);
  }

  [[nodiscard]] TopicModel read_topic(const At& at, const Model& model) {
    check_keys(
        at, {"name", "alias", "description", "kind", "role", "geometry", "id", "count", "board", "byte_order",
             "period", "shortest_period", "deadline", "jitter", "priority", "timeout", "frames", "source"});
    TopicModel topic;
    if (const auto a = require(at, "name", "what people call it")) topic.name = name(*a);
    if (const auto a = at.member("description")) topic.description = line(*a);
    topic.source = read_source(at,
                               {"kind", "role", "geometry", "id", "count", "board", "byte_order", "period",
                                "shortest_period", "deadline", "jitter", "priority", "timeout", "frames"},
                               false);
    if (const auto a = at.member("kind")) {
      static constexpr std::pair<std::string_view, protocol::Kind> kinds[] = {
          {"sensor", protocol::Kind::sensor}, {"actuator", protocol::Kind::actuator}};
      // What has a timeout is meant to be an actuator, whatever the word is.
      const bool acts = at.member("timeout").has_value();
      topic.kind = one_of(*a, kinds).value_or(acts ? protocol::Kind::actuator : protocol::Kind::sensor);
    }
    const bool sensor = topic.kind == protocol::Kind::sensor;
    if (const auto a = at.member("count")) {
      topic.is_group = true;
      if (const auto n = integer(*a, 1, 255)) topic.count = static_cast<std::uint8_t>(*n);
      if (sensor)
        tell(*a, "\"count\" is for actuators",
             "one topic with a frame of this count: a request then serves all");
    }
    read_names(at, topic);
    const auto board = require(at, "board", "which of the boards serves it");
    const bool has_board = board && read_board(*board, model, topic);
    std::optional<std::uint8_t> topic_id;
    if (const auto a = require(at, "id",
                               sensor ? "the number that requests carry, \"0x08\""
                                      : "the number that set points carry, \"0x08\"")) {
      topic_id = id(*a);
      if (topic_id) {
        topic.id = *topic_id;
        claim_ids(*a, commands_, topic.id, topic.count, "commands");
      }
    }
    read_times(at, topic);
    topic.priority = defaults_.priority;
    if (const auto a = at.member("priority")) topic.priority = priority(*a).value_or(topic.priority);
    const protocol::ByteOrder order = read_order(at, order_);
    if (const auto a = require(at, "frames", R"([{"fields": [{"name": "x", "byte": 0, "type": "i16"}]}])"))
      read_frames(*a, topic_id, order, topic);
    if (const auto a = at.member("role")) {
      static constexpr std::pair<std::string_view, protocol::Role> roles[] = {
          {"drive", protocol::Role::drive},   {"light", protocol::Role::light},
          {"status", protocol::Role::status}, {"refusal", protocol::Role::refusal},
          {"pose", protocol::Role::pose},     {"ring", protocol::Role::ring},
          {"floor", protocol::Role::floor}};
      topic.role = one_of(*a, roles).value_or(protocol::Role::none);
      check_role(*a, topic, has_board);
    }
    read_geometry(at, topic);
    return topic;
  }

  void read_names(const At& at, TopicModel& topic) {
    if (!topic.name.empty()) {
      const At name_at = *at.member("name");
      if (claim_name(name_at, topic.name)) claim_type(name_at, topic.name);
      for (const auto taken : namespace_members)
        if (topic.name == taken)
          tell(name_at, quoted(topic.name) + " has a meaning of its own in the header", "another name");
      if (topic.is_group)
        for (unsigned i = 1; i <= topic.count; ++i) claim_name(name_at, topic.name + "_" + std::to_string(i));
    }
    const auto alias_at = at.member("alias");
    if (!alias_at) return;
    if (topic.is_group) tell(*alias_at, "a topic with a count has no alias", "leave \"alias\" out");
    if (!is_kind(*alias_at, Kind::array, R"(a list of names: ["gyro"])")) return;
    for (std::size_t i = 0; i < alias_at->node->items.size(); ++i) {
      const At a = alias_at->item(i);
      std::string alias = name(a);
      if (alias.empty()) continue;
      claim_name(a, alias);
      topic.aliases.push_back(std::move(alias));
    }
  }
  /// Whether it was free.
  bool claim_name(const At& at, const std::string& topic_name) {
    const auto [other, is_new] = topic_names_.emplace(topic_name, at.path);
    if (!is_new)
      tell(at, "a second topic is called " + quoted(topic_name) + " (see " + other->second + ")",
           "names and aliases are unique over all topics");
    return is_new;
  }

  /// False if there is no such board.
  bool read_board(const At& at, const Model& model, TopicModel& topic) {
    if (!is_kind(at, Kind::string, "the name of a board")) return false;
    for (std::size_t i = 0; i < model.boards.size(); ++i) {
      if (model.boards[i].name != at.node->text || at.node->text.empty()) continue;
      topic.board = static_cast<std::uint8_t>(i);
      return true;
    }
    if (!boards_known_) return false;  // told already
    std::vector<std::string> names;
    for (const BoardModel& board : model.boards)
      if (!board.name.empty()) names.push_back(board.name);
    const std::string near = nearest_name(at.node->text, names);
    tell(at, "unknown board " + quoted(at.node->text),
         !near.empty() ? "did you mean " + quoted(near) + "?" : "one of " + list_of(names));
    return false;
  }

  /// Every id of `count` consecutive ones, in one direction of the bus.
  void claim_ids(const At& at, std::map<unsigned, std::string>& taken, unsigned first, unsigned count,
                 std::string_view direction) {
    if (first + count - 1 > 0xFF) {
      tell(at, std::to_string(count) + " ids from " + hex(first) + " on end at " + hex(first + count - 1),
           "the last must be 0xFF or below: start at " + hex(0x100 - count) + " or below");
      return;
    }
    for (unsigned i = first; i < first + count; ++i) {
      const auto [other, is_new] = taken.emplace(i, at.path);
      if (is_new) continue;
      tell(
          at, "id " + hex(i) + " is taken (see " + other->second + ")",
          "a number that no other of the " + std::string{direction} + " has, such as " + hex(free_id(taken)));
      return;
    }
  }
  [[nodiscard]] static unsigned free_id(const std::map<unsigned, std::string>& taken) {
    unsigned candidate = 1;
    while (candidate < 0xFF && taken.count(candidate) != 0) ++candidate;
    return candidate;
  }

  void read_times(const At& at, TopicModel& topic) {
    const bool sensor = topic.kind == protocol::Kind::sensor;
    for (const std::string_view key : {"period", "shortest_period"})
      if (const auto a = at.member(key); a && !sensor)
        tell(*a, quoted(key) + " is for sensors", "leave it out: an actuator sends nothing");
    if (const auto a = at.member("timeout"); a && sensor)
      tell(*a, "\"timeout\" is for actuators", "leave it out, or say \"kind\": \"actuator\"");
    topic.deadline = defaults_.deadline;
    topic.jitter = defaults_.jitter;
    if (sensor) topic.period = defaults_.period;
    if (!sensor) topic.timeout = defaults_.timeout;
    if (const auto a = at.member("period")) topic.period = period(*a).value_or(topic.period);
    if (const auto a = at.member("shortest_period")) {
      const auto shortest = duration(*a);
      topic.shortest_period = shortest.value_or(Duration{});
      if (shortest && *shortest == Duration{})
        tell(*a, "a shortest period of zero", "how often the part delivers something new, such as \"4ms\"");
    }
    if (const auto a = at.member("deadline")) topic.deadline = duration(*a).value_or(Duration{});
    if (const auto a = at.member("jitter")) topic.jitter = duration(*a).value_or(Duration{});
    if (const auto a = at.member("timeout")) topic.timeout = duration(*a).value_or(Duration{});
  }

  // --- frames ---

  void read_frames(const At& at, std::optional<std::uint8_t> topic_id, protocol::ByteOrder order,
                   TopicModel& topic) {
    if (!is_kind(at, Kind::array, "a list of frames, in the order in which they are sent")) return;
    if (at.node->items.empty()) tell(at, "the list is empty", "at least one frame");
    if (at.node->items.size() > 255)
      return tell(at, std::to_string(at.node->items.size()) + " frames", "at most 255");
    const bool several = at.node->items.size() > 1;
    std::map<std::string, std::string> names;
    for (std::size_t i = 0; i < at.node->items.size(); ++i) {
      const At frame_at = at.item(i);
      if (!is_object(frame_at, R"({"id": "0x08", "fields": [...]})")) continue;
      FrameModel frame = read_frame(frame_at, topic_id, several, order, topic);
      if (!frame.name.empty()) {
        const At name_at = *frame_at.member("name");
        std::vector<std::string> mine{frame.name};
        if (frame.is_array)
          for (unsigned n = 1; n <= frame.count; ++n) mine.push_back(frame.name + "_" + std::to_string(n));
        bool free = true;
        for (const std::string& one : mine) {
          const auto [other, is_new] = names.emplace(one, name_at.path);
          free = free && is_new;
          if (is_new) continue;
          tell(name_at, "a second frame is called " + quoted(one) + " (see " + other->second + ")",
               "a name of its own for each frame of the topic");
        }
        if (free && !topic.name.empty()) claim_type(name_at, topic.name + "_" + frame.name);
      }
      topic.frames.push_back(std::move(frame));
    }
    std::size_t count = 0;
    for (const FrameModel& frame : topic.frames) count += frame.count;
    if (count > 255) tell(at, std::to_string(count) + " frames with their counts", "at most 255");
  }

  [[nodiscard]] FrameModel read_frame(const At& at, std::optional<std::uint8_t> topic_id, bool several,
                                      protocol::ByteOrder order, const TopicModel& topic) {
    check_keys(at,
               {"name", "description", "id", "count", "dlc", "byte_order", "fields", "derived", "source"});
    FrameModel frame;
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const auto count_at = at.member("count");
    if (count_at) {
      frame.is_array = true;
      if (const auto n = integer(*count_at, 1, 255)) frame.count = static_cast<std::uint8_t>(*n);
      if (!sensor)
        tell(*count_at, "\"count\" of a frame is for sensors",
             "a set point travels in one frame: give the topic a count");
    }
    const auto name_at = at.member("name");
    if (name_at) {
      frame.name = name(*name_at);
      if (!several && !count_at) {
        tell(*name_at, "the topic's only frame has a name", "leave it out: the topic's name is enough");
        frame.name.clear();
      }
    } else if (several || count_at) {
      tell(at, "no \"name\"",
           several ? "add \"name\": a topic's frames have names when there are several"
                   : "add \"name\": frames with a count are called name_1, name_2, ...");
    }
    if (!frame.name.empty()) check_member_name(*name_at, frame.name);
    if (!sensor && several)
      tell(at, "a set point of several frames", "one frame: the wheels must not act on half a set point");
    if (const auto a = at.member("description")) frame.description = line(*a);
    frame.source = read_source(at, {"id", "count", "dlc", "byte_order", "fields", "derived"}, true);

    std::optional<std::uint8_t> own_id;
    if (const auto a = at.member("id"))
      own_id = id(*a);
    else if (several)
      tell(at, "no \"id\"", "add \"id\": each of several frames has its own");
    else
      own_id = topic_id;
    if (own_id.has_value()) {
      frame.id = own_id.value_or(0);
      const At id_at = at.member("id").value_or(at);
      if (sensor)
        claim_ids(id_at, samples_, frame.id, frame.count, "sensors' frames");
      else if (topic_id && frame.id != *topic_id)
        tell(id_at, "the set point's frame has id " + hex(frame.id) + ", the topic " + hex(*topic_id),
             "the same id for both, or no \"id\" here");
    }

    std::optional<std::uint8_t> dlc;
    const auto dlc_at = at.member("dlc");
    if (dlc_at) {
      if (const auto n = integer(*dlc_at, 0, 8)) dlc = static_cast<std::uint8_t>(*n);
    }
    order = read_order(at, order);
    std::uint8_t used = 0;
    if (const auto a = require(at, "fields", R"([{"name": "x", "byte": 0, "type": "i16"}])"))
      used = read_fields(*a, dlc, order, pascal_case(topic.name + "_" + frame.name), frame);
    frame.dlc = dlc.value_or(used);
    if (const auto a = at.member("derived")) {
      if (!sensor)
        tell(*a, "\"derived\" of an actuator", "leave it out: what is commanded is on the wire");
      else
        read_derived(*a, frame);
    }
    return frame;
  }

  // --- roles ---

  /// What a tool relies on, that knows the role and not the robot.
  void check_role(const At& at, const TopicModel& topic, bool has_board) {
    using protocol::Role;
    const bool sensor = topic.kind == protocol::Kind::sensor;
    const bool acts = topic.role == Role::drive || topic.role == Role::light;
    const bool reports = topic.role == Role::status || topic.role == Role::refusal;
    if (topic.role == Role::none) return;
    if (sensor == acts)
      return tell(at, "role " + shown(*at.node) + " is for " + (acts ? "actuators" : "sensors"),
                  acts ? "leave it out, or say \"kind\": \"actuator\""
                       : "leave it out, or leave out \"kind\": \"actuator\"");
    if (reports && has_board) {
      const auto [other, is_new] = reports_.emplace(std::pair{topic.board, topic.role}, at.path);
      if (!is_new)
        tell(at,
             "a second topic of its board has the role " + shown(*at.node) + " (see " + other->second + ")",
             "at most one of a board");
    }

    struct Wanted {
      std::string_view frame;
      std::string_view field;
      std::string_view unit;
    };
    static constexpr Wanted drive[]{{"", "x", "m/s"}, {"", "z", "rad/s"}};
    static constexpr Wanted light[]{{"", "red", ""}, {"", "green", ""}, {"", "blue", ""}};
    static constexpr Wanted status[]{
        {"identity", "uptime", "s"}, {"identity", "reset", ""},  {"identity", "wire_hash", ""},
        {"health", "load", "%"},     {"health", "bus", ""},      {"health", "publishing", ""},
        {"health", "faults", ""},    {"health", "overload", ""}, {"health", "bus_errors", ""}};
    static constexpr Wanted refusal[]{{"", "topic", ""}, {"", "reason", ""}, {"", "refused", ""}};
    static constexpr Wanted pose[]{{"pose", "x", "m"}, {"pose", "y", "m"}, {"pose", "orientation", "rad"}};
    std::span<const Wanted> wanted;  // of ring and floor: fields of any names, a sensor each
    if (topic.role == Role::drive) wanted = drive;
    if (topic.role == Role::light) wanted = light;
    if (topic.role == Role::status) wanted = status;
    if (topic.role == Role::refusal) wanted = refusal;
    if (topic.role == Role::pose) wanted = pose;
    const auto form = [&] {
      std::string text;
      for (const Wanted& field : wanted) {
        text += text.empty() ? "fields " : &field == &wanted.back() ? " and " : ", ";
        if (!field.frame.empty()) text.append(field.frame).append(".");
        text.append(field.field);
        if (!field.unit.empty()) text.append(" in ").append(field.unit);
      }
      return text;
    };
    for (const Wanted& field : wanted) {
      const std::string full =
          (field.frame.empty() ? "" : std::string{field.frame} + ".") + std::string{field.field};
      const FieldModel* found = nullptr;
      for (const FrameModel& frame : topic.frames)
        for (const FieldModel& f : frame.fields)
          if (frame.name == field.frame && f.name == field.field) found = &f;
      if (found == nullptr)
        tell(at, "role " + shown(*at.node) + " without a field " + quoted(full), form());
      else if (found->unit != field.unit)
        tell(at, "role " + shown(*at.node) + " with field " + quoted(full) + " in " + quoted(found->unit),
             field.unit.empty() ? "no unit" : "the unit \"" + std::string{field.unit} + "\"");
      else if (found->number != protocol::Number::integer)
        tell(at, "role " + shown(*at.node) + " with field " + quoted(full) + ", a floating-point number",
             "an integer type, such as \"i32\", with a scale");
    }
  }

  void read_geometry(const At& at, TopicModel& topic) {
    const auto its = at.member("geometry");
    if (topic.role != protocol::Role::ring) {
      if (its) tell(*its, "\"geometry\" is of a ring", "leave it out, or say \"role\": \"ring\"");
      return;
    }
    static constexpr std::string_view form = R"({"radius": 0.05, "first": 2.7, "step": -0.785})";
    const auto a = require(at, "geometry", form);
    if (!a || !is_object(*a, form)) return;
    check_keys(*a, {"radius", "first", "step"});
    const auto read = [&](std::string_view key, std::string_view what, bool positive) {
      const auto number_at = require(*a, key, what);
      const auto number = number_at ? decimal(*number_at, what) : std::nullopt;
      if (number && positive && number->digits <= 0) tell(*number_at, "not above zero", std::string{what});
      return number.value_or(base::Decimal{1, 0});
    };
    RingGeometry geometry;
    geometry.radius = read("radius", "metres from the robot's middle to the sensors", true);
    geometry.first = read("first", "radians of the first sensor, counter-clockwise from ahead", false);
    geometry.step = read("step", "radians from one sensor to the next", false);
    topic.geometry = geometry;
    for (const FrameModel& frame : topic.frames)
      for (std::size_t i = 0; i < frame.fields.size(); ++i)
        if (std::none_of(frame.derived.begin(), frame.derived.end(),
                         [&](const DerivedModel& derived) { return derived.of == i && derived.unit == "m"; }))
          tell(at, "role \"ring\" without a distance derived of " + quoted(frame.fields[i].name),
               "in its frame " + std::string{derived_form});
  }

  /// A topic that others can be like.
  struct Pattern {
    std::string name;
    const Node* node;
    bool good;  ///< nothing was wrong with it
  };

  MessageReader messages_;
  protocol::ByteOrder order_ = protocol::ByteOrder::little;
  TopicModel defaults_;
  bool boards_known_ = false;
  std::map<std::string, std::string> boards_;
  std::map<std::string, std::string> types_;        ///< name in C++, where
  std::map<std::string, std::string> topic_names_;  ///< name or alias, where
  std::map<unsigned, std::string> commands_;        ///< ids of requests and set points, where
  std::map<unsigned, std::string> samples_;         ///< ids of sensors' frames, where
  std::map<std::pair<std::uint8_t, protocol::Role>, std::string> reports_;  ///< of which board, where
  std::vector<Pattern> patterns_;
};

}  // namespace

Model read_model(const Node& root, std::string_view file_name, std::vector<Problem>& problems,
                 std::vector<Problem>& doubts) {
  return Reader{file_name, problems, doubts}.read(root);
}

}  // namespace ocm::spec
