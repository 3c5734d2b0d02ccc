#!/usr/bin/env bash
# Checks the layers: schemas <- format <- {preprocess, player} <- bench, tests. Only preprocess uses ITK and VTK; they
# are also peers in bench/peers. In every folder: at most 15 modules on 6 levels, no circle. One source prints.
#   check_layers.sh            the sources
#   check_layers.sh PROGRAM    also the program, which must be linked with neither ITK nor VTK
set -euo pipefail
cd "$(dirname "$0")/.."

bad=0
tell() {
  printf '%s\n' "$1" >&2
  bad=1
}

# "SOURCE SOURCE" for each source, and "SOURCE HEADER" for each include.
includes=$(
  find format player preprocess bench tests \( -name '*.h' -o -name '*.cpp' \) -printf '%p %p\n'
  grep -rHoE --include='*.h' --include='*.cpp' '^ *# *include *"[^"]+' format player preprocess bench tests |
    sed -E 's/: *# *include *"/ /'
)

# may_include FOLDER LAYER...: sources in the folder include headers of these layers only.
may_include() {
  local folder=$1 line
  shift
  while IFS= read -r line; do
    tell "$line: $folder may include only: $*"
  done < <(awk -v folder="$folder/" -v allowed=" $* " '
    BEGIN { split("schemas format preprocess player bench tests", names, " "); for (n in names) layers[names[n]] }
    index($1, folder) == 1 && $1 != $2 {
      layer = $2
      sub("/.*", "", layer)
      if (layer in layers && !index(allowed, " " layer " ")) print
    }' <<<"$includes")
}

# must_not_include PATTERN WHY FOLDER...: no source in the folders includes a header whose name starts with the pattern.
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
may_include tests/player format player tests
may_include tests/phantom format tests
may_include tests/support format player tests
may_include tests/fuzz format preprocess player tests
may_include tests/reference format player tests

must_not_include 'itk|vtk|gdcm|vnl' 'ITK and VTK belong to preprocess' \
  schemas format player tests/format tests/player tests/phantom tests/support tests/reference tests/installed
mapfile -t bench_itself < <(find bench -path bench/peers -prune -o -type f -print)
must_not_include 'itk|vtk|gdcm|vnl' 'ITK and VTK are peers: bench/peers only' "${bench_itself[@]}"
must_not_include 'microhttpd' 'the server belongs to the player' format preprocess bench

# module_graph FOLDER: "MODULE MODULE" for each module, and "FROM TO" for each include between modules. A module is a
# folder, or a header with its source.
module_graph() {
  awk -v folder="$1/" '
    function module(path) {
      path = substr(path, length(folder) + 1)
      if (!sub("/.*", "/", path)) { sub("[.][a-z]+$", "", path); sub("-inl$", "", path) }
      return path
    }
    index($1, folder) == 1 && index($2, folder) == 1 { print module($1), module($2) }' <<<"$includes" | sort -u
}

# check_graph NAME MODULES LEVELS <GRAPH: prints circles, and excesses of both limits.
check_graph() {
  awk -v name="$1" -v max_modules="$2" -v max_levels="$3" '
    { level[$1]; level[$2]; if ($1 != $2) edges[$1, $2] }
    END {
      for (module in level) { modules++; level[module] = 1 }
      if (modules == 0) exit
      levels = 1
      do {  # a module has a higher level than those that it includes
        moved = 0
        for (edge in edges) {
          split(edge, end, SUBSEP)
          if (level[end[1]] <= level[end[2]]) { level[end[1]] = level[end[2]] + 1; moved = 1 }
          if (level[end[1]] > levels) levels = level[end[1]]
        }
      } while (moved && levels <= modules)
      if (modules > max_modules) print name ": " modules " modules; at most " max_modules
      if (levels > modules) {
        for (module in level) if (level[module] > 1) circle = circle " " module
        print name ": a circle of includes among" circle
      } else if (levels > max_levels) print name ": " levels " levels; at most " max_levels
    }'
}

# Test the check itself: it finds a circle, and excessive levels and modules. A diamond is not a circle.
[[ $(printf '%s\n' 'a b' 'b c' 'c a' | check_graph test 9 9) == *circle* ]] || tell "check_graph misses a circle"
[[ $(printf '%s\n' 'a b' 'b c' | check_graph test 9 2) == *levels* ]] || tell "check_graph misses a level"
[[ $(printf '%s\n' 'a b' 'b c' | check_graph test 2 9) == *modules* ]] || tell "check_graph misses a module"
[[ $(printf '%s\n' 'a a' 'b b' 'c c' | check_graph test 2 9) == *modules* ]] || tell "check_graph misses a lone module"
[[ -z $(printf '%s\n' 'a b' 'a c' 'b d' 'c d' | check_graph test 4 3) ]] || tell "check_graph finds what is not there"
while IFS= read -r folder; do
  wrong=$(module_graph "$folder" | check_graph "$folder" 15 6)
  [[ -z $wrong ]] || tell "$wrong"
done < <(find format player preprocess bench -type d)

# Only standard_output.cpp prints, and only PrintableText: no name from a file reaches a terminal unescaped.
printing='\b(std::)?(v?printf|v?fprintf|puts|putchar|fputs|fputc|perror) *\(|fmt::print|std::(cout|cerr|clog) *<<|fwrite\(.*std(out|err)'
[[ 'std::fprintf(stderr, "x")' =~ $printing && ! 'std::snprintf(text, 9, "x")' =~ $printing ]] ||
  tell "the check of printing is wrong"
while IFS= read -r line; do
  tell "$line: print PrintableText (format/program/standard_output.h)"
done < <(grep -rnE --include='*.h' --include='*.cpp' "$printing" format preprocess player bench |
  grep -v '^format/program/standard_output.cpp:')

if (($# > 0)); then
  linked=$(readelf --dynamic "$1" | sed -nE 's/.*\(NEEDED\).*\[(.*)\]/\1/p')
  [[ -n $linked ]] || tell "$1: readelf lists no libraries"
  foreign=$(grep -iE '^lib(itk|vtk|gdcm)' <<<"$linked" || true)
  [[ -z $foreign ]] || tell "$1 is linked with ${foreign//$'\n'/, }: the player needs neither ITK nor VTK"
fi

((bad == 0)) && echo "Every include follows the layers; modules form no circle; one source prints."
exit "$bad"
