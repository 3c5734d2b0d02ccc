#!/usr/bin/env bash
# Fuzzes with libFuzzer, AddressSanitizer and UndefinedBehaviorSanitizer: builds the preset fuzz, runs its targets, and
# prints the number of executions of each. Findings and the corpus are kept in build/fuzz/fuzzing/.
#   fuzz.sh                       every target, 60 seconds each
#   fuzz.sh SECONDS [TARGET]...   these targets (see tests/fuzz/CMakeLists.txt), or all
# FUZZ_JOBS is the number of targets that run at a time; default: the number of processors.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

seconds=${1:-60}
((seconds > 0)) 2>/dev/null || { printf 'fuzz.sh: %s: must be a number of seconds\n' "$seconds" >&2; exit 2; }
targets=("${@:2}")
jobs=${FUZZ_JOBS:-$(nproc)}
folder=build/fuzz/fuzzing

build() {
  configure fuzz
  cmake --build --preset fuzz
  mkdir -p "$folder/findings"
  build/fuzz/bin/fuzz-seeds "$folder/seeds"
}

all_targets() {
  local source
  for source in tests/fuzz/*_fuzzer.cpp; do basename "$source" _fuzzer.cpp; done
}

# Keep scratch files of the targets in memory, if possible.
[[ ! -d /dev/shm ]] || export TMPDIR=/dev/shm

# The saved corpus of a target comes first: libFuzzer adds new inputs to it. Weighting inputs by rare features
# (-entropic) takes most of the time of targets that draw pictures.
fuzz() {
  local target=$1 inputs=("$folder/corpus/$1") options=()
  mkdir -p "$folder/corpus/$target"
  [[ ! -d tests/fuzz/corpus/$target ]] || inputs+=("tests/fuzz/corpus/$target")
  [[ ! -d $folder/seeds/$target ]] || inputs+=("$folder/seeds/$target")
  [[ ! -f tests/fuzz/$target.dict ]] || options+=("-dict=tests/fuzz/$target.dict")
  FUZZ_TARGET=$target ASAN_OPTIONS=quarantine_size_mb=16:allocator_may_return_null=0 \
    build/fuzz/bin/fuzz -max_total_time="$seconds" -timeout=60 -rss_limit_mb=1024 -max_len=8192 -entropic=0 \
    -print_final_stats=1 -artifact_prefix="$folder/findings/$target-" "${options[@]}" "${inputs[@]}" \
    >"$folder/$target.log" 2>&1
}

fuzz_all() {
  local target running=0 failed=0
  for target in "${targets[@]}"; do
    if ((running >= jobs)); then
      wait -n || failed=1
      running=$((running - 1))
    fi
    fuzz "$target" &
    ((running += 1))
  done
  while ((running > 0)); do
    wait -n || failed=1
    running=$((running - 1))
  done
  tell_executions
  return "$failed"
}

# Prints the finding of a target after its count, or the end of its log without a count.
tell_executions() {
  local target count sum=0
  for target in "${targets[@]}"; do
    count=$(sed -nE 's/^stat::number_of_executed_units: *([0-9]+)$/\1/p' "$folder/$target.log")
    printf '%-16s %10s executions\n' "$target" "${count:-no}"
    sum=$((sum + ${count:-0}))
    grep -m 3 -E 'finding:|ERROR|runtime error' "$folder/$target.log" || [[ -n $count ]] || tail -n 5 "$folder/$target.log"
  done
  printf '%-16s %10d executions\n' "all" "$sum"
}

step "Fuzzing: build" build
((${#targets[@]} > 0)) || mapfile -t targets < <(all_targets)
step "Fuzzing: $seconds s each of ${#targets[@]} targets, $jobs at a time" fuzz_all
