// splatlas-phantom FOLDER: writes the golden phantom's files, for the demo and the command line tests.
#include <iostream>

#include "tests/phantom/phantom_files.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: splatlas-phantom FOLDER\n";
    return splatlas::exit_status(splatlas::ErrorCode::kUsage);
  }
  if (const auto written = splatlas::phantom::write_files(argv[1]); !written) {
    std::cerr << "splatlas-phantom: " << written.error().message << '\n';
    return splatlas::exit_status(written.error().code);
  }
  return 0;
}
