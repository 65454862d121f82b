#include "cli/serve/orders.hpp"

#include <sys/eventfd.h>
#include <unistd.h>
#include <utility>

namespace ocm::cli::serve {

Orders::Orders() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}

bool Orders::put(Order order) {
  const std::lock_guard lock{mutex_};
  if (orders_.size() >= most && order.kind != Order::Kind::gone) return false;
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
