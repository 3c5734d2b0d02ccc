// GIFTI surfaces in all encodings, written by the test.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "preprocess/import/meshes/import_mesh.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/fails_with.h"
#include "tests/support/temporary_folder.h"

namespace splatlas {
namespace {

struct Coding {
  std::string encoding = "ASCII";
  bool by_columns = false, big_endian = false;
};

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 3; ++b)
      bits = bits << 8 | (n + b < bytes.size() ? static_cast<unsigned char>(bytes[n + b]) : 0u);
    for (std::size_t d = 0; d < 4; ++d)
      text += n + d <= bytes.size() ? kDigits[bits >> (18 - 6 * d) & 63] : '=';
  }
  return text;
}

/// Rows of three numbers as a DataArray; `matrix` goes ahead of the data.
template <typename T>
std::string data_array(const std::string& intent, const std::string& type, std::vector<T> numbers,
                       const Coding& coding, const std::string& matrix = "") {
  const std::size_t rows = numbers.size() / 3;
  if (coding.by_columns) {
    const std::vector<T> by_rows = numbers;
    for (std::size_t n = 0; n < numbers.size(); ++n) numbers[n] = by_rows[n % rows * 3 + n / rows];
  }
  std::string data;
  for (const T number : numbers) {
    if (coding.encoding == "ASCII") {
      data += fmt::format("{} ", number);
      continue;
    }
    std::string bytes(reinterpret_cast<const char*>(&number), sizeof(T));
    if (coding.big_endian) std::ranges::reverse(bytes);
    data += bytes;
  }
  if (coding.encoding.starts_with("GZip")) data = deflated(data, false);
  if (coding.encoding != "ASCII") data = base64(data);
  return fmt::format(R"(<DataArray Intent="{}" DataType="{}" ArrayIndexingOrder="{}MajorOrder" )"
                     R"(Dimensionality="2" Dim0="{}" Dim1="3" Encoding="{}" Endian="{}Endian">)"
                     "{}<Data>{}</Data></DataArray>\n",
                     intent, type, coding.by_columns ? "Column" : "Row", rows, coding.encoding,
                     coding.big_endian ? "Big" : "Little", matrix, data);
}

/// Point n is (n, 2 n + 0.5, -n * n); triangles join neighbours.
constexpr int kPoints = 7;

std::string surface(const Coding& coding, const std::string& matrix = "") {
  std::vector<float> points;
  std::vector<std::int32_t> triangles;
  for (int n = 0; n < kPoints; ++n) {
    const auto x = static_cast<float>(n);
    points.insert(points.end(), {x, 2 * x + 0.5f, -x * x});
    if (n >= 2) triangles.insert(triangles.end(), {n - 2, n - 1, n});
  }
  return "<?xml version=\"1.0\"?>\n<GIFTI Version=\"1.0\" NumberOfDataArrays=\"2\">\n" +
         data_array("NIFTI_INTENT_POINTSET", "NIFTI_TYPE_FLOAT32", points, coding, matrix) +
         data_array("NIFTI_INTENT_TRIANGLE", "NIFTI_TYPE_INT32", triangles, coding) + "</GIFTI>\n";
}

class ReadGifti : public testing::Test {
 protected:
  /// Expects point n at `place(n, 2 n + 0.5, -n * n)` in RAS.
  template <typename Place>
  void expect_points(const std::string& bytes, const Place& place) const {
    write_bytes(folder_.file("a.gii"), bytes);
    Notes notes;
    const TriangleMesh mesh =
        value_or_throw(place_mesh({.name = "a", .file = folder_.file("a.gii")}, {}, notes));
    EXPECT_TRUE(notes.empty());  // GIFTI is RAS
    ASSERT_EQ(mesh.positions_lps_mm.size(), 7u);
    ASSERT_EQ(mesh.triangles.size(), 5u);
    for (std::uint32_t n = 0; n < kPoints; ++n) {
      const Vec3 ras = place(double{1} * n, 2. * n + 0.5, -double{1} * n * n);
      EXPECT_EQ(mesh.positions_lps_mm[n], (Vec3{-ras[0], -ras[1], ras[2]})) << n;
    }
    for (std::uint32_t n = 2; n < kPoints; ++n)
      EXPECT_EQ(mesh.triangles[n - 2], (std::array<std::uint32_t, 3>{n - 2, n - 1, n}));
  }
  TemporaryFolder folder_;
};

TEST_F(ReadGifti, InEveryEncoding) {
  for (const std::string encoding : {"ASCII", "Base64Binary", "GZipBase64Binary"}) {
    for (const bool by_columns : {false, true}) {
      for (const bool big_endian : {false, true}) {
        SCOPED_TRACE(fmt::format("{} {} {}", encoding, by_columns, big_endian));
        expect_points(surface({encoding, by_columns, big_endian}), [](double x, double y, double z) {
          return Vec3{x, y, z};
        });
      }
    }
  }
}

TEST_F(ReadGifti, PointsMoveToTheScanner) {
  const auto matrix = [](const std::string& space) {
    return "<CoordinateSystemTransformMatrix><DataSpace><![CDATA[NIFTI_XFORM_UNKNOWN]]></DataSpace>"
           "<TransformedSpace><![CDATA[" +
           space +
           "]]></TransformedSpace><MatrixData>0 0 2 10\n1 0 0 20\n0 1 0 -30\n0 0 0 1</MatrixData>"
           "</CoordinateSystemTransformMatrix>";
  };
  expect_points(surface({"Base64Binary"}, matrix("NIFTI_XFORM_SCANNER_ANAT")),
                [](double x, double y, double z) {
                  return Vec3{2 * z + 10, x + 20, y - 30};
                });
  expect_points(surface({}, matrix("NIFTI_XFORM_TALAIRACH") + matrix("NIFTI_XFORM_SCANNER_ANAT")),
                [](double x, double y, double z) {
                  return Vec3{2 * z + 10, x + 20, y - 30};
                });
  // A matrix to another space is not the scanner's.
  expect_points(surface({}, matrix("NIFTI_XFORM_TALAIRACH")), [](double x, double y, double z) {
    return Vec3{x, y, z};
  });
  // FreeSurfer's surfaces have the centre of their volume.
  const std::string center =
      "<MetaData><MD><Name>VolGeomC_R</Name><Value>1.5</Value></MD><MD><Name>VolGeomC_A</Name>"
      "<Value>-2</Value></MD><MD><Name>VolGeomC_S</Name><Value>4</Value></MD></MetaData>";
  expect_points(surface({}, center), [](double x, double y, double z) {
    return Vec3{x + 1.5, y - 2, z + 4};
  });
}

TEST_F(ReadGifti, RefusesDamage) {
  const auto refusal = [&](const std::string& from, const std::string& to) {
    write_bytes(folder_.file("a.gii"), replaced(surface({"GZipBase64Binary"}), from, to));
    const Result<MeshFile> mesh = read_mesh(folder_.file("a.gii"));
    return mesh ? "no error" : mesh.error().message;
  };
  EXPECT_THAT(refusal("Dim0=\"7\"", "Dim0=\"8\""), HasSubstr("damaged array (NIFTI_INTENT_POINTSET)"));
  EXPECT_THAT(refusal("Dim0=\"7\"", "Dim0=\"6\""), HasSubstr("damaged array (NIFTI_INTENT_POINTSET)"));
  EXPECT_THAT(refusal("Dim1=\"3\"", "Dim1=\"4\""), HasSubstr("N x 3 are needed"));
  EXPECT_THAT(refusal("<Data>", "<Data>*"), HasSubstr("damaged array"));
  EXPECT_THAT(refusal("</GIFTI>", ""), HasSubstr("its XML is not whole"));
  EXPECT_THAT(refusal("FLOAT32", "FLOAT64"), HasSubstr("type NIFTI_TYPE_FLOAT64"));
}

}  // namespace
}  // namespace splatlas
