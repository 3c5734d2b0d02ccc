// splatlas._engine: atlases as arrays, and pictures of a PageEngine, for the package in splatlas/.
// Calls of one Player take turns. Work is done on threads of its own, so that Ctrl+C ends it.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
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

std::atomic<std::thread::id> ending_thread;  // of Python, once it ends
std::atomic<int> threads_away = 0;           // without the interpreter

/// Python ends on another thread, and kills threads that ask for the interpreter: they sleep instead.
bool is_left_behind() {
  const std::thread::id ending = ending_thread;
  return ending != std::thread::id() && ending != std::this_thread::get_id();
}

[[noreturn]] void sleep_forever() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

/// Waits for threads whose work ends with Python, at most ten seconds.
void end_python() {
  ending_thread = std::this_thread::get_id();
  for (int tries = 0; threads_away > 0 && tries < 1000; ++tries) {
    const py::gil_scoped_release release;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

/// Waits 50 ms without the interpreter, or until stopped work has ended.
template <typename T>
bool is_ready(const std::future<T>& result, std::stop_source& stop) {
  ++threads_away;
  PyThreadState* const state = PyEval_SaveThread();
  const auto status = result.wait_for(std::chrono::milliseconds(50));
  const bool is_left = is_left_behind();
  if (is_left) stop.request_stop();
  if (stop.stop_requested()) result.wait();
  if (is_left) --threads_away, sleep_forever();
  PyEval_RestoreThread(state);
  --threads_away;
  return status == std::future_status::ready;
}

/// Ctrl+C and Python's end end `work`, a task with the budget on a thread of its own: this one asks for them
/// every 50 ms, as waiting for the interpreter takes time.
template <typename Work>
auto interruptible(const WorkBudget* budget, const Work& work) {
  if (is_left_behind()) PyEval_SaveThread(), sleep_forever();
  std::stop_source stop;
  auto result = std::async(std::launch::async, [&] {
    try {
      const TaskControl task(stop.get_token(), {}, budget);
      return work();
    } catch (const OverBudget& over) {
      throw over.error();
    }
  });
  while (!is_ready(result, stop)) {
    if (PyErr_CheckSignals() == 0) continue;
    stop.request_stop();
    is_ready(result, stop);
    throw py::error_already_set();
  }
  return result.get();
}

/// An array that owns `values`.
template <typename T>
py::array array_of(std::vector<T> values, const py::dtype& type, const Shape& shape) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  void* const data = kept->data();
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  static_cast<void>(kept.release());
  return {type, shape, data, owner};
}

/// What `read` makes of the content without grey values: voxels in the order of the source.
template <typename Read>
py::object voxels(const Atlas& atlas, const Read& read) {
  VoxelBuffer buffer = interruptible(&atlas.work_budget(),
                                     [&] { return read(value_or_fail(atlas.read_classes(), atlas.name())); });
  const py::dtype type(name_of(buffer.type));
  const auto& size = atlas.source_grid().size;
  return array_of(std::move(buffer.bytes), type, {size[2], size[1], size[0]}).attr("T");
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
      frame = engine_.take_frame({});
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

  std::shared_ptr<const Atlas> atlas_;
  RendererOptions options_;
  std::timed_mutex mutex_;  // of what follows
  PageEngine engine_;
  std::string select_;
  std::size_t selections_ = 0;
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

py::object labels(const Player& player, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = player.atlas();
  check_type(atlas, atlas.label_type(), "was built without a label map; use mask()");
  return voxels(atlas, [&](const AtlasContent& content) {
    const std::vector<bool> is_wanted = below(atlas.graph(), structures);
    return value_or_fail(label_map(content, atlas.name(), "use mask()", is_wanted), atlas.name());
  });
}

py::object mask(const Player& player, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = player.atlas();
  return voxels(
      atlas, [&](const AtlasContent& content) { return mask_of(content, below(atlas.graph(), structures)); });
}

py::object volume(const Player& player) {
  const Atlas& atlas = player.atlas();
  check_type(atlas, atlas.value_type(), "has no grey values; build it with a volume");
  return voxels(atlas, [&](const AtlasContent& content) {
    return to_source_order(value_or_fail(atlas.read_value_volume(content.class_volume), atlas.name()),
                           content);
  });
}

/// Vertices in mm, triangles and normals of the structures and their descendants, in LPS.
py::tuple surface(const Player& player, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = player.atlas();
  std::vector<Vec3> vertices;
  SurfaceMesh all;
  interruptible(&atlas.work_budget(), [&] {
    const Affine to_lps = index_to_lps_mm(atlas.grid());
    for (const StructureIndex s : atlas.graph().descendants(structures)) {
      const SurfaceMesh mesh = value_or_fail(atlas.read_surface(s), atlas.name());
      const auto first = static_cast<std::uint32_t>(vertices.size());
      all.normals_lps.insert(all.normals_lps.end(), mesh.normals_lps.begin(), mesh.normals_lps.end());
      for (const auto& [i, j, k] : mesh.positions_ijk) vertices.push_back(to_lps.apply({i, j, k}));
      check_task();
      for (const auto& [a, b, c] : mesh.triangles) all.triangles.push_back({first + a, first + b, first + c});
    }
  });
  const auto rows = [](auto values, const char* type) {
    const auto size = static_cast<py::ssize_t>(values.size());
    return array_of(std::move(values), py::dtype(type), {size, 3});
  };
  return py::make_tuple(rows(std::move(vertices), "f8"), rows(std::move(all.triangles), "u4"),
                        rows(std::move(all.normals_lps), "f4"));
}

PYBIND11_MODULE(_engine, module) {
  static py::object& error_type = *new py::object(py::exception<Error>(module, "Error"));  // outlives Python
  error_type.attr("__doc__") = "Of an atlas, a selection, a file or a program; see kind and subject.";
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
  pthread_atfork(nullptr, nullptr, [] { threads_away = 0; });
  py::module_::import("atexit").attr("register")(py::cpp_function(&end_python));
  py::class_<Player, std::shared_ptr<Player>>(module, "Player")
      .def(py::init([](const std::string& path, unsigned threads, std::uint64_t memory, double max_work) {
        return interruptible(nullptr, [&] {
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
      .def_property_readonly("array", &Drawing::srgb)
      .def_property_readonly("linear", &pixels<4, &Frame::picture, &Picture::rgba>)
      .def_property_readonly("ids", &pixels<1, &Frame::ids, &IdImage::numbers>)
      .def_property_readonly("depth", &pixels<1, &Frame::depths, &DepthMap::mm>);
  module.def("parse_cuts", [](const std::string& text) {
    std::vector<std::pair<Vec3, double>> planes;
    for (const CutPlane& plane : value_or_fail(parse_cuts(text), "cuts"))
      planes.emplace_back(plane.normal_lps, plane.offset_mm);
    return planes;
  });
}

}  // namespace
}  // namespace splatlas
