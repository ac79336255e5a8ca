#include "sim/nodes/canopen_errors.h"

#include <algorithm>

namespace limber::sim {
namespace {

canopen::Object history(int i) noexcept {
  return {{canopen::kErrorCount.id.index, static_cast<std::uint8_t>(i)}, 4};
}

}  // namespace

CanopenErrors::CanopenErrors(CanopenDictionary* dictionary) : dictionary_(dictionary) {
  dictionary_->add(canopen::kErrorRegister, ValueType::kU8, 0, Access::kReadOnly, Mapping::kYes);
  // Only a zero may be written: it empties the history.
  dictionary_->add_writable(canopen::kErrorCount, ValueType::kU8, 0, 0, 0);
  for (int i = 1; i <= kHistory; ++i)
    dictionary_->add(history(i), ValueType::kU32, 0, Access::kReadOnly, Mapping::kNo);
}

bool CanopenErrors::raise(std::uint16_t code, std::uint8_t register_bit,
                          canopen::Emergency* message) noexcept {
  const auto present = errors_.begin() + count_;
  const auto same = [code](const Error& error) { return error.code == code; };
  if (count_ == kMost || std::any_of(errors_.begin(), present, same)) return false;
  errors_[static_cast<std::size_t>(count_++)] = {code, register_bit};
  for (int i = kHistory; i > 1; --i)
    dictionary_->set(history(i), dictionary_->value(history(i - 1)));
  dictionary_->set(history(1), code);
  dictionary_->set(canopen::kErrorCount,
                   std::min(dictionary_->value(canopen::kErrorCount) + 1.0, double{kHistory}));
  *message = {code, error_register(), {}};
  return true;
}

bool CanopenErrors::clear(std::uint16_t code, canopen::Emergency* message) noexcept {
  const auto present = errors_.begin() + count_;
  const auto kept = std::remove_if(errors_.begin(), present,
                                   [code](const Error& error) { return error.code == code; });
  if (kept == present) return false;
  count_ = static_cast<int>(kept - errors_.begin());
  return all_gone(message);
}

bool CanopenErrors::clear_all(canopen::Emergency* message) noexcept {
  if (count_ == 0) return false;
  count_ = 0;
  return all_gone(message);
}

bool CanopenErrors::all_gone(canopen::Emergency* message) noexcept {
  *message = {0, error_register(), {}};
  return count_ == 0;
}

std::uint8_t CanopenErrors::error_register() noexcept {
  unsigned bits = 0;
  for (int i = 0; i < count_; ++i)
    bits |= errors_[static_cast<std::size_t>(i)].register_bit | canopen::kErrorGeneric;
  dictionary_->set(canopen::kErrorRegister, bits);
  return static_cast<std::uint8_t>(bits);
}

void CanopenErrors::forget_history() noexcept {
  for (int i = 1; i <= kHistory; ++i) dictionary_->set(history(i), 0.0);
}

}  // namespace limber::sim
