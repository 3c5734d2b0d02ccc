#!/usr/bin/env bash
# Proves the layers: schemas <- format <- {preprocess, player} <- bench, tests; ITK and VTK in preprocess only,
# but for VTK as a peer in bench/peers.
#   check_layers.sh            the #include lines of the sources
#   check_layers.sh PROGRAM    as well, that this program is linked with neither ITK nor VTK
set -euo pipefail
cd "$(dirname "$0")/.."

bad=0
tell() {
  printf '%s\n' "$1" >&2
  bad=1
}

# may_include FOLDER LAYER...: no source in the folder includes a header of a layer that is not listed.
may_include() {
  local folder=$1 line layer
  shift
  while IFS= read -r line; do
    layer=$(sed -E 's/.*include *"([a-z]+)\/.*/\1/' <<<"$line")
    [[ " $* " == *" $layer "* ]] || tell "$line: $folder may include only: $*"
  done < <(grep -rnE --include='*.h' --include='*.cpp' \
    '^ *# *include *"(schemas|format|preprocess|player|bench|tests)/' "$folder")
}

# must_not_include PATTERN WHY FOLDER...: no source in the folders includes a header whose name starts so.
must_not_include() {
  local pattern=$1 why=$2 line
  shift 2
  while IFS= read -r line; do
    tell "$line: $why"
  done < <(grep -rnE --include='*.h' --include='*.cpp' "^ *# *include *[<\"]($pattern)" "$@")
}

may_include format schemas format
may_include preprocess format preprocess
may_include player format player
may_include bench format preprocess player bench tests
may_include tests/format schemas format tests
may_include tests/damage format player tests
may_include tests/player format player tests
may_include tests/phantom format tests
may_include tests/support format player tests
may_include tests/fuzz format preprocess player tests
may_include tests/reference format player tests

must_not_include 'itk|vtk|gdcm|vnl' 'ITK and VTK belong to preprocess' \
  schemas format player tests/format tests/player tests/phantom tests/support tests/reference tests/installed
mapfile -t bench_itself < <(find bench -path bench/peers -prune -o -type f -print)
must_not_include 'itk|vtk|gdcm|vnl' 'VTK is a peer: bench/peers only' "${bench_itself[@]}"
must_not_include 'itk|gdcm|vnl' 'ITK belongs to preprocess' bench/peers
must_not_include 'SDL|imgui|GL/' 'the window belongs to the player' format preprocess bench

if (($# > 0)); then
  linked=$(readelf --dynamic "$1" | sed -nE 's/.*\(NEEDED\).*\[(.*)\]/\1/p')
  [[ -n $linked ]] || tell "$1: readelf lists no libraries"
  foreign=$(grep -iE '^lib(itk|vtk|gdcm)' <<<"$linked" || true)
  [[ -z $foreign ]] || tell "$1 is linked with ${foreign//$'\n'/, }: the player needs neither ITK nor VTK"
fi

((bad == 0)) && echo "Every include follows the layers."
exit "$bad"
