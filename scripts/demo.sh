#!/usr/bin/env bash
# Pictures on a fresh Debian 12 machine: installs missing packages, builds the programs and the atlases of the phantom
# and of the Colin 27 brain, and renders the gallery (scripts/gallery.tsv) to out/. Keeps outputs that are up to date.
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

readonly programs=build/release/bin
readonly size=800x800

build_programs() {
  configure_web_module
  configure release -DSPLATLAS_BUILD_TESTS=OFF -DSPLATLAS_BUILD_BENCH=OFF  # until scripts/test.sh turns them on
  cmake --build --preset release --target splatlas-preprocess splatlas-player splatlas-phantom
}

make_phantom_atlas() {
  local folder=out/phantom atlas=out/phantom.atlas
  if up_to_date $atlas "$programs/splatlas-phantom" "$programs/splatlas-preprocess"; then
    echo "$atlas is up to date"
    return
  fi
  "$programs/splatlas-phantom" $folder
  "$programs/splatlas-preprocess" build -o $atlas --title "Two balls" --labels $folder/labels.nrrd \
    --volume $folder/volume.nrrd --names $folder/names.txt --tree $folder/phantom.tree
}

make_colin27_atlas() {
  local atlas=out/colin27.atlas options=examples/colin27.args sources
  mapfile -t sources < <(grep -oE '[^ ":=]*/[a-z0-9_/]+\.(nii\.gz|tsv|tree|toml)' $options)
  if up_to_date $atlas "$programs/splatlas-preprocess" $options "${sources[@]}"; then
    echo "$atlas is up to date"
    return
  fi
  "$programs/splatlas-preprocess" build -o $atlas @$options
}

# for_each_picture COMMAND: COMMAND PICTURE ATLAS VIEW SELECTION, for every line of the gallery.
for_each_picture() {
  local name atlas view selection
  while IFS=$'\t' read -r name atlas view selection; do
    [[ $name == \#* ]] || "$1" "out/$name.png" "out/$atlas.atlas" "$view" "$selection"
  done <scripts/gallery.tsv
}

render_picture() {
  local picture=$1 atlas=$2 view=$3 selection=$4
  if up_to_date "$picture" "$atlas" "$programs/splatlas-player" scripts/gallery.tsv; then
    echo "$picture is up to date"
    return
  fi
  echo "$picture: $selection"
  # shellcheck disable=SC2086  # the view is several options
  "$programs/splatlas-player" render "$atlas" -o "$picture" --size $size --fit grid --background '#ffffff' $view --select "$selection"
}

make_contact_sheet() {
  local pictures=() cells=()
  add_cell() {
    pictures+=("$1")
    cells+=("$1" "$(basename "$1" .png)   $4")
  }
  for_each_picture add_cell
  if up_to_date out/gallery.png "${pictures[@]}" scripts/contact_sheet.sh; then
    echo "out/gallery.png is up to date"
  else
    scripts/contact_sheet.sh out/gallery.png 6 "${cells[@]}"
    echo "out/gallery.png"
  fi
}

make_page() {
  local page=out/colin27.html
  if [[ ! -e build/web/splatlas.wasm ]]; then
    echo "No page without the web module"
  else
    "$programs/splatlas-player" export out/colin27.atlas --html $page
  fi
}

mkdir -p out
step "Packages" scripts/install_packages.sh --demo
step "Programs, and their module for pages" build_programs
step "Atlas of the phantom" make_phantom_atlas
step "Atlas of the Colin 27 brain" make_colin27_atlas
step "Gallery" for_each_picture render_picture
step "Contact sheet" make_contact_sheet
step "Page" make_page

tell_times
echo
echo "The gallery is out/gallery.png. Look around with: $programs/splatlas-player out/colin27.atlas"
echo "The atlas holds a lesson of twelve scenes: Page down shows the next one."
echo "out/colin27.html plays it in a browser."
