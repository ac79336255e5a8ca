// The list of drive protocols, and nothing else: docs/adding.md.
#include <array>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {

extern const DriveProtocol kDamiaoMit;
extern const DriveProtocol kMoteus;
extern const DriveProtocol kCia402;
extern const DriveProtocol kRobstride;
extern const DriveProtocol kMyactuator;
extern const DriveProtocol kCubemars;
extern const DriveProtocol kOdrive;

std::span<const DriveProtocol* const> drive_protocols() noexcept {
  static constexpr std::array kAll = {
      &kDamiaoMit, &kMoteus, &kCia402, &kRobstride, &kMyactuator, &kCubemars, &kOdrive,
  };
  return kAll;
}

}  // namespace limber
