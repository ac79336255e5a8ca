// Reading good YAML, and refusing what would be read wrongly.
#include "common/parse_number.h"
#include "common/suggest.h"
#include "common/yaml_reader.h"
#include "tests/support/mutation.h"

namespace limber::test_yaml_reader {
namespace {

YamlMap read(const std::string& text) { return YamlMap::from_text(text, "f.yaml"); }

TEST(YamlReader, ReadsEveryKind) {
  const YamlMap yaml = read(
      "speed: -1.5e-3\ncount: 7\nflag: true\nname: \"a: b\"\nword: two\nlist: [1, 2, 3]\nsingle: "
      "4\nrows: [[1, 2], [3, 4]]\ninner: {x: 1}\nmany:\n  - {x: 2}\n  - {x: 3}\n");
  EXPECT_EQ(yaml.number("speed", {-1.0, 1.0}), -1.5e-3);
  EXPECT_EQ(yaml.number_or("absent", {0.0, 1.0}, 0.25), 0.25);
  EXPECT_EQ(yaml.integer("count", 0, 10), 7);
  EXPECT_EQ(yaml.integer_or("absent", 0, 10, 3), 3);
  EXPECT_TRUE(yaml.boolean_or("flag", false));
  EXPECT_TRUE(yaml.boolean_or("absent", true));
  EXPECT_EQ(yaml.text("name"), "a: b");
  EXPECT_EQ(yaml.text_or("absent", "x"), "x");
  EXPECT_EQ(yaml.word("word", {"one", "two"}), "two");
  EXPECT_EQ(yaml.numbers("list", 3, {0.0, 5.0}), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(yaml.numbers("single", 2, {0.0, 5.0}, true), (std::vector<double>{4, 4}));
  EXPECT_EQ(yaml.matrix("rows", 2, 2, {0.0, 5.0}), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(yaml.map("inner").integer("x", 0, 9), 1);
  EXPECT_EQ(yaml.maps("many")[1].integer("x", 0, 9), 3);
  EXPECT_EQ(yaml.line_of("count"), 2);
  EXPECT_EQ(yaml.line_of("many"), 10);
  EXPECT_NO_THROW(yaml.finish());
}

TEST(YamlReader, AMissingValueIsNamedOnItsOwnLine) {
  const YamlMap yaml = read("a:\n\n\nb: 1\n");
  EXPECT_EQ(testing::complaint_of([&] { yaml.text("a"); }),
            "f.yaml:1: a: found nothing; expected text");
}

TEST(YamlReader, KeysKeepTheOrderOfTheFile) {
  const YamlMap yaml = read("zebra: 1\nant: 2\n");
  EXPECT_EQ(yaml.keys(), (std::vector<std::string>{"zebra", "ant"}));
  EXPECT_NO_THROW(yaml.finish());
}

TEST(YamlReader, FinishNamesTheKeyNobodyAskedFor) {
  const YamlMap yaml = read("inner:\n  torque_Nm: 1\n  torqe_rate: 2\n");
  const YamlMap inner = yaml.map("inner");
  inner.number("torque_Nm", {0.0, 1.0});
  inner.has("torque_rate");
  const std::string complaint = testing::complaint_of([&] { inner.finish(); });
  EXPECT_EQ(complaint,
            "f.yaml:3: inner: unknown key 'torqe_rate'; did you mean 'torque_rate'? allowed here: "
            "torque_Nm, torque_rate");
}

TEST(YamlReader, RangesIncludeTheirEndsOnly) {
  const YamlMap yaml = read("a: 1\nb: 1.0000001\n");
  EXPECT_EQ(yaml.number("a", {0.0, 1.0}), 1.0);
  EXPECT_EQ(testing::complaint_of([&] {
              yaml.number("b", {0.0, 1.0});
            }),
            "f.yaml:2: b: '1.0000001' is out of range; expected a number from 0 to 1");
}

TEST(YamlReader, NumbersAreDecimalAndWhole) {
  for (const char* good : {"1", "-0.5", "+2", "1e3", "1E-3", ".5", "5."})
    EXPECT_TRUE(parse_number(good)) << good;
  for (const char* bad : {"", " 1", "1 ", "1,5", "1.2.3", "0x10", "nan", "inf", ".inf", "1e999",
                          "+-1", "1_000", "1:30", "12kg", "--1", "e5", "1e", "١"})
    EXPECT_FALSE(parse_number(bad)) << bad;
}

TEST(YamlReader, RefusesTextsThatAreNoMapping) {
  for (const char* text : {"", "   \n", "# only a comment\n", "just text", "- a\n- b\n", "~",
                           "[1, 2]", "a: [1, 2", "a: b: c", "{a: 1, a: 2}", "? [x]\n: 1\n",
                           "a: 'open", "%YAML 9.9\n%TAG\n---\na: 1", "a: 1\n...\n---\nb: 2\n"}) {
    const std::string complaint = testing::complaint_of([&] { read(text); });
    EXPECT_EQ(complaint.rfind("f.yaml", 0), 0u) << text << "\n" << complaint;
  }
}

TEST(YamlReader, RefusesAnchorsBeforeTheyUnfold) {
  std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string from = "*a" + std::to_string(i - 1);
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + from;
    for (int j = 0; j < 8; ++j) bomb += ", " + from;
    bomb += "]\n";
  }
  EXPECT_NE(testing::complaint_of([&] { read(bomb); }).find("f.yaml:1: anchors"),
            std::string::npos);
}

TEST(YamlReader, RefusesDeepNesting) {
  const std::string deep = "a: " + std::string(100, '[') + std::string(100, ']');
  const std::string complaint = testing::complaint_of([&] { read(deep); });
  EXPECT_NE(complaint.find("f.yaml:1: nested too deeply"), std::string::npos) << complaint;
  testing::complaint_of([&] { read("a: " + std::string(100'000, '[')); });
  testing::complaint_of([&] { read("a: " + std::string(100'000, '{')); });
  const std::string maps = "{a: {a: {a: {a: {a: {a: {a: {a: {a: {a: {a: {a: 1}}}}}}}}}}}}";
  EXPECT_NO_THROW(read(maps));
  EXPECT_THROW(read("{a: " + maps + "}"), ConfigError);
}

TEST(YamlReader, RefusesFilesThatAreTooBigMissingOrNoText) {
  const testing::TemporaryFolder folder;
  const std::string big = folder.write("big.yaml", "a: 1 #" + std::string(1 << 20, 'x'));
  EXPECT_NE(testing::complaint_of([&] { YamlMap::from_file(big); }).find("larger than 1 MiB"),
            std::string::npos);
  EXPECT_NE(
      testing::complaint_of([&] { YamlMap::from_file("/nowhere.yaml"); }).find("no such file"),
      std::string::npos);
  EXPECT_NE(testing::complaint_of([&] { YamlMap::from_file(folder.path()); }).find("no such file"),
            std::string::npos);
  testing::complaint_of([] { read(std::string("a: 1\0", 5)); });
}

TEST(YamlReader, WholeNumbersMayBeHexadecimal) {
  const YamlMap yaml = YamlMap::from_text("a: 0x1F\nb: 0x\nc: 0x-1\nd: 0xG\n", "ids.yaml");
  EXPECT_EQ(yaml.integer("a", 0, 100), 31);
  for (const char* key : {"b", "c", "d"}) EXPECT_THROW(yaml.integer(key, -10, 100), ConfigError);
}

TEST(Suggest, FindsSlipsAndNothingElse) {
  const std::vector<std::string> words = {"hold", "active", "acknowledge"};
  EXPECT_EQ(nearest_word("hlod", words), "hold");
  EXPECT_EQ(nearest_word("Active", words), "active");
  EXPECT_EQ(nearest_word("aknowledge", words), "acknowledge");
  EXPECT_EQ(nearest_word("banana", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("x", {}), "");
  EXPECT_EQ(nearest_word("K_x_translation", {"K_q_Nm_per_rad", "K_x_translation_N_per_m"}),
            "K_x_translation_N_per_m");
  EXPECT_EQ(nearest_word("timeout_seconds_long", {"timeout"}), "timeout");
  EXPECT_EQ(nearest_word("timeouts_everywhere", {"timeout"}), "");
  EXPECT_EQ(nearest_word("K_x_translation", {"K_x", "K_x_translation_N_per_m"}),
            "K_x_translation_N_per_m")
      << "a missing unit comes before a shorter key";
  const std::vector<std::string> laws = {"joint_impedance", "cartesian_impedance"};
  EXPECT_EQ(nearest_word("cartesian", laws), "cartesian_impedance");
  EXPECT_EQ(nearest_word("impedance", laws), "") << "of two, neither is meant more";
}

TEST(YamlReader, TabsAreNamed) {
  const auto read = [] { YamlMap::from_text("a:\n  b: 1\n\tc: 2\n", "tabs.yaml"); };
  EXPECT_NE(testing::complaint_of(read).find("tabs.yaml:3: not valid YAML"), std::string::npos);
  EXPECT_NE(testing::complaint_of(read).find("holds a tab"), std::string::npos);
}

}  // namespace
}  // namespace limber::test_yaml_reader
