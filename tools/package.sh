#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Makes dist/adit-VERSION-linux-ARCH.tar.gz: the program, the Vulkan loader beside it, manual pages, completions,
# JSON schemas, licences. Runs where glibc is 2.35 or later and a Vulkan driver is installed. Called by `./dev package`.
#
# The C++ runtime is linked in rather than put beside: a bundled libstdc++.so would be the one that the
# system's Vulkan driver gets as well, and a newer driver needs a newer one. The loader is C. Ceres and what
# it needs are linked in too (docs/decisions/0015), which puts the program, not its source, under the GPL.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/package
max_bytes=$((60 * 1024 * 1024))
max_glibc=2.35

die() { printf 'package: %s\n' "$*" >&2; exit 1; }

# DT_RPATH, not DT_RUNPATH: it also holds for what the bundled libraries load in turn.
link_flags='-static-libstdc++ -static-libgcc -s -Wl,--disable-new-dtags,-rpath,\$ORIGIN/../lib'
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DADIT_TESTS=OFF -DADIT_PYTHON=OFF -DADIT_UNITY=ON \
  -DADIT_PEERS=OFF -DADIT_STATIC_CERES=ON -DADIT_FMT_HEADER_ONLY=ON -DCMAKE_SKIP_RPATH=ON "-DCMAKE_EXE_LINKER_FLAGS=$link_flags" >&2
cmake --build "$build" --target adit >&2

version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
name=adit-$version-linux-$(uname -m)
stage=$build/stage/$name
rm -rf "$build/stage"
mkdir -p "$stage/bin" "$stage/lib" "$stage/licenses"
cp "$build/tools/adit" "$stage/bin/"
cp -r "$build/tools/share" "$stage/"
mkdir -p "$stage/share/adit/schemas"
cp "$root"/docs/schemas/*.schema.json "$stage/share/adit/schemas/"
cp "$root/README.md" "$root/LICENSE" "$root/CHANGELOG.md" "$stage/"

licenses=$stage/licenses
source "$root/tools/licenses.sh"

bundle() { # NAME PATH
  local package
  [[ -f $2 ]] || die "$1, which adit loads, was not found"
  [[ $1 != libstdc++* && $1 != libgcc_s* ]] || die "$1 is to be linked statically"
  cp -L "$2" "$stage/lib/$1"
  package=$(owner_of "$2")
  [[ -n $package ]] || die "$2 belongs to no package: its licence is not known"
  add_license "$package"
}

# Opened by name while the program runs, so ldd does not know of it; the RPATH holds for that too.
bundle libvulkan.so.1 "$(g++ -print-file-name=libvulkan.so.1)"
while read -r library path; do
  is_glibc "$library" || bundle "$library" "$path"
done < <(ldd "$stage/bin/adit" | sed -n 's/^\s*\(\S*\) => \(\S*\) (.*/\1 \2/p')

# Compiled or linked in: header-only libraries, the C++ and Fortran runtimes, Ceres and what it needs.
linked=(libceres-dev libgeographiclib-dev libsuitesparse-dev libatlas-base-dev libgoogle-glog-dev libgflags-dev libgfortran-12-dev
  libstdc++6)
for package in "${compiled_in[@]}" "${linked[@]}"; do
  add_license "$package"
done
add_common_licenses
page_components=$(add_page_licenses "$build/tools/view_page")

# What the package is, and where the source of each part of it is found: one line each.
{
  cat <<'EOT'
The source of adit is under the Apache License 2.0 (LICENSE). The program bin/adit also contains Ceres with
CHOLMOD, whose supernodal factorisation is under the GPL, version 2 or any later one. As a whole the program may
therefore be passed on under the GPL, version 3 (licenses/GPL-3.txt). The Debian source packages of the versions
below are its parts' complete source (Debian's snapshot archive keeps all of them); adit's own is the
repository at the version that `bin/adit --version` and `bin/adit bench` name. Who wants a program under the
Apache License builds adit with a Ceres without SuiteSparse.

Each part's licence is in licenses/NAME.txt.

EOT
  list_components
  echo "$page_components"
} >"$stage/COMPONENTS.txt"

# What was staged stands alone: nothing from outside but glibc, and no newer glibc than promised.
for file in "$stage"/bin/* "$stage"/lib/*; do
  while read -r library _ path _; do
    is_glibc "${library##*/}" && continue
    # What a bundled library loads is found by the program's DT_RPATH, which ldd of it alone ignores.
    [[ $file == "$stage"/lib/* && -e $stage/lib/${library##*/} ]] && continue
    [[ $(realpath "$path") == "$stage"/* ]] || die "${file##*/}: $library would come from $path, outside the package"
  done < <(ldd "$file")
  needs=$(objdump -T "$file" | grep -o 'GLIBC_[0-9.]*' | sed 's/GLIBC_//' | sort -uV | tail -n 1)
  [[ $(printf '%s\n%s\n' "$needs" "$max_glibc" | sort -V | tail -n 1) == "$max_glibc" ]] ||
    die "${file##*/} needs glibc $needs; the package promises $max_glibc (build it on Debian 12)"
done
# And it does what it is for, with the libraries that lie beside it.
trial=$(mktemp -d)
trap 'rm -rf "$trial"' EXIT
"$stage/bin/adit" simulate room --duration 1 -o "$trial/room.mcap" --quiet >/dev/null &&
  "$stage/bin/adit" run "$trial/room.mcap" -o "$trial/out" --quiet >"$trial/run.txt" 2>&1 ||
  die "the staged program does not map a recording: $(tail -n 3 "$trial/run.txt" 2>/dev/null)"

mkdir -p "$root/dist"
archive=$root/dist/$name.tar.gz
# The same tree gives the same bytes.
stamp=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 0)}
tar --create --directory "$build/stage" --sort=name --mtime="@$stamp" --owner=0 --group=0 --numeric-owner "$name" |
  gzip -9n >"$archive"
bytes=$(stat -c %s "$archive")
((bytes < max_bytes)) || die "$archive has $bytes bytes; the limit is $max_bytes"
printf '%s  (%d.%d MiB)\n' "$archive" $((bytes / 1048576)) $((bytes % 1048576 * 10 / 1048576))
