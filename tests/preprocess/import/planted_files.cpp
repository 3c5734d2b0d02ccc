#include "tests/preprocess/import/planted_files.h"

#include <cstdint>

#include <fmt/format.h>

#include "tests/preprocess/import/side_volumes.h"
#include "tests/preprocess/raw_image_files.h"

namespace splatlas {
namespace {

/// `text` in a field of a binary header.
std::string with_text(std::string bytes, std::size_t offset, const std::string& text) {
  return bytes.replace(offset, text.size(), text);
}

/// Extensions of NIfTI with `count` comments (code 6) of 32 bytes.
std::string extensions(std::size_t count, Planter& plant) {
  std::string bytes(4, '\0');
  bytes[0] = 1;
  for (std::size_t n = 0; n < count; ++n) {
    std::string extension(32, '\0');
    extension = with_number<std::int32_t>(with_number<std::int32_t>(extension, 0, 32), 4, 6);
    bytes += with_text(extension, 8, plant());
  }
  return bytes;
}

std::string planted_nifti(const PlacedVolume& volume, Planter& plant) {
  std::string bytes = nifti_by_sform(volume);
  for (const std::size_t offset : {14u, 148u, 160u, 172u, 184u, 196u, 208u, 228u, 328u})
    bytes = with_text(bytes, offset, plant());
  bytes.replace(348, 4, extensions(20, plant));
  return with_number<float>(bytes, 108, 352 + 20 * 32);
}

std::string planted_nifti2(const PlacedVolume& volume, Planter& plant) {
  std::string bytes = nifti2_by_sform(volume);
  for (const std::size_t offset : {240u, 252u, 264u, 276u, 288u, 300u, 320u, 508u})
    bytes = with_text(bytes, offset, plant());
  bytes.replace(540, 4, extensions(20, plant));
  return with_number<std::int64_t>(bytes, 168, 544 + 20 * 32);
}

std::string planted_nrrd(const std::string& bytes, Planter& plant) {
  std::string lines = "\ncontent: " + plant() + "\nsample units: " + plant() + "\nspace units: \"" + plant() +
                      "\" \"mm\" \"mm\"\nlabels: \"" + plant() + "\" \"" + plant() + "\" \"\"\n";
  for (int n = 0; n < 10; ++n) {
    lines += "# " + plant() + "\n";
    lines += fmt::format("{}:={}\nDICOM_{}:={}\n", plant(), plant(), n, plant());
  }
  return replaced(bytes, "\n\n", lines + "\n");
}

std::string planted_meta_image(const PlacedVolume& volume, Planter& plant) {
  std::string lines = "ObjectType = Image\nComment = " + plant() + "\nObjectSubType = " + plant() +
                      "\nName = " + plant() + "\nAcquisitionDate = " + plant() + "\n";
  for (int n = 0; n < 10; ++n) lines += plant() + " = " + plant() + "\n";
  return replaced(meta_image_of(volume), "ObjectType = Image\n", lines);
}

/// Tags after the voxels: a number, a length, a text. 3 is a command line, 20 a name of a subject.
std::string planted_mgh(const PlacedVolume& volume, Planter& plant) {
  std::string bytes = mgh_of(volume) + std::string(20, '\0');
  for (int n = 0; n < 20; ++n) {
    const std::string text = plant();
    bytes += std::string(3, '\0') + static_cast<char>(n % 2 == 0 ? 3 : 20) + std::string(7, '\0') +
             static_cast<char>(text.size()) + text;
  }
  return bytes;
}

std::string float_bytes(const std::vector<float>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)};
}

std::string planted_stl(Planter& plant) {
  std::string bytes = plant() + " SPACE=LPS " + plant();
  bytes.resize(80, ' ');
  bytes += std::string("\4\0\0\0", 4);
  for (const auto& face : std::vector<std::vector<float>>{{0, 30, 10, 0, 33, 10, 3, 30, 10},
                                                          {0, 30, 10, 3, 30, 10, 0, 30, 13},
                                                          {0, 30, 10, 0, 30, 13, 0, 33, 10},
                                                          {3, 30, 10, 0, 33, 10, 0, 30, 13}})
    bytes += std::string(12, '\0') + float_bytes(face) + std::string(2, '\0');
  return bytes;
}

std::string planted_text_stl(Planter& plant) {
  return "solid " + plant() +
         " SPACE=LPS\nfacet normal 0 0 1\nouter loop\nvertex 0 30 10\nvertex 3 30 10\nvertex 0 33 10\n"
         "endloop\nendfacet\nendsolid " +
         plant() + "\n";
}

std::string planted_ply(Planter& plant) {
  std::string lines;
  for (int n = 0; n < 5; ++n) lines += "comment " + plant() + "\nobj_info " + plant() + "\n";
  return "ply\nformat ascii 1.0\ncomment SPACE=LPS\n" + lines +
         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n0 30 10\n3 30 10\n0 33 10\n3 0 1 2\n";
}

std::string planted_obj(Planter& plant) {
  std::string lines;
  for (int n = 0; n < 5; ++n) lines += "# " + plant() + "\n";
  return "# SPACE=LPS\n" + lines + "mtllib " + plant() + "\no " + plant() + "\ng " + plant() + "\nusemtl " +
         plant() + "\nv 0 30 10\nv 3 30 10\nv 0 33 10\nf 1 2 3\n";
}

std::string planted_vtk(Planter& plant) {
  return "# vtk DataFile Version 3.0\nSPACE=LPS " + plant() +
         "\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 30 10 3 30 10 0 33 10\nPOLYGONS 1 4\n3 0 1 2\n"
         "CELL_DATA 1\nSCALARS " +
         plant() + " float 1\nLOOKUP_TABLE default\n1\n";
}

std::string planted_gifti(Planter& plant) {
  const auto metadata = [&](int count) {
    std::string text = "<MetaData>";
    for (int n = 0; n < count; ++n)
      text += "<MD><Name>" + plant() + "</Name><Value><![CDATA[" + plant() + "]]></Value></MD>";
    return text + "</MetaData>";
  };
  const auto array = [&](const std::string& intent, const std::string& type, const std::string& data,
                         int rows) {
    return fmt::format(
        "<DataArray Intent=\"NIFTI_INTENT_{}\" DataType=\"NIFTI_TYPE_{}\" "
        "ArrayIndexingOrder=\"RowMajorOrder\""
        " Dimensionality=\"2\" Dim0=\"{}\" Dim1=\"3\" Encoding=\"ASCII\" Endian=\"LittleEndian\">{}<Data>{}"
        "</Data></DataArray>\n",
        intent, type, rows, metadata(5), data);
  };
  return "<?xml version=\"1.0\"?>\n<!-- " + plant() + " -->\n<GIFTI Version=\"1.0\">\n" + metadata(5) +
         "<LabelTable><Label Key=\"0\">" + plant() + "</Label></LabelTable>\n" +
         array("POINTSET", "FLOAT32", "0 -30 10 -3 -30 10 0 -33 10", 3) +
         array("TRIANGLE", "INT32", "0 1 2", 1) + "</GIFTI>\n";
}

}  // namespace

std::vector<PlantedFile> planted_images(Planter& plant) {
  const PlacedVolume volume = placed(Body(), {});
  return {{"one.nii", planted_nifti(volume, plant)},
          {"one.nii.gz", deflated(planted_nifti(volume, plant), true)},
          {"two.nii", planted_nifti2(volume, plant)},
          {"a.nrrd", planted_nrrd(nrrd_in(volume, "RAS"), plant)},
          {"a.seg.nrrd", planted_nrrd(seg_nrrd(volume), plant)},
          {"a.mha", planted_meta_image(volume, plant)},
          {"a.mgh", planted_mgh(volume, plant)},
          {"a.mgz", deflated(planted_mgh(volume, plant), true)}};
}

std::vector<PlantedFile> planted_meshes(Planter& plant) {
  return {{"a.gii", planted_gifti(plant)},       {"a.stl", planted_stl(plant)},
          {"text.stl", planted_text_stl(plant)}, {"a.ply", planted_ply(plant)},
          {"a.obj", planted_obj(plant)},         {"a.vtk", planted_vtk(plant)}};
}

}  // namespace splatlas
