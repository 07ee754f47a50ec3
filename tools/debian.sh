#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Runs a command in the tree as on another Debian: of another release, or for arm64 (Jetson, Raspberry Pi, servers).
# Called by `./dev on`, as root, on an amd64 Debian 12.
#
# That Debian lies in build/on/RELEASE-ARCHITECTURE/root, and is made when it is first asked for; what is built in it lies
# beside it, in build/on/RELEASE-ARCHITECTURE/build. Programs of arm64 are run by qemu-user. The compiler, CMake, ninja
# and the tools of the shaders are amd64's own there and make code for arm64: a build takes about as long as one for this
# machine, and other scripts need no word of it.
#
# Usage: debian.sh RELEASE ARCHITECTURE PACKAGE... -- COMMAND...: PACKAGES are what the build needs.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
here=/adit # where the tree is in that Debian

die() { printf 'on: %s\n' "$*" >&2; exit 1; }

[[ $# -ge 4 ]] || die "usage: debian.sh RELEASE ARCHITECTURE PACKAGE... -- COMMAND..."
release=$1 architecture=$2 packages=()
shift 2
while [[ $# -gt 0 && $1 != -- ]]; do packages+=("$1") && shift; done
shift
work=$root/build/on/$release-$architecture
target=$work/root
machine=$(dpkg --print-architecture)
case $architecture in
  "$machine") native=() compiler=() compiler_libraries=() cxx=c++ ;;
  arm64)
    [[ $release == bookworm ]] || die "the compiler for arm64 is Debian 12's: bookworm is expected, not $release"
    cxx=aarch64-linux-gnu-g++-12
    # What takes the time of a build.
    native=(cmake ninja-build glslang-tools spirv-tools ccache)
    # Unpacked beside what apt has installed: apt does not mix the parts of a compiler of amd64 with those of arm64.
    compiler=({cpp,gcc,g++}-12-aarch64-linux-gnu:"$machine" binutils-aarch64-linux-gnu:"$machine" libgcc-12-dev-arm64-cross
      libstdc++-12-dev-arm64-cross libc6-dev-arm64-cross linux-libc-dev-arm64-cross libc6-arm64-cross
      libgcc-s1-arm64-cross libstdc++6-arm64-cross)
    compiler_libraries=(libisl23 libmpc3 libmpfr6 libgmp10 libzstd1 zlib1g libstdc++6 libgcc-s1 libjansson4 libbinutils)
    ;;
  *) die "$architecture is not known: $machine or arm64 is expected" ;;
esac
((EUID == 0)) || die "chroot and mount need root"

run_foreign_programs() {
  local status=/proc/sys/fs/binfmt_misc
  [[ -e $status/status ]] || mount -t binfmt_misc binfmt_misc "$status" ||
    die "the kernel has no binfmt_misc, by which programs of $architecture run"
  [[ -e $status/qemu-aarch64 ]] || update-binfmts --enable qemu-aarch64 >&2 || true
  [[ -e $status/qemu-aarch64 ]] || die "programs of $architecture do not run here; Debian: qemu-user-static, binfmt-support"
}

make_root() {
  local package wanted=()
  for package in "${packages[@]}"; do
    [[ " ${native[*]} " == *" $package "* ]] || wanted+=("$package")
  done
  wanted+=("${native[@]/%/:$machine}" "${compiler_libraries[@]/%/:$machine}" git ca-certificates)
  rm -rf "$target"
  mkdir -p "$work"
  mmdebstrap --architectures="$architecture$([[ $architecture == "$machine" ]] || echo ",$machine")" --variant=apt \
    --include="$(IFS=,; echo "${wanted[*]}")" "$release" "$target" >&2 || die "mmdebstrap made no Debian, see above"
  ((${#compiler[@]})) || return 0
  cp -L /etc/resolv.conf "$target/etc/resolv.conf"
  chroot "$target" sh -c 'apt-get update -q && cd /tmp && apt-get download -q "$@"' download "${compiler[@]}" >&2 ||
    die "the compiler for $architecture could not be had"
  for package in "$target"/tmp/*.deb; do
    dpkg -x "$package" "$target"
    rm "$package"
  done
}

[[ $architecture == "$machine" ]] || run_foreign_programs
wanted=$(printf '%s\n' "${packages[@]}" "${native[@]}" "${compiler[@]}" | sha256sum)
if [[ ! -f $work/made || $(<"$work/made") != "$wanted" ]]; then
  make_root
  echo "$wanted" >"$work/made"
fi

# What is mounted ends with the command.
mkdir -p "$work/build" "$target$here" "$root/build" "$root/dist"
export root work target here cxx
# shellcheck disable=SC2016
exec unshare --mount bash -c '
  set -e
  mount --bind "$root" "$target$here"
  mount --bind "$work/build" "$target$here/build"
  for outside in "$(git -C "$root" rev-parse --path-format=absolute --git-common-dir 2>/dev/null || true)" "${CCACHE_DIR:-}"; do
    [[ -z $outside || $outside == "$root"/* ]] && continue
    mkdir -p "$target$outside"
    mount --bind "$outside" "$target$outside"
  done
  mount -t proc proc "$target/proc"
  mount --rbind /dev "$target/dev"
  for file in /etc/resolv.conf /etc/ssl/certs/ca-certificates.crt; do cp -L "$file" "$target$file" 2>/dev/null || true; done
  exec env HOME=/root LANG=C.UTF-8 CXX="$cxx" ADIT_NO_INSTALL=1 GIT_CONFIG_COUNT=1 GIT_CONFIG_KEY_0=safe.directory \
    GIT_CONFIG_VALUE_0="*" chroot "$target" sh -c "cd $here && exec \"\$@\"" run "$@"
' on "$@"
