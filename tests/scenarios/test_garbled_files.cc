// Files garbled at random are accepted or refused with a ConfigError; nothing else may happen.
#include <random>

#include "controller/laws/registry.h"
#include "scenarios/loader/scenario.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_garbled_files {
namespace {

constexpr int kRounds = 1000;
constexpr std::uint64_t kSeed = 20240229;

const std::string kArm = source_path("tests/robots/data/arm/");
const std::string kScenario = source_path("tests/scenarios/data/good.yaml");

/// Pieces that readers stumble over.
const std::string kPieces[] = {
    "nan", "-1", "1e999", "0",    "\"",    "<",  ">",   "<!--", "&#0;", "&lt;", "{",  "}",
    "[",   "]",  ":",     ",",    "\n",    "\t", "- ",  "&a ",  "*a",   "!!x",  "~",  "\\x00",
    "%",   "'",  "é",     "\xff", "<link", "/>", "---", "...",  "| ",   "> ",   "? ", "<<: "};

template <typename Generator>
std::string garble(const std::string& good, Generator& random) {
  const auto below = [&](std::size_t end) { return static_cast<std::size_t>(random() % end); };
  std::string text = good;
  for (std::size_t changes = 1 + below(4); changes > 0; --changes) {
    const std::size_t at = below(text.size());
    const std::size_t length = below(30);
    switch (below(4)) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, kPieces[below(std::size(kPieces))]);
        break;
      default:
        text.insert(at, text.substr(below(text.size()), length));
    }
  }
  return text;
}

template <typename Load>
void expect_nothing_worse_than_a_refusal(const std::string& good, Load load) {
  std::mt19937_64 random(kSeed);
  int refused = 0;
  for (int i = 0; i < kRounds; ++i) {
    try {
      load(garble(good, random));
    } catch (const ConfigError& error) {
      EXPECT_STRNE(error.what(), "");
      ++refused;
    }
  }
  // Both happen: a garbled comment is fine, a garbled number is not.
  EXPECT_GT(refused, kRounds / 10);
  EXPECT_LT(refused, kRounds);
}

TEST(GarbledFiles, Urdf) {
  const testing::TemporaryFolder folder;
  const double gravity[3] = {0.0, 0.0, -9.81};
  expect_nothing_worse_than_a_refusal(
      testing::read_text(kArm + "robot.urdf"), [&](const std::string& text) {
        load_urdf(folder.write("robot.urdf", text), "base", "hand", gravity);
      });
}

TEST(GarbledFiles, RobotYaml) {
  const testing::TemporaryFolder folder;
  folder.write("robot.urdf", testing::read_text(kArm + "robot.urdf"));
  expect_nothing_worse_than_a_refusal(testing::read_text(kArm + "robot.yaml"),
                                      [&](const std::string& text) {
                                        folder.write("robot.yaml", text);
                                        load_robot(folder.path());
                                      });
}

TEST(GarbledFiles, Scenario) {
  const testing::TemporaryFolder folder;
  const LoadedRobot robot = load_robot(kArm);
  expect_nothing_worse_than_a_refusal(testing::read_text(kScenario), [&](const std::string& text) {
    load_scenario(folder.write("scenario.yaml", text), robot, &controller::law_catalog());
  });
}

}  // namespace
}  // namespace limber::test_garbled_files
