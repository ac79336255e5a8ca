// Lines of a candump log: what is read is a frame that a bus could carry, and reads the same when
// it is written again. The whole input as a file is read or refused with the line's number.
#include "drivers/can/candump_log.h"

#include "common/config_error.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/input_file.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::InputFile file("frames.log");
  file.write(fuzz::text_of(data, size));
  CandumpReader reader(file.path());
  try {
    for (LoggedFrame logged; reader.next(&logged);) {
      fuzz::require(is_possible(logged.frame), "a bus could carry what was read");
      const std::string line = to_candump(logged);
      LoggedFrame again;
      fuzz::require(from_candump(line, &again), "our own line is read");
      fuzz::require(to_candump(again) == line, "and written the same");
    }
  } catch (const ConfigError& error) {
    fuzz::require(std::string(error.what()).find("frames.log:") != std::string::npos,
                  "a refusal names file and line");
  }
  return 0;
}
