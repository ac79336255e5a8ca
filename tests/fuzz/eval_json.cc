// Cases of limber-eval: an answer without NaN that can be written as JSON, or a refusal.
#include "common/config_error.h"
#include "lecture/eval/evaluate.h"
#include "tests/fuzz/support/fuzz_input.h"
#include "tests/fuzz/support/require.h"
#include "tests/support/source_path.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static eval::Arms arms(source_path("robots/planar2r"));
  try {
    const eval::Json outputs =
        eval::evaluate(eval::parse(std::string(fuzz::text_of(data, size))), &arms);
    const std::string text = outputs.dump();
    fuzz::require(!text.empty(), "an answer has a text");
  } catch (const ConfigError& error) {
    fuzz::require(*error.what() != '\0', "a refusal has words");
  }
  return 0;
}
