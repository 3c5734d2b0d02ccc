// A picture on its way to the screen.
#pragma once

#include <imgui.h>

#include "player/window/render_worker.h"

namespace splatlas {

/// An OpenGL texture that holds the latest frame. Needs a current OpenGL context, also when it is destroyed.
class PictureTexture {
 public:
  PictureTexture() = default;
  ~PictureTexture();
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;

  /// Uploads the frame, unless it is there already.
  void show(const std::shared_ptr<const Frame>& frame);
  [[nodiscard]] const std::shared_ptr<const Frame>& frame() const { return frame_; }
  [[nodiscard]] ImTextureID id() const;

 private:
  unsigned texture_ = 0;
  std::shared_ptr<const Frame> frame_;
};

}  // namespace splatlas
