// limber-faults: injects the faults of the table into a simulated arm of each family of drives and
// prints the reactions.
#include <cstdio>

#include "common/config_error.h"
#include "common/program.h"
#include "qa/faults/fault_report.h"

using namespace limber;

int main(int argc, char** argv) {
  CommandLine line("limber-faults",
                   "Injects faults into simulated arms, in lock step on a wire with bit time, and "
                   "prints the driver's reactions as JSON.");
  faults::ReportOptions options;
  std::int64_t phases = options.phases;
  bool list = false;
  line.text("fault", &options.fault, "one fault by its name; all if there is none");
  line.integer("--phases", &phases, 1, 1000, "phases of the motion at which each fault begins");
  line.text("--place", &options.place, "only faults of the bus, controller or feedback");
  line.text("--family", &options.family, "only drives of this protocol");
  line.text("--traces", &options.traces, "folder for one candump log a run: PROTOCOL-PHASE.log");
  line.flag("--list", &list, "name the faults, inject none");
  return run_program(line, argc, argv, [&] {
    if (!options.traces.empty() && options.fault.empty())
      throw ConfigError("--traces needs a fault: the files of all would have the same names");
    options.phases = static_cast<int>(phases);
    const std::string text = list ? faults::list_json() : faults::report_json(options);
    std::fputs(text.c_str(), stdout);
    return kExitDone;
  });
}
