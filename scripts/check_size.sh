#!/usr/bin/env bash
# Lines of each part. A sum above its limit is a failure: delete lines, since the limits are not raised.
set -euo pipefail
cd "$(dirname "$0")/.."
bad=0
# check NAME LIMIT ENDINGS FOLDER...: the lines of the folders' files with these endings that git tracks.
check() {
  local name=$1 limit=$2 endings=$3 lines
  shift 3
  lines=$(git ls-files -z -- "$@" | grep -zE "($endings)\$" |
    { xargs -0 cat 2>/dev/null || true; } | wc -l)  # deleted files are tracked until the commit
  printf '%-8s %6d lines, limit %d\n' "$name" "$lines" "$limit"
  if ((lines > limit)); then
    printf 'check_size: %s: %d lines above its limit\n' "$name" $((lines - limit)) >&2
    bad=1
  fi
}

readonly sources='\.cpp|\.h|\.fbs|\.js|\.html|\.css|\.sh|\.py|\.cmake|CMakeLists\.txt|Snakefile'
check product 62500 "$sources" format preprocess player schemas
check tests 45900 "$sources" tests
check bench 5500 "$sources" bench
check build 1825 "$sources" CMakeLists.txt cmake scripts .ci docs examples
exit "$bad"
