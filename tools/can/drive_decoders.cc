// The list of drive decoders, and nothing else: docs/adding.md.
#include "tools/can/drive_decoders.h"

#include <array>

#include "robots/loader/protocols/drive_protocol.h"
#include "tools/can/canopen_decoder.h"
#include "tools/can/cubemars_decoder.h"
#include "tools/can/damiao_decoder.h"
#include "tools/can/moteus_decoder.h"
#include "tools/can/myactuator_decoder.h"
#include "tools/can/odrive_decoder.h"
#include "tools/can/robstride_decoder.h"

namespace limber::bus_tools {
namespace {

using Decoder = std::unique_ptr<FrameDecoder>;

constexpr std::array kDecoders = {
    DriveDecoders{
        .protocol = "damiao_mit",
        .make = [](const Motor& motor, const BusFacts&) -> Decoder {
          return std::make_unique<DamiaoDecoder>(motor);
        },
        .add_messages = add_damiao_messages,
        .add_network_messages = add_damiao_registers,
    },
    DriveDecoders{
        .protocol = "moteus",
        .make = [](const Motor& motor, const BusFacts&) -> Decoder {
          return std::make_unique<MoteusDecoder>(motor);
        },
        .add_messages = add_moteus_messages,
        .last = true,
    },
    DriveDecoders{
        .protocol = "cia402",
        .make = [](const Motor& motor, const BusFacts& bus) -> Decoder {
          return std::make_unique<CanopenDecoder>(motor, bus.fd, bus.period_s);
        },
        .add_messages = add_canopen_messages,
        .make_network = [](const std::vector<Motor>& motors) -> Decoder {
          return std::make_unique<CanopenNetworkDecoder>(motors);
        },
        .add_network_messages = add_canopen_network_messages,
    },
    DriveDecoders{
        .protocol = "robstride",
        .make = [](const Motor& motor, const BusFacts&) -> Decoder {
          return std::make_unique<RobstrideDecoder>(motor);
        },
        .add_messages = add_robstride_messages,
    },
    DriveDecoders{
        .protocol = "myactuator",
        .make = [](const Motor& motor, const BusFacts&) -> Decoder {
          return std::make_unique<MyactuatorDecoder>(motor);
        },
        .add_messages = add_myactuator_messages,
    },
    DriveDecoders{
        .protocol = "cubemars",
        .make = [](const Motor& motor, const BusFacts&) -> Decoder {
          return std::make_unique<CubemarsDecoder>(motor);
        },
        .add_messages = add_cubemars_messages,
    },
    DriveDecoders{
        .protocol = "odrive",
        .make = [](const Motor& motor, const BusFacts&) -> Decoder {
          return std::make_unique<OdriveDecoder>(motor);
        },
        .add_messages = add_odrive_messages,
    },
};

}  // namespace

const DriveDecoders& decoders_of(const DriveConfig& drive) {
  return row_of(kDecoders, *drive.protocol);
}

}  // namespace limber::bus_tools
