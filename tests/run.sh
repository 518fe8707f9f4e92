#!/usr/bin/env bash
# Builds the program and its tests (installing what is missing) and runs every test: those of the numerical core and of
# scripts, and with sanitizers all others. Arguments go to ctest: tests/run.sh -R lattice
set -euo pipefail
cd "$(dirname "$0")/.."
jobs/build.sh --tests
cmake --preset asan -DTREBSWEEP_WERROR=ON
cmake --build --preset asan
status=0
for preset in release asan; do
  ctest --preset $preset -j "$(nproc)" "$@" || status=$?
done
sed -n 's/^skipped: /Skipped: /p' build/{release,asan}/Testing/Temporary/LastTest.log | sort -u || true # they need not exist
exit $status
