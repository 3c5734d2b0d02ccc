// Left stays left, in files of every format and axis order.
#include <utility>

#include "preprocess/sources/import_sources.h"
#include "tests/preprocess/import/sides_fixture.h"
#include "tests/preprocess/raw_image_files.h"
#include "tests/support/fails_with.h"

namespace splatlas {
namespace {

TEST_F(Sides, OfNifti) {
  expect_sides_of_all_orders("sform.nii", nifti_by_sform);
  expect_sides_of_all_orders("qform.nii", nifti_by_qform);
  expect_sides_of_all_orders("two.nii", nifti2_by_sform);
}

TEST_F(Sides, OfNrrd) {
  for (const char* space : {"LPS", "RAS", "LAS"})
    expect_sides_of_all_orders("a.nrrd", [&](const PlacedVolume& volume) { return nrrd_in(volume, space); });
  expect_sides_of_all_orders("a.seg.nrrd", seg_nrrd);
}

/// Other spellings, and spaces of volumes in time, which ITK reads as LPS.
TEST_F(Sides, OfNrrdSpacesByOtherNames) {
  const Body body = bodies().back();
  for (const auto& [space, name] :
       std::vector<std::pair<std::string, std::string>>{{"LAS", "LAS"},
                                                        {"RAS", "right anterior superior"},
                                                        {"LAS", "leftanteriorsuperior"},
                                                        {"RAS", "RAS"}}) {
    SCOPED_TRACE(name);
    const std::string bytes = nrrd_in(placed(body, {}), space);
    const std::size_t first = bytes.find("space: ") + 7, last = bytes.find('\n', first);
    write_bytes(folder_.file("a.nrrd"), std::string(bytes).replace(first, last - first, name));
    expect_sides(folder_.file("a.nrrd"), body);
    std::string timed = std::string(bytes).replace(last, 0, "-time");
    timed = replaced(replaced(timed, "dimension: 3", "dimension: 4"), "sizes: 8 6 5", "sizes: 8 6 5 1");
    timed = replaced(timed, "kinds: domain domain domain", "kinds: domain domain domain time");
    for (std::size_t at = timed.find('('); at < timed.find("\n\n"); at = timed.find('(', at + 1))
      timed.insert(timed.find(')', at), ",0");
    timed = replaced(timed, "\nkinds", " (0,0,0,1)\nkinds");
    write_bytes(folder_.file("a.nrrd"), timed);
    expect_sides(folder_.file("a.nrrd"), body);
  }
}

TEST_F(Sides, OfMetaImage) {
  expect_sides_of_all_orders("a.mha", meta_image_of);
}

TEST_F(Sides, OfMgh) {
  expect_sides_of_all_orders("a.mgh", mgh_of);
}

/// Grey values are ten times the marks. Two files of one grid, in different orders: no voxel is interpolated.
TEST_F(Sides, OfLabelsAndVolumesInDifferentOrders) {
  const std::vector<AxisOrder> orders = all_axis_orders();
  for (std::size_t n = 0; n < orders.size(); ++n) {
    for (const Body& body : bodies()) {
      PlacedVolume grey = placed(body, orders[(n + 29) % orders.size()]);
      for (std::uint8_t& value : grey.values) value = static_cast<std::uint8_t>(10 * value);
      write_bytes(folder_.file("labels.nrrd"), nrrd_in(placed(body, orders[n]), "RAS"));
      write_bytes(folder_.file("grey.nii"), nifti_by_sform(grey));
      for (const ResampleTo resample : {ResampleTo::kAsk, ResampleTo::kVolume}) {
        SourceFiles files;
        files.labels = folder_.file("labels.nrrd");
        files.volume = folder_.file("grey.nii");
        files.resample = resample;
        Notes notes;
        const SourceModel model = value_or_throw(import_sources(files, notes));
        EXPECT_THAT(messages_of(notes), IsEmpty()) << n;
        ASSERT_EQ(model.values.type, VoxelType::kUInt8);
        const auto voxels = model.memberships.voxels();
        for (std::size_t v = 0; v < voxels.size(); ++v) {
          const auto& set = model.memberships.sets()[voxels[v]];
          ASSERT_EQ(model.values.as<std::uint8_t>()[v], set.empty() ? 0 : 10 * (1 + set.front())) << n;
        }
      }
    }
  }
}

}  // namespace
}  // namespace splatlas
