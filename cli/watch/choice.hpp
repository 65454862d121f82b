/// Which frames a verb shows: of which topics and messages, of which sender, with which identifiers, and
/// while which conditions hold.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/client/frame_index.hpp"
#include "ocm/client/sample.hpp"
#include "ocm/j1939/transport.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/transport/bus.hpp"

#include "cli/output/selection.hpp"
#include "cli/shared/arguments.hpp"
#include "cli/shared/filters.hpp"
#include "cli/words/condition.hpp"

namespace ocm::cli {

struct ChoiceOptions {
  std::vector<std::string> topics;
  std::vector<std::string> senders;
  std::vector<std::string> filters;  ///< id:mask
  std::vector<std::string> groups;   ///< of J1939
  std::vector<std::string> conditions;
};

/// --sender, --filter, --pgn and --where.
void add_choice_options(Verb verb, ChoiceOptions& options);

class Choice {
 public:
  /// Mistakes are exit_usage, in words that begin with the verb. The catalogue must outlive it.
  Choice(std::string_view verb, const protocol::Catalogue& catalogue, const ChoiceOptions& options);

  /// Nothing is chosen, so that all is shown.
  [[nodiscard]] bool everything() const noexcept { return everything_; }
  /// The topics and messages that are named, or whose sender is.
  [[nodiscard]] const std::vector<const protocol::Topic*>& topics() const noexcept { return topics_; }

  /// Leaves through cli::fail where fields are chosen (words of --field), and each is of a topic that is not.
  void expect_any_of(const std::vector<std::string>& fields) const;

  /// Whether a frame is shown. Ask of all frames in the order in which they came: a condition holds from the
  /// frame in which it does until the frame in which it does not.
  [[nodiscard]] bool has(const log::Entry& entry) { return everything_ || is_chosen(entry); }
  /// The same once it is known what the frame means: a packet of J1939's transport protocol is shown for the
  /// message that it completes. Ask of all that it `has`.
  [[nodiscard]] bool shows(const log::Entry& entry, const client::Reception& reception) {
    return everything_ || !is_packet(entry) || is_chosen_packet(entry, reception);
  }

  /// Lets a bus leave out what is not looked at, where it can; with `commands` requests and set points are
  /// looked at.
  void subscribe(transport::Bus& bus, bool commands) const;

  /// Frames of interface `number` come over the one of this name: topics of others are none of theirs.
  void on_interface(std::uint16_t number, std::string_view name);

 private:
  struct HeldField {
    ChosenField of;
    words::Condition condition;
    bool holds = false;  ///< as the last frame with the field said
  };
  /// A condition on a field, or on the fields of one name that several interfaces have.
  struct Held {
    std::vector<HeldField> fields;
  };

  /// Where messages of its parameter groups are chosen.
  [[nodiscard]] bool is_chosen(const log::Entry& entry);
  [[nodiscard]] bool is_chosen_packet(const log::Entry& entry, const client::Reception& reception);
  /// Notes what a frame, or a message in several, says of the conditions; whether all hold.
  [[nodiscard]] bool conditions_hold(const client::Subject& subject, std::span<const std::uint8_t> data,
                                     std::uint16_t interface);
  /// On the interface, where it has the field; else on any.
  [[nodiscard]] bool holds(const Held& held, std::uint16_t interface) const;
  [[nodiscard]] bool is_meant(const protocol::Topic* topic, std::uint32_t id, can::Format format) const;
  void read_conditions(std::string_view verb, const protocol::Catalogue& catalogue,
                       const std::vector<std::string>& conditions);

  std::string verb_;  // for messages
  const protocol::Catalogue* catalogue_;
  bool everything_ = true;
  std::vector<const protocol::Topic*> topics_;
  Filters filters_;  ///< of identifiers and parameter groups
  std::vector<Held> conditions_;
  client::InterfaceIndexes index_;
  std::vector<std::string> interfaces_;  // names by number
};

}  // namespace ocm::cli
