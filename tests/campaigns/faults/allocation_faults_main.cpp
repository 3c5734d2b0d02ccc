// splatlas-allocation-faults: failing allocations in opening, reading, rendering and writing.
// Each allocation fails alone, then with all later ones. Each time the library must report kLimit, succeed in
// a retry with memory, and leak nothing.

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iterator>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "format/atlas_writer.h"
#include "format/file/reader/value_cache.h"
#include "format/io/checksum.h"
#include "format/result_macros.h"
#include "format/tasks/thread_pool.h"
#include "player/renderer.h"
#include "player/write_png.h"
#include "tests/campaigns/faults/failing_allocator.h"
#include "tests/campaigns/faults/small_atlas.h"
#include "tests/format/atlas_surgery.h"
#include "tests/support/file_bytes.h"
#include "tests/support/run_program.h"

namespace splatlas {
namespace {

namespace fs = std::filesystem;

/// Does the work, or resumes it after a failure. Returns a checksum of the result.
using Work = std::function<Result<std::uint64_t>()>;

struct Scenario {
  std::string name;
  std::function<Work()> begin;
};

/// Opens, selects, renders and encodes. The next attempt reuses the existing objects.
Work rendering(const fs::path& atlas_path, const std::string& selection_text, const Camera& camera,
               const RenderOptions& options) {
  const auto renderer = std::make_shared<std::optional<Renderer>>();
  return [=]() -> Result<std::uint64_t> {
    if (!*renderer) {
      SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(atlas_path));
      renderer->emplace(atlas, RendererOptions{.threads = 2});
    }
    SPLATLAS_ASSIGN_OR_RETURN(const Selection selection,
                              Selection::parse(selection_text, (*renderer)->atlas().graph()));
    SPLATLAS_RETURN_IF_ERROR((*renderer)->select(selection));
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, (*renderer)->render(camera, options));
    static_cast<void>(frame.pick(options.size.width / 2.0, options.size.height / 2.0));
    SPLATLAS_ASSIGN_OR_RETURN(const auto bytes, encode_png(frame.picture));
    return checksum_of(bytes);
  };
}

/// The fault of a renderer whose select() has failed: it picks or draws the selection before; "" for none.
std::string fault_without_selection(Renderer& renderer, const Frame& before, const Camera& camera,
                                    const RenderOptions& options) {
  const auto [width, height] = options.size;
  for (int n = 0; n < width * height; ++n) {
    if (before.pick(n % width + 0.5, n / width + 0.5)) return "the frame before is picked";
  }
  const Result<Frame> frame = renderer.render(camera, options);
  if (!frame) return "nothing cannot be drawn: " + frame.error().message;
  const bool is_clear = std::ranges::all_of(frame->picture.rgba, [](float channel) { return channel == 0; });
  return is_clear ? "" : "the selection before is drawn";
}

/// Draws a selection, and replaces it by another one under faults.
Work selecting(const fs::path& atlas_path, const Camera& camera) {
  const RenderOptions options{.size = {40, 30}};
  const auto renderer =
      std::make_shared<Renderer>(Atlas::open(atlas_path).value(), RendererOptions{.threads = 2});
  const auto selection = [&](const char* text) {
    return Selection::parse(text, renderer->atlas().graph()).value();
  };
  if (!renderer->select(selection("*:both(opacity=0.4)")))
    throw std::runtime_error("the first selection cannot be drawn");
  return [=, before = renderer->render(camera, options).value(),
          next = selection("left:volume + ball:surface")]() -> Result<std::uint64_t> {
    Result<void> selected = fail(ErrorCode::kLimit, "thrown");
    try {
      selected = renderer->select(next);
    } catch (const std::bad_alloc&) {  // for the message
    }
    if (!selected) {
      FailingAllocator::disarm();
      const std::string fault = fault_without_selection(*renderer, before, camera, options);
      if (!fault.empty()) return fail(ErrorCode::kFailed, fault);
      return tl::unexpected(selected.error());
    }
    SPLATLAS_ASSIGN_OR_RETURN(const Frame frame, renderer->render(camera, options));
    return checksum_of(std::as_bytes(std::span(frame.picture.rgba)));
  };
}

/// Verifies, then reads everything.
Work reading(const fs::path& atlas_path) {
  return [=]() -> Result<std::uint64_t> {
    SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(atlas_path));
    SPLATLAS_RETURN_IF_ERROR(atlas->verify());
    SPLATLAS_ASSIGN_OR_RETURN(const AtlasContent content, atlas->read_all());
    return checksum_of(content.values.bytes);
  };
}

Work writing(const AtlasContent& content, const fs::path& path, bool compact) {
  return [&content, path, compact]() -> Result<std::uint64_t> {
    SPLATLAS_RETURN_IF_ERROR(
        write_atlas(content, path, {.level = 3, .compact = compact, .threads = 2, .means_from = 1}));
    return fs::file_size(path);
  };
}

/// Writes the atlas with a wrong byte in every chunk.
void write_damaged(const AtlasContent& content, const fs::path& path) {
  AtlasParts parts = take_apart(encode_atlas(content, {.means_from = 1}).value());
  for (Bytes& chunk : parts.chunks) chunk.back() ^= std::byte{1};
  write_bytes(path.string(), put_together(parts));
}

/// Reads each part of a damaged atlas, on two threads. Returns the number of damaged parts.
Work reading_damaged(const fs::path& atlas_path) {
  const auto opened = std::make_shared<std::shared_ptr<const Atlas>>();
  return [=]() -> Result<std::uint64_t> {
    if (!*opened) {
      SPLATLAS_ASSIGN_OR_RETURN(*opened, Atlas::open(atlas_path));
    }
    const Atlas& atlas = **opened;
    std::atomic<std::uint64_t> damaged = 0;
    std::atomic<bool> is_out_of_memory = false;
    const auto count = [&](const auto& read) {
      if (read) return;
      (read.error().code == ErrorCode::kInvalidAtlas ? void(++damaged) : void(is_out_of_memory = true));
    };
    ThreadPool(2).for_each(atlas.classes().size(), [&](std::size_t n) {
      const auto c = static_cast<ClassId>(n);
      for (const Axis axis : kAxes) count(atlas.read_runs(c, axis));
      count(atlas.read_values(c));
      count(atlas.read_normals(c));
      count(atlas.read_means(c));
    });
    for (StructureIndex s = 0; s < atlas.graph().size(); ++s) count(atlas.read_surface(s));
    if (is_out_of_memory) return fail(ErrorCode::kLimit, "out of memory");
    return damaged.load();
  };
}

/// Takes values of a group that is larger than its cache. Returns the number of decodings.
Work caching() {
  const auto cache = std::make_shared<ValueCache>(1, 1);
  return [=]() -> Result<std::uint64_t> {
    constexpr int kTimes = 200;
    std::uint64_t decodings = 0;
    const auto decode = [&] {
      ++decodings;
      return Result<ValueCache::GroupValues>({{std::byte{1}, std::byte{2}}, {std::byte{3}}});
    };
    for (int n = 0; n < kTimes; ++n) {
      SPLATLAS_ASSIGN_OR_RETURN(const std::vector<std::byte> values, cache->take(0, 0, decode));
      if (values.size() != 2) return fail(ErrorCode::kFailed, "other values");
    }
    return decodings;
  };
}

/// Parallel loops of both kinds.
Work threading() {
  return []() -> Result<std::uint64_t> {
    std::atomic<std::uint64_t> sum = 0;
    ThreadPool(4).for_each(8, [&](std::size_t n) { sum += n; });
    parallel_for(
        8, 4, [&](std::size_t n) { sum += n; }, [](std::size_t) {});
    return sum.load();
  };
}

std::vector<Scenario> scenarios(const AtlasContent& content, const fs::path& folder) {
  const fs::path atlas = folder / "in.atlas", output = folder / "out.atlas";
  const Camera turned{.azimuth_deg = 30, .elevation_deg = 20};
  Camera perspective = turned;
  perspective.projection = CameraProjection::kPerspective;
  const RenderOptions small{.size = {40, 30}};
  RenderOptions after = small, cued = small;
  after.classification = Classification::kAfter;
  cued.depth_cue = DepthCue::kEdges;
  const auto render = [&](const std::string& text, const Camera& camera, const RenderOptions& options) {
    return [=] { return rendering(atlas, text, camera, options); };
  };
  return {{"threads", threading},
          {"value cache", caching},
          {"surface", render("*:surface(opacity=0.5)", turned, small)},
          {"volume", render("*:volume", turned, small)},
          {"hybrid", render("*:both(opacity=0.4)", turned, cued)},
          {"rays", render("*:both(opacity=0.4)", perspective, small)},
          {"rays after", render("*:volume(profile=hard)", turned, after)},
          {"select again", [=] { return selecting(atlas, turned); }},
          {"select again, rays", [=] { return selecting(atlas, perspective); }},
          {"verify, read all", [=] { return reading(atlas); }},
          {"damaged chunks", [=] { return reading_damaged(folder / "damaged.atlas"); }},
          {"write", [=, &content] { return writing(content, output, false); }},
          {"write compact", [=, &content] { return writing(content, output, true); }}};
}

struct Tally {
  std::uint64_t points = 0, errors = 0, thrown = 0, done = 0, wrong = 0;
};

/// One attempt under memory faults; std::bad_alloc counts as kLimit.
struct Attempt {
  Result<std::uint64_t> result = fail(ErrorCode::kLimit, "");
  bool thrown = false, failed = false;
};

Attempt attempt(const Work& work, std::uint64_t number, bool lasting) {
  Attempt outcome;
  FailingAllocator::arm(number, lasting);
  try {
    outcome.result = work();
  } catch (const std::bad_alloc&) {
    outcome.thrown = true;
  }
  outcome.failed = FailingAllocator::count() > number;
  FailingAllocator::disarm();
  return outcome;
}

class Trial {
 public:
  Trial(const Scenario& scenario, const fs::path& folder) : scenario_(scenario), folder_(folder) {
    for (int n = 0; n < 3; ++n) expected_ = scenario_.begin()().value();  // permanent allocations exist now
    names_ = names();
    live_ = FailingAllocator::live();
  }

  /// True if the work reaches the allocation of this number.
  bool strike(std::uint64_t number, bool lasting) {
    std::string complaint;
    bool failed = false;
    {
      const Work work = scenario_.begin();
      const Attempt outcome = attempt(work, number, lasting);
      failed = outcome.failed;
      if (!failed && outcome.result) return false;
      complaint = judge(outcome, work);
    }
    ++tally_.points;
    if (complaint.empty() && leaks(number, lasting)) complaint = "memory leaks";
    if (complaint.empty() && names() != names_) complaint = "a temporary file remains";
    if (!complaint.empty()) {
      ++tally_.wrong;
      fmt::print("  {}, allocation {}{}: {}\n", scenario_.name, number, lasting ? " and all after it" : "",
                 complaint);
    }
    return failed;
  }

  [[nodiscard]] const Tally& tally() const { return tally_; }

 private:
  /// True if memory in use grows with each run. One growth is no leak: each thread keeps a compressor.
  [[nodiscard]] bool leaks(std::uint64_t number, bool lasting) {
    constexpr int kTimes = 3;
    int times = 0;
    while (FailingAllocator::live() > live_ && times++ < kTimes) {
      live_ = FailingAllocator::live();
      const Work work = scenario_.begin();
      static_cast<void>(attempt(work, number, lasting));
      static_cast<void>(work());
    }
    return times > kTimes;
  }

  [[nodiscard]] std::string judge(const Attempt& outcome, const Work& work) {
    ++(outcome.thrown ? tally_.thrown : outcome.result ? tally_.done : tally_.errors);
    if (outcome.result && *outcome.result != expected_) return "success with another result";
    if (!outcome.result && outcome.result.error().code != ErrorCode::kLimit)
      return "another error than out of memory: " + outcome.result.error().message;
    const Result<std::uint64_t> again = work();
    if (!again) return "the retry fails: " + again.error().message;
    return *again == expected_ ? "" : "the retry has another result";
  }

  [[nodiscard]] std::size_t names() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}));
  }

  const Scenario& scenario_;
  fs::path folder_;
  std::uint64_t expected_ = 0;
  std::size_t names_ = 0;
  std::int64_t live_ = 0;
  Tally tally_;
};

/// The points to run: `first` and every `every`-th after it, in scenarios whose name contains `only`.
struct ChosenPoints {
  std::uint64_t every = 1, first = 0;
  std::string only;
};

int run(const ChosenPoints& chosen) {
  const TemporaryFolder temporary;
  const AtlasContent content = small_atlas();
  if (const auto written = write_atlas(content, temporary.path() / "in.atlas"); !written)
    throw std::runtime_error(written.error().message);
  write_damaged(content, temporary.path() / "damaged.atlas");
  fmt::print("{:18} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "", "points", "errors", "thrown", "done", "wrong");
  Tally sum;
  for (const Scenario& scenario : scenarios(content, temporary.path())) {
    if (scenario.name.find(chosen.only) == std::string::npos) continue;
    Trial trial(scenario, temporary.path());
    for (const bool lasting : {false, true}) {
      std::uint64_t number = chosen.first;
      while (trial.strike(number, lasting)) number += chosen.every;
    }
    const Tally& tally = trial.tally();
    fmt::print("{:18} {:8} {:8} {:8} {:8} {:8}\n", scenario.name, tally.points, tally.errors, tally.thrown,
               tally.done, tally.wrong);
    std::fflush(stdout);
    sum.points += tally.points;
    sum.wrong += tally.wrong;
  }
  fmt::print("{} points, {} wrong\n", sum.points, sum.wrong);
  return sum.points > 0 && sum.wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace splatlas

int main(int argc, char** argv) {
  splatlas::ChosenPoints points;
  CLI::App app{"Failure of every allocation", "splatlas-allocation-faults"};
  app.add_option("--every", points.every, "stride of the points")->check(CLI::PositiveNumber);
  app.add_option("--first", points.first, "the first point");
  app.add_option("--only", points.only, "scenarios with this in their names");
  CLI11_PARSE(app, argc, argv);
  try {
    return splatlas::run(points);
  } catch (const std::exception& exception) {
    std::fprintf(stderr, "splatlas-allocation-faults: %s\n", exception.what());
    return 1;
  }
}
