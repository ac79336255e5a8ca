// limber-record: the user plane into an LCM event log.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "common/clock.h"
#include "common/lcm_url.h"
#include "common/program.h"
#include "common/realtime.h"
#include "common/wait_readable.h"
#include "tools/record/episode_marks.h"
#include "tools/record/lcm_listener.h"
#include "tools/record/recorder.h"

namespace {

/// What is under way when the user stops the recording still belongs to the run: it goes on until
/// the line has been quiet this long, or for `--tail`.
constexpr std::int64_t kQuiet_ns = 200'000'000;
constexpr double kTail_s = 5.0;

struct Options {
  std::string path;
  double duration_s = 0.0;
  double tail_s = kTail_s;
  double least_free_MB = limber::EventLog::kLeastFree_bytes / 1e6;
};

int record(const Options& given, const std::string& url) {
  const auto& stop = limber::stop_on_signals();
  limber::raise_priority(/*paced=*/true);  // a run in lock step beside other work waits for nobody
  limber::Recorder recorder(given.path, static_cast<std::int64_t>(given.least_free_MB * 1e6));
  limber::LcmListener listener(url);
  limber::EpisodeMarks marks(url);
  const auto write = [&](std::int64_t time_us, const limber::LcmDatagram& message) {
    recorder.write(time_us, message.channel, message.message);
    if (marks.take(message)) marks.wait_for(recorder.hurry());
  };
  spdlog::info("recording {} to {}", url, given.path);
  const std::int64_t start_ns = limber::monotonic_ns();
  std::int64_t stopped_ns = 0;
  const auto stored = [&](std::int64_t number) { return recorder.stored(number); };
  while (true) {
    marks.confirm(stored);
    const std::int64_t now = limber::monotonic_ns();
    if (stopped_ns == 0 &&
        (stop != 0 || (given.duration_s > 0 && now - start_ns > given.duration_s * 1e9)))
      stopped_ns = now;
    const auto ends = [&](std::int64_t time_ns) {
      return stopped_ns != 0 && time_ns - stopped_ns > given.tail_s * 1e9;
    };
    if (listener.take_batch(write) > 0) {
      // By its arrival: what waited when the user stopped the recording is written, however long
      // that takes.
      if (ends(listener.newest_ns())) break;
      continue;
    }
    const std::int64_t last_ns = std::max(start_ns, listener.newest_ns());
    if (ends(now) || (stopped_ns != 0 && now - last_ns > kQuiet_ns)) break;
    limber::wait_readable(listener.descriptor(), now + 50'000'000);
  }
  recorder.close();
  marks.confirm(stored);
  if (listener.incomplete() > 0) {
    spdlog::warn("{} messages in fragments did not come whole: left out", listener.incomplete());
  }
  std::printf("%s\n", recorder.report(listener.dropped()).c_str());
  return limber::kExitDone;
}

}  // namespace

LIMBER_MAIN(record) {
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
