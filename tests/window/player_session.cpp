#include "tests/window/player_session.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "format/atlas_writer.h"
#include "tests/support/phantom_content.h"

namespace splatlas {
namespace {

constexpr const char* kAtlas = "phantom.atlas";
constexpr const char* kLog = "window.log";

}  // namespace

void write_phantom_atlas(const std::string& path) {
  if (const auto written = write_atlas(phantom_content(), path); !written) {
    throw std::runtime_error(written.error().message);
  }
}

PlayerSession::PlayerSession(const std::function<void(const std::string&)>& prepare)
    : display_(std::make_unique<VirtualDisplay>()) {
  write_phantom_atlas(folder_.file(kAtlas));
  if (prepare) prepare(folder_.file(kAtlas));
  setenv("SPLATLAS_WINDOW_LOG", folder_.file(kLog).c_str(), 1);
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  player_ = std::async(std::launch::async, [this] {
    return run_program({SPLATLAS_PLAYER, kAtlas}, folder_.path());
  });
  display_->find_window(std::string(kAtlas) + " - Splatlas");
  wait_for("ready");
  wait_for_final_picture();
}

PlayerSession::~PlayerSession() {
  display_.reset();
  unsetenv("SPLATLAS_WINDOW_LOG");
}

void PlayerSession::read_log() {
  std::ifstream file(folder_.file(kLog), std::ios::binary);
  file.seekg(static_cast<std::streamoff>(log_bytes_));
  for (std::string line; std::getline(file, line) && !file.eof();) {
    log_bytes_ += line.size() + 1;
    Json event = Json::parse(line);
    if (event.at("event") == "layout") {
      layout_ = std::move(event);
    } else {
      events_.push_back(std::move(event));
    }
  }
}

PlayerSession::Json PlayerSession::wait_for(const std::string& name,
                                            const std::function<bool(const Json&)>& holds) {
  Json event, latest;
  const auto comes = [&] {
    read_log();
    while (!events_.empty()) {
      event = std::move(events_.front());
      events_.erase(events_.begin());
      if (event.at("event") != name) continue;
      if (!holds || holds(event)) return true;
      latest = event;
    }
    return false;
  };
  wait_until(comes, [&] { return "'" + name + "'; the latest: " + latest.dump(); });
  return event;
}

PlayerSession::Json PlayerSession::wait_for_final_picture() {
  return wait_for("picture", [](const Json& picture) { return picture.at("final") == true; });
}

void PlayerSession::wait_for_layout(const std::function<bool(const Json&)>& holds) {
  const auto comes = [&] {
    read_log();
    return holds(layout_);
  };
  wait_until(comes, [&] { return "a layout; the latest: " + layout_.dump(); });
}

std::array<int, 2> PlayerSession::place(const std::string& pointer) {
  const Json::json_pointer where(pointer);
  wait_for_layout([&](const Json& layout) { return layout.contains(where); });
  const Json& value = layout_.at(where);
  return {value.at(0), value.at(1)};
}

ProgramResult PlayerSession::close() {
  display_->request_close();
  if (player_.wait_for(std::chrono::minutes(1)) != std::future_status::ready) {
    throw std::runtime_error("the window does not close");
  }
  return player_.get();
}

}  // namespace splatlas
