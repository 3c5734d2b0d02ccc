#!/usr/bin/env bash
# Installs missing Debian 12 packages: for everything, the demo or the player. If none is missing, it needs neither
# privileges nor the network.
set -euo pipefail

help() {
  cat <<'HELP'
Usage: scripts/install_packages.sh [--demo | --player | --help]

  (no option)  Everything: programs, tests, benchmarks and their data.
  --demo       Both programs, the page and the data of scripts/demo.sh, without tests and benchmarks.
  --player     The player and its libraries alone, without ITK, VTK, tests and benchmarks. Then build with
               cmake --preset player-only -DSPLATLAS_BUILD_TESTS=OFF && cmake --build --preset player-only
HELP
}

# One package per line, with its purpose.
player=(
  build-essential          # compiler and linker
  cmake                    # build system, tests, installation
  ninja-build              # the presets' generator
  pkg-config               # finds xxHash, libmicrohttpd and Pango; tests: splatlas.pc

  libexpected-dev          # tl::expected, the type of every result
  libflatbuffers-dev       # directory of the atlas file
  flatbuffers-compiler     # flatc, for schemas/
  libfmt-dev               # messages
  libmeshoptimizer-dev     # surfaces in the atlas file
  libutfcpp-dev            # texts of the atlas file, names and trees
  libxxhash-dev            # checksums of the atlas file
  libzstd-dev              # chunks of the atlas file

  libcli11-dev             # command lines
  libhwy-dev               # player: portable SIMD
  libpng-dev               # player: PNG
  libpango1.0-dev          # player: text of annotations, PDF
  fonts-dejavu-core        # player: text of annotations in Arabic, Hebrew and others
  fonts-liberation         # player: text of annotations
  libopenimageio-dev       # player: JPEG, TIFF and EXR
  libopencv-core-dev       # include folder of OpenImageIO's CMake package, which does not depend on it
  openimageio-tools        # programs of OpenImageIO's CMake package; oiiotool: contact sheets
  libmicrohttpd-dev        # player: serves the page
  libwebp-dev              # player: pictures of pages
  nlohmann-json3-dev       # statistics and reports
  nettle-dev               # player: SHA-256 and base64 of pages
  zlib1g-dev               # player: checksums of PNG; preprocess: checks compressed images
)
demo=(
  libinsighttoolkit5-dev   # preprocess: readers, segmentation
  libvtk9-dev              # preprocess: marching cubes, mesh files
  libtiff-dev              # preprocess: TIFF
  libtomlplusplus-dev      # preprocess: scenes
  libbz2-dev               # preprocess: compressed NRRD
  libdcmtk-dev             # preprocess: DICOM
  libopenjp2-7-dev         # preprocess: JPEG 2000 in DICOM

  ca-certificates          # for package sources over https
  dpkg-dev                 # player in a page: sources of Debian
  emscripten               # player in a page: C++ library, compiler, linker and Node for WebAssembly

  mricron-data             # the Colin 27 brain: volume, AAL labels and names
)
tests=(
  ccache                   # repeated builds
  clang-format             # scripts/check_format.sh
  clang-tidy               # scripts/check_tidy.sh

  libgmock-dev             # tests
  libgtest-dev             # tests
  librapidcheck-dev        # tests: properties
  clang                    # tests: compiles the fuzz targets
  libclang-rt-dev          # tests: libFuzzer, and Clang's sanitizers
  chromium                 # tests: the page in a browser
  libsdl2-dev              # tests: examples/viewer.cpp
  munge                    # tests: authentication of Slurm
  slurm-wlm                # tests: docs/batch on a cluster
  snakemake                # tests: docs/batch, many subjects
  strace                   # tests: faults of system calls

  gnuplot-nox              # bench: plots
  libbenchmark-dev         # bench
  libgl1-mesa-dri          # bench: OpenGL in software
  libvolpack1-dev          # bench: VolPack, a peer (as is VTK, above, which draws under xvfb)
  xvfb                     # bench: a display without a screen

  invesalius-examples      # bench: a CT of a head
  poppler-utils            # tests: text and pages of PDF
)

if (($# > 1)); then set -- "$*"; fi
case ${1-} in
  '') packages=("${player[@]}" "${demo[@]}" "${tests[@]}") ;;
  --demo) packages=("${player[@]}" "${demo[@]}") ;;
  --player) packages=("${player[@]}") ;;
  --help | -h) help; exit 0 ;;
  *) printf 'install_packages: %s: must be --demo, --player or --help\n' "$1" >&2; exit 2 ;;
esac

say() { printf '%s\n' "$*"; }
give_up() { printf 'install_packages: %s\n' "$*" >&2; exit 1; }

installed() { [[ $(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]; }

missing_packages() {
  local package
  for package in "${packages[@]}"; do
    installed "$package" || printf '%s\n' "$package"
  done
}

command -v dpkg-query apt-get >/dev/null ||
  give_up "this system has no Debian packages (dpkg-query, apt-get); install by hand: ${packages[*]}"

mapfile -t missing < <(missing_packages)
if ((${#missing[@]} == 0)); then
  say "All ${#packages[@]} packages are installed."
  exit 0
fi
say "Missing ${#missing[@]} of ${#packages[@]} packages: ${missing[*]}"

as_root=()
if ((EUID != 0)); then
  command -v sudo >/dev/null || give_up "not root, and there is no sudo; run as root: apt-get install ${missing[*]}"
  as_root=(sudo)
  [[ -t 0 ]] || as_root+=(--non-interactive)
fi
apt_get() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 \
    apt-get --quiet --quiet --yes -o DPkg::Lock::Timeout=600 -o Dpkg::Use-Pty=0 "$@" </dev/null
}
apt_get update || give_up "apt-get update failed; are the package sources in order, and may this user use sudo?"
apt_get install --no-install-recommends "${missing[@]}" >/dev/null ||
  give_up "apt-get could not install: ${missing[*]}"

mapfile -t missing < <(missing_packages)
((${#missing[@]} == 0)) || give_up "still missing after the installation: ${missing[*]}"
say "All ${#packages[@]} packages are installed."
