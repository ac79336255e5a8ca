// Datagrams of the virtual bus: what is understood is a frame that a bus could carry, and comes
// back the same when it is sent on.
#include "drivers/can/virtual_frame.h"

#include <array>

#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  CanFrame frame;
  if (!decode_datagram({data, size}, &frame)) return 0;
  fuzz::require(is_possible(frame), "a bus could carry what was understood");
  std::array<std::uint8_t, kLongestEncodedBytes> datagram{};
  const std::size_t written = encode_datagram(frame, datagram);
  fuzz::require(written <= datagram.size(), "a datagram fits");
  CanFrame again;
  fuzz::require(decode_datagram({datagram.data(), written}, &again), "our own datagram is read");
  fuzz::require(frame.id == again.id && frame.length == again.length && frame.fd == again.fd &&
                    frame.extended == again.extended && frame.remote == again.remote &&
                    frame.error == again.error && frame.bitrate_switch == again.bitrate_switch,
                "identifier, length and flags survive");
  for (std::size_t i = 0; !frame.remote && i < frame.length; ++i)
    fuzz::require(frame.data[i] == again.data[i], "data survive");
  return 0;
}
