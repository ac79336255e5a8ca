// The result of a soak as JSON.
#pragma once

#include <string>

#include "qa/soak/soak.h"

namespace limber::soak {

/// `wall_s`: how long it took. Names of faults and causes as in the messages, in lower case.
std::string report_json(const SoakResult& result, const Robot& robot, std::uint64_t seed,
                        double wall_s);

}  // namespace limber::soak
