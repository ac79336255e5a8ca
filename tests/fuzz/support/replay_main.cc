// A fuzz target without a fuzzer: every kept input, then mutations of them, the same ones every
// time. An input that fails is written down before the process ends.
#include <sanitizer/common_interface_defs.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "common/program.h"
#include "tests/fuzz/support/mutate.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// A finding of the undefined-behaviour sanitizer ends in SIGABRT, as the others do.
extern "C" const char* __ubsan_default_options() { return "abort_on_error=1:print_stacktrace=1"; }

namespace {

using limber::fuzz::Bytes;
namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> corpora;
  std::int64_t mutations = 0;
  std::int64_t seed = 1;
  std::string failure = "failed-input";
};

Bytes current;
std::string failure_file;

void keep_current() {
  if (std::FILE* file = std::fopen(failure_file.c_str(), "wb")) {
    std::fwrite(current.data(), 1, current.size(), file);
    std::fclose(file);
    std::fprintf(stderr, "fuzz: the input is in %s\n", failure_file.c_str());
  }
}

void on_abort(int) {
  keep_current();
  std::signal(SIGABRT, SIG_DFL);
}

void run_one(Bytes input) {
  current = std::move(input);
  LLVMFuzzerTestOneInput(current.data(), current.size());
}

std::vector<Bytes> read_corpora(const std::vector<std::string>& folders) {
  std::vector<fs::path> files;
  for (const std::string& folder : folders) {
    if (fs::is_regular_file(folder)) files.emplace_back(folder);
    if (!fs::is_directory(folder)) continue;
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) throw limber::ConfigError("no input in " + folders.at(0));
  std::vector<Bytes> inputs;
  for (const fs::path& file : files) {
    std::ifstream stream(file, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  }
  return inputs;
}

int run(const Arguments& given) {
  failure_file = given.failure;
  __sanitizer_set_death_callback(keep_current);
  std::signal(SIGABRT, on_abort);
  const std::vector<Bytes> kept = read_corpora(given.corpora);
  run_one({});
  for (const Bytes& input : kept) run_one(input);
  std::mt19937_64 random(static_cast<std::uint64_t>(given.seed));
  for (std::int64_t i = 0; i < given.mutations; ++i) {
    const Bytes& from = kept[random() % kept.size()];
    run_one(limber::fuzz::mutate(from, kept[random() % kept.size()], random));
  }
  std::printf("{\"kept\": %zu, \"mutations\": %lld}\n", kept.size(),
              static_cast<long long>(given.mutations));
  return limber::kExitDone;
}

}  // namespace

int main(int argc, char** argv) {
  limber::CommandLine line("fuzz", "Replays kept inputs of a fuzz target, and mutations of them.");
  Arguments given;
  line.texts("corpus", &given.corpora, "folders of inputs, or single ones").required();
  line.integer("--mutations", &given.mutations, 0, 1'000'000'000, "how many to try besides");
  line.integer("--seed", &given.seed, 0, 1'000'000'000, "of the mutations");
  line.text("--failure", &given.failure, "where the input goes that fails");
  return limber::run_program(line, argc, argv, [&] { return run(given); });
}
