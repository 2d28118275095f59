#!/usr/bin/env bash
#
# The main job from end to end, in commands to copy: makes a piece of softwood, computes how it conducts heat and how it
# lets water vapour through, in both directions, and draws what happens inside. ./dev demo builds first and runs this.
#
# Usage: examples/demo/run.sh [FOLDER]      (default: results/demo; what is there from before is replaced)
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
lamella=${LAMELLA:-$top/build/bin/lamella}
folder=${1:-$top/results/demo}
[[ -x $lamella ]] || {
  echo "error: there is no $lamella" >&2
  echo "hint: ./dev demo builds it first; or set LAMELLA to the program" >&2
  exit 1
}
mkdir -p "$folder"
cd "$folder"
rm -f tissue.png heat.json vapour.json heat_{x,y}.vti vapour_{x,y}.vti heat_y_lines.vtp heat.png vapour.png

lamella() { # shows a command as it can be typed, and runs it
  printf '$ lamella %s\n' "$*"
  "$lamella" "$@"
}
measure() { # file arguments...: the same, with its numbers in a file
  local file=$1
  shift
  printf '$ lamella %s --json > %s\n' "$*" "$file"
  "$lamella" "$@" --json >"$file"
}

SECONDS=0
echo "1. A tissue: earlywood to latewood, two fifths of it cell wall"
lamella generate softwood --size 600,400 --pixel-size 1um --solid-fraction 0.40 --ring-position 0,1 --seed 2016 -o tissue.png

echo
echo "2. Heat (wall 1, air 0.023) and water vapour (wall 0.004, air 1), in both directions"
measure heat.json diffusion tissue.png --conductivity wall=1 --conductivity lumen=0.023 -o heat.vti
measure vapour.json diffusion tissue.png --conductivity wall=0.004 --conductivity lumen=1 \
  --quantity concentration -o vapour.vti

echo
echo "3. What flows where"
lamella flux-map heat_y.vti -o heat_y_lines.vtp
lamella snapshot heat_y.vti --preset flux -o heat.png
lamella snapshot vapour_x.vti --preset flux -o vapour.png

echo
echo "Effective conductivities, x across the picture and y down it:"
echo
python3 "$top/examples/demo/table.py" heat=heat.json vapour=vapour.json
echo
echo "All of it took $SECONDS s. In $folder:"
echo "  pictures       heat.png, vapour.png"
echo "  for ParaView   heat_x.vti, heat_y.vti, vapour_x.vti, vapour_y.vti, heat_y_lines.vtp"
echo "  numbers        heat.json, vapour.json"
