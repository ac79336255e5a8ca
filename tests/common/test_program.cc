// What all programs share: options, refusals of arguments, exit codes, numbers of runs.
#include <gtest/gtest.h>

#include <csignal>
#include <stdexcept>

#include "common/config_error.h"
#include "common/program.h"
#include "common/run_id.h"

namespace limber::test_program {
namespace {

struct Given {
  std::string text;
  double number = 0.0;
  std::int64_t integer = 0;
  std::vector<double> numbers;
  std::map<std::string, std::string> buses;
  std::optional<Pace> pace;
  int priority = 80;
  bool flag = false;
};

int run(std::vector<std::string> arguments, Given* given, const std::function<int()>& body) {
  CommandLine line("limber-test", "A program of the tests.");
  line.text("--text", &given->text, "");
  line.number("--number", &given->number, 1.0, 10.0, "");
  line.integer("--integer", &given->integer, 1, 5, "");
  line.numbers("--numbers", &given->numbers, "").count(3);
  line.flag("--flag", &given->flag, "");
  line.buses(&given->buses);
  line.pace(&given->pace, "");
  line.priority(&given->priority);
  std::vector<char*> argv;
  std::string name = "limber-test";
  argv.push_back(name.data());
  for (std::string& argument : arguments) argv.push_back(argument.data());
  return run_program(line, static_cast<int>(argv.size()), argv.data(), body);
}

/// The exit code, and what went to the standard error output.
std::pair<int, std::string> refused(std::vector<std::string> arguments) {
  ::testing::internal::CaptureStderr();
  Given given;
  const int code = run(std::move(arguments), &given, [] { return 99; });
  return {code, ::testing::internal::GetCapturedStderr()};
}

TEST(Program, FillsInItsOptions) {
  Given given;
  EXPECT_EQ(run({"--text", "a b", "--number", "2.5", "--integer", "4", "--numbers", "0,0,-9.81",
                 "--bus", "a=virtual:x", "--bus", "b=socketcan:can0", "--lockstep"},
                &given, [] { return kExitDone; }),
            0);
  EXPECT_EQ(given.text, "a b");
  EXPECT_EQ(given.number, 2.5);
  EXPECT_EQ(given.integer, 4);
  EXPECT_EQ(given.numbers, (std::vector<double>{0.0, 0.0, -9.81}));
  EXPECT_EQ(given.buses,
            (std::map<std::string, std::string>{{"a", "virtual:x"}, {"b", "socketcan:can0"}}));
  EXPECT_EQ(given.pace, Pace::kLockstep);
  EXPECT_EQ(given.priority, 80);
  EXPECT_FALSE(given.flag);
}

TEST(Program, ThePaceIsOpenUntilSomebodyChooses) {
  Given given;
  run({}, &given, [] { return kExitDone; });
  EXPECT_FALSE(given.pace.has_value());
  run({"--realtime"}, &given, [] { return kExitDone; });
  EXPECT_EQ(given.pace, Pace::kRealtime);
  run({"--paced"}, &given, [] { return kExitDone; });
  EXPECT_EQ(given.pace, Pace::kPaced);
  EXPECT_EQ(refused({"--paced", "--lockstep"}).first, 2);
  EXPECT_EQ(refused({"--paced", "--realtime"}).first, 2);
}

TEST(Program, WrongArgumentsEndWithTwoAndOneLine) {
  for (const std::vector<std::string>& wrong :
       std::vector<std::vector<std::string>>{{"--number", "nan"},
                                             {"--number", "0.5"},
                                             {"--number", "inf"},
                                             {"--integer", "6"},
                                             {"--numbers", "1,2"},
                                             {"--bus", "virtual:x"},
                                             {"--bus", "=virtual:x"},
                                             {"--lockstep", "--realtime"},
                                             {"--realtime-priority", "100"},
                                             {"--unknown"},
                                             {"surplus"}}) {
    const auto [code, text] = refused(wrong);
    EXPECT_EQ(code, kExitWrongInput) << wrong[0];
    EXPECT_EQ(text.rfind("limber-test: ", 0), 0U) << text;
  }
}

TEST(Program, HelpIsNoError) {
  ::testing::internal::CaptureStdout();
  Given given;
  EXPECT_EQ(run({"--help"}, &given, [] { return 99; }), kExitDone);
  EXPECT_NE(::testing::internal::GetCapturedStdout().find("--realtime-priority"),
            std::string::npos);
}

TEST(Program, ErrorsBecomeExitCodes) {
  Given given;
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({}, &given, []() -> int { throw ConfigError("no such file"); }), 2);
  EXPECT_EQ(run({}, &given, []() -> int { throw std::runtime_error("disk full"); }), 3);
  EXPECT_EQ(run({}, &given, [] { return kExitFailed; }), 3);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "limber-test: no such file\nlimber-test: disk full\n");
}

TEST(Program, SignalsOnlySetTheFlag) {
  const volatile std::sig_atomic_t& stop = stop_on_signals();
  EXPECT_EQ(stop, 0);
  std::raise(SIGTERM);
  EXPECT_NE(stop, 0);
  std::signal(SIGTERM, SIG_DFL);
  std::signal(SIGINT, SIG_DFL);
}

TEST(RunId, IsOneInLockStepAndRandomOtherwise) {
  EXPECT_EQ(run_id(17, false), 17);
  EXPECT_EQ(run_id(17, true), 17);
  EXPECT_EQ(run_id(0, true), 1);
  const std::int64_t first = run_id(0, false);
  EXPECT_GT(first, 0);
  EXPECT_NE(first, run_id(0, false));
}

}  // namespace
}  // namespace limber::test_program
