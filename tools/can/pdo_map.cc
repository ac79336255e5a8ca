#include "tools/can/pdo_map.h"

namespace limber::bus_tools {
namespace {

constexpr std::uint32_t kRecordsEach = 0x200;
constexpr std::uint32_t kTpdos = kRecordsEach;
constexpr std::uint32_t kIdBits = 0x1FFFFFFF;

/// Number of the record that starts at `first`; nothing if the index lies in none of them.
std::optional<std::uint32_t> record_number(std::uint16_t index, std::uint16_t first,
                                           std::uint32_t offset) {
  if (index < first || index >= first + kRecordsEach) return std::nullopt;
  return index - first + offset;
}

}  // namespace

void PdoMap::note_write(canopen::ObjectId id, std::uint32_t value) {
  for (const auto& [first, offset] : {std::pair{canopen::kRpdoCommunication, 0U},
                                      std::pair{canopen::kTpdoCommunication, kTpdos}}) {
    const auto number = record_number(id.index, first, offset);
    if (!number || id.sub != 1) continue;
    records_[*number].cob_id = value;
    update(*number);
  }
  for (const auto& [first, offset] :
       {std::pair{canopen::kRpdoMapping, 0U}, std::pair{canopen::kTpdoMapping, kTpdos}}) {
    const auto number = record_number(id.index, first, offset);
    if (!number) continue;
    if (id.sub == 0)
      records_[*number].count = static_cast<std::uint8_t>(value);
    else
      records_[*number].mapping[id.sub] = value;
    update(*number);
  }
}

void PdoMap::update(std::uint32_t number) {
  const Record& record = records_[number];
  Pdo& pdo = pdos_[number];
  pdo = {};
  pdo.to_node = number < kTpdos;
  pdo.name = (pdo.to_node ? "RPDO" : "TPDO") + std::to_string(number % kRecordsEach + 1);
  pdo.used = record.cob_id && (*record.cob_id & canopen::kPdoDisabled) == 0;
  pdo.cob_id = record.cob_id.value_or(0) & kIdBits;
  for (unsigned i = 1; i <= record.count; ++i) {
    const auto entry = record.mapping.find(static_cast<std::uint8_t>(i));
    if (entry == record.mapping.end()) break;
    const std::uint32_t value = entry->second;
    pdo.objects.push_back(
        {{static_cast<std::uint16_t>(value >> 16U), static_cast<std::uint8_t>(value >> 8U)},
         static_cast<int>(value & 0xFFU)});
  }
}

const Pdo* PdoMap::find(std::uint32_t cob_id) const {
  for (const auto& [number, pdo] : pdos_) {
    if (pdo.used && pdo.cob_id == cob_id) return &pdo;
  }
  return nullptr;
}

std::vector<Pdo> PdoMap::used() const {
  std::vector<Pdo> used;
  for (const auto& [number, pdo] : pdos_) {
    if (pdo.used) used.push_back(pdo);
  }
  return used;
}

}  // namespace limber::bus_tools
