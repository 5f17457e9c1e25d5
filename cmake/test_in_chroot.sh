#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds and tests the committed state of this checkout in a bare Debian of any release:
#
#   cmake/test_in_chroot.sh [--bare] SUITE DIRECTORY [COMMAND [ARGUMENT...]]
#
#   SUITE       bookworm, trixie, sid, or experimental (sid, with Trilinos' packages from experimental)
#   DIRECTORY   of the chroot; made by debootstrap if it is not there, else used again with what it holds
#   COMMAND     run in the checkout (/srv/harmos in the chroot); default: cmake/bootstrap.sh test
#   --bare      without a checkout: the command runs in /root and finds the repository in /srv/harmos.git, for trials
#               of what begins with a clone
#
# Needs root, debootstrap and git. The mirror is that of this machine's apt; nothing else of this machine is shared
# with the chroot. /proc, /sys and /dev are mounted in a namespace of the command's own, so that nothing stays mounted
# and no process stays behind.
set -euo pipefail

say() { printf '== %s\n' "$*" >&2; }
fail() { printf 'error: %s\n' "$*" >&2; exit 2; }

bare=
if [ "${1:-}" = --bare ]; then
  bare=yes
  shift
fi
[ $# -ge 2 ] || fail "usage: cmake/test_in_chroot.sh [--bare] SUITE DIRECTORY [COMMAND [ARGUMENT...]]"
suite=$1
mkdir -p "$2"
root=$(cd "$2" && pwd)
shift 2
[ $# -gt 0 ] || set -- cmake/bootstrap.sh test
[ "$(id -u)" -eq 0 ] || fail "a chroot needs root: run this as root"
for tool in debootstrap git unshare; do
  command -v "$tool" >/dev/null || fail "$tool is missing: apt-get install debootstrap git util-linux"
done
source=$(cd "$(dirname "$0")/.." && pwd)
here_git() { git -c safe.directory='*' -C "$source" "$@"; }

make_chroot() {
  local mirror base=$suite
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Origin: Debian' 'Label: Debian' |
    sed -n 1p)
  [ -n "$mirror" ] || fail "apt on this machine has no source of Debian to take the mirror from"
  [ "$suite" != experimental ] || base=sid
  say "Making a chroot of $base in $root"
  debootstrap --variant=minbase "$base" "$root" "$mirror" >&2
  # How this machine reaches its mirror (a proxy, checks of dates) holds for the chroot as well.
  apt-config dump | grep -E '^Acquire::(http|https|Check-|Retries)' >"$root/etc/apt/apt.conf.d/00machine" || true
  if [ "$suite" = experimental ]; then
    printf 'deb %s experimental main\n' "$mirror" >>"$root/etc/apt/sources.list"
    # Nothing but Trilinos is taken from experimental, and all of Trilinos.
    printf 'Package: src:trilinos\nPin: release a=%s\nPin-Priority: %s\n\n' experimental 990 unstable -1 \
      >"$root/etc/apt/preferences.d/trilinos"
  fi
  printf '%s\n' "$suite" >"$root/etc/harmos_suite"
}

if [ -e "$root/etc/harmos_suite" ]; then
  [ "$(cat "$root/etc/harmos_suite")" = "$suite" ] ||
    fail "$root holds a chroot of $(cat "$root/etc/harmos_suite"), not of $suite: name another directory"
else
  [ -z "$(ls -A "$root")" ] ||
    fail "$root is neither empty nor a chroot that this script finished: name another directory"
  make_chroot
fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
# The machine's own name: mpirun asks for it, and ranks would wait for servers of names, 5 seconds each.
printf '127.0.0.1 localhost\n127.0.0.1 %s\n' "$(hostname)" >"$root/etc/hosts"

say "Copying commit $(here_git rev-parse --short HEAD)"
rm -rf "$root/srv/harmos.git"
git -c safe.directory='*' clone -q --bare --no-hardlinks "$source" "$root/srv/harmos.git"
place=/root
if [ -z "$bare" ]; then
  place=/srv/harmos
  [ -d "$root$place/.git" ] || git init -q "$root$place"
  git -C "$root$place" fetch -q "$root/srv/harmos.git" HEAD
  git -C "$root$place" checkout -q --force --detach FETCH_HEAD
fi

say "$suite: $*"
# Variables of this machine would be others' settings: none but what the build asks for is passed on.
exec unshare --mount --pid --fork --kill-child bash -c '
  set -e
  root=$1 place=$2
  shift 2
  mount --make-rprivate /
  mount -t proc proc "$root/proc"
  mount -t sysfs -o ro sysfs "$root/sys"
  mount --bind /dev "$root/dev"
  mkdir -p "$root/dev/shm"
  mount -t tmpfs tmpfs "$root/dev/shm"
  exec chroot "$root" /usr/bin/env -i HOME=/root LANG=C.UTF-8 TERM=dumb \
    PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    ${HARMOS_JOBS:+HARMOS_JOBS="$HARMOS_JOBS"} \
    bash -c '\''cd "$0" && exec "$@"'\'' "$place" "$@"
' bash "$root" "$place" "$@"
