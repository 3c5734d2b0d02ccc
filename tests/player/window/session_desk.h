// Viewing session without a window, for tests.
#pragma once

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <gtest/gtest.h>

#include "player/window/session/session.h"
#include "tests/support/phantom_content.h"

namespace splatlas {

inline constexpr PictureSize kDeskSize{96, 64};

/// Session with a replacement for the window's event loop.
class Desk {
 public:
  explicit Desk(std::shared_ptr<const Atlas> atlas, const RendererOptions& options = {.threads = 2},
                SessionLog log = {})
      : session_(
            std::move(atlas), options, [this] { wake(); }, std::move(log)) {
    session_.resize(kDeskSize);
  }

  Session* operator->() { return &session_; }

  /// Updates now and at every wake until `holds`. Throws after a timeout.
  template <typename Holds>
  void until(Holds holds) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    session_.update();
    while (!holds()) {
      std::unique_lock lock(mutex_);
      if (!changed_.wait_until(lock, deadline, [this] { return woken_; })) {
        throw std::runtime_error("the session does not get there");
      }
      woken_ = false;
      lock.unlock();
      session_.update();
    }
  }
  /// Runs until the latest picture has final quality.
  void until_done() {
    until([this] { return session_.frame() && !session_.refining(); });
  }

 private:
  void wake() {
    {
      const std::lock_guard lock(mutex_);
      woken_ = true;
    }
    changed_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;
  Session session_;  // last, so that its thread ends first
};

/// Position of the centre of a ball in the view.
inline ViewPoint place_of(const phantom::Ball& ball, const Camera& camera, const Display& display) {
  const auto [i, j, k] = ball.center;
  const auto shown = view_of(camera, kDeskSize, display)->picture_point(Vec3{1.0 * i, 1.0 * j, 1.0 * k});
  return {shown->x / kDeskSize.width, shown->y / kDeskSize.height};
}

class SessionTest : public testing::Test {
 protected:
  static std::shared_ptr<const Atlas> atlas() {
    static const std::shared_ptr<const Atlas> opened = open_in_memory(phantom_content());
    return opened;
  }
};

}  // namespace splatlas
