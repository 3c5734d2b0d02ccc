#include "tests/faults/own_imports.h"

#include <stdexcept>

#include "preprocess/export/write_image.h"
#include "tests/preprocess/random_images.h"

namespace splatlas {

void write_own_imports(const std::filesystem::path& folder) {
  std::mt19937 random(1);
  const Image labels = random_labels(awkward_grid(0.3), VoxelType::kUInt8, random);
  for (const char* name : {"a.nii", "a.nii.gz", "a.nrrd", "a.mha"}) {
    if (const auto written = write_image(labels, folder / name); !written)
      throw std::runtime_error(written.error().message);
  }
}

}  // namespace splatlas
