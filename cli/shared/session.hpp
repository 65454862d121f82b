/// What all verbs share: the options before the verb, the robot's catalogue and the bus.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/protocol/topic.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/shared/arguments.hpp"
#include "cli/shared/messages.hpp"

namespace ocm::spec {
class Spec;
struct Model;
}  // namespace ocm::spec

namespace ocm::cli {

class Session {
 public:
  Session();
  ~Session();

  /// The options that every verb takes.
  void add_options(Verb app);

  /// The AMiRo's, compiled in, or that of --spec; of several, all that they say.
  [[nodiscard]] const protocol::Catalogue& catalogue();
  /// The same with all that its spec says, read when it is asked for.
  [[nodiscard]] const spec::Spec& spec();
  /// What is on the bus that is commanded: --spec can1=FILE is nothing that can0 takes. The bus is --bus, or
  /// the only one; where none is known, as with --dry-run, all that there is.
  [[nodiscard]] const protocol::Catalogue& catalogue_on_bus(bool opens_bus);
  /// The same of a bus by its name.
  [[nodiscard]] const protocol::Catalogue& catalogue_on(const std::string& bus);
  /// Of a verb that is about one bus: from now on the specs are those for it, as if they had been given
  /// without their interface. It is `bus`, or where that is empty the only one that --spec names; exit_usage
  /// where there are several, or none for it. To be called before anything of the spec is asked for. Returns
  /// the bus; empty: no interface is named, and none is chosen.
  [[nodiscard]] std::string narrow_to_bus(std::string_view verb, const std::string& bus);
  /// exit_usage where the output is a file of --spec: it cannot be made again.
  void keep_specs(std::string_view verb, const std::string& output) const;
  /// Of a verb that is about one bus which has no name: exit_usage where --spec names interfaces.
  void refuse_interfaces(std::string_view verb);

  /// The bus of --bus, AMIROCTL_BUS, or the only one there is; says on stderr which.
  [[nodiscard]] std::unique_ptr<transport::Bus> open_bus();
  /// As open_bus, by name.
  [[nodiscard]] static std::unique_ptr<transport::Bus> open_bus(std::string_view name);

  /// Whether to colour what goes to stdout: a terminal, and neither --no-color nor NO_COLOR.
  [[nodiscard]] bool colour() const;

  std::string bus_name;
  std::vector<std::string> spec_files;
  std::string config_file;

 private:
  [[nodiscard]] spec::Model load(const std::string& word) const;

  bool no_colour_ = false;
  bool strict_spec_ = false;
  std::unique_ptr<spec::Spec> spec_;
  std::map<std::string, std::unique_ptr<spec::Spec>> specs_on_;  ///< by bus
};

}  // namespace ocm::cli
