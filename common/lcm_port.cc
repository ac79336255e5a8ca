#include "common/lcm_port.h"

#include <sys/socket.h>

#include <algorithm>

#include "common/open_files.h"
#include "common/receive_buffer.h"

namespace limber {

namespace {

/// In one call: a flood must not keep the loop here.
constexpr int kMostTaken = 128;

}  // namespace

LcmPort::LcmPort(const std::string& url, Use use)
    : url_(url),
      address_(parse_lcm_url(url)),
      sockets_(open_multicast("user plane " + url, address_.group, address_.ttl,
                              address_.receive_buffer_bytes.value_or(kReceiveBuffer_bytes))) {
  require_open_files();
  if (use == Use::kPublishOnly) {
    sockets_.receiver = FileDescriptor();
    return;
  }
  hear_only(url_, sockets_, {});
}

bool LcmPort::send(Bytes datagram) noexcept {
  const auto sent =
      sendto(sockets_.sender.get(), datagram.data(), datagram.size(), 0,
             reinterpret_cast<const sockaddr*>(&address_.group), sizeof address_.group);
  return sent == static_cast<ssize_t>(datagram.size());
}

void LcmPort::subscribe_bytes(std::string_view channel, int queue,
                              std::function<void(Bytes)> handler) {
  // What waits refers to the subscriptions, which move.
  first_ = count_ = 0;
  subscriptions_.push_back({channel, queue, std::move(handler)});
  waiting_.resize(waiting_.size() + static_cast<std::size_t>(queue));
  std::vector<std::string_view> channels;
  for (const Subscription& subscription : subscriptions_) channels.push_back(subscription.channel);
  hear_only(url_, sockets_, channels);
}

void LcmPort::handle_waiting(int most) noexcept {
  take_arrived();
  for (; most > 0 && count_ > 0; --most) {
    const Waiting& next = waiting_[first_];
    Subscription& subscription = *next.subscription;
    first_ = (first_ + 1) % waiting_.size();
    --count_;
    ++subscription.room;
    const Bytes message = std::span(next.bytes).first(next.size);
    keep(subscription.channel, message);
    subscription.handler(message);
  }
}

void LcmPort::take_arrived() noexcept {
  if (descriptor() < 0) return;
  for (int taken = 0; taken < kMostTaken; ++taken) {
    const auto size = recv(descriptor(), received_.data(), received_.size(), MSG_TRUNC);
    if (size < 0) return;
    const auto bytes = static_cast<std::size_t>(size);
    if (bytes <= received_.size()) {
      take(std::span(received_).first(bytes));
    } else {
      ++undecodable_;
    }
  }
}

void LcmPort::take(Bytes datagram) noexcept {
  const auto read = read_lcm_datagram(datagram);
  if (!read) return;
  const auto subscription =
      std::ranges::find(subscriptions_, read->channel, &Subscription::channel);
  if (subscription == subscriptions_.end()) return;
  if (read->message.size() > kMaxMessageBytes) {
    ++undecodable_;
    return;
  }
  if (subscription->room == 0) return;
  --subscription->room;
  Waiting& last = waiting_[(first_ + count_++) % waiting_.size()];
  last.subscription = &*subscription;
  last.size = read->message.size();
  std::ranges::copy(read->message, last.bytes.begin());
}

}  // namespace limber
