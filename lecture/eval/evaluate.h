// Cases in, outputs out.
#pragma once

#include <string>

#include "lecture/eval/arm.h"

namespace limber::eval {

/// Parses JSON text; a key that is given twice is refused. Throws ConfigError with line and column.
Json parse(const std::string& text);

/// The outputs of a case {"law", "robot", "in"}, or of each in a list of cases. Throws ConfigError
/// naming the case, the law and the key.
Json evaluate(const Json& document, Arms* arms);

}  // namespace limber::eval
