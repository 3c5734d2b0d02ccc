// Player window on a virtual display, observed through its log.
#pragma once

#include <functional>
#include <future>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/support/run_program.h"
#include "tests/window/virtual_display.h"

namespace splatlas {

/// Runs splatlas-player on the phantom, in its own folder, until the window closes.
class PlayerSession {
 public:
  /// Waits for the first picture of final quality. `prepare` may change the atlas file before.
  explicit PlayerSession(const std::function<void(const std::string& atlas)>& prepare = {});
  /// Closes the display and waits for a program that is still running.
  ~PlayerSession();
  PlayerSession(const PlayerSession&) = delete;
  PlayerSession& operator=(const PlayerSession&) = delete;

  [[nodiscard]] VirtualDisplay& display() { return *display_; }
  [[nodiscard]] const TemporaryFolder& folder() const { return folder_; }

  using Json = nlohmann::json;
  /// Waits for an unread event of this name that satisfies `holds`, and marks events up to it as read. Throws
  /// std::runtime_error with the latest event of that name after a minute.
  Json wait_for(const std::string& event, const std::function<bool(const Json&)>& holds = {});
  /// Waits for the picture of the current selection and view in final quality.
  Json wait_for_final_picture();
  /// The latest layout.
  [[nodiscard]] const Json& layout() const { return layout_; }
  void wait_for_layout(const std::function<bool(const Json&)>& holds);
  /// Waits until the layout contains `pointer`, and returns its centre.
  std::array<int, 2> place(const std::string& pointer);

  /// Asks the window to close, and waits for the program to end.
  ProgramResult close();

 private:
  void read_log();

  TemporaryFolder folder_;
  std::unique_ptr<VirtualDisplay> display_;
  std::future<ProgramResult> player_;
  std::vector<Json> events_;  // unread
  std::size_t log_bytes_ = 0;
  Json layout_;
};

/// Writes the phantom as an atlas file.
void write_phantom_atlas(const std::string& path);

}  // namespace splatlas
