#include "player/window/picture_texture.h"

#include <cstdint>

#include <SDL_opengl.h>

namespace splatlas {

PictureTexture::~PictureTexture() {
  if (texture_ != 0) glDeleteTextures(1, &texture_);
}

void PictureTexture::show(const std::shared_ptr<const Frame>& frame) {
  if (frame == frame_) return;
  frame_ = frame;
  if (!frame_) return;
  if (texture_ == 0) glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB, frame_->size.width, frame_->size.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               frame_->srgb8.data());
}

ImTextureID PictureTexture::id() const {
  return reinterpret_cast<ImTextureID>(std::uintptr_t{texture_});  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace splatlas
