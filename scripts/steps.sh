# Steps with names and times, sourced by other scripts.
# shellcheck shell=bash

steps_done=()
# Ninja's default, two more than processors, doubles in the build of the module for pages: caches overflow.
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

# now_in_seconds: "WALL CPU" since the start of the script. CPU is that of ended processes.
now_in_seconds() {
  local stat
  read -ra stat </proc/$$/stat
  printf '%d %d' "$SECONDS" $(((stat[13] + stat[14] + stat[15] + stat[16]) / 100))
}

minutes() { printf '%d:%02d' $(($1 / 60)) $(($1 % 60)); }

# step NAME COMMAND...: runs the command under a headline and prints its wall time and CPU time. A failure ends the
# script. The command does not run within a condition, so `set -e` applies inside functions too.
step() {
  local name=$1 begun ended time
  shift
  read -ra begun <<<"$(now_in_seconds)"
  printf '\n==> %s\n' "$name"
  step_name=$name
  "$@"
  step_name=
  read -ra ended <<<"$(now_in_seconds)"
  time=$(printf '%6s min, CPU %6s' "$(minutes $((ended[0] - begun[0])))" "$(minutes $((ended[1] - begun[1])))")
  steps_done+=("$time  $name")
  printf '    %s: %s\n' "$name" "$time"
}

tell_failed_step() {
  local status=$?
  if ((status != 0)); then
    tell_times >&2
    printf '\nFAILED%s (exit status %d); see its output above.\n' "${step_name:+: $step_name}" "$status" >&2
  fi
  exit "$status"
}
trap tell_failed_step EXIT

tell_times() {
  local ended
  read -ra ended <<<"$(now_in_seconds)"
  printf '\nTimes\n'
  printf '    %s\n' "${steps_done[@]}"
  printf '    %6s min, CPU %6s  in all\n' "$(minutes "${ended[0]}")" "$(minutes "${ended[1]}")"
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

# The player's module for pages, which the release build makes and embeds. Where Debian's sources are out of reach,
# programs are built without it.
configure_web_module() {
  local sources=build/web/third_party
  if [[ -d $sources/meshoptimizer/src ]] || scripts/fetch_web_sources.sh "$sources"; then
    configure web
  else
    printf 'No web module: its sources could not be fetched\n'
  fi
}

# configure PRESET [OPTION]...: only without build files. Ninja detects later changes itself.
configure() {
  [[ -e build/$1/build.ninja ]] || cmake --preset "$@" --log-level=NOTICE --no-warn-unused-cli >/dev/null
}
