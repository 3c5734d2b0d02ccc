#!/usr/bin/env bash
# Puts pictures on one sheet, each over its title:
#   contact_sheet.sh SHEET COLUMNS PICTURE TITLE [PICTURE TITLE]...
# Pictures are fitted into squares; titles are wrapped below them.
set -euo pipefail

(($# >= 4 && $# % 2 == 0)) || { echo "usage: contact_sheet.sh SHEET COLUMNS PICTURE TITLE [PICTURE TITLE]..." >&2; exit 2; }
sheet=$1 columns=$2
shift 2

readonly margin=5 square=400 title_height=110 font_size=15 line_height=20 characters_a_line=48
readonly paper=0.97,0.97,0.97 ink=0.1,0.1,0.1
readonly cell_size=$((square + 2 * margin))x$((square + title_height + 2 * margin))

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# cell NUMBER [PICTURE TITLE]: one square with its title, or nothing, as a file that sorts by number.
cell() {
  local number=$1 line y=$((margin + square + 22)) content=()
  if (($# == 3)); then
    content+=("$2" --ch 'R,G,B' --fit "${square}x$square" --swap --paste "+$margin+$margin")
    while IFS= read -r line; do
      content+=("--text:x=$((2 * margin)):y=$y:size=$font_size:font=DejaVuSans:color=$ink" "$line")
      y=$((y + line_height))
    done < <(fold --spaces --width=$characters_a_line <<<"$3")
  fi
  oiiotool --wildcardoff --evaloff --create "$cell_size" 3 --fill:color=$paper "$cell_size" "${content[@]}" -d uint8 \
    -o "$folder/$(printf '%06d' "$number").png"
}

number=0
while (($# > 0)); do
  cell $((number += 1)) "$1" "$2"
  shift 2
done
while ((number % columns != 0)); do
  cell $((number += 1))
done
# Without date and command, the same pictures give the same bytes.
oiiotool --nosoftwareattrib "$folder"/*.png --mosaic "${columns}x$((number / columns))" --eraseattrib DateTime \
  -o "$folder/sheet.png"
mv "$folder/sheet.png" "$sheet"
