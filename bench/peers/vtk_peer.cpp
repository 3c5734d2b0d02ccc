#include "bench/peers/vtk_peer.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkColorTransferFunction.h>
#include <vtkFixedPointRayCastImage.h>
#include <vtkFixedPointVolumeRayCastMapper.h>
#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkOpenGLGPUVolumeRayCastMapper.h>
#include <vtkPiecewiseFunction.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPropCollection.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVolume.h>
#include <vtkVolumeCollection.h>
#include <vtkVolumeProperty.h>

#include "tests/support/xvfb.h"

namespace splatlas {
namespace {

using reference::GreyAppearance;
using reference::MaskedVolume;

constexpr int kThreads = 2;
constexpr int kMaxPeels = 100;
constexpr double kAmbient = 0.15;  // of the model

/// The volume padded by a layer of 0.
vtkSmartPointer<vtkImageData> padded_image(const MaskedVolume& volume) {
  const Index3& size = volume.grid.size;
  vtkNew<vtkImageData> image;
  image->SetExtent(-1, static_cast<int>(size[0]), -1, static_cast<int>(size[1]), -1,
                   static_cast<int>(size[2]));
  image->SetSpacing(volume.grid.spacing_mm.data());
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  auto* greys = static_cast<std::uint8_t*>(image->GetScalarPointer());
  std::fill_n(greys, image->GetNumberOfPoints(), std::uint8_t{0});
  for (std::int64_t k = 0; k < size[2]; ++k) {
    for (std::int64_t j = 0; j < size[1]; ++j) {
      std::memcpy(greys + ((k + 1) * (size[1] + 2) + j + 1) * (size[0] + 2) + 1,
                  volume.greys.data() + volume.grid.offset(0, j, k), static_cast<std::size_t>(size[0]));
    }
  }
  return image;
}

/// Position and direction of the grid; the image has the spacing.
vtkSmartPointer<vtkMatrix4x4> placement(const Grid& grid) {
  vtkNew<vtkMatrix4x4> matrix;
  for (std::size_t row = 0; row < 3; ++row) {
    const auto r = static_cast<int>(row);
    for (std::size_t column = 0; column < 3; ++column) {
      matrix->SetElement(r, static_cast<int>(column), grid.direction_lps[3 * row + column]);
    }
    matrix->SetElement(r, 3, grid.origin_lps_mm[row]);
  }
  return matrix;
}

/// Opacities per mm. They are not linear where extinctions are: one point per grey value and per knot.
vtkSmartPointer<vtkVolumeProperty> property_of(const GreyAppearance& appearance) {
  vtkNew<vtkPiecewiseFunction> opacity;
  vtkNew<vtkColorTransferFunction> color;
  const auto add = [&](double grey) {
    const GreyAppearance::Knot knot = appearance.at(grey);
    opacity->AddPoint(grey, -std::expm1(-knot.extinction_per_mm));
    color->AddRGBPoint(grey, knot.color[0], knot.color[1], knot.color[2]);
  };
  for (int grey = 0; grey <= 255; ++grey) add(grey);
  for (const GreyAppearance::Knot& knot : appearance.knots) add(knot.grey);
  vtkNew<vtkVolumeProperty> property;
  property->SetScalarOpacity(opacity);
  property->SetColor(color);
  property->SetScalarOpacityUnitDistance(1);
  property->SetInterpolationTypeToLinear();
  property->ShadeOff();
  property->SetAmbient(kAmbient);
  property->SetDiffuse(1 - kAmbient);
  property->SetSpecular(0);
  return property;
}

vtkSmartPointer<vtkOpenGLGPUVolumeRayCastMapper> gpu_mapper(float step) {
  vtkNew<vtkOpenGLGPUVolumeRayCastMapper> mapper;
  mapper->AutoAdjustSampleDistancesOff();
  mapper->LockSampleDistanceToInputSpacingOff();
  mapper->UseJitteringOff();
  mapper->SetSampleDistance(step);
  return mapper;
}

vtkSmartPointer<vtkFixedPointVolumeRayCastMapper> fixed_point_mapper(float step) {
  vtkNew<vtkFixedPointVolumeRayCastMapper> mapper;
  mapper->AutoAdjustSampleDistancesOff();
  mapper->LockSampleDistanceToInputSpacingOff();
  mapper->SetSampleDistance(step);
  mapper->SetInteractiveSampleDistance(step);
  mapper->SetNumberOfThreads(kThreads);
  return mapper;
}

/// The result of the rays: the part of the picture that the volume box covers, bottom row first.
Picture cast_image(vtkFixedPointVolumeRayCastMapper& mapper, const PictureSize& size) {
  constexpr float kOne = 32767;
  vtkFixedPointRayCastImage& image = *mapper.GetRayCastImage();
  Picture picture{size, {}};
  picture.rgba.resize(4 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  const int* used = image.GetImageInUseSize();
  const int* origin = image.GetImageOrigin();
  for (int y = 0; y < used[1]; ++y) {
    const unsigned short* from = image.GetImage() + std::ptrdiff_t{4} * y * image.GetImageMemorySize()[0];
    const std::ptrdiff_t row = size.height - 1 - (origin[1] + y);
    float* to = picture.rgba.data() + 4 * (row * size.width + origin[0]);
    for (int n = 0; n < 4 * used[0]; ++n) to[n] = static_cast<float>(from[n]) / kOne;
  }
  return picture;
}

vtkSmartPointer<vtkPolyData> poly_data(const SurfaceMesh& mesh, const Grid& grid) {
  const Affine to_lps = index_to_lps_mm(grid);
  vtkNew<vtkPoints> points;
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.positions_ijk.size()));
  for (std::size_t n = 0; n < mesh.positions_ijk.size(); ++n) {
    const auto& [i, j, k] = mesh.positions_ijk[n];
    points->SetPoint(static_cast<vtkIdType>(n), to_lps.apply({i, j, k}).data());
  }
  vtkNew<vtkCellArray> triangles;
  for (const auto& triangle : mesh.triangles) {
    triangles->InsertNextCell({triangle[0], triangle[1], triangle[2]});
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(triangles);
  return data;
}

}  // namespace

Result<XServer> start_x_server() {
  if (std::getenv("DISPLAY") != nullptr) return XServer();
  const XvfbServer server = start_xvfb("Xvfb", "1280x1280x24");
  XServer started(nullptr, [process = server.process](const void*) {
    stop_xvfb(process);
    unsetenv("DISPLAY");
  });
  if (server.display.empty()) {
    return fail(ErrorCode::kFailed, "Xvfb does not start; install Debian's package xvfb, or set DISPLAY");
  }
  setenv("DISPLAY", server.display.c_str(), 1);
  return started;
}

struct VtkPeer::Impl {
  PictureSize size;
  vtkNew<vtkRenderWindow> window;
  vtkNew<vtkRenderer> renderer;
  vtkSmartPointer<vtkVolumeMapper> volume_mapper;  // latest mapper
  vtkSmartPointer<vtkFixedPointVolumeRayCastMapper> fixed_point;

  void appearance(const ParallelView& view, const Vec3& eye) {
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetPosition(eye.data());
    camera->SetFocalPoint(view.center_lps_mm.data());
    camera->SetViewUp(view.up_lps.data());
    renderer->ResetCameraClippingRange();
    window->Render();
    window->WaitForCompletion();
  }
};

VtkPeer::VtkPeer(const PictureSize& size) : impl_(std::make_shared<Impl>()) {
  impl_->size = size;
  vtkRenderWindow& window = *impl_->window;
  window.SetOffScreenRendering(1);
  window.SetMultiSamples(0);
  window.SetAlphaBitPlanes(1);
  window.SetSize(size.width, size.height);
  window.AddRenderer(impl_->renderer);
  impl_->renderer->SetBackground(0, 0, 0);
  impl_->renderer->SetBackgroundAlpha(0);
}

void VtkPeer::add_volume(const MaskedVolume& volume, const GreyAppearance& appearance, VtkVolumeMapper mapper,
                         double step_mm) {
  const auto step = static_cast<float>(step_mm);
  vtkSmartPointer<vtkVolumeMapper>& volume_mapper = impl_->volume_mapper;
  if (mapper == VtkVolumeMapper::kGpu) {
    volume_mapper = gpu_mapper(step);
  } else {
    impl_->fixed_point = fixed_point_mapper(step);
    volume_mapper = impl_->fixed_point;
  }
  volume_mapper->SetInputDataObject(padded_image(volume));
  vtkNew<vtkVolume> prop;
  prop->SetMapper(volume_mapper);
  prop->SetProperty(property_of(appearance));
  prop->SetUserMatrix(placement(volume.grid));
  impl_->renderer->AddVolume(prop);
}

void VtkPeer::replace_volume(const MaskedVolume& volume) {
  impl_->volume_mapper->SetInputDataObject(padded_image(volume));
}

void VtkPeer::shade_volumes(bool lit) {
  vtkVolumeCollection& volumes = *impl_->renderer->GetVolumes();
  for (int n = 0; n < volumes.GetNumberOfItems(); ++n)
    static_cast<vtkVolume*>(volumes.GetItemAsObject(n))->GetProperty()->SetShade(lit ? 1 : 0);
}

void VtkPeer::add_surface(const SurfaceMesh& mesh, const Grid& grid, const std::array<double, 3>& color,
                          double opacity) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(poly_data(mesh, grid));
  vtkNew<vtkActor> actor;
  actor->SetMapper(mapper);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->SetOpacity(opacity);
  impl_->renderer->AddActor(actor);
}

void VtkPeer::peel_depths() {
  vtkRenderer& renderer = *impl_->renderer;
  renderer.UseDepthPeelingOn();
  renderer.UseDepthPeelingForVolumesOn();
  renderer.SetMaximumNumberOfPeels(kMaxPeels);
  renderer.SetOcclusionRatio(0);
}

void VtkPeer::render(const ParallelView& view) {
  vtkCamera* camera = impl_->renderer->GetActiveCamera();
  camera->ParallelProjectionOn();
  camera->SetParallelScale(0.5 * view.size.height * view.mm_per_pixel);
  // Anywhere in front of the scene.
  Vec3 eye = view.center_lps_mm;
  for (std::size_t a = 0; a < 3; ++a) eye[a] -= 1000 * view.forward_lps[a];
  impl_->appearance(view, eye);
}

void VtkPeer::render(const reference::PerspectiveView& view) {
  vtkCamera* camera = impl_->renderer->GetActiveCamera();
  camera->ParallelProjectionOff();
  camera->SetViewAngle(view.vertical_fov_deg);
  impl_->appearance(view.in_plane, view.eye_lps_mm());
}

Picture VtkPeer::picture() const {
  if (impl_->fixed_point != nullptr && impl_->renderer->GetViewProps()->GetNumberOfItems() == 1) {
    return cast_image(*impl_->fixed_point, impl_->size);
  }
  const auto [width, height] = impl_->size;
  vtkNew<vtkUnsignedCharArray> bytes;
  impl_->window->GetRGBACharPixelData(0, 0, width - 1, height - 1, 0, bytes);
  Picture picture{impl_->size, {}};
  picture.rgba.reserve(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int row = height - 1; row >= 0; --row) {
    const unsigned char* first = bytes->GetPointer(4 * static_cast<vtkIdType>(row) * width);
    for (int n = 0; n < 4 * width; ++n) picture.rgba.push_back(static_cast<float>(first[n]) / 255.0f);
  }
  return picture;
}

}  // namespace splatlas
