// Inputs that break renderers: numbers of every size, volumes of every shape, views from everywhere.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "player/render_frame.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// A volume with the selections and the views that it is drawn in.
struct StressInput {
  AtlasContent content;
  std::vector<std::string> selections;
  std::vector<Camera> cameras;
  std::vector<RenderOptions> options;  ///< each camera with each of these
};

/// Inputs of one kind, made when they are asked for: some are large.
struct StressKind {
  const char* name;
  std::function<std::vector<StressInput>()> make;
};
[[nodiscard]] std::vector<StressKind> stress_kinds();

}  // namespace splatlas
