# Steps with names and times, sourced by other scripts.
# shellcheck shell=bash

steps_begun=$SECONDS
steps_done=()

elapsed() { printf '%d:%02d min' $((($1) / 60)) $((($1) % 60)); }

# step NAME COMMAND...: runs the command under a headline and prints its time. A failure ends the script.
# The command does not run within a condition, so `set -e` applies inside functions too.
step() {
  local name=$1 begun=$SECONDS
  shift
  printf '\n==> %s\n' "$name"
  step_name=$name
  "$@"
  step_name=
  local time
  time=$(elapsed $((SECONDS - begun)))
  steps_done+=("$time  $name")
  printf '    %s: %s\n' "$name" "$time"
}

tell_failed_step() {
  local status=$?
  if ((status != 0)); then
    printf '\nFAILED%s (exit status %d); see its output above.\n' "${step_name:+: $step_name}" "$status" >&2
  fi
  exit "$status"
}
trap tell_failed_step EXIT

tell_times() {
  printf '\nTimes\n'
  printf '    %s\n' "${steps_done[@]}"
  printf '    %s  in all\n' "$(elapsed $((SECONDS - steps_begun)))"
}

# up_to_date OUTPUT INPUT...: the output exists and no input is newer.
up_to_date() {
  local output=$1 input
  shift
  [[ -e $output ]] || return 1
  for input in "$@"; do
    [[ ! $input -nt $output ]] || return 1
  done
}

# The player's module for pages, which the release build embeds. Where Debian's sources are out of reach, programs are
# built without it.
build_web_module() {
  local sources=build/web/third_party
  if [[ -d $sources/meshoptimizer/src ]] || scripts/fetch_web_sources.sh "$sources"; then
    configure web
    cmake --build --preset web
  else
    printf 'No web module: its sources could not be fetched\n'
  fi
}

# configure PRESET: only without build files. Ninja detects later changes itself.
configure() {
  [[ -e build/$1/build.ninja ]] || cmake --preset "$1" --log-level=NOTICE --no-warn-unused-cli >/dev/null
}
