// A request changes what it names: each field alone, blocks of K_x, parts of period_cycles.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "controller/laws/registry.h"
#include "lcmtypes/gains_merge.h"
#include "lcmtypes/gains_table.h"
#include "robots/loader/load_robot.h"
#include "scenarios/loader/gains_yaml.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_gains_merge {
namespace {

using Message = compliance_gains_t;

// Every field at a value that no default has.
Message changed() {
  Message message = standard_gains();
  const auto fill = [&](auto& value) { value = 7; };
  for (const GainRow& row : gain_table()) {
    std::visit(
        [&](auto field) {
          if constexpr (!std::is_same_v<decltype(field), std::monostate>) {
            auto& value = message.*field;
            if constexpr (std::rank_v<std::remove_reference_t<decltype(value)>> == 2) {
              for (auto& line : value) {
                for (auto& entry : line) fill(entry);
              }
            } else if constexpr (std::is_array_v<std::remove_reference_t<decltype(value)>>) {
              for (auto& entry : value) fill(entry);
            } else {
              fill(value);
            }
          }
        },
        row.field);
  }
  return message;
}

// The bytes of everything but the names.
std::string bytes_of(Message message) {
  message.named.clear();
  message.num_named = 0;
  message.scope = 0;
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

Message merged(const Message& request) {
  Message present = standard_gains();
  merge_gains(request, &present);
  return present;
}

TEST(GainsMerge, AllOfTheFieldsOrThoseNamed) {
  Message request = changed();
  EXPECT_EQ(bytes_of(merged(request)), bytes_of(request));
  request.scope = Message::SCOPE_NAMED;
  EXPECT_EQ(bytes_of(merged(request)), bytes_of(standard_gains()));
  std::vector<std::string> seen;
  for (const GainRow& row : gain_table()) {
    if (row.key == std::string("period_cycles")) continue;
    request.named.clear();
    name_gain(row.key, &request);
    const Message present = merged(request);
    EXPECT_NE(bytes_of(present), bytes_of(standard_gains())) << row.key;
    for (const std::string& other : seen) EXPECT_NE(bytes_of(present), other) << row.key;
    seen.push_back(bytes_of(present));
    EXPECT_EQ(unknown_gain(request), nullptr) << row.key;
  }
  // Named together they are all.
  request.named.clear();
  for (const GainRow& row : gain_table()) name_gain(row.key, &request);
  for (const char* part : {"jacobian", "inertia", "coriolis", "stiffness", "damping"})
    name_gain(part_key("period_cycles", part).c_str(), &request);
  EXPECT_EQ(bytes_of(merged(request)), bytes_of(changed()));
}

TEST(GainsMerge, ABlockOfKxLeavesTheOtherAndClearsTheCoupling) {
  Message present = changed();
  Message request = standard_gains();
  request.scope = Message::SCOPE_NAMED;
  for (int i = 0; i < 3; ++i) request.K_x[i][i] = 300.0 + i;
  request.K_x[4][4] = 99.0;  // is not named
  name_gain("K_x_translation_N_per_m", &request);
  merge_gains(request, &present);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double here =
          i < 3 && j < 3 ? (i == j ? 300.0 + i : 0.0) : (i < 3 || j < 3 ? 0.0 : 7.0);
      EXPECT_EQ(present.K_x[i][j], here) << i << j;
    }
  }
  request.named = {"K_x_rotation_Nm_per_rad"};
  merge_gains(request, &present);
  EXPECT_EQ(present.K_x[0][0], 300.0);
  EXPECT_EQ(present.K_x[4][4], 99.0);
  EXPECT_EQ(present.K_x[4][5], 0.0);
}

TEST(GainsMerge, OnePartOfThePeriods) {
  Message request = changed();
  request.scope = Message::SCOPE_NAMED;
  name_gain("period_cycles.coriolis", &request);
  const Message present = merged(request);
  for (int term = 0; term < 5; ++term)
    EXPECT_EQ(present.period_cycles[term], term == Message::PERIOD_C ? 7 : 1);
}

TEST(GainsMerge, UnknownNamesAreFound) {
  for (const char* key : {"K_z", "", "period_cycles", "period_cycles.", "period_cycles.mass",
                          "damping_ratio.x", "law", "torque_gain"}) {
    Message request = changed();
    name_gain("K_x", &request);
    name_gain(key, &request);
    ASSERT_NE(unknown_gain(request), nullptr) << key;
    EXPECT_STREQ(unknown_gain(request), key);
  }
}

TEST(GainsMerge, AnEntryNamesWhatItHolds) {
  const LoadedRobot arm = load_robot(source_path("tests/robots/data/arm"));
  const auto read = [&](const std::string& text) {
    return read_gains_entry(YamlMap::from_text(text, "entry"), arm.robot,
                            controller::law_catalog());
  };
  const Message one = read(
      "{law: joint_pd, ramp_s: 1, damping_ratio: 0.5, K_x_rotation_Nm_per_rad: 9,"
      " period_cycles: {inertia: 4}, torque_gain: 0.5}");
  EXPECT_EQ(one.scope, +Message::SCOPE_NAMED);
  EXPECT_EQ(one.named, (std::vector<std::string>{"damping_ratio", "period_cycles.inertia",
                                                 "K_x_rotation_Nm_per_rad"}))
      << "law, ramp_s and parameters of single laws need no name";
  EXPECT_EQ(one.num_named, 3);
  EXPECT_EQ(unknown_gain(one), nullptr);
  EXPECT_EQ(read("{reset: true, damping_ratio: 0.5}").scope, +Message::SCOPE_ALL);
  EXPECT_EQ(read("{reset: false, damping_ratio: 0.5}").scope, +Message::SCOPE_NAMED);
}

}  // namespace
}  // namespace limber::test_gains_merge
