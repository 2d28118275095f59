#!/usr/bin/env bash
# What ./dev says to someone who is not root: with nothing installed, with no sudo, with an unknown command.
# Runs a copy of it among programs that only pretend, so that nothing is installed.
#
# Usage: check-dev.sh SOURCES
set -euo pipefail
sources=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin" "$work/repo"
cp "$sources/dev" "$sources/packages.txt" "$sources/CMakePresets.json" "$work/repo/"

pretend() { # name body
  printf '#!/bin/sh\n%s\n' "$2" >"$work/bin/$1"
  chmod +x "$work/bin/$1"
}
expect() { # what text pattern
  grep -qE -- "$3" <<<"$2" || {
    echo "FAILED: $1: no '$3' in:" >&2
    echo "$2" >&2
    exit 1
  }
}
for program in bash env dirname sed grep awk cat tail mkdir mktemp rm sort find; do
  ln -s "$(command -v "$program")" "$work/bin/$program"
done
dev() { (cd "$work/repo" && PATH=$work/bin ./dev "$@" </dev/null 2>&1) || echo "exit $?"; }

# A machine with nothing of the list, an ordinary user, no sudo: one line with every name, and how to mend it.
pretend dpkg-query 'exit 1'
pretend id 'echo 1000'
pretend nproc 'echo 2'
output=$(dev build)
expect "no root, no sudo" "$output" '^error: these packages are missing.*: .*paraview-dev.*libgtest-dev'
expect "no root, no sudo" "$output" '^hint: as root: apt-get install --no-install-recommends '
expect "no root, no sudo" "$output" '^exit 1$'
[[ $(wc -l <<<"$output") == 3 ]] || expect "two lines and no more" "$output" '^$'

# With the system's VTK: its packages, none of ParaView's, and nothing is removed for them.
output=$(PRESET=vtk dev build)
expect "the system's VTK" "$output" '^error: these packages are missing.*: .*libgtest-dev.*libvtk9-dev python3-vtk9$'
! grep paraview <<<"$output" || expect "no ParaView beside the system's VTK" "$output" '^$'

# With sudo that needs no password: it is used, and only for apt-get.
# shellcheck disable=SC2016
pretend sudo '[ "$1" = -n ] && exit 0; echo "$@" >> '"$work"'/asked; exit 0'
pretend cmake 'exit 0'
output=$(dev build)
expect "sudo" "$(<"$work/asked")" '^env DEBIAN_FRONTEND=noninteractive apt-get .*install --yes --no-install-recommends .*cmake'
! grep -e --no-remove "$work/asked" || expect "sudo" "$(<"$work/asked")" '^$'
output=$(PRESET=vtk dev build)
expect "the system's VTK" "$(tail -n 1 "$work/asked")" '^env DEBIAN_FRONTEND=noninteractive apt-get .* --no-remove$'
rm "$work/asked"

# Everything is there: neither root nor sudo is needed.
# shellcheck disable=SC2016 # the script expands it
pretend dpkg-query 'for name; do case $name in --*) ;; *) echo "$name installed" ;; esac; done'
output=$(dev build)
[[ ! -e $work/asked ]] || expect "all packages there: no sudo" "$output" '^$'
expect "all packages there" "$output" '^building'

# Benchmarks get what has the form KEY=VALUE; the rest are their names.
mkdir -p "$work/repo/build/bin/benchmarks"
printf '#!/bin/sh\necho "ran with: $*"\n' >"$work/repo/build/bin/benchmarks/thing"
chmod +x "$work/repo/build/bin/benchmarks/thing"
expect "a benchmark with keys" "$(dev bench thing size=full repeat=3)" '^ran with: size=full repeat=3$'
expect "keys for all benchmarks" "$(dev bench size=full)" '^ran with: size=full$'
expect "an unknown benchmark" "$(dev bench size=full other)" "^error: no benchmark 'other'"

expect "an unknown command" "$(dev tset)" "^error: no command 'tset'"
expect "a wrong preset" "$(PRESET=fast dev build)" "^error: no preset 'fast'"
for command in demo test build bench lint format docs clean help; do
  expect "help" "$(dev help)" "^  $command"
done
echo "dev: says what it needs"
