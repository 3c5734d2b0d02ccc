#include "tests/campaigns/faults/own_imports.h"

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/preprocess/import/images/dicom/dicom_files.h"
#include "tests/preprocess/import/planted_files.h"
#include "tests/preprocess/import/side_volumes.h"
#include "tests/preprocess/raw_image_files.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& bytes) {
  fs::create_directories(path.parent_path());
  if (!write_bytes(path, bytes)) throw std::runtime_error(path.string() + ": cannot be written");
}

/// 8 x 6 grey pixels of 8 bits.
std::string png(char value) {
  const std::string row = std::string(1, '\0') + std::string(8, value);
  std::string rows;
  for (int n = 0; n < 6; ++n) rows += row;
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR", big_endian(8) + big_endian(6) + std::string("\x8\0\0\0\0", 5)) +
         png_chunk("IDAT", deflated(rows, false)) + png_chunk("IEND", "");
}

void write_dicom(const fs::path& folder) {
  fs::create_directories(folder / "series");
  for (int k = 0; k < 5; ++k) {
    TestSlice slice;
    slice.position = {0, 0, 2. * k};
    slice.stored.assign(TestSlice::kPixels, static_cast<std::uint16_t>(k));
    constexpr std::array kCodings{TestCoding::kExplicit, TestCoding::kRunLengths, TestCoding::kJpegLossless,
                                  TestCoding::kDeflated, TestCoding::kJpegLs};
    write_slice(slice, folder / "series" / fmt::format("{}.dcm", k),
                kCodings.at(static_cast<std::size_t>(k)));
  }
  TestSegmentation segmentation;
  segmentation.segments = {{1, "Liver", {34902, 53485, 50171}, "SCT", "10200004", ""}};
  for (const double z : {0., 2., 4.})
    segmentation.frames.push_back({1, z, std::vector<std::uint16_t>(TestSegmentation::kPixels, 1)});
  write_segmentation(segmentation, folder / "seg.dcm");
}

}  // namespace

void write_own_imports(const fs::path& folder) {
  Planter plant;
  for (const PlantedFile& file : planted_images(plant)) write(folder / file.name, file.bytes);
  for (const PlantedFile& file : planted_meshes(plant)) write(folder / file.name, file.bytes);
  write(
      folder / "a.vtp",
      "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\"><PolyData><Piece "
      "NumberOfPoints=\"3\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"1\">"
      "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0"
      "</DataArray></Points><Polys><DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2"
      "</DataArray><DataArray type=\"Int32\" Name=\"offsets\" format=\"ascii\">3</DataArray></Polys></Piece>"
      "</PolyData></VTKFile>\n");
  const std::string mask = deflated(nifti_by_sform(placed(Body(), {})), true);
  for (const char* name : {"liver.nii.gz", "spleen.nii.gz", "aorta.nii.gz"})
    write(folder / "masks" / name, mask);
  for (const char value : {'\1', '\2', '\3'})
    write(folder / "stack" / fmt::format("{}.png", int{value}), png(value));
  write_dicom(folder);
  write(folder / "itksnap.label", "    0  0 0 0  0 0 0 \"Clear\"\n    1  255 0 0  1 1 1 \"Liver\"\n");
  write(folder / "lut.txt", "# id name\n1 Left-Lung 220 216 20 0\n2 Right-Lung 220 216 20 0\n");
  write(folder / "dseg.tsv", "index\tname\tcolor\n1\tLiver\t#781283\n2\tSpleen\t#d03e52\n");
  write(folder / "table.csv", "id,name,parent\n1,Body,\n2,\"Lung, left\",1\n");
  write(folder / "allen.json",
        R"([{"id":1,"name":"root","acronym":"r","color_hex_triplet":"FFFFFF","children":[{"id":2,"name":"a",)"
        R"("acronym":"a","color_hex_triplet":"7ED04B","children":[]}]}])");
  write(folder / "map.json", R"({"1": "spleen", "2": "kidney"})");
  write(folder / "paths.tree", "Body/Lungs/Left lung\nBody/Lungs/#2 color=#ff0000\n");
}

}  // namespace splatlas
