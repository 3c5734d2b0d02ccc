// splatlas._engine: atlases as arrays, and pictures of a PageEngine, for the package in splatlas/.
// Work is done on threads of its own, so that Ctrl+C ends it.
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
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
    const TaskControl task(stop.get_token(), {}, budget);
    return work();
  });
  while (!is_ready(result, stop)) {
    if (PyErr_CheckSignals() == 0) continue;
    stop.request_stop();
    is_ready(result, stop);
    throw py::error_already_set();
  }
  return result.get();
}

/// A flat array of a type that owns the bytes of `values`.
template <typename T>
py::array array_of(std::vector<T> values, const char* type) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  const py::capsule owner(kept.get(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  const std::vector<T>& owned = *kept.release();
  const py::dtype element(type);
  const auto size = static_cast<py::ssize_t>(owned.size() * sizeof(T)) / element.itemsize();
  return {element, size, owned.data(), owner};
}

struct File {
  std::shared_ptr<const Atlas> atlas;
  RendererOptions renderer;
};

std::pair<std::string, Frame> draw(PageEngine& engine, const std::string& request) {
  return interruptible(nullptr, [&] {
    PageAnswer answer = engine.call(request);
    if (answer.status != 0)
      throw Error{static_cast<ErrorCode>(answer.status - 1), answer.text, answer.subject};
    return std::pair(std::move(answer.text), engine.take_frame({}));
  });
}

py::array srgb(const Frame& frame, const std::optional<Rgb>& background) {
  auto bytes = interruptible(
      nullptr, [&] { return background ? to_srgb8(frame.picture, *background) : to_srgba8(frame.picture); });
  return array_of(std::move(bytes), "u1");
}

py::bytes png(const Frame& frame, const std::optional<Rgb>& background) {
  const auto bytes =
      interruptible(nullptr, [&] { return value_or_fail(encode_png(frame.picture, background)); });
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void save(const Frame& frame, const std::string& path, const std::optional<Rgb>& background) {
  interruptible(nullptr, [&] { value_or_fail(write_picture(frame.picture, path, background), path); });
}

/// A structure and its point.
py::object pick(const Frame& frame, double x, double y) {
  const std::optional<Pick> pick = interruptible(nullptr, [&] { return frame.pick(x, y); });
  return pick ? py::object(py::make_tuple(pick->structure, pick->point_lps_mm)) : py::none();
}

/// An array of the `values` of an `image` of a frame, without a copy; None if it has none.
template <py::ssize_t channels, auto image, auto values>
py::object pixels(const py::object& self) {
  const auto& frame = self.cast<const Frame&>();
  const auto& kept = frame.*image.*values;
  if (kept.empty()) return py::none();
  std::vector<py::ssize_t> shape{frame.picture.size.height, frame.picture.size.width};
  if (channels > 1) shape.push_back(channels);
  py::array array(std::move(shape), kept.data(), self);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// "labels" or "mask" of structures and their descendants, or "volume", in the order of the source.
py::object voxels(const File& file, const std::string& what, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = *file.atlas;
  const bool is_mask = what == "mask", is_volume = what == "volume";
  const VoxelType stored = is_volume ? atlas.value_type() : atlas.label_type();
  if (!is_mask && stored == VoxelType::kNone) {
    const char* const fault = is_volume ? ": has no grey values; build it with a volume"
                                        : ": was built without a label map; use mask()";
    throw Error{ErrorCode::kFailed, atlas.name() + fault, atlas.name()};
  }
  VoxelBuffer buffer = interruptible(&atlas.work_budget(), [&] {
    const AtlasContent content = value_or_fail(atlas.read_classes(), atlas.name());
    if (is_volume) {
      const auto values = value_or_fail(atlas.read_value_volume(content.class_volume), atlas.name());
      return to_source_order(values, content);
    }
    std::vector<bool> is_wanted(content.graph.size());
    for (const StructureIndex s : content.graph.descendants(structures)) is_wanted[s] = true;
    if (is_mask) return mask_of(content, is_wanted);
    return value_or_fail(label_map(content, atlas.name(), "use mask()", is_wanted), atlas.name());
  });
  const py::array flat = array_of(std::move(buffer.bytes), is_mask ? "?" : name_of(buffer.type));
  return flat.attr("reshape")(atlas.source_grid().size, py::arg("order") = "F");
}

/// Vertices in mm, triangles and normals of the structures and their descendants, in LPS, flat.
py::tuple surface(const File& file, const std::vector<StructureIndex>& structures) {
  const Atlas& atlas = *file.atlas;
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
  return py::make_tuple(array_of(std::move(vertices), "f8"), array_of(std::move(all.triangles), "u4"),
                        array_of(std::move(all.normals_lps), "f4"));
}

PYBIND11_MODULE(_engine, module) {
  static const py::object& error_type =
      *new py::object(py::module_::import("splatlas._arguments").attr("Error"));  // outlives Python
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const Error& error) {
      constexpr std::array kKinds{"failed", "usage", "invalid atlas", "not found", "limit", "cancelled"};
      const char* const kind = kKinds[static_cast<std::size_t>(error.code)];
      const py::object raised = error_type(printable(error.message), kind, printable(error.subject));
      PyErr_SetObject(error_type.ptr(), raised.ptr());
    };
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const Error& error) {
      raise(error);
    } catch (const OverBudget& over) {
      raise(over.error());
    }
  });
  pthread_atfork(nullptr, nullptr, [] { threads_away = 0; });
  py::module_::import("atexit").attr("register")(py::cpp_function(&end_python));
  py::class_<File>(module, "File")
      .def(py::init([](const std::string& path, unsigned threads, std::uint64_t memory, double max_work) {
        return interruptible(nullptr, [&] {
          return File{value_or_fail(Atlas::open(path, {max_work, memory}), path), {threads, memory}};
        });
      }))
      .def("info",
           [](const File& file) { return interruptible(nullptr, [&] { return info_json(*file.atlas); }); })
      .def("find",
           [](const File& file, const std::string& name) {
             return value_or_fail(file.atlas->graph().find_named(name), name);
           })
      .def("voxels", &voxels)
      .def("surface", &surface);
  py::class_<PageEngine>(module, "Engine")
      .def(py::init([](const File& file) {
        auto engine = std::make_unique<PageEngine>(file.renderer);
        engine->open(file.atlas);
        return engine;
      }))
      .def("draw", &draw);
  py::class_<Rgb>(module, "Rgb").def(py::init([](const std::string& text) {
    return value_or_fail(parse_color(text), "background");
  }));
  py::class_<Frame>(module, "Frame")
      .def("srgb", &srgb)
      .def("png", &png)
      .def("save", &save)
      .def("pick", &pick)
      .def("emptiness", &emptiness_of)
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
