#!/usr/bin/env bash
# A renderer author's afternoon: every material of a folder in a renderer in C++ that chooses them by name when it runs.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
source "$here/../lib.sh" "$@"

# Tables, and the header that loads them.
step export "$brdfs" --format runtime -o "$out"

timed "c++ sphere.cpp" "${CXX:-c++}" -std=c++11 -O2 -I"$out" "$here/sphere.cpp" -o "$out/sphere"

names=()
for table in "$out"/*.merlkit; do
  names+=("$(basename "$table" .merlkit)")
done
cd "$out"
timed "sphere picture.pfm 96 16 ${names[*]}" ./sphere picture.pfm 96 16 "${names[@]}"
