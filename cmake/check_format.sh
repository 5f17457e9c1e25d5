#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Names every C++ source that clang-format 14 (Debian 12) would change, later ones break lines elsewhere; exit status 77
# without it.
set -euo pipefail
cd "$(dirname "$0")/.."
if ! command -v clang-format >/dev/null 2>&1; then
  echo "SKIPPED: clang-format is not installed"
  exit 77
fi
case $(clang-format --version) in
*"version 14."*) ;;
*)
  echo "SKIPPED: the format is that of clang-format 14, this is $(clang-format --version)"
  exit 77
  ;;
esac
mapfile -t sources < <(find packages apps tests docs -name '*.cpp' -o -name '*.hpp' | sort)
clang-format --dry-run --Werror "${sources[@]}"
echo "${#sources[@]} sources are in the format"
