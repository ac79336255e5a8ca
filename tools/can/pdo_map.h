// What a CANopen node's PDOs carry, learnt from the writes that map them.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "drivers/protocols/canopen_sdo.h"

namespace limber::bus_tools {

struct MappedObject {
  canopen::ObjectId id;
  int bits = 0;
};

struct Pdo {
  std::string name;      ///< RPDO1, TPDO2
  bool to_node = false;  ///< RPDO
  std::uint32_t cob_id = 0;
  bool used = false;  ///< its COB-ID is set and not switched off
  std::vector<MappedObject> objects;
};

class PdoMap {
 public:
  /// An object of the node was written; all but communication and mapping records are ignored.
  void note_write(canopen::ObjectId id, std::uint32_t value);

  /// nullptr if no PDO in use has this identifier.
  const Pdo* find(std::uint32_t cob_id) const;
  /// Those in use, RPDOs first.
  std::vector<Pdo> used() const;

 private:
  struct Record {
    std::optional<std::uint32_t> cob_id;
    std::uint8_t count = 0;
    std::map<std::uint8_t, std::uint32_t> mapping;
  };
  void update(std::uint32_t number);

  std::map<std::uint32_t, Record> records_;  // RPDOs from 0, TPDOs from 0x200
  std::map<std::uint32_t, Pdo> pdos_;
};

}  // namespace limber::bus_tools
