// Scripted input of the viewer: the commands drag DX DY, click X Y and key NAME.
#pragma once

#include <fstream>
#include <string>

#include <SDL.h>
#include <splatlas/format/result.h>

class Script {
 public:
  /// Opens a file of commands.
  splatlas::Result<void> open(const std::string& path) {
    path_ = path;
    file_.open(path);
    if (file_) return {};
    return splatlas::fail(splatlas::ErrorCode::kFailed, path + ": cannot be read");
  }
  bool is_open() const { return file_.is_open(); }

  /// Pushes the events of the next command. False at the end, at a wrong command, and without a file.
  bool push_next() {
    std::string what, key;
    int x = 0, y = 0;
    const auto push = [](SDL_Event event) { return SDL_PushEvent(&event) == 1; };
    if (!(file_ >> what)) return false;
    if (what == "key" && file_ >> key)
      return push({.key = {.type = SDL_KEYDOWN, .keysym = {.sym = SDL_GetKeyFromName(key.c_str())}}});
    if (what == "drag" && file_ >> x >> y)
      return push({.motion = {.type = SDL_MOUSEMOTION, .state = SDL_BUTTON_LMASK, .xrel = x, .yrel = y}});
    if (what == "click" && file_ >> x >> y)
      return push({.button = {.type = SDL_MOUSEBUTTONDOWN, .x = x, .y = y}}) &&
             push({.button = {.type = SDL_MOUSEBUTTONUP, .x = x, .y = y}});
    wrong_ = what;
    file_.setstate(std::ios::failbit);
    return false;
  }

  /// The error of a wrong command, or of reading.
  splatlas::Result<void> check() const {
    if (wrong_.empty() && !file_.bad()) return {};
    return splatlas::fail(splatlas::ErrorCode::kUsage,
                          path_ + ": " + wrong_ + ": must be drag DX DY, click X Y or key NAME");
  }

 private:
  std::ifstream file_;
  std::string path_, wrong_;
};
