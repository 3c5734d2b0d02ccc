// Stress inputs of the renderer: extreme numbers, volume shapes and views.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "player/renderer.h"
#include "tests/support/test_content.h"

namespace splatlas {

/// A volume with its selections and views.
struct StressInput {
  AtlasContent content;
  std::vector<std::string> selections;
  std::vector<Camera> cameras;
  std::vector<RenderOptions> options;  ///< combined with every camera
};

/// Inputs of one kind, made on demand: some are large.
struct StressKind {
  const char* name;
  std::function<std::vector<StressInput>()> make;
};
[[nodiscard]] std::vector<StressKind> stress_kinds();

}  // namespace splatlas
