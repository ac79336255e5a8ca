// limber-faults: injects every fault of the table into a simulated arm of each family of drives and
// prints the driver's reactions.
#include <cstdio>

#include "common/program.h"
#include "faults/fault_report.h"

using namespace limber;

int main(int argc, char** argv) {
  CommandLine line("limber-faults",
                   "Injects faults into simulated arms, in lock step on a wire with bit time, and "
                   "prints the driver's reactions as JSON.");
  std::string name;
  std::int64_t phases = 3;
  line.text("fault", &name, "one fault by its name; all if there is none");
  line.integer("--phases", &phases, 1, 100, "phases of the motion at which each fault begins");
  return run_program(line, argc, argv, [&] {
    std::fputs(faults::report_json(static_cast<int>(phases), name).c_str(), stdout);
    return kExitDone;
  });
}
