// Scenario files: read, or refused with a complaint. A timeline that was read is in order, and its
// gains and goals are finite or the loader would have said so.
#include "scenarios/loader/scenario.h"

#include <string>

#include "common/config_error.h"
#include "controller/laws/registry.h"
#include "tests/fuzz/support/arms.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/input_file.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const LoadedRobot arm = fuzz::load("tests/robots/data/arm");
  static const fuzz::InputFile file("scenario.yaml");
  file.write(fuzz::text_of(data, size));
  try {
    const Scenario scenario = load_scenario(file.path(), arm, &controller::law_catalog());
    fuzz::require_finite({scenario.duration_s, scenario.step_s}, "durations are finite");
    std::int64_t last_ns = 0;
    for (const TimedMessage& entry : scenario.timeline) {
      fuzz::require(entry.time_ns >= last_ns, "the timeline is in order");
      last_ns = entry.time_ns;
    }
  } catch (const ConfigError& error) {
    fuzz::require(*error.what() != '\0', "a refusal has words");
  }
  return 0;
}
