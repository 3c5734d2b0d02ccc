// splatlas._engine: atlases as arrays, and pictures of a PageEngine, for the package in splatlas/.
// Calls of one Player take turns. Work is done on threads of its own, so that Ctrl+C ends it.
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "format/atlas_reader.h"
#include "format/content/cut_planes.h"
#include "format/derive/label_map.h"
#include "format/tasks/task_control.h"
#include "player/web/page_engine.h"
#include "player/web/page_json.h"
#include "player/write_picture.h"
#include "player/write_png.h"

namespace py = pybind11;

namespace splatlas {
namespace {

using Shape = std::vector<py::ssize_t>;

/// `subject` is for errors without one.
template <typename T>
T value_or_fail(Result<T> result, const std::string& subject = {}) {
  if (!result && result.error().subject.empty()) result.error().subject = subject;
  if (!result) throw result.error();
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

/// Without the interpreter.
template <typename Work>
auto released(const Work& work) {
  const py::gil_scoped_release release;
  return work();
}

/// Ctrl+C ends `work`, a task with the budget on a thread of its own: this one asks the interpreter every 50
/// ms, as waiting for it takes time.
template <typename Work>
auto interruptible(const WorkBudget* budget, const Work& work) {
  std::stop_source stop;
  auto result = std::async(std::launch::async, [&] {
    try {
      const TaskControl task(stop.get_token(), {}, budget);
      return work();
    } catch (const OverBudget& over) {
      throw over.error();
    }
  });
  while (released([&] { return result.wait_for(std::chrono::milliseconds(50)); }) !=
         std::future_status::ready) {
    if (PyErr_CheckSignals() == 0) continue;
    stop.request_stop();
    released([&] { result.wait(); });
    throw py::error_already_set();
  }
  return result.get();
}

/// An array that owns `values`: columns first (the first index varies fastest) or rows first.
template <typename T>
py::array array_of(std::vector<T> values, const py::dtype& type, const Shape& shape,
                   bool columns_first = false) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  void* const data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  static_cast<void>(kept.release());
  const auto bytes = type.itemsize();
  return {type, shape,
          columns_first ? py::detail::f_strides(shape, bytes) : py::detail::c_strides(shape, bytes), data,
          owner};
}

/// What `read` makes of the content without grey values: voxels in the order of the source.
template <typename Read>
py::array voxels(const Atlas& atlas, const Read& read) {
  VoxelBuffer buffer = interruptible(&atlas.work_budget(),
                                     [&] { return read(value_or_fail(atlas.read_classes(), atlas.name())); });
  const py::dtype type(name_of(buffer.type));
  const auto& size = atlas.source_grid().size;
  return array_of(std::move(buffer.bytes), type, {size[0], size[1], size[2]}, true);
}

/// An atlas and its renderer.
class Player {
 public:
  Player(std::shared_ptr<const Atlas> atlas, const RendererOptions& renderer)
      : atlas_(std::move(atlas)), options_(renderer), engine_(renderer) {
    engine_.open(atlas_);
  }

  /// Another renderer of the same open file.
  [[nodiscard]] std::shared_ptr<Player> another() const { return std::make_shared<Player>(atlas_, options_); }
  [[nodiscard]] const Atlas& atlas() const { return *atlas_; }

  std::string call(const std::string& request) {
    return in_turn([&] { return answer_of(request); });
  }

  /// Draws, moves the picture to `frame`, and numbers its selection. `select` is the request's.
  std::string draw(const std::string& request, const std::string& select, Frame& frame,
                   std::size_t& selection) {
    return in_turn([&] {
      if (std::exchange(select_, select) != select) ++selections_;
      selection = selections_;
      std::string answer = answer_of(request);
      frame = engine_.take_frame(take_spare());
      return answer;
    });
  }

  [[nodiscard]] std::optional<Pick> pick(const Frame& frame, std::size_t selection, double x, double y) {
    return in_turn([&] {
      if (selection == selections_) return frame.pick(x, y);
      throw Error{ErrorCode::kUsage,
                  "the renderer shows another selection by now; render the picture again to pick in it",
                  {}};
    });
  }

  /// Keeps the memory of a picture for the next one.
  void recycle(Frame frame) {
    const std::lock_guard lock(spare_mutex_);
    spare_ = std::move(frame);
  }

 private:
  /// Ctrl+C also ends the wait for other callers.
  template <typename Work>
  std::invoke_result_t<Work> in_turn(const Work& work) {
    return interruptible(nullptr, [&] {
      std::unique_lock lock(mutex_, std::defer_lock);
      while (!lock.try_lock_for(std::chrono::milliseconds(50))) check_task();
      return work();
    });
  }

  std::string answer_of(const std::string& request) {
    PageAnswer answer = engine_.call(request);
    if (answer.status == 0) return std::move(answer.text);
    throw Error{static_cast<ErrorCode>(answer.status - 1), answer.text, answer.subject};
  }

  Frame take_spare() {
    const std::lock_guard lock(spare_mutex_);
    return std::exchange(spare_, {});
  }

  std::shared_ptr<const Atlas> atlas_;
  RendererOptions options_;
  std::timed_mutex mutex_;  // of what follows
  PageEngine engine_;
  std::string select_;
  std::size_t selections_ = 0;
  std::mutex spare_mutex_;
  Frame spare_;
};

/// A picture, and what it shows.
class Drawing {
 public:
  Drawing(std::shared_ptr<Player> player, const std::string& request, const std::string& select,
          const std::optional<std::string>& background)
      : player_(std::move(player)) {
    if (background) background_ = value_or_fail(parse_color(*background), "background");
    answer = player_->draw(request, select, frame_, selection_);
  }
  ~Drawing() { player_->recycle(std::move(frame_)); }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  [[nodiscard]] Shape shape() const { return {frame_.picture.size.height, frame_.picture.size.width}; }

  [[nodiscard]] py::array srgb() const {
    auto bytes = interruptible(nullptr, [&] {
      return background_ ? to_srgb8(frame_.picture, *background_) : to_srgba8(frame_.picture);
    });
    return array_of(std::move(bytes), py::dtype::of<std::uint8_t>(),
                    {shape()[0], shape()[1], background_ ? 3 : 4});
  }

  [[nodiscard]] py::bytes png() const {
    const auto bytes =
        interruptible(nullptr, [&] { return value_or_fail(encode_png(frame_.picture, background_)); });
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  void save(const std::string& path) const {
    interruptible(nullptr, [&] { value_or_fail(write_picture(frame_.picture, path, background_), path); });
  }

  [[nodiscard]] const Frame& frame() const { return frame_; }
  /// A structure and its point in LPS mm.
  [[nodiscard]] std::optional<std::pair<StructureIndex, Vec3>> pick(double x, double y) const {
    const std::optional<Pick> pick = player_->pick(frame_, selection_, x, y);
    return pick ? std::optional(std::pair(pick->structure, pick->point_lps_mm)) : std::nullopt;
  }

  std::string answer;  ///< of PageEngine::call()

 private:
  std::shared_ptr<Player> player_;
  std::optional<Rgb> background_;  // none: transparent
  std::size_t selection_ = 0;
  Frame frame_;
};

/// An array of the `values` of an `image` of a Drawing's frame, without a copy; None if it has none.
template <py::ssize_t channels, auto image, auto values>
py::object pixels(const py::object& drawing) {
  const auto& self = drawing.cast<const Drawing&>();
  const auto& kept = self.frame().*image.*values;
  if (kept.empty()) return py::none();
  Shape shape = self.shape();
  if (channels > 1) shape.push_back(channels);
  using T = typename std::decay_t<decltype(kept)>::value_type;
  py::array array(py::dtype::of<T>(), std::move(shape), kept.data(), drawing);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// [structure]: one of these or a descendant.
std::vector<bool> below(const StructureGraph& graph, const std::vector<StructureIndex>& structures) {
  std::vector<bool> is_below(graph.size());
  for (const StructureIndex s : graph.descendants(structures)) is_below[s] = true;
  return is_below;
}

void check_type(const Atlas& atlas, VoxelType type, const char* fault) {
  if (type == VoxelType::kNone) throw Error{ErrorCode::kFailed, atlas.name() + ": " + fault, atlas.name()};
}

py::array labels(const Player& player, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = player.atlas();
  check_type(atlas, atlas.label_type(), "was built without a label map; use mask()");
  return voxels(atlas, [&](const AtlasContent& content) {
    const std::vector<bool> is_wanted = below(atlas.graph(), structures);
    return value_or_fail(label_map(content, atlas.name(), "use mask()", is_wanted), atlas.name());
  });
}

py::array mask(const Player& player, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = player.atlas();
  const py::array bytes = voxels(atlas, [&](const AtlasContent& content) {
    const std::vector<bool> is_wanted = below(atlas.graph(), structures);
    std::vector<std::byte> in_class(content.classes.size());
    for (ClassId c = 0; c < content.classes.size(); ++c) {
      for (const Membership& m : content.classes.members(c)) {
        if (m.holds() && is_wanted[m.structure]) in_class[c] = std::byte{1};
      }
    }
    VoxelBuffer stored{VoxelType::kUInt8, {}};
    stored.bytes.reserve(content.class_volume.size());
    for (const ClassId c : content.class_volume) stored.bytes.push_back(in_class[c]);
    return to_source_order(stored, content);
  });
  return bytes.attr("view")("bool");
}

py::array volume(const Player& player) {
  const Atlas& atlas = player.atlas();
  check_type(atlas, atlas.value_type(), "has no grey values; build it with a volume");
  return voxels(atlas, [&](const AtlasContent& content) {
    return to_source_order(value_or_fail(atlas.read_value_volume(content.class_volume), atlas.name()),
                           content);
  });
}

/// Vertices in RAS mm, triangles and normals of the structures and their descendants.
py::tuple surface(const Player& player, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = player.atlas();
  std::vector<double> vertices;
  std::vector<float> normals;
  std::vector<std::uint32_t> triangles;
  interruptible(&atlas.work_budget(), [&] {
    const Affine to_lps = index_to_lps_mm(atlas.grid());
    for (const StructureIndex s : atlas.graph().descendants(structures)) {
      const SurfaceMesh mesh = value_or_fail(atlas.read_surface(s), atlas.name());
      const auto first = static_cast<std::uint32_t>(vertices.size() / 3);
      for (const auto& [i, j, k] : mesh.positions_ijk) {
        const auto [left, posterior, superior] = to_lps.apply({i, j, k});
        vertices.insert(vertices.end(), {-left, -posterior, superior});
      }
      for (const auto& [left, posterior, superior] : mesh.normals_lps)
        normals.insert(normals.end(), {-left, -posterior, superior});
      for (const auto& corners : mesh.triangles)
        for (const std::uint32_t corner : corners) triangles.push_back(first + corner);
    }
  });
  const auto rows = [](const auto& values) { return Shape{static_cast<py::ssize_t>(values.size() / 3), 3}; };
  const Shape vertex_rows = rows(vertices), triangle_rows = rows(triangles);
  return py::make_tuple(array_of(std::move(vertices), py::dtype::of<double>(), vertex_rows),
                        array_of(std::move(triangles), py::dtype::of<std::uint32_t>(), triangle_rows),
                        array_of(std::move(normals), py::dtype::of<float>(), vertex_rows));
}

PYBIND11_MODULE(_engine, module) {
  static py::object& error_type = *new py::object(py::exception<Error>(module, "Error"));  // outlives Python
  error_type.attr("kind") = "failed";
  error_type.attr("subject") = "";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const Error& failure) {
      const py::object error = error_type(printable(failure.message));
      constexpr std::array kKinds{"failed", "usage", "invalid atlas", "not found", "limit", "cancelled"};
      error.attr("kind") = kKinds[static_cast<std::size_t>(failure.code)];
      error.attr("subject") = printable(failure.subject);
      PyErr_SetObject(error_type.ptr(), error.ptr());
    }
  });
  py::class_<Player, std::shared_ptr<Player>>(module, "Player")
      .def(py::init([](const std::string& path, unsigned threads, std::uint64_t memory, double max_work) {
        return released([&] {
          auto atlas = value_or_fail(Atlas::open(path, AtlasOptions{max_work, memory}), path);
          return std::make_shared<Player>(std::move(atlas), RendererOptions{threads, memory});
        });
      }))
      .def("another", &Player::another)
      .def("call", &Player::call)
      .def("find",
           [](const Player& player, const std::string& name) {
             return value_or_fail(player.atlas().graph().find_named(name), name);
           })
      .def("labels", &labels)
      .def("mask", &mask)
      .def("volume", &volume)
      .def("surface", &surface);
  py::class_<Drawing>(module, "Drawing")
      .def(py::init<std::shared_ptr<Player>, const std::string&, const std::string&,
                    const std::optional<std::string>&>())
      .def_readonly("_answer", &Drawing::answer)
      .def("_emptiness", [](const Drawing& drawing) { return emptiness_of(drawing.frame()); })
      .def("_save", &Drawing::save)
      .def("_pick", &Drawing::pick)
      .def("_repr_png_", &Drawing::png)
      .def_property_readonly("array", &Drawing::srgb,
                             "(height, width, 3) uint8: sRGB; with background None (height, width, 4), the "
                             "last is straight alpha.")
      .def_property_readonly("linear", &pixels<4, &Frame::picture, &Picture::rgba>,
                             "(height, width, 4) float32: linear RGB, premultiplied by alpha, without "
                             "background. Read only.")
      .def_property_readonly("ids", &pixels<1, &Frame::ids, &IdImage::numbers>,
                             "(height, width) uint16: 1 + index of the structure of each pixel, 0 for none; "
                             "None without ids=True. Read only.")
      .def_property_readonly("depth", &pixels<1, &Frame::depths, &DepthMap::mm>,
                             "(height, width) float32: mm behind the plane of the centre, inf for none; None "
                             "without depth=True. Read only.");
  module.def("parse_cuts", [](const std::string& text) {
    std::vector<std::pair<Vec3, double>> planes;
    for (const CutPlane& plane : value_or_fail(parse_cuts(text), "cuts"))
      planes.emplace_back(plane.normal_lps, plane.offset_mm);
    return planes;
  });
}

}  // namespace
}  // namespace splatlas
