/// The formats of logs, one line a format in formats.cpp: what reads it, what writes it, how it is
/// recognised. Verbs know formats by this list only.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/log/reader.hpp"
#include "ocm/log/writer.hpp"
#include "ocm/protocol/topic.hpp"

namespace ocm::cli::logs {

struct LogFormat {
  std::string_view name;         ///< for --from and --to: "candump"
  std::string_view ending;       ///< of files in it: ".log"
  std::string_view description;  ///< one line, for --help
  /// Whether a file that begins so (up to 4 KiB of it) is of this format. Asked in the order of the list.
  bool (*recognises)(std::string_view beginning);
  /// The catalogue is for formats that hold decoded values; it outlives what is made. Null: not read.
  std::unique_ptr<log::Reader> (*reader)(log::Input& input, const protocol::Catalogue& catalogue);
  /// Null: not written.
  std::unique_ptr<log::Writer> (*writer)(const protocol::Catalogue& catalogue);
};

[[nodiscard]] std::span<const LogFormat> log_formats();
/// By name; nullptr: there is none.
[[nodiscard]] const LogFormat* find_format(std::string_view name);
/// The names of those that are read, and of those that are written.
[[nodiscard]] std::vector<std::string> readable_formats();
[[nodiscard]] std::vector<std::string> writable_formats();
/// By the ending of a file's name, without .gz and .zst; nullptr: it says nothing.
[[nodiscard]] const LogFormat* format_of_name(std::string_view file);
/// The format in which to write `out`: `named`, if it is not empty, else that of the ending; for "-"
/// `for_stdout`, if there is one. Leaves with exit_usage if there is no such format, or it is only read.
[[nodiscard]] const LogFormat& format_to_write(std::string_view verb, const std::string& out,
                                               const std::string& named, const char* for_stdout = nullptr);
/// Whether a word names a file, there or not: it has a slash or the ending of a log, packed or not.
[[nodiscard]] bool names_file(std::string_view word);

}  // namespace ocm::cli::logs
