#!/usr/bin/env bash
# Installs what is missing, builds, and runs every check and every test; CI runs exactly this.
# The first failure ends it.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
export CCACHE_BASEDIR=$PWD  # presets share what does not differ between them
launcher=()  # what builds and tests are run by
passed=0
totals=()

build() {
  configure "$1"
  "${launcher[@]}" cmake --build --preset "$1"
}

# run_tests PRESET [CTEST_OPTION]...: every test, or those that the options name; none at all is a failure.
run_tests() {
  local preset=$1 log=build/$1/ctest.log total
  "${launcher[@]}" ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "${@:2}" | tee "$log"
  total=$(sed -nE 's/.* 0 tests failed out of ([0-9]+)$/\1/p' "$log")
  totals+=("$(printf '%-12s %5d tests' "$preset" "$total")")
  passed=$((passed + total))
}

step "Packages" scripts/install_packages.sh
step "Layers of the sources" scripts/check_layers.sh
step "Layout of the sources" scripts/check_format.sh
step "Release: build" build release
step "Release: tests" run_tests release
step "Player without ITK and VTK: build" build player-only
step "Player without ITK and VTK: tests" run_tests player-only
step "Player without ITK and VTK: linked libraries" scripts/check_layers.sh build/player-only/bin/splatlas-player
step "clang-tidy" scripts/check_tidy.sh build/release
step "Address and undefined behaviour sanitizers: build" build asan-ubsan
step "Address and undefined behaviour sanitizers: tests" \
  run_tests asan-ubsan --label-regex '^(format|player|preprocess)$'
# Debian 12's thread sanitizer cannot place its memory where the kernel randomises more address bits than it knows.
! setarch -R true 2>/dev/null || launcher=(setarch -R)
step "Thread sanitizer: build" build tsan
step "Thread sanitizer: tests" run_tests tsan --label-regex '^(format|player)$'
# Two to a processor: 60 seconds each, in half the time.
step "Fuzzing" env FUZZ_JOBS=$((2 * $(nproc))) scripts/fuzz.sh 60

tell_times
printf '\nTests\n'
printf '    %s\n' "${totals[@]}"
printf '\n%d passed, 0 failed\n' "$passed"
