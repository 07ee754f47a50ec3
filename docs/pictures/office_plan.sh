#!/bin/sh
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: Apache-2.0
#
# The picture of docs/plans.md: the plan of a simulated office. Usage: office_plan.sh ADIT PICTURE.png; needs Debian's
# librsvg2-bin.
set -eu
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$1" simulate office --seed 6601 --duration 60 --quiet -o "$folder/office.mcap"
"$1" run "$folder/office.mcap" -o "$folder/office"
"$1" export "$folder/office" --plan -o "$folder/plan.svg"
rsvg-convert --width 1200 --output "$2" "$folder/plan_0.svg"
