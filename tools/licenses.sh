# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# For scripts that put libraries of Debian into what they make (package.sh, wheel.sh): which those are, and their
# licences. They define die() and set `licenses`, the folder that licences are copied to.

# Libraries that every glibc system has. All others that are loaded are put beside the program.
is_glibc() { [[ $1 =~ ^(linux-vdso|ld-linux-[^/]*|libc|libm|libdl|librt|libpthread)\.so ]]; }

# Compiled or linked into all that is made: header-only libraries.
# Boost's package has its version in its name.
compiled_in=(libeigen3-dev libfmt-dev libcli11-dev nlohmann-json3-dev libtomlplusplus-dev libxxhash-dev libvulkan-dev
  "$(dpkg -S /usr/include/boost/version.hpp | cut -d : -f 1)")

declare -A licensed=()
add_license() { # PACKAGE
  local from=/usr/share/doc/$1/copyright
  [[ -z ${licensed[$1]:-} ]] || return 0
  [[ -f $from ]] || die "the licence of $1 is not at $from"
  cp "$from" "$licenses/$1.txt"
  licensed[$1]=1
}

owner_of() { # FILE: the Debian package it comes from
  local file
  file=$(realpath "$1")
  # Files that were packaged before /lib became /usr/lib are known by their old place.
  { dpkg-query -S "$file" || dpkg-query -S "${file#/usr}" || true; } 2>/dev/null | sed 's/:.*//' | head -n 1
}

# A line for each: package, version and source.
list_components() {
  local package
  for package in "${!licensed[@]}"; do
    dpkg-query -W -f '${Package} ${Version} (source ${source:Package} ${source:Version})\n' "$package" | head -n 1
  done | LC_ALL=C sort
}

# What the page of `adit view` is made of, from the folder that the build made it in (tools/viewer/page.cmake). A line for
# each component goes to the standard output.
add_page_licenses() { # FOLDER
  local package version
  [[ -s $1/page.html ]] || die "adit was built without the page of adit view: npm or its packages are missing"
  for package in three; do
    version=$(node -p "require('$1/node_modules/$package/package.json').version")
    cp "$1/node_modules/$package/LICENSE" "$licenses/$package.js.txt" || die "the licence of $package.js is missing"
    echo "$package.js $version (npm package $package $version, MIT licence)"
  done
}

add_common_licenses() { # texts which those files refer to
  local text
  for text in GPL-3 LGPL-2.1 Apache-2.0; do
    cp "/usr/share/common-licenses/$text" "$licenses/$text.txt"
  done
}
