#!/usr/bin/env bash
# Runs clang-tidy over sources, as the preset release compiles each of them alone (configured in build/tidy).
#   check_tidy.sh                      every source
#   check_tidy.sh SOURCE...            these sources
#   check_tidy.sh --changed-since REV  changes since the merge base of REV and HEAD, uncommitted ones included
#   check_tidy.sh --recent             files of the newest commits, at most 40; for CI, whose fresh clone has no
#                                      earlier state to compare with
# A changed header is checked with a source that includes it. Without history, every source is checked.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly recent_files=40

all_sources() { find format preprocess player bench -name '*.cpp' | sort; }

# changed_since REV: files that differ, untracked ones included.
changed_since() {
  git diff --name-only --diff-filter=d "$1" -- format preprocess player bench
  git ls-files --others --exclude-standard -- format preprocess player bench
}

# recently_changed: the files of the newest commits, newest first.
recently_changed() {
  git log --format= --name-only -- format preprocess player bench | awk '!seen[$0]++' |
    while IFS= read -r file; do [[ ! -f $file ]] || printf '%s\n' "$file"; done | sed "${recent_files}q"
}

# Changed sources, and one source for each changed header that none of them includes.
sources_of() {
  local file source taken=()
  mapfile -t taken < <(printf '%s\n' "$@" | grep '\.cpp$')
  for file in "$@"; do
    [[ $file == *.h ]] || continue
    grep -qsF "#include \"$file\"" "${taken[@]}" /dev/null && continue
    source=$(all_sources | xargs grep -lF "#include \"$file\"" | head -n 1) || true
    [[ -z $source ]] || taken+=("$source")
  done
  ((${#taken[@]} == 0)) || printf '%s\n' "${taken[@]}" | sort -u
}

sources=("$@")
changed=()
case ${1-} in
  --changed-since)
    if base=$(git merge-base "$2" HEAD 2>/dev/null); then
      mapfile -t changed < <(changed_since "$base")
      mapfile -t sources < <(sources_of "${changed[@]}")
    else
      mapfile -t sources < <(all_sources)
    fi
    ;;
  --recent)
    mapfile -t changed < <(recently_changed)
    mapfile -t sources < <(((${#changed[@]} == 0)) && all_sources || sources_of "${changed[@]}")
    ;;
  '') mapfile -t sources < <(all_sources) ;;
  -*) printf 'check_tidy: %s: must be --changed-since, --recent or a source\n' "$1" >&2; exit 2 ;;
esac
if ((${#sources[@]} == 0)); then
  echo "No source has changed."
  exit 0
fi

cmake --preset release -B build/tidy -DSPLATLAS_UNITY=OFF --log-level=NOTICE --no-warn-unused-cli >/dev/null
cmake --build build/tidy --target splatlas_schema_header >/dev/null
echo "${#sources[@]} sources, $(nproc) at a time"
# Prints one line per finding. "N warnings generated" counts warnings in headers of libraries.
# Clang accepts ITK's headers only after the header that is included first, and lacks a flag of the kernels.
printf '%s\n' "${sources[@]}" |
  xargs -P "$(nproc)" -n 1 sh -c '
    out=$(clang-tidy --quiet -p build/tidy --extra-arg=-include --extra-arg="$PWD/cmake/itk_with_clang.h" \
      --extra-arg=-Wno-ignored-optimization-argument "$0" 2>&1) || { printf "%s\n" "$out"; exit 1; }' ||
  { echo "check_tidy: see the findings above" >&2; exit 1; }
echo "clang-tidy finds nothing."
