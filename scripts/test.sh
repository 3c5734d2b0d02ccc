#!/usr/bin/env bash
# Installs missing packages, builds, and runs the checks and tests. CI runs it without options. The first failure ends
# it.
set -euo pipefail
cd "$(dirname "$0")/.."

help() {
  cat <<'HELP'
Usage: scripts/test.sh [--quick | --all | --help]

  (no option)  The checks of CI, in about half an hour from nothing on two cores: layers, layout and size of the
               sources; web module; release build and tests; clang-tidy over recent changes; player without ITK and VTK,
               installed and used; address and undefined behaviour sanitizers.
  --quick      For daily work, within five minutes of a recent build: layers, layout, size, release build and tests,
               clang-tidy over changes since origin/HEAD.
  --all        Every check, in some hours: all tests of the release build, of each source compiled alone (preset dev),
               and of the player without ITK and VTK; clang-tidy over every source; both sanitizers with the tests of
               format and player, the first also with those of preprocess; an hour of fuzzing. Under sanitizers, tests
               repeat random cases less often (tests/support/repetitions.h).

Every form ends with `N passed, 0 failed`; a failure ends it with the name of the step and an exit status other than 0.
HELP
}

form=usual
if (($# > 1)); then set -- "$*"; fi
case ${1-} in
  '') ;;
  --quick) form=quick ;;
  --all) form=all ;;
  --help | -h) help; exit 0 ;;
  *) printf 'test.sh: %s: must be --quick, --all or --help\n' "$1" >&2; exit 2 ;;
esac
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
launcher=()  # command in front of builds and tests
passed=0
totals=()

# Tests sync what they write, and wait for the disk. Keep their files in memory, if it has room.
room=$(df --output=avail -k /dev/shm 2>/dev/null | tail -n 1) || room=0
if ((room >= 4 << 20)); then export TMPDIR=/dev/shm; fi

# build PRESET [TARGET]...: these targets, or all.
build() {
  configure "$1"
  "${launcher[@]}" cmake --build --preset "$1" ${2:+--target "${@:2}"}
}

# Programs with their module for pages, tests and benches.
build_release() {
  configure_web_module
  cmake --preset release -DSPLATLAS_BUILD_TESTS=ON -DSPLATLAS_BUILD_BENCH=ON --log-level=NOTICE >/dev/null  # after the demo
  build release
}

# run_tests PRESET [CTEST_OPTION]...: all tests, or those that the options select. No test at all is a failure. A shard
# of a test program counts as its cases.
run_tests() {
  local preset=$1 log=build/$1/ctest.log total
  "${launcher[@]}" ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "${@:2}" | tee "$log"
  total=$(sed -nE 's/.* 0 tests failed out of ([0-9]+)$/\1/p' "$log")
  total=$(sed -nE 's/^\[  PASSED  \] ([0-9]+) tests?\.$/\1/p' "build/$preset/Testing/Temporary/LastTest.log" |
    awk -v total="$total" '{ total += $1 - 1 } END { print total }')
  totals+=("$(printf '%-12s %5d tests' "$preset" "$total")")
  passed=$((passed + total))
}

# Without ITK and VTK. The objects are those of the release build, so their tests need not run twice.
build_player_only() { build player-only splatlas-player splatlas-phantom-atlas; }

# Debian 12's thread sanitizer fails on kernels that randomise more address bits than it expects.
fix_addresses() { ! setarch -R true 2>/dev/null || launcher=(setarch -R); }

step "Packages" scripts/install_packages.sh
step "Layers of the sources" scripts/check_layers.sh
step "Layout of the sources" scripts/check_format.sh
step "Size of the sources" scripts/check_size.sh
step "Release: build" build_release
step "Release: tests" run_tests release

if [[ $form == quick ]]; then
  step "clang-tidy" scripts/check_tidy.sh --changed-since origin/HEAD
elif [[ $form == usual ]]; then
  step "clang-tidy" scripts/check_tidy.sh --recent
  step "Player without ITK and VTK: build" build_player_only
  step "Player without ITK and VTK: tests" run_tests player-only --label-regex '^installed$'
  step "Player without ITK and VTK: linked libraries" scripts/check_layers.sh build/player-only/bin/splatlas-player
  step "Address and undefined behaviour sanitizers: build" build asan-ubsan checks-format checks-player checks-preprocess
  step "Address and undefined behaviour sanitizers: tests" \
    run_tests asan-ubsan --label-regex '^(format|player|preprocess)$'
else
  step "clang-tidy" scripts/check_tidy.sh
  step "Each source alone: build" build dev
  step "Each source alone: tests" run_tests dev
  step "Player without ITK and VTK: build" build player-only
  step "Player without ITK and VTK: tests" run_tests player-only
  step "Player without ITK and VTK: linked libraries" scripts/check_layers.sh build/player-only/bin/splatlas-player
  step "Address and undefined behaviour sanitizers: build" build asan-ubsan
  step "Address and undefined behaviour sanitizers: tests" \
    run_tests asan-ubsan --label-regex '^(format|player|preprocess)$'
  fix_addresses
  step "Thread sanitizer: build" build tsan
  step "Thread sanitizer: tests" run_tests tsan --label-regex '^(format|player)$'
  # Twelve targets, two per core, 1200 seconds each: an hour on two cores.
  step "Fuzzing" env FUZZ_JOBS=$((2 * $(nproc))) scripts/fuzz.sh 1200
fi

tell_times
printf '\nTests\n'
printf '    %s\n' "${totals[@]}"
printf '\n%d passed, 0 failed\n' "$passed"
