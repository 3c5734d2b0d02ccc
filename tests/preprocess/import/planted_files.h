// Source files that hold identifiers wherever their format has place for free text.
#pragma once

#include <string>
#include <vector>

namespace splatlas {

/// A file with identifiers, all of which hold the word PLANTED and a number.
struct PlantedFile {
  std::string name;
  std::string bytes;
};

/// Hands out identifiers, and counts them.
class Planter {
 public:
  std::string operator()() { return "PLANTED" + std::to_string(count_++); }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::size_t count_ = 0;
};

/// Volumes of the marks of a body (side_volumes.h): NIfTI-1 and 2, NRRD, MetaImage and MGH.
[[nodiscard]] std::vector<PlantedFile> planted_images(Planter& plant);
/// Surfaces of a tetrahedron at (0, 30, 10) mm: GIFTI, STL, PLY, OBJ and VTK.
[[nodiscard]] std::vector<PlantedFile> planted_meshes(Planter& plant);

}  // namespace splatlas
