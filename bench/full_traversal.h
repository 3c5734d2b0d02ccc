// The paper's unit of cost (section 4): "a non-optimized version of the traversal algorithm using the
// original voxel model without RDT and RL".
#pragma once

#include <memory>
#include <vector>

#include "bench/voxel_model.h"
#include "format/decision_tree.h"
#include "format/system/thread_pool.h"
#include "player/frame/sheet_frame.h"
#include "player/transfer/volume_appearances.h"

namespace splatlas {

/// Every frame visits every voxel of the volume and every triangle of every structure, to test whether it is
/// selected. What is selected is then drawn by the player's own code, so that only the traversal differs, and
/// the pictures are the player's bit for bit. Not for use by several threads at once; works on its own
/// threads inside.
class FullTraversal {
 public:
  /// `model` is the atlas's and must outlive this. 0 threads: one per core.
  FullTraversal(std::shared_ptr<const Atlas> atlas, const VoxelModel& model, unsigned threads);

  /// Which classes and structures are drawn: a flag each, which is all that the traversal knows of them.
  /// `selection` is one of the atlas's graph.
  void select(const Selection& selection);

  struct Frame {
    Picture picture;
    Elapsed traversal;  ///< voxels, light and triangles
    FrameCounters drawn;
  };
  [[nodiscard]] Result<Frame> render(const Camera& camera, const RenderOptions& options);

 private:
  void visit_triangles();
  [[nodiscard]] std::vector<SurfaceDraw> surface_draws() const;

  std::shared_ptr<const Atlas> atlas_;
  const VoxelModel& model_;
  ThreadPool pool_;

  Selection selection_;
  DrawPlan plan_;
  VolumeAppearances appearances_;             // of plan_.classes
  std::vector<std::uint32_t> draw_of_class_;  // index into plan_.classes, or VoxelSelection::kNotDrawn
  std::vector<bool> draws_surface_;           // per structure

  std::vector<std::vector<StructureIndex>> owners_;  // per structure and triangle: whose it is
  std::vector<SurfaceMesh> meshes_;                  // per structure: its vertices, the frame's triangles
  FrameBuffers buffers_;
};

}  // namespace splatlas
