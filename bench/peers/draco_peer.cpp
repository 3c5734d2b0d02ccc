#include "bench/peers/draco_peer.h"

#include <array>
#include <string>
#include <vector>

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

namespace splatlas::draco_peer {
namespace {

void add_attribute(const std::vector<std::array<float, 3>>& values, draco::GeometryAttribute::Type type,
                   draco::Mesh& mesh) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
  const int id = mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(values.size()));
  for (std::uint32_t v = 0; v < values.size(); ++v)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(v), values[v].data());
}

}  // namespace

Result<std::vector<std::byte>> encode(const SurfaceMesh& surface, const Settings& settings) {
  if (surface.empty()) return std::vector<std::byte>{};
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(surface.positions_ijk.size()));
  add_attribute(surface.positions_ijk, draco::GeometryAttribute::POSITION, mesh);
  if (settings.normal_bits > 0) add_attribute(surface.normals_lps, draco::GeometryAttribute::NORMAL, mesh);
  mesh.SetNumFaces(surface.triangles.size());
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    mesh.SetFace(draco::FaceIndex(t), {draco::PointIndex(a), draco::PointIndex(b), draco::PointIndex(c)});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(0, 0);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, settings.position_bits);
  if (settings.normal_bits > 0)
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, settings.normal_bits);
  draco::EncoderBuffer buffer;
  if (const draco::Status status = encoder.EncodeMeshToBuffer(mesh, &buffer); !status.ok()) {
    return fail(ErrorCode::kFailed, "Draco: " + status.error_msg_string());
  }
  const auto* const bytes = reinterpret_cast<const std::byte*>(buffer.data());
  return std::vector<std::byte>(bytes, bytes + buffer.size());
}

Result<std::uint64_t> decode(std::span<const std::byte> file) {
  if (file.empty()) return std::uint64_t{0};
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(file.data()), file.size());
  auto mesh = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) return fail(ErrorCode::kFailed, "Draco: " + mesh.status().error_msg_string());
  return std::uint64_t{mesh.value()->num_faces()};
}

}  // namespace splatlas::draco_peer
