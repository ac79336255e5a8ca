// `gains:` of a scenario's timeline, by the table of lcmtypes/gains_table.h.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "common/yaml_reader.h"
#include "lcmtypes/gains_table.h"
#include "robots/loader/robot.h"

namespace limber {

/// A request that changes what the entry names and nothing else; with `reset: true` all else goes
/// back to robot.yaml and the defaults. `K_x_translation_N_per_m` and `K_x_rotation_Nm_per_rad`
/// (one number or three) set their diagonal block and clear the coupling between translation and
/// rotation; `K_x` sets all of it. Set-up only.
compliance_gains_t read_gains_entry(const YamlMap& yaml, const Robot& robot,
                                    const LawCatalog& laws);

}  // namespace limber
