#include "cli/serve/orders.hpp"

#include <algorithm>
#include <sys/eventfd.h>
#include <unistd.h>
#include <utility>

namespace ocm::cli::serve {

Orders::Orders() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

bool Orders::put(Order order) {
  const std::lock_guard lock{mutex_};
  const auto is_first = [&] {
    return std::none_of(orders_.begin(), orders_.end(),
                        [&](const Order& each) { return each.viewer == order.viewer; });
  };
  if (orders_.size() >= most && order.kind != Order::Kind::gone && !is_first()) return false;
  orders_.push_back(std::move(order));
  const std::uint64_t one = 1;
  // It fails only where it is readable already.
  [[maybe_unused]] const auto written = ::write(event_.get(), &one, sizeof one);
  return true;
}

std::vector<Order> Orders::take() {
  const std::lock_guard lock{mutex_};
  std::uint64_t count = 0;
  [[maybe_unused]] const auto read = ::read(event_.get(), &count, sizeof count);
  return std::exchange(orders_, {});
}

}  // namespace ocm::cli::serve
