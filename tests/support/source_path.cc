#include "tests/support/source_path.h"

namespace limber {

std::string source_path(const std::string& from_top) { return LIMBER_SOURCE_DIR "/" + from_top; }

}  // namespace limber
