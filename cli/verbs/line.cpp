/// What robots and their server say over the mapper's link, as JSON lines: whole sentences only; what is
/// damaged is counted and reported at the end.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "ocm/mapper/link/demultiplexer.hpp"

#include "cli/fleet/line_log.hpp"
#include "cli/logs/file_source.hpp"
#include "cli/output/digits.hpp"
#include "cli/output/printer.hpp"
#include "cli/shared/interrupt.hpp"
#include "cli/shared/messages.hpp"
#include "cli/shared/output_file.hpp"
#include "cli/verbs/verb.hpp"

namespace ocm::cli {
namespace {

struct LineOptions {
  std::string file = "-";
  bool to_robot = false;
  bool strict = false;
  std::uint64_t count = 0;
};

/// One robot's stream, in the direction that is asked for.
class Stream {
 public:
  explicit Stream(bool to_robot) : to_robot_(to_robot) {}

  mapper::link::Kind feed(std::uint8_t byte) {
    said_ = true;
    packed_ = mapper::link::is_packed(byte);
    const mapper::link::Kind kind = to_robot_ ? server_.feed(static_cast<char>(byte)) : robot_.feed(byte);
    if (kind != mapper::link::Kind::none) ++sentences_;
    return kind;
  }
  /// The prefix that names the robot. Another name is another robot, on a link of its own.
  void call(std::string_view name) {
    if (!name_.empty() && name_ != name) {
      robot_.restart();
      server_.restart();
    }
    name_ = name;
  }
  /// Nothing more comes: what was begun is damaged.
  void end() {
    if (said_) (void)feed('\n');
  }

  [[nodiscard]] const mapper::link::Sentence& sentence() const {
    return to_robot_ ? server_.sentence() : robot_.sentence();
  }
  /// The sentence was a packed update, which has a number.
  [[nodiscard]] bool packed() const { return packed_; }
  [[nodiscard]] std::uint8_t sequence() const { return robot_.packed().packed().sequence; }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool said_anything() const { return said_; }
  [[nodiscard]] std::uint64_t sentences() const { return sentences_; }
  [[nodiscard]] std::uint64_t damaged() const {
    return std::uint64_t{text().faults().total()} + robot_.packed().faults().total();
  }
  [[nodiscard]] std::uint64_t stray() const {
    return std::uint64_t{text().stray()} + robot_.packed().faults().stray;
  }
  [[nodiscard]] const mapper::link::Reader& text() const { return to_robot_ ? server_ : robot_.text(); }
  [[nodiscard]] const mapper::link::Ear& ear() const { return robot_; }

 private:
  bool to_robot_;
  bool said_ = false;
  bool packed_ = false;
  mapper::link::Ear robot_;
  mapper::link::Reader server_{mapper::link::Direction::to_robot};
  std::string name_;
  std::uint64_t sentences_ = 0;
};

/// Robots by the central's index; and what has no prefix, as on a line without a central.
class Streams {
 public:
  static constexpr std::size_t nameless = 256;

  explicit Streams(bool to_robot) : streams_(nameless + 1, Stream{to_robot}) {}

  /// Which stream the byte completes a sentence of; -1: none.
  int feed(std::uint8_t byte) {
    using Step = mapper::link::PrefixFilter::Step;
    const char c = static_cast<char>(byte);
    switch (filter_.feed(c)) {
      case Step::prefix:
        if (c == '[') prefix_.clear();
        prefix_ += c;
        return -1;
      case Step::source:
        current_ = filter_.source();
        streams_[current_].call(std::string_view{prefix_}.substr(prefix_.rfind(':') + 1));
        return -1;
      case Step::no_robot:
        ++of_no_robot_;
        return -1;
      case Step::text:
        break;
    }
    return streams_[current_].feed(byte) != mapper::link::Kind::none ? static_cast<int>(current_) : -1;
  }
  void end() {
    for (Stream& stream : streams_) stream.end();
  }

  [[nodiscard]] const Stream& operator[](std::size_t index) const { return streams_[index]; }
  [[nodiscard]] std::size_t size() const { return streams_.size(); }
  [[nodiscard]] std::uint64_t of_no_robot() const { return of_no_robot_; }
  [[nodiscard]] std::uint64_t broken_prefixes() const { return filter_.broken(); }

 private:
  mapper::link::PrefixFilter filter_{true};
  std::string prefix_;
  std::size_t current_ = nameless;
  std::vector<Stream> streams_;
  std::uint64_t of_no_robot_ = 0;
};

// --- JSON --------------------------------------------------------------------------------------------------

void put_number(Buffer& out, int number) {
  out.grow_to(put_signed(out.room(32), number));
}

/// The integers that came by the names of a T's fields; what a robot said beyond them in a list.
template <class T>
void put_values(Buffer& out, const mapper::link::Sentence& sentence) {
  const std::size_t named = std::min<std::size_t>(sentence.count, T::fields.size());
  for (std::size_t i = 0; i < named; ++i) {
    out.append(i == 0 ? "\"" : ",\"");
    out.append(T::fields[i].name);
    out.append("\":");
    put_number(out, sentence.integers[i]);
  }
  for (std::size_t i = named; i < sentence.count; ++i) {
    out.append(i == named ? ",\"more\":[" : ",");
    put_number(out, sentence.integers[i]);
  }
  if (named < sentence.count) out.append(']');
}

void put_values(Buffer& out, const mapper::link::Sentence& sentence) {
  switch (sentence.kind) {
    case mapper::link::Kind::set_point:
      return put_values<mapper::link::SetPoint>(out, sentence);
    case mapper::link::Kind::calibrate:
      return put_values<mapper::link::Calibrate>(out, sentence);
    case mapper::link::Kind::calibration:
      return put_values<mapper::link::Calibration>(out, sentence);
    case mapper::link::Kind::handshake:
      return put_values<mapper::link::Handshake>(out, sentence);
    case mapper::link::Kind::update:
      return put_values<mapper::link::Update>(out, sentence);
    default:
      return;
  }
}

/// A name has no character that JSON escapes but the quote and the backslash: fits_name.
void put_robot(Buffer& out, std::size_t index, std::string_view name) {
  if (index == Streams::nameless) return out.append(R"({"robot":null,"name":null)");
  out.append(R"({"robot":)");
  put_number(out, static_cast<int>(index));
  out.append(R"(,"name":")");
  for (const char c : name) {
    if (c == '"' || c == '\\') out.append('\\');
    out.append(c);
  }
  out.append('"');
}

void put_sentence(Buffer& out, std::size_t index, const Stream& stream) {
  const mapper::link::Sentence& sentence = stream.sentence();
  put_robot(out, index, stream.name());
  out.append(R"(,"type":")");
  out.append(mapper::link::name(sentence.kind));
  out.append(R"(","values":{)");
  put_values(out, sentence);
  out.append('}');
  if (stream.packed()) {
    out.append(R"(,"sequence":)");
    put_number(out, stream.sequence());
  }
  out.append("}\n");
}

// --- what was heard, in words ------------------------------------------------------------------------------

template <class Faults>
struct Cause {
  std::uint32_t Faults::*count;
  std::string_view words;
};
constexpr Cause<mapper::link::ReaderFaults> text_causes[] = {
    {&mapper::link::ReaderFaults::torn, "torn"},
    {&mapper::link::ReaderFaults::unclosed, "unclosed"},
    {&mapper::link::ReaderFaults::headless, "headless"},
    {&mapper::link::ReaderFaults::unknown, "unknown"},
    {&mapper::link::ReaderFaults::bad_number, "with a bad number"},
    {&mapper::link::ReaderFaults::wrong_count, "with a wrong count of integers"},
    {&mapper::link::ReaderFaults::out_of_range, "out of range"},
    {&mapper::link::ReaderFaults::too_long, "too long"},
};
constexpr Cause<mapper::link::PackedFaults> packed_causes[] = {
    {&mapper::link::PackedFaults::corrupt, "packed and corrupt"},
    {&mapper::link::PackedFaults::torn, "packed and torn"},
    {&mapper::link::PackedFaults::lost, "packed and lost"},
    {&mapper::link::PackedFaults::repeated, "packed and repeated"},
    {&mapper::link::PackedFaults::late, "packed and late"},
    {&mapper::link::PackedFaults::out_of_range, "packed and out of range"},
};

template <class Faults, std::size_t N>
void add_causes(std::string& text, const Faults& faults, const Cause<Faults> (&causes)[N]) {
  for (const auto& cause : causes)
    if (faults.*cause.count != 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", faults.*cause.count, cause.words);
}

std::string describe(const Stream& stream) {
  std::string causes;
  add_causes(causes, stream.text().faults(), text_causes);
  add_causes(causes, stream.ear().packed().faults(), packed_causes);
  std::string text =
      fmt::format("{}, {} damaged", counted(stream.sentences(), "whole sentence"), stream.damaged());
  if (!causes.empty()) text += fmt::format(" ({})", causes);
  if (stream.stray() != 0) text += ", " + counted(stream.stray(), "stray character");
  return text;
}

/// A new link is trusted: what was never a sentence, whole or damaged, says nothing about it.
std::string quality(const Stream& stream) {
  if (stream.sentences() == 0) return stream.damaged() == 0 ? "unknown" : "0 %";
  return fmt::format("{} %", stream.ear().quality().per_mille() / 10);
}

/// Whether anything of the stream was not of a whole sentence.
bool summarise(const Streams& streams, bool to_robot) {
  bool damaged = false;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const Stream& stream = streams[i];
    if (!stream.said_anything()) continue;
    damaged |= stream.damaged() != 0 || stream.stray() != 0;
    std::string text = describe(stream);
    if (!to_robot) text += "; link quality " + quality(stream);
    remark(i == Streams::nameless ? text : fmt::format("[{}] {}: {}", i, stream.name(), text));
  }
  if (streams.broken_prefixes() == 0) return damaged;
  remark(fmt::format("broken prefixes: {}, and after them {} whose robot is unknown",
                     streams.broken_prefixes(), counted(streams.of_no_robot(), "character")));
  return true;
}

// --- the verb ----------------------------------------------------------------------------------------------

/// Reads to the end, to a signal, or until `most` sentences were shown (0: all); how many were. Leaves
/// through cli::fail where it is a file of `map --record`: that has times, and both directions.
std::uint64_t show(log::Source& source, const std::string& name, Streams& streams, std::uint64_t most) {
  std::array<char, 1 << 16> block;
  Buffer out;
  std::uint64_t shown = 0;
  bool begins = true;
  for (std::size_t size = source.read(block); size != 0; size = source.read(block)) {
    if (std::exchange(begins, false) &&
        std::string_view{block.data(), size}.starts_with(fleet::line_log_begins))
      fail({fmt::format("line: {} is the recorded line of a central, with times and both directions", name),
            "`amiroctl serve FILE` plays it; line reads the bytes of one direction"},
           exit_usage);
    for (const char c : std::string_view{block.data(), size}) {
      const int index = streams.feed(static_cast<std::uint8_t>(c));
      if (index < 0) continue;
      put_sentence(out, static_cast<std::size_t>(index), streams[static_cast<std::size_t>(index)]);
      if (++shown == most) break;
    }
    write_out(out);  // what a pipe or a terminal has brought is shown before more is waited for
    if (most != 0 && shown == most) return shown;
  }
  streams.end();
  return shown;
}

void run_line(const LineOptions& options, int& exit_code) {
  refuse_same_file("line", options.file, "-");
  catch_interrupts();
  logs::FileSource source{options.file};
  const std::string shown_name = options.file == "-" ? "the standard input" : options.file;
  const auto wanted = options.to_robot ? "what a server said to a robot" : "what a robot said";
  if (!source.failure().empty())
    fail({fmt::format("cannot read {}: {}", shown_name, source.failure()),
          fmt::format("expected a file with {}", wanted)});
  Streams streams{options.to_robot};
  const std::uint64_t shown = show(source, shown_name, streams, options.count);
  const bool damaged = summarise(streams, options.to_robot);
  if (interrupted() == 0 && !source.failure().empty())
    fail({fmt::format("{}: cannot be read beyond byte {}: {}", shown_name, source.position(),
                      source.failure()),
          "what came before it is above"});
  if (shown == 0)
    remark(fmt::format("no whole sentence in {}: it is read as {}; {} reads the other direction", shown_name,
                       wanted, options.to_robot ? "without --to-robot line" : "--to-robot"));
  if (shown == 0 || (options.strict && damaged)) exit_code = exit_failure;
  exit_code = exit_code_after_interrupt(exit_code);
}

}  // namespace

void declare_line(Verb verb, Session&, int& exit_code) {
  verb.describe("say what mappers said, as JSON", mapper_group,
                "  amiroctl line central.log | jq -c 'select(.name==\"AVR\") | .values'\n"
                "  amiroctl line --to-robot server.log\n"
                "  stty -F /dev/ttyUSB0 raw -echo 115200; amiroctl line /dev/ttyUSB0\n"
                "  amiroctl line --strict central.log > /dev/null    exit 1 when anything was damaged");
  const auto options = std::make_shared<LineOptions>();
  verb.add_option("file", options->file,
                  "bytes of a robot's line, or of a central with its prefixes; default: - (standard input)")
      .type_name("[FILE]");
  verb.add_flag("--to-robot", options->to_robot, "what is said to robots; default: what they say");
  verb.add_option("-n,--count", options->count, "end after so many sentences").type_name("N").positive();
  verb.add_flag("--strict", options->strict, "exit 1 when anything was damaged or stray");
  verb.callback([options, &exit_code] { run_line(*options, exit_code); });
}

}  // namespace ocm::cli
