#include "cli/bus_model/models.hpp"

namespace ocm::cli::bus_model {

Model& Models::of(std::string_view name) {
  if (last_ < models_.size() && models_[last_].name == name) return models_[last_].model;
  for (last_ = 0; last_ < models_.size(); ++last_)
    if (models_[last_].name == name) return models_[last_].model;
  return models_.emplace_back(Named{std::string{name}, Model{*catalogue_, rates_.nominal, rates_.data, name}})
      .model;
}

void Models::until(base::Time now) {
  constexpr base::Duration longest = step * static_cast<std::int64_t>(Model::history_size);
  // A clock that was set, or a long pause: no more than a graph holds.
  if (!next_tick_ || *next_tick_ - now > step || now - *next_tick_ > longest) next_tick_ = now;
  for (; *next_tick_ <= now; *next_tick_ += step)
    for (Named& named : models_) named.model.tick();
}

bool Models::follow(std::size_t bus, const std::set<FieldKey>& fields) {
  bool any = false;
  for (const FieldKey& field : fields) any = models_[bus].model.follow(field) || any;
  return any;
}

std::vector<Bus> Models::buses() const {
  std::vector<Bus> buses;
  for (const Named& named : models_) buses.push_back({named.name, &named.model});
  return buses;
}

}  // namespace ocm::cli::bus_model
