#!/usr/bin/env bash
# A researcher's tables: albedos, costs of samplers and fits of every material of a folder, to go on with in another program.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../lib.sh" "$@"

# Directional albedos, a row for each material and angle.
step info "$brdfs" --json "$out/facts.json" --csv "$out/albedos.csv"

# Memory, time, bias and variance of two samplers.
step report "$brdfs" --sampler cosine --sampler half-vector:2KB --draws 2000 --json "$out/samplers.json" --csv "$out/samplers.csv"

# Which analytic model comes nearest, and with which parameters.
step fit "$brdfs" --model ggx,ward --pairs 500 --json "$out/fits.json" --csv "$out/fits.csv"
