// The truth for volumes: a ray caster in double precision.
#pragma once

#include "tests/reference/optical_field.h"
#include "tests/reference/ray.h"
#include "tests/reference/reference_radiance.h"

namespace splatlas::reference {

/// Light of the trilinear field along a ray from `from_mm` to `to_mm`:
///   color = integral of transmittance(s) * emission(s) ds,  transmittance(s) = exp(-integral of extinction).
/// Between two planes of voxel centres the field is a cubic along the ray, so the ray is cut at every plane;
/// the optical depth is then a polynomial of degree four, taken exactly, and the colour a smooth integrand,
/// taken by Gauss-Legendre's rule on steps of an optical depth of at most 1/4: exact to about 1e-12.
[[nodiscard]] RayRadiance integrate_ray(const OpticalField& field, const Ray& ray, double from_mm,
                                        double to_mm);

/// All of the ray.
[[nodiscard]] RayRadiance integrate_ray(const OpticalField& field, const Ray& ray);

}  // namespace splatlas::reference
