#!/usr/bin/env bash
# Builds the program and its tests (installing what is missing) and runs every test.
# Arguments go to ctest: tests/run.sh -R lattice
set -euo pipefail
cd "$(dirname "$0")/.."
jobs/build.sh --tests
ctest --preset release -j "$(nproc)" "$@"
