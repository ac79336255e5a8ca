// limber-record: the user plane into an LCM event log.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>
#include <string>

#include "common/clock.h"
#include "common/lcm_url.h"
#include "common/open_lcm.h"
#include "common/program.h"
#include "common/wait_readable.h"
#include "tools/record/recorder.h"

namespace {

/// What is under way when the user stops the recording still belongs to the run: it goes on until
/// the line has been quiet this long, or for `--tail`.
constexpr std::int64_t kQuiet_ns = 200'000'000;
constexpr double kTail_s = 5.0;

/// Longer than any message of limber's. LCM hands on sizes of broken datagrams as they come.
constexpr std::uint32_t kMostBytes = 1U << 20U;

struct Sink {
  limber::Recorder* recorder;
  std::int64_t last_ns = 0;
  std::int64_t ignored = 0;  // impossible sizes
  std::string failure;       // no exception may cross LCM's C code
};

void on_message(const lcm::ReceiveBuffer* buffer, const std::string& channel, Sink* sink) {
  if (buffer->data_size > kMostBytes) {
    if (sink->ignored++ == 0)
      spdlog::warn("a datagram on {} has an impossible size: left out", channel);
    return;
  }
  try {
    sink->recorder->write(buffer->recv_utime, channel, buffer->data,
                          static_cast<std::int32_t>(buffer->data_size));
  } catch (const std::exception& error) {
    sink->failure = error.what();
  }
  sink->last_ns = limber::monotonic_ns();
}

struct Options {
  std::string path;
  double duration_s = 0.0;
  double tail_s = kTail_s;
  double least_free_MB = limber::EventLog::kLeastFree_bytes / 1e6;
};

int record(const Options& given, const std::string& url) {
  const auto& stop = limber::stop_on_signals();
  limber::Recorder recorder(given.path, static_cast<std::int64_t>(given.least_free_MB * 1e6));
  const auto lcm = limber::open_lcm(url);
  Sink sink{&recorder, limber::monotonic_ns(), 0, {}};
  lcm->subscribeFunction(".*", on_message, &sink)->setQueueCapacity(0);
  spdlog::info("recording {} to {}", url, given.path);
  const std::int64_t start_ns = limber::monotonic_ns();
  const int descriptor = lcm->getFileno();
  std::int64_t stopped_ns = 0;
  while (true) {
    const std::int64_t now = limber::monotonic_ns();
    if (stopped_ns == 0 &&
        (stop != 0 || (given.duration_s > 0 && now - start_ns > given.duration_s * 1e9)))
      stopped_ns = now;
    if (stopped_ns != 0 &&
        (now - sink.last_ns > kQuiet_ns || now - stopped_ns > given.tail_s * 1e9))
      break;
    if (limber::wait_readable(std::span(&descriptor, 1), now + 50'000'000)) lcm->handle();
    if (!sink.failure.empty()) throw std::runtime_error(sink.failure);
  }
  recorder.close();
  std::printf("%s\n", recorder.report().c_str());
  return limber::kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  limber::CommandLine line(
      "limber-record",
      "Records every message of the user plane to an LCM event log, without dropping any.");
  Options given;
  line.text("--out", &given.path, "log file to write; compressed if it ends in .zst").required();
  line.number("--duration", &given.duration_s, 0.0, 1e6,
              "stop after this many seconds (default: on Ctrl-C)");
  line.number("--tail", &given.tail_s, 0.0, 60.0,
              "once stopped, record on until nothing comes, at most this many seconds");
  line.number("--least-free-MB", &given.least_free_MB, 0.0, 1e9,
              "stop when less than this is free on the disk");
  return limber::run_program(line, argc, argv,
                             [&] { return record(given, limber::user_plane_url()); });
}
