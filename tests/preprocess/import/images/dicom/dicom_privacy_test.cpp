// Nothing of a DICOM header that may identify a patient is passed on.
#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"
#include "tests/support/file_bytes.h"

namespace splatlas {
namespace {

using testing::HasSubstr;
using testing::Not;

class DicomPrivacy : public ImportDicom {
 protected:
  /// All texts of a result, and what was printed meanwhile.
  [[nodiscard]] std::string texts_of_import(const std::string& series = "") const {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const Result<SourceImage> image = import(series);
    std::string all = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
    if (!image) return all + image.error().message;
    for (const std::string& message : notes_of(*image)) all += message + "\n";
    for (const SourceSegment& segment : image->segments) {
      all += segment.structure.name + "\n";
      for (const Term& term : segment.structure.terms) all += term.vocabulary + " " + term.value + "\n";
    }
    return all;
  }

  void expect_clean(const std::string& text, const std::string& evidence) const {
    EXPECT_THAT(text, HasSubstr(evidence));  // the case is the one that is meant
    EXPECT_THAT(text, Not(HasSubstr("PLANT")));
    EXPECT_THAT(text, Not(HasSubstr("9.8.7")));
  }

  void plant_all() const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      EXPECT_GE(plant_identifiers(entry.path()), 200u);
  }
};

TEST_F(DicomPrivacy, ResultsAndNotesHoldNoIdentifiers) {
  write_series();
  write_slice(axial(3), file("slice99"));
  plant_all();
  expect_clean(texts_of_import(), "repeats another's position");
}

TEST_F(DicomPrivacy, ErrorsOfSeriesHoldNoIdentifiers) {
  write_series();
  TestSlice localizer = axial(0);
  localizer.axes = {0, 1, 0, 0, 0, -1};
  write_slice(localizer, file("a"));
  plant_all();
  expect_clean(texts_of_import(), "holds 2 series");
  expect_clean(texts_of_import("4"), "has no series 4");
  std::filesystem::remove(file("slice7"));
  expect_clean(texts_of_import("2"), "lacks 1 slice");
}

TEST_F(DicomPrivacy, ErrorsOfDamagedFilesHoldNoIdentifiers) {
  write_series();
  plant_all();
  const std::string whole = read_bytes(file("slice9"));
  for (std::size_t length = 200; length < whole.size(); length += whole.size() / 50) {
    write_bytes(file("slice9"), std::string_view(whole).substr(0, length));
    expect_clean(texts_of_import(), "get the file again");
  }
  for (std::size_t n = 0; n < 50; ++n) {
    std::string damaged = whole;
    damaged[400 + n * (whole.size() - 500) / 50] ^= static_cast<char>(0x81);
    write_bytes(file("slice9"), damaged);
    expect_clean(texts_of_import(), "");
  }
}

TEST_F(DicomPrivacy, SegmentationsHoldOnlyLabelsAndCodes) {
  TestSegmentation segmentation;
  segmentation.segments = {{1, "Liver", {}, "SCT", "10200004", "24028007"}};
  segmentation.frames = {{1, 0, std::vector<std::uint16_t>(TestSegmentation::kPixels, 1)}};
  write_segmentation(segmentation, file("a"));
  plant_all();
  expect_clean(texts_of_import(), "Liver\nSNOMED 10200004\nmodifier SNOMED 24028007\n");
}

}  // namespace
}  // namespace splatlas
