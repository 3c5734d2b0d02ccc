#include "format/derive/surface_net.h"

#include <bit>
#include <cstring>

#include "format/tasks/task_control.h"

namespace splatlas {
namespace {

/// Rows of a crop with one bit per voxel, lowest first. The outermost voxels are outside.
class BitRows {
 public:
  using Word = std::uint64_t;
  static constexpr std::int64_t kBits = 64;

  explicit BitRows(const StructureCrop& crop)
      : height_(crop.size[1]), words_(static_cast<std::size_t>(crop.size[0] / kBits + 1)) {
    const auto rows = static_cast<std::size_t>(crop.size[1] * crop.size[2]);
    inside_.resize(rows * words_ + 1);  // bits_at() reads a byte more
    boundary_.resize(rows * words_);
    for (std::int64_t k = 1; k + 1 < crop.size[2]; ++k) {
      for (std::int64_t j = 1; j + 1 < crop.size[1]; ++j)
        fill_row(&crop.parts[crop.offset(0, j, k)], static_cast<std::size_t>(crop.size[0]), row_at(j, k));
    }
  }

  /// Words from a row to the next.
  [[nodiscard]] std::size_t words() const { return words_; }
  [[nodiscard]] const Word* inside(std::int64_t j, std::int64_t k) const { return &inside_[row_at(j, k)]; }
  [[nodiscard]] const Word* boundary(std::int64_t j, std::int64_t k) const {
    return &boundary_[row_at(j, k)];
  }
  /// Bits i and i + 1 of a row.
  [[nodiscard]] static unsigned bits_at(const Word* row, std::int64_t i) {
    std::uint16_t bits = 0;
    std::memcpy(&bits, reinterpret_cast<const unsigned char*>(row) + (i >> 3), sizeof bits);
    return unsigned{bits} >> (i & 7) & 3u;
  }
  /// Bit n: voxel n + 1 of the row.
  [[nodiscard]] Word successors(const Word* row, std::size_t w) const {
    return row[w] >> 1 | (w + 1 < words_ ? row[w + 1] << (kBits - 1) : 0);
  }
  /// Bit n: voxel n - 1 of the row.
  [[nodiscard]] static Word predecessors(const Word* row, std::size_t w) {
    return row[w] << 1 | (w > 0 ? row[w - 1] >> (kBits - 1) : 0);
  }

 private:
  [[nodiscard]] std::size_t row_at(std::int64_t j, std::int64_t k) const {
    return static_cast<std::size_t>(k * height_ + j) * words_;
  }
  void fill_row(const std::uint8_t* parts, std::size_t width, std::size_t word) {
    static_assert(StructureCrop::kInterior == 1 && StructureCrop::kBoundary == 2);
    constexpr std::size_t kTogether = 8;
    constexpr Word kOnes = 0x0101010101010101, kGather = 0x0102040810204080;  // lowest bits to the top byte
    const auto fill = [&](std::size_t i, Word bytes) {
      const Word boundary = bytes >> 1 & kOnes, inside = boundary | (bytes & kOnes);
      inside_[word + i / kBits] |= inside * kGather >> 56 << i % kBits;
      boundary_[word + i / kBits] |= boundary * kGather >> 56 << i % kBits;
    };
    std::size_t i = 0;
    for (; i + kTogether <= width; i += kTogether) {
      Word bytes = 0;
      std::memcpy(&bytes, parts + i, kTogether);
      if (bytes != 0) fill(i, bytes);
    }
    for (; i < width; ++i) fill(i, parts[i]);
    for (auto* bits : {&inside_, &boundary_}) {
      (*bits)[word] &= ~Word{1};
      (*bits)[word + (width - 1) / kBits] &= ~(Word{1} << (width - 1) % kBits);
    }
  }

  std::int64_t height_;
  std::size_t words_;  // per row
  std::vector<Word> inside_, boundary_;
};

/// Visits the cells of a crop by leading voxel, 64 voxels at a time.
class NetWalker {
 public:
  NetWalker(const StructureCrop& crop, SurfaceNet reused)
      : crop_(crop), rows_(crop), builder_(count_vertices(), std::move(reused)) {
    for (Slice& slice : slices_) slice.ids.resize(static_cast<std::size_t>(crop.size[0] * crop.size[1]));
    around_.resize(rows_.words());
  }

  SurfaceNet walk() {
    for (std::int64_t k = 0; k + 1 < crop_.size[2]; ++k) {
      check_task();
      slices_[static_cast<std::size_t>((k + 1) % 3)].live_from = builder_.next_id();
      if (k == 0) {  // such rows have no voxels: only cells without a leading voxel
        for (Around& around : around_) around = {};
      }
      for (std::int64_t j = 0; j < 2; ++j) load_row(j, k);
      for (std::int64_t j = 0; j + 1 < crop_.size[1]; ++j) {
        if (j > 0) load_row(j + 1, k);
        for (std::size_t w = 0; w < rows_.words(); ++w) {
          add_cells_led_from(j, k, w);
          add_cells_without_leading_voxel(j, k, w);
        }
      }
    }
    return builder_.finish();
  }

 private:
  using Word = BitRows::Word;

  /// Ids of the vertices on edges from the voxels of a slice.
  struct Slice {
    std::vector<std::array<std::uint32_t, 4>> ids;  // [voxel][axis]
    std::uint32_t live_from = 1;                    // smaller ids are of a slice before
  };
  /// Two voxels of a row of a cell, for 64 cells. [0]: a voxel and its successor; [1]: its predecessor.
  struct Pairs {
    std::array<Word, 2> any{}, all{}, any_boundary{};
  };
  /// [slice k - 1, k, k + 1][row j % 3]
  using Around = std::array<std::array<Pairs, 3>, 3>;

  [[nodiscard]] std::size_t count_vertices() const {
    std::size_t count = 0;
    const auto add = [&](Word crossed) {
      if (crossed != 0) count += static_cast<std::size_t>(std::popcount(crossed));
    };
    for (std::int64_t k = 0; k + 1 < crop_.size[2]; ++k) {
      for (std::int64_t j = 0; j + 1 < crop_.size[1]; ++j) {
        const Word *row = rows_.inside(j, k), *next = rows_.inside(j + 1, k), *above = rows_.inside(j, k + 1);
        for (std::size_t w = 0; w < rows_.words(); ++w) {
          add(row[w] ^ rows_.successors(row, w));
          add(row[w] ^ next[w]);
          add(row[w] ^ above[w]);
        }
      }
    }
    return count;
  }

  [[nodiscard]] Pairs pairs_at(std::int64_t j, std::int64_t k, std::size_t w) const {
    const Word *in = rows_.inside(j, k), *edge = rows_.boundary(j, k);
    const Word after = rows_.successors(in, w), before = BitRows::predecessors(in, w);
    return {{in[w] | after, in[w] | before},
            {in[w] & after, in[w] & before},
            {edge[w] | rows_.successors(edge, w), edge[w] | BitRows::predecessors(edge, w)}};
  }

  /// Adds row j of slices k - 1 to k + 1 to the rows around.
  void load_row(std::int64_t j, std::int64_t k) {
    for (std::size_t w = 0; w < rows_.words(); ++w) {
      for (std::int64_t slice = std::max<std::int64_t>(k - 1, 0); slice <= k + 1; ++slice)
        around_[w][static_cast<std::size_t>(slice - k + 1)][static_cast<std::size_t>(j % 3)] =
            pairs_at(j, slice, w);
    }
  }

  /// Adds the cells whose leading voxel is in word w of a row. In a padded crop, it has rows all around.
  void add_cells_led_from(std::int64_t j, std::int64_t k, std::size_t w) {
    const Word* const edge = rows_.boundary(j, k);
    const Word voxels = edge[w];
    if (voxels == 0) return;
    const auto pairs = [&](std::size_t dk, std::size_t dj) {  // 0 to 2, from the row and slice before
      return &around_[w][dk][(static_cast<std::size_t>(j) + dj + 2) % 3];
    };
    const std::array<std::array<const Pairs*, 3>, 3> around{{{pairs(0, 0), pairs(0, 1), pairs(0, 2)},
                                                             {pairs(1, 0), pairs(1, 1), pairs(1, 2)},
                                                             {pairs(2, 0), pairs(2, 1), pairs(2, 2)}}};
    std::array<Word, 8> led{};  // [corner]: voxels that lead the cell with them at that corner
    Word any = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const std::size_t side = corner & 1, dj = corner >> 1 & 1, dk = corner >> 2;
      const std::array<const Pairs*, 4> rows{around[1 - dk][1 - dj], around[1 - dk][2 - dj],
                                             around[2 - dk][1 - dj], around[2 - dk][2 - dj]};
      Word some = 0, every = ~Word{0}, earlier = side == 1 ? BitRows::predecessors(edge, w) : 0;
      for (std::size_t row = 0; row < 4; ++row) {
        some |= rows[row]->any[side];
        every &= rows[row]->all[side];
        if (row < corner >> 1) earlier |= rows[row]->any_boundary[side];
      }
      led[corner] = voxels & some & ~every & ~earlier;
      any |= led[corner];
    }
    for (; any != 0; any &= any - 1) add_cells_of(std::countr_zero(any), j, k, w, led);
  }

  /// Cells in memory order: the voxel is their last corner first.
  void add_cells_of(int bit, std::int64_t j, std::int64_t k, std::size_t w, const std::array<Word, 8>& led) {
    unsigned corners = 0;
    for (unsigned corner = 0; corner < 8; ++corner)
      corners |= static_cast<unsigned>(led[corner] >> bit & 1u) << corner;
    const std::int64_t i = static_cast<std::int64_t>(w) * BitRows::kBits + bit;
    while (corners != 0) {
      const int corner = std::bit_width(corners) - 1;
      corners ^= 1u << corner;
      visit_cell(i - (corner & 1), j - (corner >> 1 & 1), k - (corner >> 2),
                 [&](auto&&... cell) { builder_.add_cell(cell...); });
    }
  }

  /// Only wrong parts cause such cells.
  void add_cells_without_leading_voxel(std::int64_t j, std::int64_t k, std::size_t w) {
    Word some = 0, every = ~Word{0}, boundary = 0;
    for (const std::size_t slice : {1, 2}) {
      for (const std::int64_t row : {j, j + 1}) {
        const Pairs& pairs = around_[w][slice][static_cast<std::size_t>(row % 3)];
        some |= pairs.any[0];
        every &= pairs.all[0];
        boundary |= pairs.any_boundary[0];
      }
    }
    for (Word cells = some & ~every & ~boundary; cells != 0; cells &= cells - 1) {
      visit_cell(static_cast<std::int64_t>(w) * BitRows::kBits + std::countr_zero(cells), j, k,
                 [&](auto&&... cell) { builder_.add_early_cell(cell...); });
    }
  }

  /// Calls visit() with the arguments of NetBuilder::add_cell() for the cell at (i, j, k) of the crop.
  template <typename Visit>
  void visit_cell(std::int64_t i, std::int64_t j, std::int64_t k, const Visit& visit) {
    const unsigned inside = BitRows::bits_at(rows_.inside(j, k), i) |
                            BitRows::bits_at(rows_.inside(j + 1, k), i) << 2 |
                            BitRows::bits_at(rows_.inside(j, k + 1), i) << 4 |
                            BitRows::bits_at(rows_.inside(j + 1, k + 1), i) << 6;
    const std::array<Slice*, 2> slices{&slices_[static_cast<std::size_t>(k % 3)],
                                       &slices_[static_cast<std::size_t>((k + 1) % 3)]};
    const auto at = static_cast<std::size_t>(j * crop_.size[0] + i),
               width = static_cast<std::size_t>(crop_.size[0]);
    const std::array<std::array<std::uint32_t, 4>*, 4> ids{&slices[0]->ids[at], &slices[0]->ids[at + width],
                                                           &slices[1]->ids[at], &slices[1]->ids[at + width]};
    const std::array<std::uint32_t, 2> live_from{slices[0]->live_from, slices[1]->live_from};
    visit(
        std::array<std::int32_t, 3>{static_cast<std::int32_t>(i + crop_.first[0]),
                                    static_cast<std::int32_t>(j + crop_.first[1]),
                                    static_cast<std::int32_t>(k + crop_.first[2])},
        inside,
        [&](const CellEdge& edge) -> std::uint32_t& {
          return ids[edge.corner >> 1][edge.corner & 1u][edge.axis];
        },
        [&](const CellEdge& edge) { return live_from[edge.corner >> 2]; });
  }

  const StructureCrop& crop_;
  BitRows rows_;
  NetBuilder builder_;
  std::array<Slice, 3> slices_;  // [k % 3]
  std::vector<Around> around_;   // [word]
};

}  // namespace

SurfaceNet surface_net(const StructureCrop& crop, SurfaceNet reused) {
  return NetWalker(crop, std::move(reused)).walk();
}

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
