#include "sim/nodes/canopen_pdos.h"

namespace limber::sim {

void CanopenPdos::load(CanopenPdoRecords* records) noexcept {
  for (std::size_t k = 0; k < kPdos; ++k) {
    rpdo_settings_[k] = records->rpdo(static_cast<int>(k));
    tpdo_settings_[k] = records->tpdo(static_cast<int>(k));
  }
}

void CanopenPdos::restart() noexcept {
  rpdos_.fill({});
  tpdos_.fill({});
}

// --- RPDOs ---------------------------------------------------------------------------------------

CanopenPdos::Heard CanopenPdos::receive(const CanFrame& frame, std::int64_t now_ns) noexcept {
  Heard heard = Heard::kNothing;
  for (std::size_t k = 0; k < kPdos; ++k) {
    const PdoSettings& pdo = rpdo_settings_[k];
    if (!pdo.enabled || !has_id(frame, pdo.id)) continue;
    if (frame.length < pdo.bytes) return Heard::kTooShort;
    const bool synchronous = pdo.type <= canopen::kLastSynchronousType;
    rpdos_[k] = {synchronous, true, now_ns, frame};
    if (!synchronous) unpack(pdo, frame);
    heard = Heard::kTaken;
  }
  return heard;
}

void CanopenPdos::apply() noexcept {
  for (std::size_t k = 0; k < kPdos; ++k) {
    if (rpdos_[k].waiting) unpack(rpdo_settings_[k], rpdos_[k].frame);
    rpdos_[k].waiting = false;
  }
}

void CanopenPdos::unpack(const PdoSettings& pdo, const CanFrame& frame) noexcept {
  std::size_t at = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pdo.count); ++i) {
    const auto bytes = static_cast<std::size_t>(mapped_length(pdo.mapped[i]));
    DictionaryEntry* object = dictionary_->find(mapped_object(pdo.mapped[i]));
    // A dummy has no entry; a value that the dictionary refuses changes nothing.
    if (object != nullptr)
      static_cast<void>(dictionary_->write(object, {frame.data.data() + at, bytes}));
    at += bytes;
  }
}

bool CanopenPdos::timed_out(std::int64_t now_ns) noexcept {
  bool timed_out = false;
  for (std::size_t k = 0; k < kPdos; ++k) {
    const std::int64_t patience_ns = rpdo_settings_[k].timer_ns;
    Rpdo& rpdo = rpdos_[k];
    if (!rpdo.watched || patience_ns == 0 || now_ns - rpdo.heard_ns <= patience_ns) continue;
    rpdo.watched = false;
    timed_out = true;
  }
  return timed_out;
}

// --- TPDOs ---------------------------------------------------------------------------------------

CanFrame CanopenPdos::pack(const PdoSettings& pdo) noexcept {
  canopen::FieldWriter fields(pdo.id, fd_ && pdo.bytes > kClassicBytes);
  for (std::size_t i = 0; i < static_cast<std::size_t>(pdo.count); ++i) {
    const DictionaryEntry* object = dictionary_->find(mapped_object(pdo.mapped[i]));
    for (const std::uint8_t byte : object->bytes()) fields.put(byte, 1);
  }
  return fields.frame();
}

bool CanopenPdos::changed(int k, const CanFrame& frame) const noexcept {
  const Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  return !tpdo.sent || frame.length != tpdo.frame.length || frame.data != tpdo.frame.data;
}

bool CanopenPdos::due_at_sync(int k, CanFrame* frame) noexcept {
  const PdoSettings& pdo = tpdo_settings_[static_cast<std::size_t>(k)];
  if (!pdo.enabled || pdo.type > canopen::kLastSynchronousType) return false;
  Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  if (pdo.type > 0 && ++tpdo.syncs < pdo.type) return false;
  *frame = pack(pdo);
  if (pdo.type == 0 && !changed(k, *frame)) return false;
  tpdo = {true, 0, 0, *frame};
  return true;
}

bool CanopenPdos::awaits_event(int k) const noexcept {
  const PdoSettings& pdo = tpdo_settings_[static_cast<std::size_t>(k)];
  return pdo.enabled && pdo.type >= kOnEvent;
}

bool CanopenPdos::due_on_event(int k, std::int64_t now_ns, CanFrame* frame) noexcept {
  const PdoSettings& pdo = tpdo_settings_[static_cast<std::size_t>(k)];
  Tpdo& tpdo = tpdos_[static_cast<std::size_t>(k)];
  const std::int64_t passed_ns = now_ns - tpdo.sent_ns;
  if (tpdo.sent && passed_ns < pdo.inhibit_ns) return false;
  *frame = pack(pdo);
  const bool timer_off = pdo.timer_ns > 0 && passed_ns >= pdo.timer_ns;
  if (!changed(k, *frame) && !timer_off) return false;
  tpdo = {true, 0, now_ns, *frame};
  return true;
}

}  // namespace limber::sim
