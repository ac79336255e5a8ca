// limber-eval: the controller's laws as a calculator, JSON in and JSON out.
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

#include "common/config_error.h"
#include "common/program.h"
#include "lecture/eval/evaluate.h"
#include "lecture/eval/law_table.h"

using namespace limber;

namespace {

struct Arguments {
  std::string file = "-";
  std::string robot;
  std::string urdf;
  std::string base;
  std::string tip;
  std::vector<double> gravity;
  bool list = false;
};

std::string read_all(const std::string& file) {
  std::ifstream opened;
  if (file != "-") opened.open(file, std::ios::binary);
  std::istream& stream = file == "-" ? std::cin : opened;
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad() || (file != "-" && !opened.is_open()))
    throw ConfigError(file + ": cannot be read; expected a file with JSON");
  return text;
}

/// The arm of the command line, named as in a case; null if there is none.
eval::Json default_arm(const Arguments& arguments) {
  if (!arguments.robot.empty()) return arguments.robot;
  if (arguments.urdf.empty()) return nullptr;
  eval::Json arm = {{"urdf", arguments.urdf}, {"base", arguments.base}, {"tip", arguments.tip}};
  if (!arguments.gravity.empty()) arm["gravity"] = arguments.gravity;
  return arm;
}

/// One line for one case, one line a case for a list.
std::string text_of(const eval::Json& outputs) {
  if (!outputs.is_array()) return outputs.dump() + "\n";
  std::string text;
  for (const eval::Json& output : outputs) text += (text.empty() ? "" : ",\n") + output.dump();
  return "[" + text + "]\n";
}

std::string answer(const Arguments& arguments) {
  std::string text;
  if (arguments.list) {
    for (const eval::LawRow& law : eval::law_table()) text += std::string(law.name) + "\n";
    return text;
  }
  eval::Arms arms(default_arm(arguments));
  try {
    return text_of(eval::evaluate(eval::parse(read_all(arguments.file)), &arms));
  } catch (const ConfigError& error) {
    const std::string where = arguments.file == "-" ? "standard input" : arguments.file;
    throw ConfigError(where + ": " + error.what());
  }
}

void define(CommandLine& line, Arguments* given) {
  line.text(
      "file", &given->file,
      "a case {\"law\", \"robot\", \"in\"} or a list of them; '-' or nothing: standard input");
  auto robot = line.text("--robot", &given->robot,
                         "arm of cases that name none: a shipped robot or a folder");
  auto urdf = line.text("--urdf", &given->urdf, "the same, a bare URDF");
  auto base = line.text("--base", &given->base, "link the arm is fixed by").needs(urdf);
  auto tip = line.text("--tip", &given->tip, "link the arm works with").needs(urdf);
  line.numbers("--gravity", &given->gravity,
               "x,y,z in m/s^2, axes of the URDF's root link (default 0,0,-9.81)")
      .count(3)
      .needs(urdf);
  urdf.needs(base).needs(tip).excludes(robot);
  line.flag("--list", &given->list, "print the names of all laws");
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line("limber-eval",
                   "Evaluates control laws. Exit status 0: done, 2: refused, nothing printed.");
  Arguments given;
  define(line, &given);
  return run_program(line, argc, argv, [&] {
    std::fputs(answer(given).c_str(), stdout);
    return kExitDone;
  });
}
