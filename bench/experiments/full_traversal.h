// Full traversal, the unit of cost of the paper (section 4): "a non-optimized version of the traversal
// algorithm using the original voxel model without RDT and RL".
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "bench/experiments/walked_spans.h"
#include "bench/measure/frames.h"
#include "format/tasks/thread_pool.h"

namespace splatlas {

/// The atlas without classes and runs: dense volumes in memory order of the grid, and all surfaces.
struct VoxelModel {
  Grid grid;
  std::vector<ClassId> classes;
  VoxelBuffer values;                 ///< kNone and empty if the atlas has none
  std::vector<SurfaceMesh> surfaces;  ///< per structure
};
[[nodiscard]] Result<VoxelModel> read_voxel_model(const Atlas& atlas);

/// Every frame tests every voxel and every triangle of every structure for selection. The code of the player
/// then draws the selected ones, so that only the traversal differs and pictures equal those of the player
/// bit for bit, without hybrid shading. Not thread-safe; uses its own threads.
class FullTraversal {
 public:
  /// Finds the spans of a selection in another way. They must be the same.
  using FindSpans = std::function<SpanModel(const WalkedScene& scene, Axis axis, ThreadPool& pool)>;

  /// `model` belongs to the atlas and must outlive this.
  FullTraversal(std::shared_ptr<const Atlas> atlas, const VoxelModel& model, unsigned threads,
                FindSpans find_spans = nullptr);

  /// Sets one flag per class and structure, the only input of the traversal. `selection` belongs to the graph
  /// of the atlas.
  void select(const Selection& selection);

  struct Frame {
    Picture picture;
    Elapsed traversal;  ///< voxels, optical properties and triangles
    RenderStats drawn;
    SheetWindow window;  ///< of the sheets
    int planes = 0;      ///< composited colours, and opacity
  };
  [[nodiscard]] Result<Frame> render(const Camera& camera, const RenderOptions& options);

 private:
  void visit_triangles();
  [[nodiscard]] std::vector<SurfaceDraw> surface_draws() const;

  std::shared_ptr<const Atlas> atlas_;
  const VoxelModel& model_;
  ThreadPool pool_;
  FindSpans find_spans_;

  Selection selection_;
  DrawPlan plan_;
  VolumeAppearances appearances_;    // per class of plan_
  std::vector<bool> draws_surface_;  // per structure

  std::vector<std::vector<StructureIndex>> owners_;  // owner of each triangle, per structure
  std::vector<SurfaceClusters> clusters_;            // per structure
  std::vector<SurfaceMesh> meshes_;  // per structure: its vertices and the triangles of the frame
  FrameBuffers buffers_;
};

}  // namespace splatlas
