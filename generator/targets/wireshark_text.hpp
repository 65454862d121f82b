/// The parts of the dissector that are the same for every spec: @ stands for the name of its protocol, @title
/// for what it is called.
#pragma once

#include <string_view>

namespace ocm::generate::lua {

inline constexpr std::string_view opening = R"lua(local robot = Proto("@", @title)

-- Fields of every frame, and what is wrong with one.
local common, experts = {}, {}
experts.wrong_length = ProtoExpert.new("@.wrong_length", "Wrong length", expert.group.MALFORMED, expert.severity.ERROR)

-- What the frames of this file are read with; nil where it has none of the kind.
local dissect_topic, dissect_message, message_of
)lua";

/// Followed by the tables `frames` and `sensors`.
inline constexpr std::string_view topic_opening = R"lua(
local priorities = { [0] = "urgent", [1] = "high", [2] = "medium", [3] = "low" }
local modes = { [0] = "stop", [1] = "publish", [2] = "once" }
local units = { [0] = "ms", [1] = "s", [2] = "us" }

common.direction = ProtoField.string("@.direction", "Direction")
common.priority = ProtoField.uint8("@.priority", "Priority", base.DEC, priorities)
common.topic = ProtoField.string("@.topic", "Topic")
common.frame = ProtoField.string("@.frame", "Frame")
common.kind = ProtoField.string("@.kind", "Kind")
common.mode = ProtoField.uint8("@.mode", "Mode", base.DEC, modes)
common.count = ProtoField.uint16("@.count", "Count")
common.unit = ProtoField.uint8("@.unit", "Unit", base.DEC, units)
common.period = ProtoField.double("@.period", "Period in s")
experts.bad_request = ProtoExpert.new("@.bad_request", "Bad request", expert.group.MALFORMED, expert.severity.ERROR)

-- Frames by identifier without its priority, sensors by the number that requests to them carry.
local frames, sensors = {}, {}
)lua";

/// Followed by the tables of messages.
inline constexpr std::string_view message_opening = R"lua(
common.message = ProtoField.string("@.message", "Message")
common.sender = ProtoField.string("@.sender", "Sender")
common.pgn = ProtoField.uint32("@.pgn", "Parameter group", base.HEX)
common.source = ProtoField.uint8("@.source", "Source address", base.HEX)
common.destination = ProtoField.uint8("@.destination", "Destination address", base.HEX)

-- Messages by identifier of 11 bits, of 29 bits, and by parameter group of J1939.
local base_messages, extended_messages, group_messages = {}, {}, {}
)lua";

/// How fields are read and shown.
inline constexpr std::string_view fields = R"lua(
-- The bits of a field byte by byte: the byte, 2^lowest bit within it, 2^number of bits, lowest bit of the field.
local function pieces_of(field)
  -- Of big-endian fields: the bits of the frame counted from the highest of its first byte on.
  local last = field.start - field.start % 8 + 7 - field.start % 8 + field.width - 1
  local pieces, bit = {}, 0
  while bit < field.width do
    local place = field.big and last - bit or field.start + bit
    local shift = field.big and 7 - place % 8 or place % 8
    local width = math.min(8 - shift, field.width - bit)
    pieces[#pieces + 1] = { byte = math.floor(place / 8), unit = 2 ^ shift, size = 2 ^ width, from = bit }
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

-- The number of IEEE 754 in the bits.
local function real_of(tvb, field)
  if field.width == 32 then return Struct.unpack("<f", Struct.pack("<I4", number_of(tvb, field))) end
  local bits = object_of(tvb, field)
  return Struct.unpack("<d", Struct.pack("<I4I4", bits:lower(), bits:higher()))
end

local all_fields = {}
for _, field in pairs(common) do all_fields[#all_fields + 1] = field end

local function register(prefix, field)
  local abbreviation = prefix .. "." .. (field.abbreviation or field.name)
  field.pieces = pieces_of(field)
  field.first, field.last = math.huge, 0
  for _, piece in ipairs(field.pieces) do
    field.first, field.last = math.min(field.first, piece.byte), math.max(field.last, piece.byte)
  end
  if field.physical or field.float then
    field.proto = ProtoField.double(abbreviation, field.name)
  else
    local kind = (field.signed and "int" or "uint") .. (field.width > 32 and "64" or "32")
    field.proto = ProtoField[kind](abbreviation, field.name, base.DEC,
                                  field.width <= 32 and not field.unit and field.names or nil)
  end
  all_fields[#all_fields + 1] = field.proto
  field.bits = {}
  for bit, name in pairs(field.flags or {}) do
    local own = string.gsub(name, "[^%w_]+", "_")
    field.bits[#field.bits + 1] = { bit = bit, name = name, proto = ProtoField.bool(abbreviation .. "." .. own, name) }
    all_fields[#all_fields + 1] = field.bits[#field.bits].proto
  end
  table.sort(field.bits, function(a, b) return a.bit < b.bit end)
end

local function add_field(tvb, tree, field)
  local range = tvb(field.first, field.last - field.first + 1)
  local wide = field.width > (field.physical and 53 or 32) and not field.float
  local raw
  if field.float then
    raw = real_of(tvb, field)
  else
    raw = wide and object_of(tvb, field) or number_of(tvb, field)
  end
  local value = raw
  if field.physical then value = field.physical(wide and raw:tonumber() or raw) end
  local item = tree:add(field.proto, range, value)
  local text = field.name .. " " .. tostring(value)
  if field.unit then
    item:append_text(" " .. field.unit)
    text = text .. " " .. field.unit
  end
  local number = wide and raw:tonumber() or raw
  local name = field.names and math.abs(number) < 2 ^ 53 and field.names[number]
  if name then
    if field.unit then item:append_text(" (" .. name .. ")") end
    text = field.name .. " " .. name
  end
  for _, flag in ipairs(field.bits) do
    local set = (wide and raw:rshift(flag.bit):band(1):tonumber() or math.floor(raw / 2 ^ flag.bit) % 2) == 1
    if set then item:append_text(" " .. flag.name) end
    item:add(flag.proto, range, set)
  end
  return text
end

)lua";

inline constexpr std::string_view topic_part = R"lua(
for _, layout in pairs(frames) do
  local prefix = "@." .. layout.topic .. (layout.frame ~= "" and "." .. layout.frame or "")
  for _, field in ipairs(layout.fields) do register(prefix, field) end
end

local function add_frame(tvb, tree, layout)
  if tvb:len() ~= layout.dlc then
    tree:add_proto_expert_info(experts.wrong_length, tvb:len() .. " bytes instead of " .. layout.dlc)
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
    tree:add_proto_expert_info(experts.wrong_length, length .. " bytes: 1, or 4 with a period")
    return "wrong length"
  end
  if mode > 2 then
    tree:add_proto_expert_info(experts.bad_request, "mode " .. mode .. ": 0 stop, 1 publish, 2 once")
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
    tree:add_proto_expert_info(experts.bad_request, unit > 2 and "unit " .. unit .. ": 0 ms, 1 s, 2 us" or "a period of zero")
    return "bad period"
  end
  tree:add(common.period, tvb(1, 3), unit == 1 and count or count / (unit == 0 and 1000 or 1000000))
  return "publish every " .. count .. " " .. units[unit]
end

function dissect_topic(tvb, pinfo, tree, id)
  local topic = id % 256
  local priority = math.floor(id / 256) % 4
  local from_board = id >= 0x400
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

)lua";

inline constexpr std::string_view message_part = R"lua(
for _, messages in ipairs({ base_messages, extended_messages, group_messages }) do
  for _, layout in pairs(messages) do
    for _, field in ipairs(layout.fields) do register("@." .. layout.abbreviation, field) end
  end
end

-- Below format 240 the byte behind the format is a destination. [SAE J1939-21, 5.2]
local function group_of(id)
  local format = math.floor(id / 0x10000) % 0x100
  local group = math.floor(id / 0x100) % 0x40000
  return format < 240 and group - group % 0x100 or group, format < 240 and group % 0x100 or 255
end

function message_of(id, is_extended)
  if not is_extended then return base_messages[id] end
  return extended_messages[id] or group_messages[group_of(id)]
end

-- Whether the frame has the field: its bytes, and those of what selects it, with a number that does.
local function has(tvb, layout, field)
  if field.last >= tvb:len() then return false end
  if not field.selector then return true end
  local selector = layout.fields[field.selector]
  if not selector or not has(tvb, layout, selector) then return false end
  local raw = number_of(tvb, selector)
  if raw < 0 then raw = raw + 2 ^ selector.width end
  for _, range in ipairs(field.selected) do
    if range[1] <= raw and raw <= range[2] then return true end
  end
  return false
end

function dissect_message(tvb, pinfo, tree, layout, id)
  local subtree = tree:add(robot, tvb())
  subtree:add(common.message, layout.name):set_generated()
  if layout.sender then subtree:add(common.sender, layout.sender):set_generated() end
  local group, destination = group_of(id)
  if group_messages[group] == layout then
    subtree:add(common.pgn, group):set_generated()
    subtree:add(common.source, id % 0x100):set_generated()
    subtree:add(common.destination, destination):set_generated()
  end
  local texts = {}
  if tvb:len() < layout.length then
    subtree:add_proto_expert_info(experts.wrong_length, tvb:len() .. " bytes, fewer than " .. layout.length)
    texts[1] = "wrong length"
  else
    for _, field in ipairs(layout.fields) do
      if has(tvb, layout, field) then texts[#texts + 1] = add_field(tvb, subtree, field) end
    end
  end
  subtree:append_text(", " .. layout.name)
  pinfo.cols.protocol = robot.description
  pinfo.cols.info = layout.name .. " " .. table.concat(texts, ", ")
  return tvb:len()
end
)lua";

inline constexpr std::string_view closing = R"lua(
robot.fields = all_fields
robot.experts = {}
for _, each in pairs(experts) do robot.experts[#robot.experts + 1] = each end

local can_id, can_remote, can_extended = Field.new("can.id"), Field.new("can.flags.rtr"), Field.new("can.flags.xtd")

local function last(values)
  return values[#values]
end

function robot.dissector(tvb, pinfo, tree)
  local id, remote, extended = last({ can_id() }), last({ can_remote() }), last({ can_extended() })
  if not id or (remote and remote.value) then return 0 end
  local is_extended = id.value > 0x7FF or (extended and extended.value)
  local layout = message_of and message_of(id.value, is_extended)
  if layout then return dissect_message(tvb, pinfo, tree, layout, id.value) end
  if is_extended or not dissect_topic then return 0 end
  return dissect_topic(tvb, pinfo, tree, id.value)
end

local identifiers = DissectorTable.get("can.id")
)lua";

inline constexpr std::string_view topic_closing = R"lua(for priority = 0, 3 do
  for key in pairs(frames) do identifiers:add(key + priority * 256, robot) end
  for key in pairs(sensors) do identifiers:add(key + priority * 256, robot) end
end
)lua";

inline constexpr std::string_view message_closing =
    R"lua(for id in pairs(base_messages) do identifiers:add(id, robot) end
for id in pairs(extended_messages) do DissectorTable.get("can.extended_id"):add(id, robot) end
-- A parameter group has more identifiers than a table should.
if next(group_messages) then
  robot:register_heuristic("can", function(tvb, pinfo, tree) return robot.dissector(tvb, pinfo, tree) > 0 end)
end
)lua";

}  // namespace ocm::generate::lua
