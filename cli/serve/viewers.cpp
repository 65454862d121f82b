#include "cli/serve/viewers.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "ocm/client/counted.hpp"

namespace ocm::cli::serve {
namespace {

/// Texts that wait for one viewer: answers to what it asks, which it reads before it asks much more.
constexpr std::size_t most_texts = 64;
/// From one word about a loss to the next.
constexpr base::Duration loss_interval = std::chrono::seconds{1};

}  // namespace

Viewers::Viewers(std::size_t channels, QueueLimits limits)
    : limits_(limits), wanted_(channels), numbers_(channels), oldest_(channels), newest_(channels) {}

void Viewers::publish(std::uint32_t channel, std::uint64_t time_ns, std::string payload) {
  if (!wanted(channel)) return;
  auto kept = std::make_shared<const std::string>(std::move(payload));
  const std::lock_guard lock{mutex_};
  put(channel, time_ns, std::move(kept));
}

void Viewers::publish_state(std::uint32_t channel, std::uint64_t time_ns, std::string payload) {
  auto kept = std::make_shared<const std::string>(std::move(payload));
  const std::lock_guard lock{mutex_};
  newest_[channel] = Message{channel, 0, time_ns, kept};
  if (wanted(channel)) put(channel, time_ns, std::move(kept));
}

void Viewers::give(ViewerId viewer, std::uint32_t channel, std::uint64_t time_ns, std::string payload) {
  auto kept = std::make_shared<const std::string>(std::move(payload));
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return;
  const auto& subscribed = found->second.by_channel[channel];
  if (!subscribed || numbers_[channel] != subscribed->first) return;
  found->second.states.push_back(
      {subscribed->id, {true, foxglove::message_head(subscribed->id, time_ns), std::move(kept)}});
}

void Viewers::put(std::uint32_t channel, std::uint64_t time_ns, Payload payload) {
  bytes_ += payload->size();
  queue_.push_back({channel, numbers_[channel]++, time_ns, std::move(payload)});
  while (queue_.size() > 1 && (queue_.size() > limits_.messages || bytes_ > limits_.bytes)) {
    const Message& oldest = queue_.front();
    bytes_ -= oldest.payload->size();
    oldest_[oldest.channel] = oldest.number + 1;
    queue_.pop_front();
    ++first_;
  }
}

void Viewers::tell(ViewerId viewer, std::string text) {
  const auto kept = std::make_shared<const std::string>(std::move(text));
  const std::lock_guard lock{mutex_};
  if (viewer == 0) {
    for (auto& [id, each] : viewers_) tell(each, kept);
  } else if (const auto found = viewers_.find(viewer); found != viewers_.end()) {
    tell(found->second, kept);
  }
}

void Viewers::tell(Viewer& viewer, Payload text) {
  viewer.texts.push_back(std::move(text));
  if (viewer.texts.size() <= most_texts) return;
  viewer.texts.pop_front();
  ++viewer.lost;
  ++lost_;
}

ViewerId Viewers::add() {
  const std::lock_guard lock{mutex_};
  Viewer& viewer = viewers_[++last_id_];
  viewer.cursor = first_ + queue_.size();
  viewer.by_channel.resize(numbers_.size());
  return last_id_;
}

void Viewers::greet(ViewerId viewer, std::vector<std::string> texts) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return;
  for (auto text = texts.rbegin(); text != texts.rend(); ++text)
    found->second.texts.push_front(std::make_shared<const std::string>(std::move(*text)));
}

void Viewers::remove(ViewerId viewer) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return;
  settle(found->second);
  for (const auto& [id, channel] : found->second.channels) --wanted_[channel];
  viewers_.erase(found);
}

std::size_t Viewers::count() const {
  const std::lock_guard lock{mutex_};
  return viewers_.size();
}

std::string Viewers::subscribe(ViewerId viewer, foxglove::Subscription subscription) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return {};
  Viewer& to = found->second;
  const std::uint32_t channel = subscription.channel;
  if (channel >= numbers_.size()) return fmt::format("there is no channel {}", channel);
  if (to.by_channel[channel]) return fmt::format("channel {} is subscribed to already", channel);
  if (!to.channels.try_emplace(subscription.id, channel).second)
    return fmt::format("subscription {} is another one already", subscription.id);
  to.by_channel[channel] = Subscribed{subscription.id, numbers_[channel], numbers_[channel]};
  ++wanted_[channel];
  if (const auto& newest = newest_[channel])
    to.states.push_back(
        {subscription.id, {true, foxglove::message_head(subscription.id, newest->time_ns), newest->payload}});
  return {};
}

std::string Viewers::unsubscribe(ViewerId viewer, std::uint32_t subscription) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return {};
  const auto at = found->second.channels.find(subscription);
  if (at == found->second.channels.end()) return fmt::format("there is no subscription {}", subscription);
  settle(found->second, at->second);
  found->second.by_channel[at->second].reset();
  --wanted_[at->second];
  found->second.channels.erase(at);
  std::erase_if(found->second.states, [&](const auto& state) { return state.first == subscription; });
  return {};
}

void Viewers::settle(Viewer& viewer, std::uint32_t channel) {
  auto& subscribed = viewer.by_channel[channel];
  if (!subscribed || subscribed->next >= oldest_[channel]) return;
  viewer.lost += oldest_[channel] - subscribed->next;
  lost_ += oldest_[channel] - subscribed->next;
  subscribed->next = oldest_[channel];
}

void Viewers::settle(Viewer& viewer) {
  if (viewer.cursor >= first_) return;
  for (const auto& [id, channel] : viewer.channels) settle(viewer, channel);
  viewer.cursor = first_;
}

std::optional<Viewers::Outgoing> Viewers::word_of_loss(Viewer& viewer, base::Time now) {
  if (viewer.lost == viewer.told || (viewer.told != 0 && now - viewer.told_at < loss_interval)) return {};
  viewer.told = viewer.lost;
  viewer.told_at = now;
  const std::string text = fmt::format("this viewer is too slow for what it asks: it has lost {}",
                                       client::counted(viewer.lost, "message"));
  return Outgoing{
      false,
      {},
      std::make_shared<const std::string>(foxglove::status(foxglove::Level::warning, text, "loss"))};
}

std::optional<Viewers::Outgoing> Viewers::from_queue(Viewer& viewer) {
  settle(viewer);
  while (viewer.cursor < first_ + queue_.size()) {
    const Message& message = queue_[static_cast<std::size_t>(viewer.cursor++ - first_)];
    auto& subscribed = viewer.by_channel[message.channel];
    // What came before it subscribed, it has not lost.
    if (!subscribed || message.number < subscribed->next) continue;
    subscribed->next = message.number + 1;
    return Outgoing{true, foxglove::message_head(subscribed->id, message.time_ns), message.payload};
  }
  return {};
}

std::optional<Viewers::Outgoing> Viewers::next(ViewerId viewer, base::Time now) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return {};
  Viewer& to = found->second;
  if (!to.texts.empty()) {
    Payload text = std::move(to.texts.front());
    to.texts.pop_front();
    return Outgoing{false, {}, std::move(text)};
  }
  if (auto loss = word_of_loss(to, now)) return loss;
  if (!to.states.empty()) {
    Outgoing state = std::move(to.states.front().second);
    to.states.pop_front();
    return state;
  }
  auto message = from_queue(to);
  return message ? message : word_of_loss(to, now);
}

bool Viewers::has_next(ViewerId viewer) const {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  return found != viewers_.end() && has_next(found->second);
}

bool Viewers::has_next(const Viewer& of) const {
  return of.asked || !of.texts.empty() || !of.states.empty() || of.cursor < first_ + queue_.size();
}

bool Viewers::anything_waits() const {
  const std::lock_guard lock{mutex_};
  return std::any_of(viewers_.begin(), viewers_.end(),
                     [this](const auto& each) { return has_next(each.second); });
}

void Viewers::ask(ViewerId viewer) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found != viewers_.end()) found->second.asked = true;
}

bool Viewers::take_asked(ViewerId viewer) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  return found != viewers_.end() && std::exchange(found->second.asked, false);
}

void Viewers::hear(ViewerId viewer) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found != viewers_.end()) ++found->second.heard;
}

std::uint64_t Viewers::heard(ViewerId viewer) const {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  return found == viewers_.end() ? 0 : found->second.heard;
}

std::uint64_t Viewers::lost() {
  const std::lock_guard lock{mutex_};
  for (auto& [id, viewer] : viewers_) settle(viewer);
  return lost_;
}

std::uint64_t Viewers::lost(ViewerId viewer) {
  const std::lock_guard lock{mutex_};
  const auto found = viewers_.find(viewer);
  if (found == viewers_.end()) return 0;
  settle(found->second);
  return found->second.lost;
}

std::size_t Viewers::size() const {
  const std::lock_guard lock{mutex_};
  return bytes_;
}

}  // namespace ocm::cli::serve
