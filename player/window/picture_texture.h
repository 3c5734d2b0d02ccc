// OpenGL texture of the latest frame.
#pragma once

#include <imgui.h>

#include "player/window/render_worker.h"

namespace splatlas {

/// Requires a current OpenGL context, also for destruction. Main thread only.
class PictureTexture {
 public:
  PictureTexture() = default;
  ~PictureTexture();
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;

  /// Uploads the frame if it has changed.
  void show(const std::shared_ptr<const Frame>& frame);
  [[nodiscard]] const std::shared_ptr<const Frame>& frame() const { return frame_; }
  [[nodiscard]] ImTextureID id() const;

 private:
  unsigned texture_ = 0;
  std::shared_ptr<const Frame> frame_;
};

}  // namespace splatlas
