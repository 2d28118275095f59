#!/usr/bin/env bash
# Small files of all kinds, made by lamella itself, for fuzz to alter: corpus.sh LAMELLA FOLDER
set -euo pipefail
lamella=$(realpath "$1")
here=$(realpath "$(dirname "$0")")
mkdir -p "$2"
cd "$2"
export OMP_NUM_THREADS=1
make() { "$lamella" "$@" --overwrite >/dev/null; }

make generate honeycomb --size 24,20 -o cells.vti
make generate softwood --size 40,40 -o wood.png
make generate spheres --size 9,9,9 -o spheres.tif
make convert spheres.tif -o spheres.vti
make convert spheres.tif -o spheres.vtkhdf
make packing --count 12 -o grains.vtp --contacts forces.vtp
make convert grains.vtp -o grains.csv
make diffusion cells.vti --conductivity lumen=0.1 --conductivity wall=1 --direction x -o solved.vti
make flux-map solved.vti -o flux.vti -o lines.vtp
make transient cells.vti --diffusivity lumen=1e-9 --diffusivity wall=2e-9 --end-time 0.001 --checkpoint run.h5
printf '{"units": "um", "lumens": [[[0,0],[4,0],[4,3],[0,3]],[[6,0],[9,0],[9,5.5],[6,5]]]}' >cells.json
gzip -kf cells.json
cp "$here"/../../examples/scenes/*.toml .
printf '%s' '{"title": "T", "sections": [{"title": "S", "text": "words", "figures": [{"file": "wood.png", "caption": "c"}], "tables": [{"file": "grains.csv", "caption": "c"}]}]}' >page.plan
