// What all programs of limber share: exit codes, the log, the end.
#pragma once

#include <csignal>
#include <functional>

#include "common/command_line.h"
#include "common/public.h"

/// `int main(int argc, char** argv)` of limber-NAME. liblimber.so has all of them, each under its
/// own name, for the launchers of cmake/limber_install.cmake.
#ifdef LIMBER_IN_LIBRARY
#define LIMBER_MAIN(name)                                                   \
  extern "C" LIMBER_PUBLIC int limber_##name##_main(int argc, char** argv); \
  int limber_##name##_main(int argc, char** argv)
#else
#define LIMBER_MAIN(name) int main(int argc, char** argv)
#endif

namespace limber {

/// Exit codes of all programs.
enum ExitCode : int {
  kExitDone = 0,
  kExitWrongInput = 2,  ///< arguments, files, set-up: ConfigError
  kExitFailed = 3,      ///< at run time: a full disk, motors or controller silent, ...
};

/// Reads the command line and calls `run`, which returns an exit code. What either throws is
/// printed as "limber-NAME: ..." on the standard error output and becomes an exit code. The log of
/// spdlog goes there too, each line with time and name. A pipe whose reader is gone is no reason to
/// die.
int run_program(CommandLine& line, int argc, char** argv, const std::function<int()>& run);

/// From now on SIGINT and SIGTERM only set the flag that is returned: the one who calls this ends
/// in order when it is not 0. A wait in progress returns.
const volatile std::sig_atomic_t& stop_on_signals();

}  // namespace limber
