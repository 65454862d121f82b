/// The last seconds of the bus on the disk, while an operator runs: what is left of a run that was killed.
/// Two files in turn, so that no more than twice that time lies there.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"
#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/logs/log_file.hpp"

namespace ocm::cli::operate {

class Spool {
 public:
  /// `name` is the operator's. The catalogue must outlive it.
  Spool(std::string folder, std::string name, base::Duration lasting, const protocol::Catalogue& catalogue);

  struct Recovered {
    std::vector<std::string> files;          ///< in the order of time; empty: the run ended by itself
    std::optional<transport::Failure> lost;  ///< why something that was left is not kept
  };
  /// What a run before has left, joined into `path`; where the disk has no room for that, in `path` and
  /// `beside`. A failure: that run goes on. Before `append`.
  [[nodiscard]] transport::Outcome<Recovered> recover(const std::string& path, const std::string& beside);
  /// Puts them on the disk, as far as the kernel does that: a program that is killed loses none of them.
  /// After a failure it begins a new file at the next call.
  [[nodiscard]] transport::Outcome<void> append(std::span<const log::Entry> entries,
                                                const log::Interfaces& interfaces);
  /// The run ends by itself: there is nothing to recover.
  void end();

 private:
  [[nodiscard]] std::string path(int number) const;

  std::string folder_;
  std::string name_;
  base::Duration lasting_;
  const protocol::Catalogue* catalogue_;
  std::unique_ptr<logs::LogFile> file_;
  int number_ = 1;      ///< of the file that is written
  base::Time begin_{};  ///< of its first frame
};

}  // namespace ocm::cli::operate
