// Nothing of a DICOM header that may identify a patient is passed on.
#include "tests/preprocess/import/images/dicom/import_dicom_fixture.h"

namespace splatlas {
namespace {

using testing::HasSubstr;
using testing::Not;

class DicomPrivacy : public ImportDicom {
 protected:
  /// The error, and what was printed meanwhile.
  [[nodiscard]] std::string error_of_import(const std::string& series = "") const {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const Result<SourceImage> image = import(series);
    const std::string all = testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr();
    return image ? "no error" : all + image.error().message;
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

TEST_F(DicomPrivacy, ErrorsOfSeriesHoldNoIdentifiers) {
  write_series();
  TestSlice localizer = axial(0);
  localizer.axes = {0, 1, 0, 0, 0, -1};
  write_slice(localizer, file("a"));
  TestSlice beside = axial(2);
  beside.position[0] = 1;
  write_slice(beside, file("slice7"));
  plant_all();
  expect_clean(error_of_import(), "holds 2 series");
  expect_clean(error_of_import("4"), "has no series 4");
  expect_clean(error_of_import("2"), "off the line");
}

}  // namespace
}  // namespace splatlas
