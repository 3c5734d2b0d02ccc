#include <array>
#include <csignal>
#include <cstdlib>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <spawn.h>
#include <unistd.h>

#include "format/program/command_options.h"
#include "format/program/standard_output.h"
#include "format/result_macros.h"
#include "player/commands/commands.h"
#include "player/web/html_page.h"
#include "player/web/server/page_server.h"

namespace splatlas {
namespace {

constexpr std::uint16_t kLeastPort = 1024;

/// Chromium shows the page in a window of its own.
constexpr const char* kOpenBrowser = R"(
case $(xdg-settings get default-web-browser 2>/dev/null) in
  *chromium*) command -v chromium >/dev/null && exec chromium --app="$1" ;;
  *google-chrome*) command -v google-chrome >/dev/null && exec google-chrome --app="$1" ;;
esac
exec xdg-open "$1")";

bool is_set(const char* variable) {
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

/// Opens the address. The user reads what to do where that is not possible.
void open_browser(const std::string& address) {
  if (!is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY")) {
    return print_to(stderr,
                    PrintableText("note: there is no display: open the address in a browser, from another "
                                  "machine through a tunnel (ssh -L PORT:127.0.0.1:PORT)\n"));
  }
  const std::string script = "exec >/dev/null 2>&1" + std::string(kOpenBrowser);
  std::array<const char*, 6> words{"sh", "-c", script.c_str(), "sh", address.c_str(), nullptr};
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl+C ends the player, not the browser
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, "sh", nullptr, &attributes, const_cast<char**>(words.data()), environ);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) print_to(stderr, PrintableText("note: no browser was started: open the address in one\n"));
}

/// The signals that end the program, blocked for the threads that start later.
sigset_t block_end_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

Result<std::string> served_page(const Atlas& atlas) {
  SPLATLAS_ASSIGN_OR_RETURN(const Opening opening, opening_of({}, atlas));
  return encode_html({.is_served = true,
                      .title = atlas.provenance().title,
                      .caption = opening.caption,
                      .opening = json_of(opening)});
}

}  // namespace

void add_play(CLI::App& app, PlayRequest& request) {
  add_path(app, "ATLAS", request.atlas, "atlas file to play in the browser");
  app.add_flag("--no-browser", request.no_browser, "print the address alone");
  app.add_option("--port", request.port, "of the address (any that is free)")
      ->check(CLI::Range(kLeastPort, std::uint16_t{65535}));
  add_threads(app, request.renderer.threads, "0: one per core");
  add_memory(app, request.renderer.max_memory_bytes);
  add_max_work(app, request.atlas_options.max_work);
}

Result<void> play(const PlayRequest& request) {
  const sigset_t signals = block_end_signals();
  LessonFile lesson(request.atlas, request.atlas_options);
  SPLATLAS_ASSIGN_OR_RETURN(const auto atlas, Atlas::open(request.atlas, request.atlas_options));
  SPLATLAS_ASSIGN_OR_RETURN(const auto server, PageServer::start({atlas, served_page, request.renderer,
                                                                  request.port, std::move(lesson)}));
  SPLATLAS_RETURN_IF_ERROR(print_text(PrintableText("{}\n", server->address())));
  if (!request.no_browser) open_browser(server->address_with_ticket());
  constexpr timespec kPause{.tv_sec = 0, .tv_nsec = 200'000'000};
  while (!server->is_left() && sigtimedwait(&signals, nullptr, &kPause) < 0) {
  }
  if (server->missing().empty()) return {};
  return fail(ErrorCode::kInvalidAtlas, "{}: damaged; was shown without what is missing: {}",
              request.atlas.filename().string(), server->missing());
}

}  // namespace splatlas
