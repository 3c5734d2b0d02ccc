// Uses the installed headers and libraries alone: opens the atlas that the command line names.
#include <iostream>

#include <format/atlas_reader.h>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: consumer ATLAS\n";
    return 2;
  }
  const auto atlas = splatlas::Atlas::open(argv[1]);
  if (!atlas) {
    std::cerr << atlas.error().message << '\n';
    return splatlas::exit_status(atlas.error().code);
  }
  std::cout << (*atlas)->graph().size() << " structures\n";
  return 0;
}
