// TICK and TOCK: a frame is at most one of them, and its number is the one that was sent.
#include "drivers/can/lockstep_frame.h"

#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::FuzzInput input(data, size);
  while (!input.empty()) {
    const CanFrame frame = input.frame();
    const bool tick = lockstep::is_tick(frame);
    const bool tock = lockstep::is_tock(frame);
    fuzz::require(!(tick && tock), "not both");
    if (!tick && !tock) continue;
    fuzz::require(frame.length == 8 && !frame.remote && !frame.error, "eight bytes of data");
    const std::int64_t number = lockstep::sequence(frame);
    const CanFrame again = tick ? lockstep::tick(number) : lockstep::tock(number);
    fuzz::require(again.id == frame.id && lockstep::sequence(again) == number, "the same number");
  }
  return 0;
}
