#!/usr/bin/env bash
# Coverage of the lines and branches of format/ by its tests: tests/format/, and failing allocations and races from
# tests/campaigns/faults/. Branches of exceptions are not counted, nor are processes that a signal ends, as in tests of
# interrupts.
# Prints a table of files; build/coverage/report/index.html shows the lines. Needs gcovr.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

command -v gcovr >/dev/null || { echo "coverage.sh: needs gcovr; first: apt-get install gcovr" >&2; exit 1; }

build() {
  configure coverage
  find build/coverage -name '*.gcda' -delete  # counts of earlier runs
  cmake --build --preset coverage
}

run_tests() {
  local tests=(ctest --preset coverage --parallel "$(nproc)" --no-tests=error)
  "${tests[@]}" --label-regex '^format$' --exclude-regex '^fuzz\.'
  "${tests[@]}" --tests-regex '^player\.(allocation_faults|file_races)'
}

# gcov writes into the current folder.
report() {
  mkdir -p build/coverage/report
  (cd build/coverage && gcovr --root ../.. --filter ../../format/ --exclude-throw-branches --csv report/files.csv \
    --html-details report/index.html .)
  awk -F, '
    function row(name, lines, of_lines, branches, of_branches) {
      printf "%-32s %5d / %5d %6.1f %%  %6d / %5d %6.1f %%\n", name, lines, of_lines, 100 * lines / of_lines,
        branches, of_branches, of_branches ? 100 * branches / of_branches : 100
    }
    BEGIN { printf "%-32s %23s  %23s\n", "", "lines", "branches" }
    NR > 1 { row($1, $3, $2, $6, $5); lines += $3; of_lines += $2; branches += $6; of_branches += $5 }
    END { row("all", lines, of_lines, branches, of_branches) }' build/coverage/report/files.csv
}

step "Coverage: build" build
step "Coverage: tests" run_tests
step "Coverage: lines and branches" report
