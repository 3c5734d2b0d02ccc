#!/usr/bin/env bash
# Lines of product, tests and bench. A sum above its limit is a failure: delete lines, or raise the limit and give the
# reason in the commit.
set -euo pipefail
cd "$(dirname "$0")/.."

bad=0
# check NAME LIMIT FOLDER...: the lines of the folders' sources that git tracks.
check() {
  local name=$1 limit=$2 lines
  shift 2
  lines=$(git ls-files -z -- "$@" | grep -zE '(\.cpp|\.h|\.fbs|\.sh|\.py|/CMakeLists\.txt)$' |
    { xargs -0 cat 2>/dev/null || true; } | wc -l)  # deleted files are tracked until the commit
  printf '%-8s %6d lines, limit %d\n' "$name" "$lines" "$limit"
  if ((lines > limit)); then
    printf 'check_size: %s: %d lines above its limit\n' "$name" $((lines - limit)) >&2
    bad=1
  fi
}

check product 63040 format preprocess player schemas
check tests 50290 tests
check bench 5500 bench
exit "$bad"
