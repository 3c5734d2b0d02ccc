#!/usr/bin/env bash
# Fetches Debian's signed sources of the libraries that the web module compiles, into FOLDER, as FOLDER/highway,
# FOLDER/libzstd and FOLDER/meshoptimizer. The machine's own lists of apt stay as they are.
#   fetch_web_sources.sh FOLDER
set -euo pipefail

mkdir -p "$1/lists/partial"
cd "$1"
# The machine's own mirrors of Debian, for sources instead of packages
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
apt-get indextargets --format "deb-src [signed-by=$keyring] \$(REPO_URI) \$(RELEASE) main" \
  'Created-By: Packages' 'Origin: Debian' 'Component: main' | sort -u >sources.list
options=(-o Dir::Etc::sourcelist="$PWD/sources.list" -o Dir::Etc::sourceparts=/dev/null
  -o Dir::State::lists="$PWD/lists" -o Acquire::Languages=none -o APT::Sandbox::User=root)
packages=(highway libzstd meshoptimizer)
apt-get -qq "${options[@]}" update
download() { apt-get -qq "${options[@]}" source --download-only "$@" "${packages[@]}"; }
# A mirror may list a security update before it has its sources: the release has the ones before it.
download || download --target-release="$(. /etc/os-release && printf '%s' "$VERSION_CODENAME")"
for package in "${packages[@]}"; do
  rm -rf "$package"
  dpkg-source --no-check -x "$package"_*.dsc "$package" >/dev/null  # apt-get has checked the signature and the hashes
done
