#include "preprocess/import/images/itk/itk_call.h"

#include <algorithm>
#include <array>

#include "format/text/ascii_text.h"

namespace splatlas {
std::string message_of(const itk::ExceptionObject& error) {
  // "ITK ERROR: NiftiImageIO(0x55d0c0): Cannot read" -> "Cannot read".
  std::string text = error.GetDescription();
  for (const std::string mark : {"itk::ERROR:", "ITK ERROR:"}) {
    if (const std::size_t at = text.find(mark); at != std::string::npos) text.erase(0, at + mark.size());
  }
  const std::size_t address = text.find("(0x");
  const std::size_t end = address == std::string::npos ? address : text.find("): ", address);
  if (end != std::string::npos) text.erase(0, end + 3);
  if (text.find("[nrrd] ") != std::string::npos) return message_of_teem(text);
  return one_line(text, "ITK gives no reason");
}

std::string message_of_teem(const std::string& stack) {
  const std::size_t last = stack.rfind("[nrrd] "), cause = stack.find(": ", std::min(last, stack.size()));
  std::string text = cause == std::string::npos ? "" : stack.substr(cause + 2);
  if (text.starts_with("didn't start with")) return "a unit or label of its header needs double quotes";
  text.erase(std::min(text.find_first_of("\"|("), text.size()));
  return one_line(text, "cannot be read") + "; sizes, type and encoding in its header must fit its pixels";
}

VoxelType voxel_type_of(itk::IOComponentEnum component) {
  using enum itk::CommonEnums::IOComponent;
  constexpr std::array kTypes{UNKNOWNCOMPONENTTYPE, UCHAR, CHAR, USHORT, SHORT, UINT, INT, FLOAT, DOUBLE};
  const auto found = std::ranges::find(kTypes, component) - kTypes.begin();
  return static_cast<VoxelType>(found % std::ssize(kTypes));
}

Grid grid_of(const itk::ImageIOBase& io) {
  Grid grid;
  grid.size = {1, 1, 1};
  const unsigned axes = std::min(3u, io.GetNumberOfDimensions());
  for (unsigned a = 0; a < axes; ++a) {
    grid.size[a] = static_cast<std::int64_t>(io.GetDimensions(a));
    grid.spacing_mm[a] = io.GetSpacing(a);
    grid.origin_lps_mm[a] = io.GetOrigin(a);
    const std::vector<double> direction = io.GetDirection(a);
    for (unsigned row = 0; row < 3; ++row) {
      // + 0.0 turns -0 into 0, so that equal grids print alike.
      grid.direction_lps[3 * row + a] = (row < direction.size() ? direction[row] : 0.0) + 0.0;
    }
  }
  return grid;
}

}  // namespace splatlas
