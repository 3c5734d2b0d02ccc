#include "format/derive/net_builder.h"

namespace splatlas {

NetBuilder::NetBuilder(std::size_t vertices, SurfaceNet reused)
    : cases_(cell_cases()), net_(std::move(reused)) {
  if (vertices > kMaxVertices) throw std::bad_array_new_length();
  net_.vertices.resize(vertices + kCellEdges + 1);
  net_.neighbours.resize(net_.vertices.size());
  net_.kinds.resize(net_.vertices.size());
  net_.triangles.resize(2 * vertices + CellCase::kMaxTriangles);
}

void NetBuilder::grow() {
  const auto larger = [](std::size_t size) { return size + size / 2 + kCellEdges; };
  if (vertices_ + kCellEdges >= net_.vertices.size()) {
    net_.vertices.resize(larger(net_.vertices.size()));
    net_.neighbours.resize(net_.vertices.size());
    net_.kinds.resize(net_.vertices.size());
  }
  if (triangles_ + CellCase::kMaxTriangles > net_.triangles.size())
    net_.triangles.resize(larger(net_.triangles.size()));
}

SurfaceNet NetBuilder::finish() {
  net_.vertices.resize(vertices_);
  net_.neighbours.resize(vertices_);
  net_.kinds.resize(vertices_);
  net_.triangles.resize(triangles_);
  if (!early_.empty()) put_early_cells_first();
  return std::move(net_);
}

void NetBuilder::put_early_cells_first() {
  SurfaceNet ordered;
  std::vector<std::uint32_t> number(vertices_, 0);  // plus 1; 0: not used yet
  std::vector<std::uint32_t> old_number;
  const auto take = [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      std::array<std::uint32_t, 3> triangle = net_.triangles[t];
      for (std::uint32_t& vertex : triangle) {
        if (number[vertex] == 0) {
          old_number.push_back(vertex);
          number[vertex] = static_cast<std::uint32_t>(old_number.size());
        }
        vertex = number[vertex] - 1;
      }
      ordered.triangles.push_back(triangle);
    }
  };
  for (const auto& [begin, end] : early_) take(begin, end);
  std::size_t next = 0;
  for (const auto& [begin, end] : early_) {
    take(next, begin);
    next = end;
  }
  take(next, triangles_);
  for (const std::uint32_t old : old_number) {
    ordered.vertices.push_back(net_.vertices[old]);
    ordered.kinds.push_back(net_.kinds[old]);
    std::array<std::uint32_t, 4> neighbours = net_.neighbours[old];
    for (std::uint32_t& neighbour : neighbours) neighbour = number[neighbour] - 1;
    ordered.neighbours.push_back(neighbours);
  }
  net_ = std::move(ordered);
}

}  // namespace splatlas
