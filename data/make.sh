#!/bin/sh
# Makes every picture in this folder anew: data/make.sh [path of the lamella program]
set -eu
lamella=$(realpath "${1:-"$(dirname "$0")/../build/bin/lamella"}")
cd "$(dirname "$0")"

make() { "$lamella" generate "$@" --overwrite --quiet; }

make softwood --size 200,200 --solid-fraction 0.40 --ring 0,0 --seed 1 -o earlywood_200.png
make softwood --size 200,200 --solid-fraction 0.78 --ring 1,1 --seed 1 -o latewood_200.png
make softwood --size 800,400 --solid-fraction 0.45 --ring 0,1 --seed 2 -o ring_800x400.png
make softwood --size 64,64,64 --solid-fraction 0.40 --ring 0,0 --tracheid-length 60um --seed 1 -o tissue_64.tif
make honeycomb --size 208,180 --solid-fraction 0.40 --cells 4 -o honeycomb_208x180.png
make disks --size 128,128 --solid-fraction 0.5 --cells 1 -o disks_128.png
