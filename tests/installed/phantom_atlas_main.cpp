// splatlas-phantom-atlas FILE: the golden phantom as an atlas, without ITK and VTK.
#include <cstdio>

#include "format/atlas_writer.h"
#include "format/system/exit_status.h"
#include "tests/support/phantom_content.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: splatlas-phantom-atlas FILE\n", stderr);
    return 2;
  }
  const auto written = splatlas::write_atlas(splatlas::phantom_content(), argv[1]);
  if (written) return 0;
  std::fprintf(stderr, "splatlas-phantom-atlas: %s\n", written.error().message.c_str());
  return splatlas::exit_status(written.error().code);
}
