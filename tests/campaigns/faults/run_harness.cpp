#include "tests/campaigns/faults/run_harness.h"

#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>

namespace splatlas {

int run_harness(int argc, char** argv, const std::string& name, const std::string& what,
                const std::function<int(const ChosenPoints&)>& run) {
  ChosenPoints points;
  CLI::App app{what, name};
  app.add_option("--every", points.every, "stride of the points")->check(CLI::PositiveNumber);
  app.add_option("--first", points.first, "the first point");
  app.add_option("--only", points.only, "scenarios with this in their names");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(points);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), exception.what());
    return 1;
  }
}

}  // namespace splatlas
