// Layout of a stream, which is empty for a surface without vertices:
//   u32 length of the vertex code, u32 length of the index code, vertex code, index code, rotations
// Vertices are u16 or u32 x, y, z and a u16 normal. meshoptimizer's index codec keeps the order of triangles
// but may rotate the corners of a triangle. The rotations, two bits per triangle, restore them. They are
// omitted if every triangle is in its lexicographically smallest rotation.
#include "format/codec/surface_codec.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

#include <meshoptimizer.h>

#include "format/content/unit_vector.h"
#include "format/result_macros.h"

namespace splatlas {

namespace {

using Triangle = std::array<std::uint32_t, 3>;
static_assert(sizeof(Triangle) == 12);

/// Position in units of 1 / position_scale voxel, relative to voxel index -1.
template <typename Coordinate>
struct Vertex {
  std::array<Coordinate, 3> position;
  std::conditional_t<sizeof(Coordinate) == 2, std::uint16_t, std::uint32_t> normal;
};
static_assert(sizeof(Vertex<std::uint16_t>) == 8 && sizeof(Vertex<std::uint32_t>) == 16);

/// Position scales of fitted surfaces.
constexpr std::array kFittedScales{static_cast<std::uint32_t>(SurfaceRule::kVoxels),
                                   static_cast<std::uint32_t>(SurfaceRule::kUneven),
                                   static_cast<std::uint32_t>(SurfaceRule::kSmooth)};
constexpr std::size_t kLengthsBytes = 2 * sizeof(std::uint32_t);
/// First bytes of the codes: meshoptimizer's decoders take other versions, too.
constexpr std::byte kVertexHeader{0xa0}, kIndexHeader{0xe1};

std::uint64_t max_coordinate(std::int64_t size, std::uint32_t scale) {
  return static_cast<std::uint64_t>(size + 1) * scale;
}
bool fits_16_bits(const Index3& size, std::uint32_t scale) {
  return max_coordinate(std::ranges::max(size), scale) <= std::numeric_limits<std::uint16_t>::max();
}
std::size_t rotation_bytes(std::size_t triangles) {
  return (triangles + 3) / 4;
}

float position_of(std::uint64_t coordinate, std::uint32_t scale) {
  return static_cast<float>(static_cast<double>(static_cast<std::int64_t>(coordinate) - scale) / scale);
}

Triangle rotated(const Triangle& t, unsigned by) {
  return {t[by % 3], t[(by + 1) % 3], t[(by + 2) % 3]};
}
Triangle smallest_rotation(const Triangle& t) {
  return std::min({t, rotated(t, 1), rotated(t, 2)});
}

/// Number of rotations from the smallest rotation of `t` to `t`.
unsigned turns(const Triangle& t) {
  const Triangle smallest = smallest_rotation(t);
  for (unsigned by = 1; by < 3; ++by) {
    if (smallest != t && rotated(smallest, by) == t) return by;
  }
  return 0;
}

/// Sets meshoptimizer's global encoder versions to those of this format.
void set_mesh_code_versions() {
  static std::once_flag once;
  std::call_once(once, [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
  });
}

template <typename Coordinate>
Result<std::vector<Vertex<Coordinate>>> quantize(const SurfaceMesh& mesh, const Index3& size) {
  std::vector<Vertex<Coordinate>> vertices(mesh.positions_ijk.size());
  const std::uint32_t scale = mesh.position_scale;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const auto& position = mesh.positions_ijk[v];
    for (std::size_t a = 0; a < 3; ++a) {
      const double counted = std::round((static_cast<double>(position[a]) + 1) * scale);
      if (!(counted >= 0 && counted <= static_cast<double>(max_coordinate(size[a], scale)))) {
        return fail(ErrorCode::kFailed, "vertex {} at ({}, {}, {}) lies outside the grid of {}x{}x{} voxels",
                    v, position[0], position[1], position[2], size[0], size[1], size[2]);
      }
      const auto coordinate = static_cast<std::uint64_t>(counted);
      if (position_of(coordinate, scale) != position[a]) {
        return fail(ErrorCode::kFailed, "vertex {} at ({}, {}, {}) is not at multiples of 1/{} voxel", v,
                    position[0], position[1], position[2], scale);
      }
      vertices[v].position[a] = static_cast<Coordinate>(coordinate);
    }
    const auto& normal = mesh.normals_lps[v];
    if (!std::ranges::all_of(normal, [](float n) { return std::isfinite(n); })) {
      return fail(ErrorCode::kFailed, "the normal of vertex {} is not finite", v);
    }
    vertices[v].normal = pack_normal(normal);
  }
  return vertices;
}

template <typename Coordinate>
Result<std::vector<std::byte>> encode_vertices(const SurfaceMesh& mesh, const Index3& size) {
  SPLATLAS_ASSIGN_OR_RETURN(const auto vertices, quantize<Coordinate>(mesh, size));
  constexpr std::size_t kVertexBytes = sizeof(Vertex<Coordinate>);
  std::vector<std::byte> code(meshopt_encodeVertexBufferBound(vertices.size(), kVertexBytes));
  code.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(code.data()), code.size(),
                                         vertices.data(), vertices.size(), kVertexBytes));
  return code;
}

std::vector<std::byte> encode_indices(const SurfaceMesh& mesh) {
  if (mesh.triangles.empty()) return {};
  const std::size_t indices = mesh.triangles.size() * 3;
  std::vector<std::byte> code(meshopt_encodeIndexBufferBound(indices, mesh.positions_ijk.size()));
  code.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(code.data()), code.size(),
                                        mesh.triangles.front().data(), indices));
  return code;
}

/// Two bits per triangle, the first in the lowest bits; empty if all are 0.
std::vector<std::byte> encode_rotations(std::span<const Triangle> triangles) {
  std::vector<std::byte> bytes(rotation_bytes(triangles.size()));
  bool any = false;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const unsigned by = turns(triangles[t]);
    any = any || by != 0;
    bytes[t / 4] |= static_cast<std::byte>(by << (t % 4 * 2));
  }
  if (!any) bytes.clear();
  return bytes;
}

Result<void> check_mesh(const SurfaceMesh& mesh, const Index3& size) {
  constexpr std::size_t kMax = std::numeric_limits<std::uint32_t>::max();
  const std::size_t vertices = mesh.positions_ijk.size();
  if (mesh.normals_lps.size() != vertices) {
    return fail(ErrorCode::kFailed, "{} normals of {} vertices", mesh.normals_lps.size(), vertices);
  }
  if (vertices > kMax || mesh.triangles.size() > kMax) {
    return fail(ErrorCode::kFailed, "{} vertices and {} triangles (limit {})", vertices,
                mesh.triangles.size(), kMax);
  }
  if (mesh.position_scale == 0 || max_coordinate(std::ranges::max(size), mesh.position_scale) > kMax) {
    return fail(ErrorCode::kFailed, "position scale {} in a grid of {}x{}x{} voxels", mesh.position_scale,
                size[0], size[1], size[2]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (std::ranges::max(mesh.triangles[t]) >= vertices) {
      return fail(ErrorCode::kFailed, "triangle {} has vertex {} of {}", t,
                  std::ranges::max(mesh.triangles[t]), vertices);
    }
  }
  return {};
}

Result<void> check_code_header(std::span<const std::byte> code, std::byte header, const char* name) {
  if (!code.empty() && code.front() == header) return {};
  return code.empty()
             ? invalid_atlas("the {} code is empty", name)
             : invalid_atlas("the {} code begins with {:#04x}, expected {:#04x}", name,
                             std::to_integer<unsigned>(code.front()), std::to_integer<unsigned>(header));
}

template <typename Coordinate>
Result<void> decode_vertices(std::span<const std::byte> code, std::uint32_t count, const Index3& size,
                             SurfaceMesh& mesh) {
  SPLATLAS_RETURN_IF_ERROR(check_code_header(code, kVertexHeader, "vertex"));
  std::vector<Vertex<Coordinate>> vertices(count);
  if (meshopt_decodeVertexBuffer(vertices.data(), count, sizeof(Vertex<Coordinate>),
                                 reinterpret_cast<const unsigned char*>(code.data()), code.size()) != 0) {
    return invalid_atlas("vertices cannot be decoded");
  }
  mesh.positions_ijk.resize(count);
  mesh.normals_lps.resize(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint64_t coordinate = vertices[v].position[a];
      if (coordinate > max_coordinate(size[a], mesh.position_scale)) {
        return invalid_atlas("vertex {} lies outside the grid", v);
      }
      mesh.positions_ijk[v][a] = position_of(coordinate, mesh.position_scale);
    }
    if (vertices[v].normal > std::numeric_limits<PackedNormal>::max()) {
      return invalid_atlas("vertex {} has normal {}", v, vertices[v].normal);
    }
    mesh.normals_lps[v] = unpack_normal(static_cast<PackedNormal>(vertices[v].normal));
  }
  return {};
}

Result<void> decode_triangles(std::span<const std::byte> code, std::span<const std::byte> rotations,
                              const SurfaceEntry& entry, std::vector<Triangle>& triangles) {
  triangles.resize(entry.triangles);
  if (triangles.empty()) return {};
  SPLATLAS_RETURN_IF_ERROR(check_code_header(code, kIndexHeader, "index"));
  if (meshopt_decodeIndexBuffer(triangles.front().data(), triangles.size() * 3, sizeof(std::uint32_t),
                                reinterpret_cast<const unsigned char*>(code.data()), code.size()) != 0) {
    return invalid_atlas("triangles cannot be decoded");
  }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (std::ranges::max(triangles[t]) >= entry.vertices) {
      return invalid_atlas("triangle {} has vertex {} of {}", t, std::ranges::max(triangles[t]),
                           entry.vertices);
    }
    const unsigned by =
        rotations.empty() ? 0 : (std::to_integer<unsigned>(rotations[t / 4]) >> (t % 4 * 2)) & 3;
    if (by == 3) return invalid_atlas("triangle {} has rotation 3", t);
    triangles[t] = rotated(smallest_rotation(triangles[t]), by);
  }
  return {};
}

}  // namespace

Result<EncodedSurface> encode_surface(const SurfaceMesh& mesh, const Index3& size) {
  SPLATLAS_RETURN_IF_ERROR(check_mesh(mesh, size));
  EncodedSurface surface;
  surface.entry = {static_cast<std::uint32_t>(mesh.positions_ijk.size()),
                   static_cast<std::uint32_t>(mesh.triangles.size()), mesh.position_scale, 0};
  if (mesh.positions_ijk.empty()) return surface;

  set_mesh_code_versions();
  SPLATLAS_ASSIGN_OR_RETURN(const auto vertices, fits_16_bits(size, mesh.position_scale)
                                                     ? encode_vertices<std::uint16_t>(mesh, size)
                                                     : encode_vertices<std::uint32_t>(mesh, size));
  const std::vector<std::byte> indices = encode_indices(mesh), rotations = encode_rotations(mesh.triangles);
  const std::size_t total = kLengthsBytes + vertices.size() + indices.size() + rotations.size();
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    return fail(ErrorCode::kFailed, "the surface takes {} bytes (limit 4 GiB)", total);
  }
  surface.entry.bytes = static_cast<std::uint32_t>(total);
  const std::array<std::uint32_t, 2> lengths{static_cast<std::uint32_t>(vertices.size()),
                                             static_cast<std::uint32_t>(indices.size())};
  surface.bytes.resize(kLengthsBytes);
  std::memcpy(surface.bytes.data(), lengths.data(), kLengthsBytes);
  for (const auto* part : {&vertices, &indices, &rotations}) {
    surface.bytes.insert(surface.bytes.end(), part->begin(), part->end());
  }
  return surface;
}

Result<SurfaceMesh> decode_surface(std::span<const std::byte> bytes, const SurfaceEntry& entry,
                                   const Index3& size) {
  SurfaceMesh mesh;
  mesh.position_scale = entry.position_scale;
  if (entry.vertices == 0) return mesh;
  std::array<std::uint32_t, 2> lengths{};
  if (bytes.size() < kLengthsBytes) return invalid_atlas("the stream is too short");
  std::memcpy(lengths.data(), bytes.data(), kLengthsBytes);
  bytes = bytes.subspan(kLengthsBytes);
  if (lengths[0] > bytes.size() || lengths[1] > bytes.size() - lengths[0])
    return invalid_atlas("wrong length of its parts");
  const auto vertices = bytes.first(lengths[0]), indices = bytes.subspan(lengths[0], lengths[1]);
  const auto rotations = bytes.subspan(std::size_t{lengths[0]} + lengths[1]);
  if (!rotations.empty() && rotations.size() != rotation_bytes(entry.triangles)) {
    return invalid_atlas("wrong length of the rotations");
  }
  if (fits_16_bits(size, entry.position_scale)) {
    SPLATLAS_RETURN_IF_ERROR(decode_vertices<std::uint16_t>(vertices, entry.vertices, size, mesh));
  } else {
    SPLATLAS_RETURN_IF_ERROR(decode_vertices<std::uint32_t>(vertices, entry.vertices, size, mesh));
  }
  SPLATLAS_RETURN_IF_ERROR(decode_triangles(indices, rotations, entry, mesh.triangles));
  return mesh;
}

Result<void> check_surface_entry(const SurfaceEntry& entry, const Index3& size) {
  if (entry.position_scale == 0 || max_coordinate(std::ranges::max(size), entry.position_scale) >
                                       std::numeric_limits<std::uint32_t>::max()) {
    return invalid_atlas("position scale {}", entry.position_scale);
  }
  if (entry.vertices == 0) {
    if (entry.triangles == 0 && entry.bytes == 0) return {};
    return invalid_atlas("no vertices, {} triangles, {} bytes", entry.triangles, entry.bytes);
  }
  if (is_fitted(entry)) {  // fitting checks the counts
    if (std::ranges::count(kFittedScales, entry.position_scale) == 0 || entry.triangles == 0) {
      return invalid_atlas("fitted, with position scale {} and {} triangles", entry.position_scale,
                           entry.triangles);
    }
    if (admits(size, rule_of(entry))) return {};
    return invalid_atlas("smoothed, in a grid of more than {} voxels along an axis", kMaxSmoothSize);
  }
  const std::size_t vertex_bytes = fits_16_bits(size, entry.position_scale) ? sizeof(Vertex<std::uint16_t>)
                                                                            : sizeof(Vertex<std::uint32_t>);
  // The codecs use at least one byte per triangle and, with eight byte lanes, one bit per vertex.
  const std::uint64_t min_bytes = kLengthsBytes + std::uint64_t{entry.triangles} + entry.vertices / 8;
  const std::uint64_t max_bytes =
      kLengthsBytes + meshopt_encodeVertexBufferBound(entry.vertices, vertex_bytes) +
      meshopt_encodeIndexBufferBound(std::size_t{entry.triangles} * 3, entry.vertices) +
      rotation_bytes(entry.triangles);
  if (entry.bytes < min_bytes || entry.bytes > max_bytes) {
    return invalid_atlas("{} bytes for {} vertices and {} triangles", entry.bytes, entry.vertices,
                         entry.triangles);
  }
  return {};
}

}  // namespace splatlas
