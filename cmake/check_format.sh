#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Names every C++ source that clang-format would change; exit status 77 without clang-format.
set -euo pipefail
cd "$(dirname "$0")/.."
if ! command -v clang-format >/dev/null 2>&1; then
  echo "SKIPPED: clang-format is not installed"
  exit 77
fi
mapfile -t sources < <(find packages apps tests docs -name '*.cpp' -o -name '*.hpp' | sort)
clang-format --dry-run --Werror "${sources[@]}"
echo "${#sources[@]} sources are in the format"
