#!/usr/bin/env bash
# Checks that every source has the layout of clang-format and at most 400 lines.
# To correct the layout: scripts/check_format.sh --fix
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t sources < <(find format preprocess player bench tests examples -name '*.h' -o -name '*.cpp' | sort)
if [[ ${1-} == --fix ]]; then
  clang-format -i "${sources[@]}"
  exit 0
fi
# Prints too long sources, and the first lines of differences.
check() {
  local source lines wrong=0
  for source in "$@"; do
    lines=$(wc -l <"$source")
    if ((lines > 400)); then
      echo "check_format: $source: $lines lines; split it: at most 400" >&2
      wrong=1
    fi
    clang-format "$source" | diff --label "$source" --label "clang-format's" -u "$source" - | head -n 12 || wrong=1
  done
  return $wrong
}
export -f check
if ! printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -n 50 bash -c 'set -o pipefail; check "$@"' check; then
  echo "check_format: see the findings above; for the layout: scripts/check_format.sh --fix" >&2
  exit 1
fi
echo "${#sources[@]} sources are laid out by clang-format, none above 400 lines."
