#!/usr/bin/env bash
# Builds the Debian packages into build/packages/ and checks them with lintian. As root, tries them on a bare Debian 12:
# installs them, opens an atlas as a double click does, draws by Python, and removes them without a trace.
#   build_packages.sh [ATLAS]          default: the demo's
#   build_packages.sh --only-build
set -euo pipefail
cd "$(dirname "$0")/.."
# shellcheck source=scripts/steps.sh
source scripts/steps.sh

readonly build=build/packages root=build/packages/root
version=$(sed -n 's/^project(splatlas VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)

build() {
  configure_web_module
  configure packages
  cmake --build $build
  mkdir -p $build/package
  printf 'splatlas (%s-1) bookworm; urgency=medium\n\n  * CHANGELOG.md lists the changes.\n\n -- %s  %s\n' \
    "$version" 'Splatlas contributors <splatlas@localhost>' "$(date -R)" | gzip --best --no-name >$build/package/changelog.gz
  make_page() { help2man --no-info --name="$2" $build/bin/"$1" | gzip --best --no-name >$build/package/"$1".1.gz; }
  make_page splatlas-player 'play anatomy atlases'
  make_page splatlas-preprocess 'make anatomy atlases'
  rm -f $build/*.deb
  (cd $build && cpack)
}

in_root() {
  unshare --pid --fork --kill-child --mount-proc="$PWD/$root/proc" chroot $root env -i LANG=C.UTF-8 HOME=/root \
    DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"
}
install_in_root() { in_root sh -c "apt-get -qq install --no-install-recommends $* >/dev/null 2>/root/log || { cat /root/log; false; }"; }

try() {
  rm -rf $root
  debootstrap --variant=minbase bookworm $root >/dev/null
  cp $build/*.deb $root/root/
  cp "$1" $root/root/brain.atlas
  install_in_root curl libglib2.0-bin shared-mime-info desktop-file-utils './root/splatlas-player_*.deb'
  in_root gio info --attributes standard::content-type /root/brain.atlas | grep -q application/vnd.splatlas.atlas
  in_root gio mime application/vnd.splatlas.atlas | grep -q 'Default.*splatlas-player.desktop'
  in_root splatlas-player render /root/brain.atlas -o /root/brain.pdf --annotate labels,legend
  # The command of the desktop entry, without a browser
  # shellcheck disable=SC2016  # the root's shell expands
  in_root sh -c 'splatlas-player --no-browser /root/brain.atlas >/root/address & sleep 3
    curl --silent --fail --location --cookie-jar /root/cookies --output /root/page "$(grep -o "http[^ ]*" /root/address)"'
  grep -q '<title>' $root/root/page
  install_in_root './root/*.deb'
  in_root python3 -c 'import splatlas; splatlas.open("/root/brain.atlas").render(size=(64, 64)).save("/root/a.jpg")'
  in_root splatlas-preprocess check /root/brain.atlas >/dev/null
  in_root sh -c 'apt-get -qq purge "splatlas-*" libsplatlas-dev python3-splatlas >/dev/null'
  [[ -z $(find $root/etc $root/usr -iname '*splatlas*' -print -quit) ]]
}

step "Packages of Debian" scripts/install_packages.sh --debian
step "Packages: build" build
if [[ ${1-} != --only-build ]]; then
  step "Packages: lintian" lintian --fail-on error --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog,initial-upload-closes-no-bugs $build/*.deb
  step "Packages: on a bare Debian" try "${1:-out/colin27.atlas}"
fi
du -h $build/*.deb
