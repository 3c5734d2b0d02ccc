# What the tests of docs/batch share. Sourced by scripts whose first argument is the folder of the built programs.
# shellcheck shell=bash

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
programs=$(cd "$1" && pwd)

readonly skipped=77  # SKIP_RETURN_CODE in CMakeLists.txt

say() { printf '%5.1f s  %s\n' "$(awk -v now="$EPOCHREALTIME" -v begun="$begun" 'BEGIN { print now - begun }')" "$*"; }
begun=$EPOCHREALTIME

skip() {
  echo "skipped: $*"
  exit $skipped
}

# need PROGRAM...: the test is skipped where one is missing.
need() {
  local program
  for program in "$@"; do
    command -v "$program" >/dev/null || skip "no $program; scripts/install_packages.sh installs it"
  done
}

need_colin27() {
  [[ -e /usr/share/mricron/templates/aal.nii.gz ]] || skip "no Colin 27 brain; scripts/install_packages.sh installs it"
}

# make_folder: sets `folder`, a temporary folder for all state, which ends with the test.
make_folder() {
  folder=$(mktemp -d)
  log=$folder/log
  batch=
  trap end_batch EXIT
  trap 'exit 1' HUP INT TERM
  export XDG_CACHE_HOME=$folder/cache HOME=$folder LC_ALL=C.UTF-8
}

end_batch() {
  end_run
  rm -rf "$folder"
}

# end_run: kills a run that is still on, so that it starts no more jobs.
end_run() {
  [[ -z $batch ]] || kill -KILL "$batch" 2>/dev/null || true
  wait "$batch" 2>/dev/null || true
  batch=
}

# fail WHAT: prints the log of the last run.
fail() {
  [[ ! -e $log ]] || tail -n 60 "$log" >&2
  echo "FAILED: $*" >&2
  exit 1
}

# start SUBJECTS LIBRARY OPTIONS...: the documented command in the background; sets `batch`, its process.
start() {
  local subjects=$1 library=$2
  shift 2
  snakemake -s "$here/../../docs/batch/Snakefile" \
    --config subjects="$subjects" library="$library" bin="$programs" "$@" >"$log" 2>&1 &
  batch=$!
}

# run SUBJECTS LIBRARY OPTIONS...: the same to its end.
run() {
  local status=0
  start "$@"
  wait "$batch" || status=$?
  batch=
  return $status
}

# file_count FOLDER PATTERN: files directly in the folder, which may be missing.
file_count() { find "$1" -maxdepth 1 -name "$2" 2>/dev/null | wc -l; }
