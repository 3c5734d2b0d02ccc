// Golden phantom, built through the command line.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "tests/cli/programs.h"
#include "tests/phantom/phantom_files.h"

namespace splatlas {

/// phantom.atlas and its source files, in a folder that is removed when the program ends.
inline const TemporaryFolder& phantom_folder() {
  static const TemporaryFolder folder;
  static const bool built = [] {
    EXPECT_TRUE(phantom::write_files(folder.path()));
    const ProgramResult build =
        run_preprocess({"build", "-o", "phantom.atlas", "--labels", "labels.nrrd", "--volume", "volume.nrrd",
                        "--names", "names.txt", "--tree", "phantom.tree", "--progress", "none"},
                       folder.path());
    EXPECT_EQ(build.status, 0) << build.err;
    return build.status == 0;
  }();
  EXPECT_TRUE(built);
  return folder;
}

inline std::string phantom_atlas() {
  return phantom_folder().file("phantom.atlas");
}

}  // namespace splatlas
