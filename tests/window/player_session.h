// The player's window on a virtual display, observed through its log.
#pragma once

#include <functional>
#include <future>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/run_program.h"
#include "tests/window/virtual_display.h"

namespace splatlas {

/// Runs splatlas-player on the phantom, in a folder of its own, until its window is closed.
class PlayerSession {
 public:
  /// Waits for the first picture in its final quality.
  PlayerSession();
  /// The result of a program that is still running is waited for, its display being gone.
  ~PlayerSession();
  PlayerSession(const PlayerSession&) = delete;
  PlayerSession& operator=(const PlayerSession&) = delete;

  [[nodiscard]] VirtualDisplay& display() { return *display_; }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

  using Json = nlohmann::json;
  /// Waits for an event of this name for which `holds` is true among those that were not looked at yet, which
  /// thereby are. Throws std::runtime_error with the latest event of that name when there is none in a
  /// minute.
  Json wait_for(const std::string& event, const std::function<bool(const Json&)>& holds = {});
  /// The picture of what is selected and seen now, in its final quality.
  Json wait_for_final_picture();
  /// The latest layout.
  [[nodiscard]] const Json& layout() const { return layout_; }
  void wait_for_layout(const std::function<bool(const Json&)>& holds);
  /// Waits until the layout has a place of this name, and returns its middle.
  std::array<int, 2> place(const std::string& pointer);

  /// Asks the window to close, and waits for the program's end.
  ProgramResult close();

 private:
  void read_log();

  TemporaryFolder folder_;
  std::unique_ptr<VirtualDisplay> display_;
  std::future<ProgramResult> player_;
  std::vector<Json> events_;  // not looked at yet
  std::size_t log_bytes_ = 0;
  Json layout_;
};

/// The phantom as an atlas file at `path`.
void write_phantom_atlas(const std::string& path);

}  // namespace splatlas
