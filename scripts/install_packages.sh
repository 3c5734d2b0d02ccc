#!/usr/bin/env bash
# Installs missing Debian 12 packages (packages.txt): for everything, the demo or the player. If none is missing, it
# needs neither privileges nor the network.
set -euo pipefail
cd "$(dirname "$0")"

if (($# > 1)); then set -- "$*"; fi
case ${1-} in
  '') sets='player|demo|python|tests' ;;
  --demo) sets='player|demo' ;;
  --debian) sets='player|demo|python|debian' ;;
  --player) sets=player ;;
  --all) sets=all ;;
  --help | -h) cat install_packages.txt; exit 0 ;;
  *) printf 'install_packages: %s: must be --demo, --player, --debian, --all or --help\n' "$1" >&2; exit 2 ;;
esac
mapfile -t packages < <(awk -v sets="^($sets)\$" '$1 ~ sets { print $2 }' packages.txt)

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
