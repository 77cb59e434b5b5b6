#!/usr/bin/env bash
# A student's figures: what the materials of a folder look like, for a report in LaTeX.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../lib.sh" "$@"

# What is in the folder, and does anything have gaps?
step info "$brdfs"

# One figure of all lobes, for the page and for slides.
step plot "$brdfs" --kind lobe --theta 30,60 -o "$out/lobes.pdf" --csv "$out/lobes.csv"
step plot "$brdfs" --kind lobe-polar -o "$out/lobes-polar.png"
step plot "$brdfs" --kind lobe-3d --theta 45 -o "$out/solids.png" --width 1600
step plot "$brdfs" --kind albedo -o "$out/albedo.pdf"

# Spheres with their names.
step sheet "$brdfs" -o "$out/spheres" --size 64 --spp 16

# How would the first material look if it were rougher?
first=$(find "$brdfs" -name '*.binary' | sort | head -n 1)
step fit "$first" --model ggx --pairs 500 -o "$out/fit.json"
step sheet "$out/fit.json" --columns-by alpha=0.05,0.1,0.2,0.4 -o "$out/rougher" --size 64 --spp 16
