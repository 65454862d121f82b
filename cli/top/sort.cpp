#include "cli/top/sort.hpp"

namespace ocm::cli::top {

bool is_before(Sort sort, const bus_model::Row& a, const bus_model::Row& b) {
  constexpr base::Duration never = base::Duration::max();
  switch (sort) {
    case Sort::spec:
      break;
    case Sort::name:
      return a.name < b.name;
    case Sort::rate:
      return a.recent.rate_hz > b.recent.rate_hz;
    case Sort::jitter:
      return a.recent.jitter_ns > b.recent.jitter_ns;
    case Sort::age:
      return a.age.value_or(never) > b.age.value_or(never);
    case Sort::share:
      return a.share.value_or(0) > b.share.value_or(0);
    case Sort::changed:
      return a.unchanged.value_or(never) < b.unchanged.value_or(never);
    case Sort::count:
      return a.count > b.count;
  }
  return false;
}

}  // namespace ocm::cli::top
