#!/usr/bin/env bash
# Draws the pictures of this directory that take seconds, as the program and treb-plot draw them now.
#
#   analysis/pictures/draw.sh [DIRECTORY]      default: this directory
#
# TREBSWEEP is the program (default: build/release/trebsweep). assess-*.png, rules.png, literature.png, importance.png and
# explorer.png take minutes, or a browser: their commands are in tests/README.md, analysis/results/rules.md,
# analysis/README.md and tests/program/explorer_test.py.
set -euo pipefail

repository=$(cd "$(dirname "$0")/../.." && pwd)
pictures=$(realpath -- "${1:-$repository/analysis/pictures}")
program=$(realpath -- "${TREBSWEEP:-$repository/build/release/trebsweep}")
python=$([[ -x /usr/bin/python3 ]] && echo /usr/bin/python3 || echo python3)
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory"

draw() { # PICTURE SUBCOMMAND ARGUMENTS...
  "$python" -B "$repository/analysis/treb-plot" "$2" -o "$pictures/$1" "${@:3}" >/dev/null
}
sweep() { # JOB ARCHIVE OPTIONS...
  "$program" sweep "$repository/jobs/$1.cfg" --output.file "$2" --progress none "${@:3}" >/dev/null
}

sweep paper paper.h5
draw paper.png heatmap paper.h5

sweep accurate accurate.h5
draw euler-error.png compare paper.h5 accurate.h5
draw loads.png loads accurate.h5 --program "$program"

swing() { # TABLE JOB OPTIONS... also writes the flight
  "$program" trace "$repository/jobs/$2.cfg" "${@:3}" >"$1"
  "$program" trace "$repository/jobs/$2.cfg" "${@:3}" --flight >"flight-$1"
}
swing optimum.txt accurate --r1 0.51 --r2 0.91 --r3 0.58
draw optimum.png trajectory optimum.txt --flight flight-optimum.txt
swing laboratory.txt lab --r1 0.25 --r2 0.975 --r3 0.87
draw laboratory.png trajectory laboratory.txt --flight flight-laboratory.txt

draw machine.svg machine
draw built.svg machine --built

draw neighbourhood.png neighbourhood "$repository/jobs/accurate.cfg" --program "$program" -- \
  --optimum.subject-to "peak-beam-stress <= 6e7" --optimum.deviation 0.01 --lattice.r1 0.52:1:0.01

# Without the version, which changes.
"$program" optimum "$repository/jobs/hobby.cfg" --json --progress none |
  sed 's/^  "version": .*/  "version": "trebsweep",/' >hobby.json
draw sheet.png sheet hobby.json --program "$program"

sweep accurate masses.h5 --scene.projectile-mass "10, 20, 50, 100, 200, 300, 500, 700, 1000" \
  --lattice.increment 0.02 --optimum.refine yes --output.maps none
draw study.png study masses.h5

sweep accurate heights.h5 --scene.projectile-mass "10, 15, 20, 30, 50, 70, 100, 150, 200, 300, 500" \
  --scene.release-height 1.6:2.2:0.05 --lattice.increment 0.02 --optimum.refine yes --output.maps none
draw study-map.png study heights.h5 --quantity value --quantity r1 --quantity r3/r2 --quantity r2/r1
