#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Makes all that a release consists of, in dist/: the tarball and the packages for Debian 12 and 13 on amd64, the tarball
# and the package for arm64, the wheel for the Python here, a bill of materials for each tarball, and SHA256SUMS of all.
# Called by `./dev release` on a clean tree, on Debian 12; takes an hour or two on two cores.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
die() { printf 'release: %s\n' "$*" >&2; exit 1; }
step() { printf '\n=== release: %s\n' "$*" >&2; }

cd "$root"
[[ -z $(git status --porcelain) ]] || die "the tree has changes; a release is of a commit"
version=$(sed -n 's/^project(adit VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
grep -q "^## $version - [0-9]" CHANGELOG.md || die "CHANGELOG.md has no section for $version with its date"
# All that is made bears the commit's time, so that the same commit gives the same bytes.
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
rm -rf dist

step "tarball for amd64" && ./dev package
step "package for Debian 12" && ./dev deb
step "wheel" && ./dev wheel
step "arm64" && ./dev on bookworm arm64
step "package for Debian 13" && ./dev on trixie amd64
for tarball in dist/adit-"$version"-linux-*.tar.gz; do
  python3 -B tools/bill_of_materials.py "$tarball" "${tarball%.tar.gz}.spdx.json"
done
(cd dist && LC_ALL=C sha256sum -- * >SHA256SUMS && cat SHA256SUMS)
