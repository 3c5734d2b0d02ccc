#!/usr/bin/env bash
# Runs clang-tidy over the sources of a configured build: check_tidy.sh [BUILD_FOLDER [SOURCE...]]
set -euo pipefail
cd "$(dirname "$0")/.."

build=${1-build/release}
[[ -e $build/compile_commands.json ]] || {
  echo "check_tidy: $build is not configured; first: cmake --preset release && cmake --build --preset release" >&2
  exit 1
}
shift || true
sources=("$@")
((${#sources[@]} > 0)) || mapfile -t sources < <(find format preprocess player bench -name '*.cpp' | sort)
echo "${#sources[@]} sources, $(nproc) at a time"
# One line per finding, the checks of .clang-tidy; "N warnings generated" counts what other people's headers hold.
# Clang reads ITK's headers only with the file that is included first.
printf '%s\n' "${sources[@]}" |
  xargs -P "$(nproc)" -n 1 sh -c '
    out=$(clang-tidy --quiet -p "$0" --extra-arg=-include --extra-arg="$PWD/cmake/itk_with_clang.h" "$1" 2>&1) || { printf "%s\n" "$out"; exit 1; }' "$build" ||
  { echo "check_tidy: findings stand above" >&2; exit 1; }
echo "clang-tidy finds nothing."
