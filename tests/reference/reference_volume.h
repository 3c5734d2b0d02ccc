// Reference ray caster for volumes, in double precision.
#pragma once

#include "tests/reference/optical_field.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Radiance of the trilinear field along a ray from `from_mm` to `to_mm`:
///   color = integral of transmittance(s) * emission(s) ds,  transmittance(s) = exp(-integral of extinction).
/// The ray is cut at all planes of voxel centres. Between two of them the field is a cubic, and the optical
/// depth a polynomial of degree four, integrated exactly. The colour is integrated by Gauss-Legendre
/// quadrature over optical depths of at most 1/4, to about 1e-12.
[[nodiscard]] RayRadiance integrate_ray(const OpticalField& field, const Ray& ray, double from_mm,
                                        double to_mm);

/// The whole ray.
[[nodiscard]] RayRadiance integrate_ray(const OpticalField& field, const Ray& ray);

}  // namespace splatlas::reference
