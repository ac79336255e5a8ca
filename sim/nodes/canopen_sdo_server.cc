#include "sim/nodes/canopen_sdo_server.h"

#include <algorithm>

namespace limber::sim {
namespace {

using canopen::ObjectId;
using canopen::SdoAbort;
using canopen::SdoKind;
using canopen::SdoMessage;

constexpr std::int64_t kPatience_ns = 1'000'000'000;

}  // namespace

bool CanopenSdoServer::receive(const CanFrame& request, std::int64_t now_ns,
                               CanFrame* answer) noexcept {
  SdoMessage message;
  if (!canopen::decode_sdo_request(request, node_, &message)) return false;
  last_ns_ = now_ns;
  if (message.kind == SdoKind::kAbort) {
    reset();
    return false;
  }
  *answer = canopen::encode_sdo_answer(work(message), node_);
  return true;
}

bool CanopenSdoServer::give_up(std::int64_t now_ns, CanFrame* abort) noexcept {
  if (direction_ == Direction::kNone || now_ns - last_ns_ <= kPatience_ns) return false;
  *abort = canopen::encode_sdo_answer(this->abort(object_, SdoAbort::kTimeout), node_);
  return true;
}

SdoMessage CanopenSdoServer::work(const SdoMessage& request) noexcept {
  switch (request.kind) {
    case SdoKind::kWrite:
      return write(request);
    case SdoKind::kRead:
      return read(request);
    case SdoKind::kStartWrite:
      return start_writing(request);
    case SdoKind::kWriteSegment:
      if (direction_ == Direction::kWriting) return store_segment(request);
      break;
    case SdoKind::kReadSegment:
      if (direction_ == Direction::kReading) return give_segment(request);
      break;
    default:
      break;
  }
  const bool segment =
      request.kind == SdoKind::kWriteSegment || request.kind == SdoKind::kReadSegment;
  return abort(segment ? object_ : request.object, SdoAbort::kUnknownCommand);
}

SdoMessage CanopenSdoServer::abort(ObjectId object, SdoAbort code) noexcept {
  reset();
  return {SdoKind::kAbort, object, static_cast<std::uint32_t>(code)};
}

SdoMessage CanopenSdoServer::write(const SdoMessage& request) noexcept {
  reset();
  DictionaryEntry* entry = dictionary_->find(request.object);
  if (entry == nullptr) return abort(request.object, dictionary_->absence(request.object));
  std::array<std::uint8_t, 4> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(request.value >> (8 * i));
  const std::size_t length =
      request.bytes > 0 ? request.bytes : std::min<std::size_t>(entry->length, bytes.size());
  if (const Refusal refusal = dictionary_->write(entry, {bytes.data(), length}))
    return abort(request.object, *refusal);
  return {SdoKind::kWrite, request.object};
}

SdoMessage CanopenSdoServer::read(const SdoMessage& request) noexcept {
  reset();
  const DictionaryEntry* entry = dictionary_->find(request.object);
  if (entry == nullptr) return abort(request.object, dictionary_->absence(request.object));
  object_ = request.object;
  at_ = 0;
  size_ = entry->length;
  toggle_ = false;
  buffer_ = entry->data;
  if (entry->length > 4) {
    direction_ = Direction::kReading;
    return {SdoKind::kStartRead, request.object, entry->length};
  }
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < entry->length; ++i)
    value |= static_cast<std::uint32_t>(entry->data[i]) << (8 * i);
  return {SdoKind::kRead, request.object, value, entry->length};
}

SdoMessage CanopenSdoServer::start_writing(const SdoMessage& request) noexcept {
  reset();
  const DictionaryEntry* entry = dictionary_->find(request.object);
  if (entry == nullptr) return abort(request.object, dictionary_->absence(request.object));
  if (entry->access == Access::kReadOnly) return abort(request.object, SdoAbort::kReadOnly);
  if (request.value > buffer_.size()) return abort(request.object, SdoAbort::kLength);
  direction_ = Direction::kWriting;
  object_ = request.object;
  at_ = 0;
  size_ = request.value;
  toggle_ = false;
  return {SdoKind::kWrite, request.object};
}

SdoMessage CanopenSdoServer::store_segment(const SdoMessage& request) noexcept {
  if (request.toggle != toggle_) return abort(object_, SdoAbort::kToggle);
  if (at_ + request.bytes > buffer_.size()) return abort(object_, SdoAbort::kLength);
  std::copy_n(request.segment.begin(), request.bytes, buffer_.begin() + static_cast<int>(at_));
  at_ += request.bytes;
  toggle_ = !toggle_;
  if (request.last) {
    const SdoMessage end = finish_writing();
    if (end.kind == SdoKind::kAbort) return end;
  }
  SdoMessage answer;
  answer.kind = SdoKind::kWriteSegment;
  answer.toggle = request.toggle;
  return answer;
}

SdoMessage CanopenSdoServer::finish_writing() noexcept {
  reset();
  if (size_ != 0 && at_ != size_) return abort(object_, SdoAbort::kLength);
  const Refusal refusal = dictionary_->write(dictionary_->find(object_), {buffer_.data(), at_});
  return refusal ? abort(object_, *refusal) : SdoMessage{SdoKind::kWrite, object_};
}

SdoMessage CanopenSdoServer::give_segment(const SdoMessage& request) noexcept {
  if (request.toggle != toggle_) return abort(object_, SdoAbort::kToggle);
  SdoMessage answer;
  answer.kind = SdoKind::kReadSegment;
  answer.toggle = request.toggle;
  answer.bytes = static_cast<std::uint8_t>(std::min(size_ - at_, answer.segment.size()));
  std::copy_n(buffer_.begin() + static_cast<int>(at_), answer.bytes, answer.segment.begin());
  at_ += answer.bytes;
  answer.last = at_ == size_;
  toggle_ = !toggle_;
  if (answer.last) reset();
  return answer;
}

}  // namespace limber::sim
