#include <algorithm>
#include <random>

#include <gtest/gtest.h>
#include <itkBinaryBallStructuringElement.h>
#include <itkBinaryMorphologicalClosingImageFilter.h>
#include <itkBinaryMorphologicalOpeningImageFilter.h>

#include "preprocess/classify/segment_volume.h"

namespace splatlas {
namespace {

using Voxels = std::vector<std::uint8_t>;
using ItkMask = itk::Image<std::uint8_t, 3>;
using Ball = itk::BinaryBallStructuringElement<std::uint8_t, 3>;

template <typename Filter>
Voxels filtered_by_itk(Voxels mask, const Index3& size, const Index3& radii) {
  itk::Size<3> extent, radius;
  for (unsigned a = 0; a < 3; ++a) {
    extent[a] = static_cast<itk::SizeValueType>(size[a]);
    radius[a] = static_cast<itk::SizeValueType>(radii[a]);
  }
  const auto image = ItkMask::New();
  image->SetRegions(extent);
  image->GetPixelContainer()->SetImportPointer(mask.data(), mask.size(), false);
  Ball ball;
  ball.SetRadius(radius);
  ball.CreateStructuringElement();
  const auto filter = Filter::New();
  filter->SetInput(image);
  filter->SetKernel(ball);
  filter->SetForegroundValue(1);
  filter->Update();
  const std::uint8_t* const first = filter->GetOutput()->GetBufferPointer();
  return {first, first + mask.size()};
}

/// Rows of one to three words, radii up to 3 of which some are 0, structures at the border.
TEST(Morphology, OpensAndClosesAsItkDoes) {
  std::mt19937 random(1);
  std::size_t changed = 0;
  for (int n = 0; n < 60; ++n) {
    const auto below = [&](int end) {
      return static_cast<std::int64_t>(random() % static_cast<unsigned>(end));
    };
    Index3 size{1 + below(150), 1 + below(12), 1 + below(12)};
    const Index3 radii{below(4), below(4), below(4)};
    if (n % 8 == 0) size[0] = 64;
    Voxels mask(static_cast<std::size_t>(size[0] * size[1] * size[2]));
    const std::int64_t density = n % 2 == 0 ? 5 + below(20) : 90 + below(10);
    for (std::uint8_t& voxel : mask) voxel = below(100) < density;
    Voxels closed = mask, opened = mask;
    close_mask(closed, size, radii);
    open_mask(opened, size, radii);
    using Closing = itk::BinaryMorphologicalClosingImageFilter<ItkMask, ItkMask, Ball>;
    using Opening = itk::BinaryMorphologicalOpeningImageFilter<ItkMask, ItkMask, Ball>;
    ASSERT_EQ(closed, (filtered_by_itk<Closing>(mask, size, radii))) << n;
    ASSERT_EQ(opened, (filtered_by_itk<Opening>(mask, size, radii))) << n;
    if (closed != mask && opened != mask) ++changed;
  }
  EXPECT_GT(changed, 40u);
}

/// Rows that are widened by more than a word.
TEST(Morphology, ABallOfAHundredVoxelsClosesAGapOfAsMany) {
  const Index3 size{500, 3, 3};
  Voxels mask(4500);
  for (const std::size_t row : {0u, 3u, 6u, 8u}) mask[row * 500 + 100] = mask[row * 500 + 300] = 1;
  Voxels closed = mask;
  close_mask(closed, size, {100, 0, 0});
  EXPECT_EQ(std::ranges::count(closed, 1), 4 * 201);
  close_mask(mask, size, {99, 0, 0});
  EXPECT_EQ(std::ranges::count(mask, 1), 8);
}

}  // namespace
}  // namespace splatlas
