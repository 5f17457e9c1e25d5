#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
#
# From a bare Debian 12 to a solved problem or a tested build:
#
#   cmake/bootstrap.sh run     install missing packages, build signorini and harmos, solve the model problem, draw it
#   cmake/bootstrap.sh test    install missing packages, build everything, run the tests
#
# and the parts of these:
#
#   cmake/bootstrap.sh packages    install what is missing
#   cmake/bootstrap.sh show        solve the model problem with what is built, draw it
#
# Runs as root or as a user with sudo; a second call skips what is done. HARMOS_JOBS sets the number of compilers and of
# tests at work (default: all cores).
set -euo pipefail

say() { printf '== %s\n' "$*"; }
fail() { printf 'error: %s\n' "$*" >&2; exit 2; }

usage="usage: cmake/bootstrap.sh run|test|packages|show"
[ $# -eq 1 ] || fail "$usage"
case "$1" in run | test | packages | show) goal=$1 ;; *) fail "$usage" ;; esac

cd "$(dirname "$0")/.."
build=build
jobs=${HARMOS_JOBS:-$(env -u OMP_NUM_THREADS nproc)}

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    "$@"
  elif command -v sudo >/dev/null 2>&1; then
    sudo "$@"
  else
    fail "\"$*\" needs root: run this as root, or install sudo"
  fi
}

install_packages() {
  command -v apt-get >/dev/null 2>&1 ||
    fail "this is not Debian (no apt-get): install the packages of cmake/packages-debian.txt yourself, then use the CMake presets"
  local name mark required=() optional=() all=0
  while read -r name mark; do
    all=$((all + 1))
    [ "$(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null || true)" != installed ] || continue
    if [ "$mark" = "?" ]; then optional+=("$name"); else required+=("$name"); fi
  done < <(grep -v -e '^#' -e '^$' cmake/packages-debian.txt)
  [ ${#required[@]} -eq 0 ] || as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q
  local missing=("${required[@]}")
  for name in "${optional[@]}"; do
    case $(LC_ALL=C apt-cache policy "$name") in
    *"Candidate: (none)"* | "") ;;
    *) missing+=("$name") ;;
    esac
  done
  if [ ${#missing[@]} -eq 0 ]; then
    say "All packages are installed"
    return
  fi
  say "Installing ${#missing[@]} of $all packages"
  as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# Debian's reference BLAS is several times slower than OpenBLAS; its serial build fits one thread a rank.
select_openblas() {
  local triplet library name path
  triplet=$(gcc -print-multiarch)
  for library in blas lapack; do
    name="lib$library.so.3-$triplet"
    path="/usr/lib/$triplet/openblas-serial/lib$library.so.3"
    [ -e "$path" ] || fail "OpenBLAS' $path is not there though libopenblas-serial-dev is installed"
    if [ "$(readlink -f "/etc/alternatives/$name")" != "$(readlink -f "$path")" ]; then
      say "Selecting OpenBLAS for $name"
      as_root update-alternatives --set "$name" "$path"
    fi
  done
}

# configure ON|OFF: with or without tests. A tree of another generator is left alone.
configure() {
  if [ -e "$build/CMakeCache.txt" ] && ! grep -q '^CMAKE_GENERATOR:INTERNAL=Ninja$' "$build/CMakeCache.txt"; then
    fail "$build/ was configured for another build program than Ninja: remove it, then start again"
  fi
  say "Configuring (preset release, in $build/)"
  cmake --preset release -DHARMOS_ENABLE_TESTS="$1"
}

# build_targets [TARGET...]: everything if there are none.
build_targets() {
  say "Building ${*:-everything} with $jobs jobs"
  cmake --build "$build" --parallel "$jobs" ${1:+--target "$@"}
}

show_model() {
  say "Solving the model problem on 2 ranks"
  mpirun -np 2 "$build/bin/signorini" apps/signorini/decks/model.xml --output run
  say "Drawing the result"
  "$build/bin/harmos-plot" run
  say "Open run/result.vtkhdf in ParaView, or look at run/solution.png and run/convergence.png"
}

if [ $goal != show ]; then
  install_packages
  select_openblas
fi
. cmake/environment.sh
case $goal in
packages) ;;
show) show_model ;;
run)
  # A tree that has tests keeps them.
  [ -e "$build/CTestTestfile.cmake" ] || configure OFF
  build_targets signorini harmos
  show_model
  say "For the other programs: cmake --build $build"
  ;;
test)
  configure ON
  build_targets
  say "Testing (all but the tests labelled long)"
  # Tests say how many processors they take: those of one rank go side by side. Not nproc, which answers 1 here:
  # cmake/environment.sh sets OMP_NUM_THREADS.
  ctest --test-dir "$build" --output-on-failure -LE long --parallel "$jobs"
  ;;
esac
