#!/usr/bin/env bash
# The kernel gives the same bits with every x86-64 instruction set that has a fused multiply-add, and on 64-bit ARM.
#
#   tests/same_bits/same_bits.sh PROGRAM KERNELS ARM-PROGRAM EMULATOR      exits with 77 if it cannot run
set -euo pipefail

program=$1 kernels=$2 arm_program=$3 emulator=$4
skip() { echo "skipped: $*"; exit 77; }
[[ -x $emulator && -x $arm_program ]] ||
  skip "needs aarch64-linux-gnu-g++ and qemu-aarch64 (Debian: g++-aarch64-linux-gnu, qemu-user)"

directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
levels=()
for level in x86-64-v3 x86-64-v4; do
  /lib64/ld-linux-x86-64.so.2 --help | grep "$level (supported" >/dev/null || continue
  [[ -d $kernels/glibc-hwcaps/$level ]] || continue
  LD_LIBRARY_PATH=$kernels/glibc-hwcaps/$level "$program" >"$directory/$level"
  levels+=("$level")
done
[[ ${#levels[@]} -gt 0 ]] || skip "this machine, or this build, has no x86-64 kernel with a fused multiply-add"

"$emulator" "$arm_program" >"$directory/arm"
cat "$directory/arm"
for level in "${levels[@]}"; do
  diff --label "$level" --label arm "$directory/$level" "$directory/arm"
done
