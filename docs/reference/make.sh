#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Makes the API reference, build/docs/html, of the docstrings. Whatever Doxygen complains of is an error: what has no
# docstring, a name that does not exist. Called by `./dev docs`.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
rm -rf "$root/build/docs"
mkdir -p "$root/build/docs"
cd "$root/build/docs"
ln -s "$root" adit # headers are shown as they are included
ADIT_VERSION=$(sed -n 's/^project(adit VERSION \([0-9.]*\).*/\1/p' adit/CMakeLists.txt) doxygen adit/docs/reference/Doxyfile

# A move says all there is to say. Settings have their meaning, once, where visit() names them: `adit config` prints it.
complaints=$(grep -v -e '&&) noexcept (function)' -e 'Config is not documented[.]$' warnings.txt || true)
if [[ -n $complaints ]]; then
  printf '%s\n' "${complaints//$PWD\/adit\//}" >&2
  exit 1
fi
printf 'docs: %s pages, %s\n' "$(find html -name '*.html' | wc -l)" build/docs/html/index.html
