#!/usr/bin/env bash
# Unpacks Debian 12's arm64 libraries of the player and its tests into build/arm64-sysroot/, for the preset arm64.
# Needs no privileges, and leaves this machine's packages alone.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly state=$PWD/build/arm64-packages root=$PWD/build/arm64-sysroot
[[ $root/complete -nt scripts/packages.txt ]] && exit
rm -rf "$state" "$root"
mkdir -p "$state"/{lists,archives}/partial "$root"/usr/{bin,lib,sbin}
ln -s usr/{bin,lib,sbin} "$root"
touch "$state/status"  # nothing is installed
apt_get() {
  apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State="$state" -o Dir::Cache="$state" \
    -o Dir::State::status="$state/status" "$@" >/dev/null
}
apt_get update
# shellcheck disable=SC2046  # a package a word
apt_get install --yes --no-install-recommends --download-only $(awk '
  $1 == "player" && $2 ~ /-dev$|^fonts|-tools$/ || $2 ~ /^lib(gmock|gtest|rapidcheck)-dev$/ { print $2 }
  ' scripts/packages.txt)
for package in "$state"/archives/*.deb; do
  dpkg-deb --fsys-tarfile "$package" | tar --extract --keep-directory-symlink --directory "$root"
done
find "$root" -type l -lname '/*' -printf '%l\0%p\0' |
  while read -rd '' target && read -rd '' link; do ln -snf "$root$target" "$link"; done
touch "$root/complete" && rm -rf "$state"
