#include "common/program.h"

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>

#include "common/config_error.h"
#include "common/log_sink.h"

namespace limber {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) { stop_requested = 1; }

void start_log(const std::string& name) {
  spdlog::set_default_logger(
      std::make_shared<spdlog::logger>("", std::make_shared<LogSink>(STDERR_FILENO)));
  spdlog::set_pattern("%T.%e " + name + ": %v");
}

/// What was printed is where it should be; a full disk shows when the buffers are emptied.
void finish_output() {
  const bool flushed = std::fflush(stdout) == 0;
  if (flushed && std::ferror(stdout) == 0) return;
  if (!flushed && errno == EPIPE) return;  // the reader has seen enough
  throw std::runtime_error("standard output could not be written; is the disk full?");
}

int failed(const std::string& name, const std::exception& error, ExitCode code) {
  std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
  return code;
}

}  // namespace

const volatile std::sig_atomic_t& stop_on_signals() {
  struct sigaction action {};
  action.sa_handler = request_stop;  // no SA_RESTART
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return stop_requested;
}

int run_program(CommandLine& line, int argc, char** argv, const std::function<int()>& run) {
  umask(umask(0) | S_IWOTH);  // containers start with none: nobody else changes what is written
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a file at its size limit is a write error as others
  start_log(line.name());
  try {
    const int code = line.parse(argc, argv) ? run() : kExitDone;
    finish_output();
    return code;
  } catch (const ConfigError& error) {
    return failed(line.name(), error, kExitWrongInput);
  } catch (const std::exception& error) {
    return failed(line.name(), error, kExitFailed);
  }
}

}  // namespace limber
