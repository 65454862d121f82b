#include "cli/simulate/cast.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "ocm/topics/amiro.hpp"

#include "cli/shared/messages.hpp"
#include "cli/shared/values.hpp"
#include "generator/spec/spec.hpp"

namespace ocm::cli::simulate {
namespace {

bool is_of_amiro(const protocol::Topic& topic) {
  const auto* own = amiro::catalogue.find(topic.name);
  return own != nullptr && own->id == topic.id && own->kind == topic.kind &&
         own->frames.size() == topic.frames.size();
}

}  // namespace

Cast cast_of(Session& session) {
  const bool plays_on_sim = session.bus_name.empty();
  const bool has_sim = std::any_of(session.spec_files.begin(), session.spec_files.end(),
                                   [](const std::string& word) { return word.starts_with("sim="); });
  const std::string bus = session.narrow_to_bus("sim", plays_on_sim && has_sim ? "sim" : session.bus_name);
  if (plays_on_sim && !has_sim && !bus.empty())
    remark(fmt::format("what --spec has for {} is played on the bus sim: for other verbs, --spec sim={}", bus,
                       session.spec_files.front()));
  if (session.spec_files.empty()) return Cast::amiro;
  bool messages = false;
  bool topics = false;
  bool foreign = false;
  for (const auto& topic : session.catalogue().topics) {
    messages = messages || topic.is_message();
    topics = topics || !topic.is_message();
    foreign = foreign || (!topic.is_message() && !is_of_amiro(topic));
  }
  // A spec with neither, such as a DBC file of nodes only, has nothing to say as a robot's either.
  if (!messages) return topics ? Cast::amiro : Cast::messages;
  if (foreign)
    remark(
        "only the messages of the spec are played: its topics are not the AMiRo's, and no other robot's "
        "boards are simulated");
  return topics && !foreign ? Cast::both : Cast::messages;
}

BitRates bit_rates(std::optional<std::uint32_t> typed, std::optional<std::uint32_t> typed_data,
                   std::uint32_t usual, Session& session, bool played) {
  const auto* const model = played ? &session.spec().model() : nullptr;
  const bool stated = model != nullptr && model->bit_rate != 0;
  const std::uint32_t nominal = typed.value_or(stated ? model->bit_rate : usual);
  if (typed_data) return {nominal, *typed_data};
  if (model != nullptr && model->data_bit_rate >= nominal) return {nominal, model->data_bit_rate};
  return {nominal, nominal <= fastest_simulated_bit_rate / 4 ? 4 * nominal : nominal};
}

}  // namespace ocm::cli::simulate
