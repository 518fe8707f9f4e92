#!/usr/bin/env bash
# Builds the program and its tests (installing what is missing) and runs every test.
# Arguments go to ctest: tests/run.sh -R lattice
set -euo pipefail
cd "$(dirname "$0")/.."
jobs/build.sh --tests
status=0
ctest --preset release -j "$(nproc)" "$@" || status=$?
sed -n 's/^skipped: /Skipped: /p' build/release/Testing/Temporary/LastTest.log | sort -u || true # it need not exist
exit $status
