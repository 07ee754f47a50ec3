#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# Makes dist/adit_VERSION_ARCH.deb of a build: the program, its manual pages and completions. The libraries that it
# loads are packages of the Debian release that it was built on, which the version names. Called by `./dev deb`.
#
# Usage: deb.sh BUILD [FOLDER]. DEBFULLNAME and DEBEMAIL say who makes it, as for Debian's own tools; without them the
# address is one that is kept for examples.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(cd "$1" && pwd)
dist=${2:-$root/dist}

die() { printf 'deb: %s\n' "$*" >&2; exit 1; }

version=$(sed -n 's/^CMAKE_PROJECT_VERSION:STATIC=//p' "$build/CMakeCache.txt")
architecture=$(dpkg --print-architecture)
release=$(. /etc/os-release && echo "$ID${VERSION_ID:-}")
full=$version-1~$release
maintainer="${DEBFULLNAME:-The adit authors} <${DEBEMAIL:-adit@example.org}>"
stamp=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 0)}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
stage=$work/debian/adit
documents=$stage/usr/share/doc/adit
DESTDIR=$stage cmake --install "$build" --component program --prefix /usr --strip >/dev/null
mkdir -p "$documents" "$stage/DEBIAN"
find "$stage/usr/share/man" -type f -exec gzip -9n {} +
# Where Debian's zsh looks for what packages bring.
mkdir -p "$stage/usr/share/zsh/vendor-completions"
mv "$stage"/usr/share/zsh/site-functions/* "$stage/usr/share/zsh/vendor-completions/"
rmdir "$stage/usr/share/zsh/site-functions"

# A service, which nothing starts by itself.
install -D -m 644 "$root/tools/adit-live.service" "$stage/usr/lib/systemd/system/adit-live.service"
install -D -m 644 "$root/tools/adit-live.default" "$stage/etc/default/adit-live"
echo /etc/default/adit-live >"$stage/DEBIAN/conffiles"

licenses=$work/licenses
mkdir "$licenses"
source "$root/tools/licenses.sh"
compiled_in+=(libceres-dev) # Debian has it as a static library alone
for package in "${compiled_in[@]}"; do
  add_license "$package"
done
{
  cat <<'EOT'
adit turns LiDAR recordings into trajectories and maps.

Copyright: 2026 The adit authors
License: Apache-2.0

On Debian systems the text of the Apache License, version 2.0, is in
/usr/share/common-licenses/Apache-2.0.

The program contains Ceres and loads CHOLMOD, whose supernodal factorisation
is under the GPL, version 2 or any later one. As a whole the program may
therefore be passed on under the GPL, version 3, in
/usr/share/common-licenses/GPL-3.

The program also contains parts of these packages, whose notices follow:

EOT
  list_components
  for package in "${compiled_in[@]}"; do
    printf '\n%s\n%s\n\n' "$package" "${package//?/=}"
    cat "$licenses/$package.txt"
  done
} >"$documents/copyright"
{
  printf 'adit (%s) unstable; urgency=medium\n\n' "$full"
  printf '  * Built from commit %s.\n\n' "$(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown)"
  printf ' -- %s  %s\n' "$maintainer" "$(date -R -u -d "@$stamp")"
} | gzip -9n >"$documents/changelog.Debian.gz"
gzip -9nc "$root/CHANGELOG.md" >"$documents/changelog.gz"

# dpkg-shlibdeps asks for a source package's control file.
printf 'Source: adit\n\nPackage: adit\nArchitecture: any\n' >"$work/debian/control"
depends=$(cd "$work" && dpkg-shlibdeps -O debian/adit/usr/bin/adit | sed -n 's/^shlibs:Depends=//p')
[[ -n $depends ]] || die "dpkg-shlibdeps found nothing that adit needs"

# The loader is opened by name while the program runs; without a driver there is no device. The plug-in for ROS 2 topics
# is opened when it is asked for, and needs a DDS that others need not install.
cat >"$stage/DEBIAN/control" <<EOT
Package: adit
Version: $full
Architecture: $architecture
Maintainer: $maintainer
Installed-Size: $(du -ks --apparent-size "$stage/usr" | cut -f 1)
Depends: $depends, libvulkan1, mesa-vulkan-drivers | vulkan-icd
Suggests: libproj25, libddsc0debian
Section: science
Priority: optional
Description: LiDAR recordings to trajectories and maps, on any GPU or none
 adit maps recordings of range sensors, with or without an inertial sensor
 and GNSS: trajectory, point cloud, a map database with closed loops, and
 what of it is reliable. It reads MCAP, ROS bags, captures of packets and
 folders of clouds. It computes on any device with a Vulkan driver, Mesa's
 software driver included.
EOT
(cd "$stage" && find etc usr -type f -print0 | LC_ALL=C sort -z | xargs -0 md5sum) >"$stage/DEBIAN/md5sums"

# The same tree gives the same bytes.
find "$stage" -type d -exec chmod 755 {} + -o -type f -exec chmod u=rwX,go=rX {} +
find "$stage" -exec touch --no-dereference --date "@$stamp" {} +
mkdir -p "$dist"
archive=$dist/adit_${full}_$architecture.deb
SOURCE_DATE_EPOCH=$stamp dpkg-deb --root-owner-group -Zxz --build "$stage" "$archive" >/dev/null
bytes=$(stat -c %s "$archive")
printf '%s  (%d.%d MiB)\n' "$archive" $((bytes / 1048576)) $((bytes % 1048576 * 10 / 1048576))
