/// A dissector in Lua for Wireshark and tshark from 3.6 on (Lua 5.2), on CAN frames however they were
/// captured. Fields are amiro.gyroscope.x, or amiro.odometry.pose.x where a topic has several frames. Values
/// are doubles, rounded once as in the C++ header; whole numbers of any width are exact.
#include <algorithm>
#include <string_view>

#include "generator/targets/target.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/messages.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace ocm::generate {
namespace {

using spec::FieldModel;
using spec::Model;

/// What a frame is found by: its identifier without the priority.
std::string key_of(const Message& message) {
  base::Text<8> text;
  text << "0x";
  text.hex((message.is_sensor() ? 0x400U : 0U) | message.id, 3);
  return std::string{text.view()};
}

/// Lua has no ' between thousands.
std::string plain(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), '\''), text.end());
  return text;
}

std::string field_row(const FieldModel& field) {
  const protocol::Position at = field.position;
  std::string row = "{ name = " + quoted(field.name) + ", start = " + std::to_string(at.start) +
                    ", width = " + std::to_string(at.width);
  if (at.order == protocol::ByteOrder::big) row += ", big = true";
  if (field.is_signed) row += ", signed = true";
  if (!field.unit.empty()) row += ", unit = " + quoted(field.unit);
  const bool scaled = field.scale != base::Decimal{1, 0} || field.offset.digits != 0;
  if (scaled)
    row += ", physical = function(raw) return " + plain(to_physical(conversion(field), "raw")) + " end";
  if (field.values.empty()) return row + " }";
  row += field.flags ? ", flags = {" : ", names = {";
  for (const auto& value : field.values)
    row += " [" + std::to_string(value.raw) + "] = " + quoted(value.name) + ",";
  return row + " } }";
}

/// The same for every robot but for its name: @ stands for amiro.
constexpr std::string_view opening = R"lua(local robot = Proto("@", @title)
local priorities = { [0] = "urgent", [1] = "high", [2] = "medium", [3] = "low" }
local modes = { [0] = "stop", [1] = "publish", [2] = "once" }
local units = { [0] = "ms", [1] = "s", [2] = "us" }

local common = {
  direction = ProtoField.string("@.direction", "Direction"),
  priority = ProtoField.uint8("@.priority", "Priority", base.DEC, priorities),
  topic = ProtoField.string("@.topic", "Topic"),
  frame = ProtoField.string("@.frame", "Frame"),
  kind = ProtoField.string("@.kind", "Kind"),
  mode = ProtoField.uint8("@.mode", "Mode", base.DEC, modes),
  count = ProtoField.uint16("@.count", "Count"),
  unit = ProtoField.uint8("@.unit", "Unit", base.DEC, units),
  period = ProtoField.double("@.period", "Period in s"),
}
local wrong_length = ProtoExpert.new("@.wrong_length", "Wrong length", expert.group.MALFORMED,
                                     expert.severity.ERROR)
local bad_request = ProtoExpert.new("@.bad_request", "Bad request", expert.group.MALFORMED,
                                    expert.severity.ERROR)
robot.experts = { wrong_length, bad_request }

-- Frames by identifier without its priority, sensors by the number that requests to them carry.
local frames, sensors = {}, {}
)lua";

constexpr std::string_view closing = R"lua(
-- The bits of a field byte by byte: { byte, 2^lowest bit within it, 2^number of bits, lowest bit of the field }.
local function pieces_of(field)
  local begin = field.start
  if field.big then begin = 64 - (begin - begin % 8 + 7 - begin % 8) - field.width end
  local pieces, bit = {}, 0
  while bit < field.width do
    local place = begin + bit
    local byte, shift = math.floor(place / 8), place % 8
    local width = math.min(8 - shift, field.width - bit)
    if field.big then byte = 7 - byte end
    pieces[#pieces + 1] = { byte = byte, unit = 2 ^ shift, size = 2 ^ width, from = bit }
    bit = bit + width
  end
  return pieces
end

local function part(tvb, piece)
  return math.floor(tvb(piece.byte, 1):uint() / piece.unit) % piece.size
end

-- The raw number; exact up to 53 bits.
local function number_of(tvb, field)
  local raw = 0
  for _, piece in ipairs(field.pieces) do raw = raw + part(tvb, piece) * 2 ^ piece.from end
  if field.signed and raw >= 2 ^ (field.width - 1) then raw = raw - 2 ^ field.width end
  return raw
end

-- The raw number as an object of 64 bits.
local function object_of(tvb, field)
  local raw = UInt64(0)
  for _, piece in ipairs(field.pieces) do raw = raw + UInt64(part(tvb, piece)):lshift(piece.from) end
  if not field.signed then return raw end
  return Int64(raw:lower(), raw:higher()):lshift(64 - field.width):arshift(64 - field.width)
end

local all_fields = {}
for _, field in pairs(common) do all_fields[#all_fields + 1] = field end

local function register(layout, field)
  local abbreviation = "@." .. layout.topic .. (layout.frame ~= "" and "." .. layout.frame or "") .. "." .. field.name
  field.pieces = pieces_of(field)
  field.first, field.last = 7, 0
  for _, piece in ipairs(field.pieces) do
    field.first, field.last = math.min(field.first, piece.byte), math.max(field.last, piece.byte)
  end
  if field.physical then
    field.proto = ProtoField.double(abbreviation, field.name)
  else
    local kind = (field.signed and "int" or "uint") .. (field.width > 32 and "64" or "32")
    field.proto = ProtoField[kind](abbreviation, field.name, base.DEC,
                                  field.width <= 32 and not field.unit and field.names or nil)
  end
  all_fields[#all_fields + 1] = field.proto
  field.bits = {}
  for bit, name in pairs(field.flags or {}) do
    field.bits[#field.bits + 1] = { bit = bit, name = name, proto = ProtoField.bool(abbreviation .. "." .. name, name) }
    all_fields[#all_fields + 1] = field.bits[#field.bits].proto
  end
  table.sort(field.bits, function(a, b) return a.bit < b.bit end)
end
for _, layout in pairs(frames) do
  for _, field in ipairs(layout.fields) do register(layout, field) end
end
robot.fields = all_fields

local function add_field(tvb, tree, field)
  local range = tvb(field.first, field.last - field.first + 1)
  local wide = field.width > (field.physical and 53 or 32)
  local raw = wide and object_of(tvb, field) or number_of(tvb, field)
  local value = raw
  if field.physical then value = field.physical(wide and raw:tonumber() or raw) end
  local item = tree:add(field.proto, range, value)
  local text = field.name .. " " .. tostring(value)
  if field.unit then
    item:append_text(" " .. field.unit)
    text = text .. " " .. field.unit
  end
  local name = not wide and field.names and field.names[raw]
  if name then
    if field.unit then item:append_text(" (" .. name .. ")") end
    text = field.name .. " " .. name
  end
  for _, flag in ipairs(field.bits) do
    local set = not wide and math.floor(raw / 2 ^ flag.bit) % 2 == 1
    if set then item:append_text(" " .. flag.name) end
    item:add(flag.proto, range, set)
  end
  return text
end

local function add_frame(tvb, tree, layout)
  if tvb:len() ~= layout.dlc then
    tree:add_proto_expert_info(wrong_length, tvb:len() .. " bytes instead of " .. layout.dlc)
    return "wrong length"
  end
  local texts = {}
  for _, field in ipairs(layout.fields) do texts[#texts + 1] = add_field(tvb, tree, field) end
  return table.concat(texts, ", ")
end

local function add_request(tvb, tree, sensor)
  local length = tvb:len()
  local mode = length > 0 and tvb(0, 1):uint() or nil
  if mode then tree:add(common.mode, tvb(0, 1)) end
  if length == 0 or (mode <= 2 and length ~= 1 and not (mode == 1 and length == 4)) then
    tree:add_proto_expert_info(wrong_length, length .. " bytes: 1, or 4 with a period")
    return "wrong length"
  end
  if mode > 2 then
    tree:add_proto_expert_info(bad_request, "mode " .. mode .. ": 0 stop, 1 publish, 2 once")
    return "bad mode"
  end
  if mode ~= 1 then return modes[mode] end
  if length == 1 then
    tree:add(common.period, sensor.period):set_generated()
    return "publish"
  end
  local count, unit = tvb(1, 2):le_uint(), tvb(3, 1):uint()
  tree:add_le(common.count, tvb(1, 2))
  tree:add(common.unit, tvb(3, 1))
  if unit > 2 or count == 0 then
    tree:add_proto_expert_info(bad_request, unit > 2 and "unit " .. unit .. ": 0 ms, 1 s, 2 us" or "a period of zero")
    return "bad period"
  end
  tree:add(common.period, tvb(1, 3), unit == 1 and count or count / (unit == 0 and 1000 or 1000000))
  return "publish every " .. count .. " " .. units[unit]
end

local can_id, can_remote = Field.new("can.id"), Field.new("can.flags.rtr")

local function last(values)
  return values[#values]
end

function robot.dissector(tvb, pinfo, tree)
  local id, remote = last({ can_id() }), last({ can_remote() })
  if not id or id.value > 0x7FF or (remote and remote.value) then return 0 end
  local topic = id.value % 256
  local priority = math.floor(id.value / 256) % 4
  local from_board = id.value >= 0x400
  local layout = frames[(from_board and 0x400 or 0) + topic]
  local sensor = not from_board and sensors[topic]
  if not layout and not sensor then return 0 end
  local kind = from_board and "sample" or sensor and "request" or "set point"
  local subtree = tree:add(robot, tvb())
  subtree:add(common.direction, from_board and "from board" or "to board"):set_generated()
  subtree:add(common.priority, priority):set_generated()
  subtree:add(common.kind, kind):set_generated()
  subtree:add(common.topic, sensor and sensor.topic or layout.topic):set_generated()
  if layout and layout.frame ~= "" then subtree:add(common.frame, layout.frame):set_generated() end
  local name = sensor and sensor.topic or layout.topic .. (layout.frame ~= "" and "." .. layout.frame or "")
  local text
  if sensor then text = add_request(tvb, subtree, sensor) else text = add_frame(tvb, subtree, layout) end
  subtree:append_text(", " .. name .. ", " .. kind)
  pinfo.cols.protocol = robot.description
  pinfo.cols.info = name .. " (" .. priorities[priority] .. " " .. kind .. ") " .. text
  return tvb:len()
end

local identifiers = DissectorTable.get("can.id")
for priority = 0, 3 do
  for key in pairs(frames) do identifiers:add(key + priority * 256, robot) end
  for key in pairs(sensors) do identifiers:add(key + priority * 256, robot) end
end
)lua";

std::string with_names(std::string_view text, const Model& model) {
  std::string out;
  for (; !text.empty(); text.remove_prefix(1)) {
    if (text.starts_with("@title")) {
      out += quoted(model.robot);
      text.remove_prefix(5);
    } else if (text.front() == '@') {
      out += model.name_space;
    } else {
      out += text.front();
    }
  }
  return out;
}

void write_frame(Writer& out, const Message& message) {
  const std::string head = "frames[" + key_of(message) + "] = { topic = " + quoted(message.topic_name) +
                           ", frame = " + quoted(message.frame_name) +
                           ", dlc = " + std::to_string(message.frame->dlc) + ", fields = {";
  if (message.frame->fields.empty()) return out.line(head + "} }");
  out.open(head);
  for (const FieldModel& field : message.frame->fields) out.line(field_row(field) + ",");
  out.close("} }");
}

}  // namespace

std::string make_wireshark(const Model& model, const Options& options) {
  Writer out;
  out.comment("Made by ocm-generate from " + options.spec_name +
                  ". Do not edit: change the spec, and generate again.",
              "-- ");
  out.line("--");
  out.comment("The topics of " + model.robot + " for Wireshark and tshark: wireshark -X lua_script:" +
                  model.name_space + ".lua FILE, or put it into the folder of personal Lua plugins.",
              "-- ");
  Writer tables;
  for (const auto& topic : model.topics)
    if (topic.kind == protocol::Kind::sensor)
      tables.line("sensors[" + hex(topic.id) + "] = { topic = " + quoted(topic.name) +
                  ", period = " + print(base::normalised(topic.period.duration().count(), -9)) + " }");
  for (const Message& message : messages(model)) write_frame(tables, message);
  return out.take() + with_names(opening, model) + tables.take() + with_names(closing, model);
}

}  // namespace ocm::generate
