// The list of drive families, and nothing else: docs/adding.md.
#include <array>

#include "drivers/families/cia402_family.h"
#include "drivers/families/cubemars_family.h"
#include "drivers/families/damiao_family.h"
#include "drivers/families/moteus_family.h"
#include "drivers/families/myactuator_family.h"
#include "drivers/families/odrive_family.h"
#include "drivers/families/robstride_family.h"
#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

struct Row {
  std::string_view protocol;
  DriveFamily (*make)(const JointConfig& joint, bool fd, double period_s);
};

constexpr std::array kFamilies = {
    Row{"damiao_mit",
        [](const JointConfig& joint, bool fd, double) -> DriveFamily {
          return {damiao_codec(joint, fd), damiao_startup(joint, fd), damiao_intruders(joint)};
        }},
    Row{"moteus",
        [](const JointConfig& joint, bool, double) -> DriveFamily {
          return {moteus_codec(joint), moteus_startup(joint), moteus_intruders(joint)};
        }},
    Row{"cia402",
        [](const JointConfig& joint, bool fd, double period_s) -> DriveFamily {
          return {cia402_codec(joint, fd), cia402_startup(joint, fd, period_s),
                  cia402_intruders(joint)};
        }},
    Row{"robstride",
        [](const JointConfig& joint, bool, double) -> DriveFamily {
          return {robstride_codec(joint), robstride_startup(joint), robstride_intruders(joint)};
        }},
    Row{"myactuator",
        [](const JointConfig& joint, bool, double period_s) -> DriveFamily {
          return {myactuator_codec(joint, period_s), myactuator_startup(joint),
                  myactuator_intruders(joint)};
        }},
    Row{"cubemars",
        [](const JointConfig& joint, bool, double) -> DriveFamily {
          return {cubemars_codec(joint), cubemars_startup(joint), cubemars_intruders(joint)};
        }},
    Row{"odrive",
        [](const JointConfig& joint, bool, double period_s) -> DriveFamily {
          return {odrive_codec(joint, period_s), odrive_startup(joint), odrive_intruders(joint)};
        }},
};

}  // namespace

DriveFamily make_drive_family(const JointConfig& joint, bool fd, double period_s) {
  return row_of(kFamilies, *joint.drive.protocol).make(joint, fd, period_s);
}

}  // namespace limber
