/// Frames as JSON lines, one object a frame with stable keys: time_ns (a string: it has more digits than a
/// double), bus, id, priority, topic, frame, fields, units, data; where values have names `names` of them;
/// and where they say something direction, fd, raw_dlc. A message has no priority; one of J1939 has priority,
/// pgn, source and destination of its identifier. A frame of J1939's transport protocol has `transport`, and
/// in `message` what it completes. A field that is not in the frame has no key. What is the same in every
/// frame of an identifier is made once, so that a line is a few copies with numbers between them. Nothing of
/// the frame is left out: cli/logs/json_lines.hpp reads it back.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/client/frame_index.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/log/bytes.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/output/field_text.hpp"
#include "cli/output/selection.hpp"

namespace ocm::cli {

/// Appends `text` as the inside of a JSON string. A byte that is no UTF-8 becomes text, `\xff`, as messages
/// show it; a backslash that would begin such a text becomes `\x5c`. So nothing is lost, which U+FFFD would
/// do: two interfaces could get one name. Lone surrogates are no Unicode, and strict readers refuse them.
/// [RFC 8259, 8.2]
void append_json(std::string& out, std::string_view text);
/// The same with the quotes.
[[nodiscard]] std::string json_string(std::string_view text);

class JsonText {
 public:
  /// The catalogue must outlive this. With a selection, only its fields, and only frames that have one. With
  /// an interface, without the topics that are on another.
  explicit JsonText(const protocol::Catalogue& catalogue, const Selection& selection = {},
                    std::string_view interface = {});

  /// Appends one line. false: nothing of the frame was selected.
  bool write(log::Bytes& out, std::string_view bus, const log::Entry& entry);
  /// The same of a frame of J1939's transport protocol, with the message that it completes in it.
  bool write_transport(log::Bytes& out, std::string_view bus, const log::Entry& entry,
                       const client::Reception& reception);

 private:
  /// Characters of `pieces_`.
  struct Piece {
    std::uint32_t begin = 0;
    std::uint32_t size = 0;
  };
  struct FieldPiece {
    FieldText value;
    Piece after;  ///< what follows the value: the next field's name, or the units
  };
  /// Of a field that is not in every frame, with colons.
  struct Labels {
    Piece name;
    Piece unit;                ///< name and unit
    std::uint16_t choice = 0;  ///< fields of one number are in a frame together, if it is long enough
  };
  /// A value's name as JSON; of flags that of a bit, without quotes.
  struct ValueName {
    std::int64_t raw = 0;
    Piece text;
  };
  /// A field of which values have names. `tabled`: the name is looked up by the field's bits, without a
  /// search and without the field itself, which is in no cache.
  struct NamedField {
    FieldText value;
    Piece label;  ///< its name, with a colon
    std::uint32_t first_name = 0;
    std::uint32_t names = 0;
    std::uint32_t first_tabled = 0;  ///< of tabled_names_, by bits; there is one more than `greatest`
    std::uint16_t greatest = 0;      ///< bits beyond it have no name
    bool tabled = false;
  };
  enum class Kind : std::uint8_t { unknown, fields, request };
  /// What an identifier means; with a copy of what is asked of every frame, so that neither topic nor layout
  /// need be looked at.
  struct Known {
    Kind kind = Kind::unknown;
    bool selected = true;
    bool varies = false;      ///< not every frame has every field
    bool plain = true;        ///< neither varies nor has named values
    bool message = false;     ///< no topic
    bool pgn = false;         ///< J1939's
    std::uint16_t least = 0;  ///< bytes of a frame
    std::uint16_t most = 0;
    std::uint16_t fields = 0;
    std::uint16_t named = 0;  ///< fields of which values have names
    std::uint16_t choices = 0;
    std::uint32_t first_field = 0;
    std::uint32_t first_named = 0;
    Piece head;  ///< of a topic from the identifier, of a message from behind it, to the first value
    protocol::FrameRef frame;
  };
  /// An interface's name, ready to be printed: `text` has `block` more bytes behind its end.
  struct BusText {
    std::string name;
    std::string text;
    std::size_t size = 0;
  };
  /// The beginning of a line: all but the last nine digits of its time, which most frames share with the one
  /// before.
  struct Second {
    static constexpr std::size_t most = 32;  ///< those that put_unsigned writes behind its end, too
    std::uint64_t number = 0;                ///< 0: none
    std::array<char, most> text{};
    std::size_t size = 0;
  };

  Piece keep(std::string_view text);
  void know(protocol::FrameRef frame, const Selection& selection);
  void know_choices(Known& known);
  [[nodiscard]] const Known& known_of(const log::Entry& entry) const noexcept;
  [[nodiscard]] char* put_identity(char* to, const log::Entry& entry, const Known& known) const noexcept;
  /// The names of a field's values; returns the room that they need.
  std::size_t know_names(const protocol::Field& field, const std::string& label);
  void tabulate(NamedField& named);
  std::size_t find_present(const Known& known, std::span<const std::uint8_t> bytes) noexcept;
  [[nodiscard]] char* put_fields(char* to, const Known& known, std::span<const std::uint8_t> bytes,
                                 std::size_t count) const noexcept;
  char* put_names(char* to, const Known& known, std::span<const std::uint8_t> bytes) const noexcept;
  char* put_name(char* to, const NamedField& field, std::int64_t raw) const noexcept;
  [[nodiscard]] char* put_content(char* to, const Known& known, std::span<const std::uint8_t> bytes,
                                  std::size_t present) const noexcept;
  void write_message(log::Bytes& out, const Known* known, const j1939::Transported& message);
  /// Inlined everywhere: a line is little else.
  [[gnu::always_inline]] inline char* put(char* to, Piece piece) const noexcept;
  char* put_begin(char* to, const BusText& bus, base::Time time) noexcept;
  const BusText& bus_text(std::string_view bus, std::uint16_t number);
  /// What a remote frame is of; nullptr: its identifier is unknown.
  [[nodiscard]] const protocol::Topic* remote_topic(const log::Entry& entry) const noexcept;
  void write_rest(log::Bytes& out, const BusText& bus, const Known& known, const log::Entry& entry);
  void write_request(log::Bytes& out, const Known& known, const log::Entry& entry) const;

  const protocol::Catalogue* catalogue_;
  client::FrameIndex index_;
  std::array<Known, can::max_base_id + 1> known_{};
  std::vector<Known> messages_;  // by number in the catalogue, those of 29 bits and of CAN FD
  std::vector<FieldPiece> fields_;
  std::vector<Labels> labels_;  // of the same number as fields_
  std::vector<NamedField> named_;
  std::vector<ValueName> value_names_;  // of each field by raw number
  std::vector<Piece> tabled_names_;     // label, name and comma; of bits without a name nothing
  std::vector<std::uint16_t>
      present_;  // which fields are in the frame at hand; as many as the most that one has
  enum class Chosen : std::uint8_t { unasked, no, yes };
  std::vector<Chosen> chosen_;  // by choice, in the frame at hand
  std::string pieces_;
  std::size_t room_ = 0;  ///< for any line without what precedes the identifier
  bool everything_;
  bool has_groups_ = false;  ///< of J1939: then all identifiers of 29 bits are shown as such
  std::array<BusText, 16> buses_;
  Second second_;
};

}  // namespace ocm::cli
