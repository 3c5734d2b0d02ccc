#!/usr/bin/env bash
# Lines of each part: sources, pages, build files and scripts. A sum above its limit is a failure: delete lines. A new
# feature brings its own deletion; the limits are not raised.
set -euo pipefail
cd "$(dirname "$0")/.."

bad=0
# check NAME LIMIT FOLDER...: the lines of the folders' sources that git tracks.
check() {
  local name=$1 limit=$2 lines
  shift 2
  lines=$(git ls-files -z -- "$@" | grep -zE '(\.(cpp|h|fbs|js|html|css|cmake|py|sh)|(^|/)(CMakeLists\.txt|Snakefile))$' |
    { xargs -0 cat 2>/dev/null || true; } | wc -l)  # deleted files are tracked until the commit
  printf '%-8s %6d lines, limit %d\n' "$name" "$lines" "$limit"
  if ((lines > limit)); then
    printf 'check_size: %s: %d lines above its limit\n' "$name" $((lines - limit)) >&2
    bad=1
  fi
}

check product 64740 format preprocess player schemas
check tests 49910 tests
check bench 5530 bench
check build 1825 CMakeLists.txt cmake scripts .ci docs examples
exit "$bad"
