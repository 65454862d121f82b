/// JSON lines of `listen --json` and `decode --json` as a log: read back bit by bit, edited or not in
/// between. A line is a frame:
///
/// - `id` and `data` make the frame; `fields` are put over `data`, so that an edited value counts and the
///   bits of no field stay. A field that says what `data` says changes nothing, be it out of range.
/// - Without `data` the frame is of zeros and `fields`; without `id` it is `topic`'s, at `priority` and, of a
///   topic with several, its `frame`.
/// - An edited value beyond the range that the spec states is refused if the reader asks for that.
/// - What contradicts itself (an id of another topic, another priority) is refused, not guessed at.
///
/// Keys in any order; those that decode prints for people are passed over, unknown ones also counted. No
/// allocation a line. A line that cannot be read costs that line: the parser says what is wrong and what
/// would be right.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ocm/client/frame_index.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"
#include "ocm/protocol/topic.hpp"

#include "cli/logs/json_scanner.hpp"
#include "cli/output/field_text.hpp"
#include "cli/output/json_text.hpp"

namespace ocm::cli::logs {

/// Why a line is no frame.
struct JsonProblem {
  log::Cause cause = log::Cause::syntax;
  std::string what;
  std::string remedy;
};

/// A key that is neither read nor printed.
struct UnknownKey {
  std::string name;  ///< as the line has it
  std::uint64_t lines = 0;
  std::uint64_t last = 0;  ///< the newest of them
};

/// Which values a line may give a field that its data does not say.
enum class Values : std::uint8_t {
  of_bits,    ///< all that the bits hold
  as_stated,  ///< those of the range that the spec states
};

class JsonLineParser {
 public:
  /// The catalogue must outlive the parser.
  explicit JsonLineParser(const protocol::Catalogue& catalogue, Values values = Values::of_bits);

  /// Reads one line into `entry` (but for its interface) and `bus` (empty: not said; holds as long as the
  /// line and until the next). A line without `time_ns` has the time of the one before. false: `problem`.
  [[nodiscard]] bool parse(std::string_view line, log::Entry& entry, std::string_view& bus);
  [[nodiscard]] const JsonProblem& problem() const noexcept { return problem_; }
  /// The time of a line between these that another parser has read.
  void follow(base::Time time) noexcept { last_ = time; }
  /// That of the last line that had one.
  [[nodiscard]] std::optional<base::Time> last_time() const noexcept { return last_; }
  /// What was passed over, in the order in which it came; of more than 64 the first 64,
  [[nodiscard]] std::span<const UnknownKey> unknown_keys() const noexcept { return unknown_; }
  /// and how often others came.
  [[nodiscard]] std::uint64_t more_unknown_keys() const noexcept { return more_unknown_; }
  /// The key that is read and was probably meant; empty: none.
  [[nodiscard]] static std::string_view meant_by(std::string_view unknown);

 private:
  struct NamedText {
    std::string_view name;
    JsonValue value;
  };
  /// The keys that matter.
  struct Record {
    JsonValue time, bus, id, priority, topic, frame, data, direction, raw_dlc;
    bool has_fd = false, has_fields = false;
    std::uint8_t fd_flags = 0;
    std::array<NamedText, 512> fields;  // a frame has 512 bits
    std::size_t field_count = 0;
  };
  /// What the identifier means.
  struct Meaning {
    const protocol::Topic* requested = nullptr;
    protocol::FrameRef frame;
  };

  bool refuse(log::Cause cause, std::string what, std::string remedy);
  bool refuse_twice(std::string_view what, std::string_view name);
  bool scan(std::string_view line);
  /// A key of which nothing is read.
  void pass_over(std::string_view key);
  bool scan_fields(JsonScanner& scanner);
  bool scan_fd(JsonScanner& scanner);
  bool take_time(log::Entry& entry);
  bool take_bus(std::string_view& bus);
  bool take_extras(log::Entry& entry);
  bool take_id(log::Entry& entry, Meaning& meaning);
  bool take_topic(log::Entry& entry, Meaning& meaning);
  bool agrees(const log::Entry& entry, const Meaning& meaning);
  bool take_data(log::Entry& entry, const Meaning& meaning);
  bool take_remote(log::Entry& entry);
  bool put_fields(log::Entry& entry, const Meaning& meaning);
  bool put_overlapping(std::span<std::uint8_t> data, const protocol::FrameLayout& layout);
  enum class Part : std::uint8_t { all, selectors, others };
  struct Texts;
  bool put_field(std::span<std::uint8_t> data, std::span<const std::uint8_t> before,
                 const protocol::FrameLayout& layout, const NamedText& named, Texts& texts, std::size_t hint,
                 Part part);
  [[nodiscard]] static const protocol::Field* derived_field(const protocol::FrameLayout& layout,
                                                            std::string_view name) noexcept;
  bool agrees(const protocol::Field& field, const protocol::FrameLayout& layout, std::string_view text,
              std::span<const std::uint8_t> before, std::span<const std::uint8_t> now);
  bool take_message(log::Entry& entry, Meaning& meaning, const protocol::Topic& message);
  bool put_request(log::Entry& entry, const protocol::Topic& topic);
  [[nodiscard]] Meaning meaning_of(const log::Entry& entry) const;

  bool give(std::span<std::uint8_t> data, std::span<const std::uint8_t> before, const protocol::Field& field,
            std::string_view text, std::int64_t raw);

  const protocol::Catalogue* catalogue_;
  Values values_;
  client::InterfaceIndexes index_;
  std::uint16_t interface_ = 0;  // of the line
  log::Interfaces interfaces_;   // of the lines, where their names matter
  /// The fields of a layout.
  struct Texts {
    std::vector<FieldText> fields;
    std::vector<std::uint64_t> given_in;  ///< the line that a field was given in last
    bool multiplexed = false;
    bool overlapping = false;  ///< two fields have bits in common
  };
  std::unordered_map<const protocol::FrameLayout*, Texts> texts_;
  Record record_;
  struct Given {
    const protocol::Field* field;
    std::int64_t raw;
  };
  std::vector<Given> given_;  // by the line, other than its data has them; of a layout that overlaps
  std::optional<base::Time> last_;
  std::string bus_;
  JsonProblem problem_;
  std::vector<UnknownKey> unknown_;
  std::uint64_t more_unknown_ = 0;
  std::uint64_t lines_ = 0;
};

class JsonLinesReader final : public log::Reader {
 public:
  JsonLinesReader(log::Input& input, const protocol::Catalogue& catalogue)
      : Reader(input), parser_(catalogue) {}
  [[nodiscard]] static bool recognises(std::string_view beginning);
  [[nodiscard]] std::size_t read(std::span<log::Entry> into) override;

 private:
  JsonLineParser parser_;
};

class JsonLinesWriter final : public log::Writer {
 public:
  explicit JsonLinesWriter(const protocol::Catalogue& catalogue) : text_(catalogue) {}
  void write(log::Bytes& out, std::span<const log::Entry> entries,
             const log::Interfaces& interfaces) override {
    for (const auto& entry : entries) text_.write(out, interfaces.name(entry.interface), entry);
  }

 private:
  JsonText text_;
};

}  // namespace ocm::cli::logs
