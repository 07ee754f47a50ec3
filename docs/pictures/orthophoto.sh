#!/bin/sh
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# The picture of docs/coloring.md: a simulated office from above in the colours of three cameras, 25 mm a cell. Usage:
# orthophoto.sh ADIT PICTURE.png; a world file comes beside the picture.
set -eu
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$1" simulate office --trajectory walk --seed 7406 --duration 15 --camera front --camera left --camera right --quiet \
    -o "$folder/office.mcap"
"$1" run "$folder/office.mcap" -o "$folder/office" --quiet
"$1" export "$folder/office" --raster color --cell 0.025 -o "$2"
