#!/usr/bin/env bash
# Installs missing packages, builds, and runs the checks and tests. CI runs it without options. The first failure ends
# it.
set -euo pipefail
cd "$(dirname "$0")/.."

form=usual
if (($# > 1)); then set -- "$*"; fi
case ${1-} in
  '') ;;
  --quick) form=quick ;;
  --all) form=all ;;
  --help | -h) cat scripts/test.txt; exit 0 ;;
  *) printf 'test.sh: %s: must be --quick, --all or --help\n' "$1" >&2; exit 2 ;;
esac
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

launcher=()  # command in front of builds and tests
passed=0
totals=()

# Tests sync what they write, and wait for the disk. Keep their files in memory, if it has room.
room=$(df --output=avail -k /dev/shm 2>/dev/null | tail -n 1) || room=0
if ((room >= 4 << 20)); then export TMPDIR=/dev/shm; fi

# build PRESET [TARGET]...: these targets, or all.
build() {
  configure "$1" -DSPLATLAS_TEST_INTENSITY=$intensity
  "${launcher[@]}" cmake --build --preset "$1" ${2:+--target "${@:2}"}
}

# build_release [TARGET]...: after the demo, the build has no tests yet.
build_release() {
  configure_web_module
  cmake --preset release -DSPLATLAS_BUILD_TESTS=ON -DSPLATLAS_BUILD_BENCH=ON -DSPLATLAS_TEST_INTENSITY=$intensity \
    --log-level=NOTICE >/dev/null
  build release "$@"
}

# run_tests PRESET [CTEST_OPTION]...: all tests, or those that the options select. No test at all is a failure. A shard
# of a test program counts as its cases.
run_tests() {
  local preset=$1 log=build/$1/ctest.log total
  "${launcher[@]}" ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "${@:2}" | tee "$log" || {
    sed -n 's/^\[  FAILED  \] \([^ ]*\) (.*/FAILED: \1/p' "build/$preset/Testing/Temporary/LastTest.log"
    printf 'Again: ctest --preset %s --rerun-failed --output-on-failure\n' "$preset" && return 1
  }
  total=$(sed -nE 's/.* 0 tests failed out of ([0-9]+)$/\1/p' "$log")
  total=$(sed -nE 's/^\[  PASSED  \] ([0-9]+) tests?\.$/\1/p' "build/$preset/Testing/Temporary/LastTest.log" |
    awk -v total="$total" '{ total += $1 - 1 } END { print total }')
  totals+=("$(printf '%-12s %5d tests' "$preset" "$total")")
  passed=$((passed + total))
}

# The player needs neither ITK nor VTK: its build files do not look for them, and it is not linked with them.
check_player_alone() {
  configure player-only
  scripts/check_layers.sh build/release/bin/splatlas-player
}

# NEON, its scalar kernels and this machine draw the same bytes.
check_arm64_pictures() {
  local of=build/arm64 emulated=(qemu-aarch64-static -L build/arm64-sysroot build/arm64/bin/splatlas-player)
  build/release/bin/splatlas-phantom-atlas $of/a.atlas
  draw() { "${@:2}" render $of/a.atlas -o "$of/$1.png" --size 160x120 --select '*:both(opacity=0.5)'; }
  draw native build/release/bin/splatlas-player
  draw neon "${emulated[@]}"
  SPLATLAS_SIMD=scalar draw scalar "${emulated[@]}"
  cmp $of/native.png $of/neon.png && cmp $of/native.png $of/scalar.png
}

# Debian 12's thread sanitizer fails on kernels that randomise more address bits than it expects.
fix_addresses() { ! setarch -R true 2>/dev/null || launcher=(setarch -R); }

readonly layers='^(format|player|reference|preprocess)$'
readonly programs='^(system|kernels|web|batch|faults|installed)$'
[[ $form == all ]] && intensity=3 || intensity=1  # SPLATLAS_TEST_INTENSITY

step "Packages" scripts/install_packages.sh
step "Layers of the sources" scripts/check_layers.sh
step "Layout of the sources" scripts/check_format.sh
step "Size of the sources" scripts/check_size.sh
if [[ $form != all ]]; then
  step "Programs and their tests: build" \
    build_release checks-system checks-kernels checks-web checks-batch checks-faults checks-installed
  step "Player without ITK and VTK" check_player_alone
  step "Programs: tests" run_tests release --label-regex "$programs"
fi
if [[ $form == quick ]]; then
  step "clang-tidy" scripts/check_tidy.sh --changed-since origin/HEAD
elif [[ $form == usual ]]; then
  step "clang-tidy" scripts/check_tidy.sh --recent
  step "Layers with sanitizers: build" build asan-ubsan checks-format checks-player checks-reference checks-preprocess
  step "Layers with sanitizers: tests" run_tests asan-ubsan --label-regex "$layers"
else
  step "Release: build" build_release
  step "Release: tests" run_tests release
  step "clang-tidy" scripts/check_tidy.sh
  step "Each source alone: build" build dev
  step "Each source alone: tests" run_tests dev
  step "Player without ITK and VTK: build" build player-only
  step "Player without ITK and VTK: tests" run_tests player-only
  step "Player without ITK and VTK" check_player_alone
  step "More packages" scripts/install_packages.sh --all
  SPLATLAS_BROWSER=/usr/bin/firefox-esr step "Page in Firefox" run_tests release --tests-regex '^web[.](n|pa|b)'
  step "arm64: libraries" scripts/arm64_sysroot.sh
  step "arm64: build" build arm64 checks-format checks-player checks-kernels splatlas-player
  step "arm64: tests" run_tests arm64 --label-regex '^(format|player|kernels)$' --exclude-regex allocation_faults
  step "arm64: pictures" check_arm64_pictures
  step "Address and undefined behaviour sanitizers: build" build asan-ubsan
  step "Address and undefined behaviour sanitizers: tests" run_tests asan-ubsan --label-regex "$layers"
  fix_addresses
  step "Thread sanitizer: build" build tsan
  step "Thread sanitizer: tests" run_tests tsan --label-regex '^(format|player)$'
  step "Fuzzing" env FUZZ_JOBS=$((2 * $(nproc))) scripts/fuzz.sh 1200
fi

tell_times
read -ra used <<<"$(now_in_seconds)"
if [[ $form == usual ]] && ((used[1] > 50 * 60)); then
  printf '    The whole took more than 50 minutes of CPU: 25 on two cores. Which step grew?\n'
fi
printf '\nTests\n'
printf '    %s\n' "${totals[@]}"
printf '\n%d passed, 0 failed\n' "$passed"
