#include <array>

#include "bench/bench.h"

namespace splatlas {

std::span<const Bench> benches() {
  static constexpr std::array kBenches{
      Bench{"phantom", "the paper's tables 1 and 2: the phantom's counts, and cost against full traversal",
            run_phantom_bench},
      Bench{"head", "the paper's tables 3 and 4 on the Colin 27 head: cost against full traversal",
            run_head_bench},
      Bench{"models",
            "one run model, one per level of the tree, octrees: memory, and the first frame of selections",
            run_models_bench},
      Bench{"scale", "1, 2, 4, 8 times the voxels around the same selection, and everything on finer grids",
            run_scale_bench},
      Bench{"size", "bytes of atlases, sections and single structures beside .nii.gz, Draco and crackle",
            run_size_bench},
      Bench{"build", "preprocessing: time by stage, over loading alone, memory", run_build_bench},
#ifdef SPLATLAS_HAS_PEERS
      Bench{"error", "run time against error, ours at every quality beside VolPack and VTK", run_error_bench},
      Bench{"hybrid", "surfaces mixed with volume, beside VTK's depth peeling and FixedPoint with surfaces",
            run_hybrid_bench},
      Bench{"numerics", "bias, popping, ripple, threads, stress inputs, orders of convergence",
            run_numerics_bench},
      Bench{"limit", "samples composited against a dense SIMD kernel, two threads against one, traversal",
            run_limit_bench},
      Bench{"skip", "cost against what is selected; selections against atlases of nothing else",
            run_skip_bench},
      Bench{"select", "selection change to the first correct picture, beside VTK's FixedPoint and VolPack",
            run_select_bench},
#endif
  };
  return kBenches;
}

}  // namespace splatlas
