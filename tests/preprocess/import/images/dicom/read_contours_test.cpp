// Structures of DICOM contours: filled polygons against their areas.
#include "preprocess/sources/import_sources.h"
#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"

namespace splatlas {
namespace {

class DicomContours : public ImportDicom {
 protected:
  static std::vector<Vec3> box(double x0, double x1, double y0, double y1, double z) {
    return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
  }

  [[nodiscard]] SourceImage labels_of(const std::filesystem::path& path) const {
    ImageOptions options;
    options.labels = true;
    return value_or_throw(import_dicom(path, options));
  }

  /// Voxels of a segment in each slice.
  static std::vector<std::int64_t> counts(const SourceImage& image, std::size_t n) {
    const std::int64_t plane = image.grid.size[0] * image.grid.size[1];
    const std::uint16_t* slice = image.voxels.as<std::uint16_t>() +
                                 static_cast<std::int64_t>(image.segments[n].layer) * image.grid.voxels();
    std::vector<std::int64_t> result;
    for (std::int64_t k = 0; k < image.grid.size[2]; ++k, slice += plane)
      result.push_back(std::count(slice, slice + plane, image.segments[n].value));
    return result;
  }
};

TEST_F(DicomContours, AreFilledOnTheSeriesBesideThem) {
  write_series();  // pixels of 0.25 x 0.5 mm from (-1, 2), slices at 10, 12, ... 18
  std::vector<std::vector<Vec3>> ring, halfway, skipped, uneven;
  for (const double z : {12, 14}) {
    ring.push_back(box(-1, 0.5, 1.75, 3.25, z));  // 6 x 3 pixels
    ring.push_back(box(-0.5, 0, 2.25, 2.75, z));  // a hole of 2 x 1
  }
  for (const double z : {11, 13, 15}) halfway.push_back({{-1, 2, z}, {0.75, 2, z}, {-1, 4, z}});
  for (const double z : {10, 12, 18}) skipped.push_back(box(-0.5, 0, 2.25, 2.75, z));
  for (const double z : {10., 12., 15.5}) uneven.push_back(box(-0.5, 0, 2.25, 2.75, z));
  write_contours({{"Ring", ring}, {"Halfway", halfway}, {"Skipped", skipped}, {"Uneven", uneven}},
                 file("rt"));
  const SourceImage image = labels_of(folder_.path());
  EXPECT_EQ(image.grid, imported().grid);
  EXPECT_THAT(counts(image, 0), ElementsAre(0, 16, 16, 0, 0));
  EXPECT_THAT(counts(image, 1), ElementsAre(19, 19, 19, 0, 0));  // rows of 7, 6, 4 and 2
  EXPECT_THAT(counts(image, 2), ElementsAre(2, 2, 0, 0, 2));
  EXPECT_THAT(counts(image, 3), ElementsAre(2, 2, 2, 2, 0));
  EXPECT_GT(image.layers, 1u);
  EXPECT_EQ(image.segments[0].structure.name, "Ring");
  EXPECT_EQ(image.segments[0].structure.color, (Rgb{10, 20, 30}));
  EXPECT_THAT(notes_of(image), IsEmpty());
}

TEST_F(DicomContours, NeedAGrid) {
  write_contours({{"Box", {box(-28, -12, 3, 8, 0)}}}, file("rt"));
  EXPECT_THAT(import_dicom(file("rt"), {}), FailsWith(ErrorCode::kFailed, HasSubstr("as --labels")));
  ImageOptions options;
  options.labels = true;
  EXPECT_THAT(
      import_dicom(file("rt"), options),
      FailsWith(ErrorCode::kFailed, HasSubstr("give their series as --volume, or the folder of both")));
}

TEST_F(DicomContours, LieOnTheVolume) {
  std::filesystem::create_directory(file("ct"));
  for (int k = 0; k < 5; ++k) {
    TestSlice slice = axial(k);
    slice.texts = {{{0x0020, 0x0052}, "1.7"}};
    write_slice(slice, file(fmt::format("ct/{}", k)));
  }
  write_contours({{"Box", {box(-0.5, 9, 2.25, 2.75, 12), {{0, 2, 12}}}}, {"Seed", {{{0, 2, 12}}}}},
                 file("rt"), "1.8");
  SourceFiles files;
  files.labels = file("rt");
  files.volume = file("ct");
  Notes notes;
  const SourceModel model = value_or_throw(import_sources(files, notes));
  EXPECT_EQ(model.source_grid.size, (Index3{8, 6, 5}));
  EXPECT_EQ(model.structures.size(), 1u);
  std::string all;
  for (const Note& note : notes.all()) all += note.message() + ";";
  EXPECT_THAT(all, AllOf(HasSubstr("alone, which enclose nothing: Seed;"), HasSubstr("are left out: Box;"),
                         HasSubstr("cut off there: Box;"), HasSubstr("differ in FrameOfReferenceUID"),
                         Not(HasSubstr("without voxels"))));
}

}  // namespace
}  // namespace splatlas
