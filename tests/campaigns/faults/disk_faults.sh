#!/usr/bin/env bash
# Faults at the system calls of every command that writes: strace lets one call fail, or ends the process there.
# Afterwards the folder must be as before or as after a whole run, and exit status and message must match. SIGKILL may
# leave a temporary name for each output, SIGTERM leaves none.
#
#   disk_faults.sh PROGRAMS [EVERY [TEXT]]   each EVERY-th point (default 1) of the commands with TEXT in their names
set -euo pipefail

programs=$(cd "$1" && pwd) every=${2-1} only=${3-}
export ASAN_OPTIONS=${ASAN_OPTIONS-}:detect_leaks=0 LC_ALL=C.UTF-8  # no leak checks under strace
if ! strace -f -qq -o /dev/null true 2>/dev/null; then
  echo "skipped: no strace, or no right to trace"
  exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/folder"
cd "$scratch/folder"

# Two structures, one in each half of the grid, and grey values.
size=20
header="ObjectType = Image\nNDims = 3\nDimSize = $size $size $size\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
{
  printf '%b' "$header"
  awk -v n=$size 'BEGIN { for (v = 0; v < n * n * n; ++v) { i = v % n; j = int(v / n) % n; k = int(v / n / n)
    printf "%d", (i > 2 && i < 17 && j > 3 && j < 16 && k > 2 && k < 15) * (1 + (i > 9)) } }' | tr 012 '\000\001\002'
} >labels.mha
{ printf '%b' "$header" && awk -v n=$size 'BEGIN { srand(1); while (v++ < n * n * n) printf "%c", 33 + int(rand() * 90) }'; } >volume.mha
printf '1 left\n2 right\n' >names.txt
build=("$programs/splatlas-preprocess" build --labels labels.mha --volume volume.mha --names names.txt --progress none)
"${build[@]}" -o in.atlas >"$scratch/out"

stores=write,pwrite64,writev,pwritev,sendfile,copy_file_range,fallocate,ftruncate,fsync,fdatasync,fchmod,fchown
stores+=",?rename,renameat,renameat2,?link,linkat,?mkdir,mkdirat"  # some machines lack the calls with ?
# Content and permissions of everything in the folder.
state() { { find . -mindepth 1 -printf '%m %p\n' && find . -type f -exec sha256sum {} +; } | sort; }

put_old() {
  rm -rf "${outputs[@]}"
  $replaces || return 0
  local output
  for output in "${outputs[@]}"; do
    echo 'the old file' >"$output"
    chmod 640 "$output"
  done
}

# Prints "CALL NUMBER" for the main process's calls on the folder, with "reads" for those that change nothing.
points() {
  awk -v folder="$PWD" '
    NR == 1 { main = $1 }
    $1 != main || / <\.\.\. |\+\+\+| --- / { next }
    { call = $2; sub(/\(.*/, "", call); ++n[call]; gsub(/AT_FDCWD<[^>]*>/, "") }
    index($0, folder) { reads = call ~ /read/ || (call == "openat" && !/O_CREAT|O_WRONLY|O_RDWR/)
                        print call, n[call], reads ? "reads" : "stores" }' "$scratch/trace"
}

# judge STATUS CALL FAULT: prints what is wrong.
judge() {
  local now left what
  left=$(find . -name '.splatlas-*' -prune | wc -l)
  if [[ $3 != E* ]]; then
    rm -rf .splatlas-*
    (($1 == 128 + $(kill -l "$3"))) || echo "exit status $1"
    [[ $left == 0 || ($3 == KILL && $left -le ${#outputs[@]}) ]] || echo "$left temporaries"
  fi
  now=$(state)
  case $now in
    "$old") what=old ;;
    "$new") what=new ;;
    *) what=mixed ;;
  esac
  if [[ $what == mixed && $2 != rename* ]] || grep -qvxF "$old"$'\n'"$new" <<<"$now"; then
    echo "neither the old folder nor the new one"
  elif [[ $3 == E* ]]; then
    case $1 in
      0) [[ $what == new ]] || echo "success, and the $what output" ;;
      1)
        [[ $what != new ]] || grep -q 'is written whole' "$scratch/err" || echo "failure, and the new output"
        [[ $(grep -cvE '^(note|warning): ' "$scratch/err") == 1 ]] || echo "not one line: $(cat "$scratch/err")"
        grep -qE '^splatlas-[a-z]+: .*(atlas|labels|volume|names|masks|surface|picture|report|exported)' "$scratch/err" ||
          echo "no file in: $(cat "$scratch/err")"
        ! grep -q '\.splatlas-' "$scratch/err" || echo "a temporary name in: $(cat "$scratch/err")"
        ;;
      *) echo "exit status $1: $(cat "$scratch/err")" ;;
    esac
  fi
}

total=0 struck=0 wrong=0
# rehearse NAME REPLACES OUTPUTS COMMAND...: a command over old outputs (REPLACES: true), or without.
rehearse() {
  local name=$1 call number kind fault inject complaint status begun=$struck
  replaces=$2
  read -ra outputs <<<"$3"
  shift 3
  [[ $name == *"$only"* ]] || return 0
  put_old
  old=$(state)
  strace -f -qq -y -o "$scratch/trace" -e trace="$stores,openat,read,pread64" "$@" >"$scratch/out"
  new=$(state)
  [[ $new != "$old" ]] || { echo "$name: changes nothing" && exit 1; }
  while read -r call number kind; do
    for fault in EIO ENOSPC KILL TERM; do
      [[ $kind == stores || $fault == EIO ]] || continue
      ((total++ % every == 0)) || continue
      inject=(--seccomp-bpf -e "inject=$call:error=$fault:when=$number")
      [[ $fault == E* ]] || inject=(-e "inject=$call:signal=$fault:when=$number")  # --seccomp-bpf loses signals
      put_old
      status=0
      { strace -f -qq -o /dev/null -e trace="$call" "${inject[@]}" "$@" >"$scratch/out" 2>"$scratch/err" ||
        status=$?; } 2>/dev/null
      complaint=$(judge "$status" "$call" "$fault" | paste -sd ';')
      ((++struck))
      [[ -z $complaint ]] || { echo "  $name: $fault at $call $number: $complaint" && ((++wrong)); }
    done
  done < <(points)
  printf '%-28s %5d points\n' "$name" $((struck - begun))
  rm -rf "${outputs[@]}"
}

export_to() { rehearse "export $1" true "$1" "$programs/splatlas-preprocess" export in.atlas "${@:2}"; }
render_to() {
  rehearse "render $1" "$2" "$1" "$programs/splatlas-player" render in.atlas -o "$1" --select 'left + right:surface' \
    --size 32x32 --threads 1
}

rehearse build true out.atlas "${build[@]}" -o out.atlas
rehearse 'build, new' false out.atlas "${build[@]}" -o out.atlas
rehearse 'build with reports' true 'out.atlas report.json report.html' "${build[@]}" -o out.atlas --json report.json \
  --report report.html
rehearse 'export masks' false masks "$programs/splatlas-preprocess" export in.atlas --labels masks/
for ending in nrrd nii nii.gz mha; do export_to "exported.$ending" --labels "exported.$ending"; done
export_to volume.nrrd --volume volume.nrrd
for ending in stl ply obj vtk; do export_to "surface.$ending" --surface "left=surface.$ending"; done
rehearse 'export several' true 'labels.nii volume.nii surface.stl' "$programs/splatlas-preprocess" export in.atlas \
  --labels labels.nii --volume volume.nii --surface '*=surface.stl'
for ending in png jpg tif exr svg pdf; do render_to "picture.$ending" true; done
render_to picture.png false
echo "$struck of $total points, $wrong wrong"
((struck > 0 && wrong == 0))
