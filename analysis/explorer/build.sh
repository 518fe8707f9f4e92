#!/usr/bin/env bash
# Installs missing Debian packages and builds the explorer: one HTML file that any browser opens from disk.
#
#   analysis/explorer/build.sh [-o FILE [--overwrite]] [--archive ARCHIVE [--at KEY=VALUE]...]
#
# The default is results/explorer.html, which is replaced; any other file is replaced only with --overwrite. With an
# archive, the page also shows the stored planes through its optimum. --at selects a scene of a study.
set -euo pipefail

usage() { sed -n '2,7s/^# \{0,1\}//p' "$0"; }
refuse() { echo "analysis/explorer/build.sh: $1" >&2; exit 2; }

page='' archive='' options=()
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    -o) [[ -n ${2:-} ]] || refuse "-o: needs the path of the page"; page=$(realpath -m -- "$2"); shift 2 ;;
    --archive) [[ -f ${2:-} ]] || refuse "--archive ${2:-}: must be the path of an archive"
               archive=$(realpath -- "$2"); shift 2 ;;
    --at) [[ -n ${2:-} ]] || refuse "--at: needs KEY=VALUE"; options+=(--at "$2"); shift 2 ;;
    --overwrite) options+=(--overwrite); shift ;;
    *) refuse "$1: unknown option" ;;
  esac
done
cd "$(dirname "$0")/../.."
[[ -n $page ]] || { page=$PWD/results/explorer.html; options+=(--overwrite); }

packages=(clang libboost-dev libc++-dev-wasm32 libclang-rt-dev-wasm32 lld python3 wasi-libc)
[[ -z $archive ]] || packages+=(python3-h5py python3-xarray)
jobs/install.sh "${packages[@]}"

build=build/explorer
mkdir -p "$build/include" "$(dirname "$page")"
exec 9>$build/lock && flock 9 # against a second build at the same time
ln -sfn /usr/include/boost "$build/include/boost" # without the rest of /usr/include, which is not WebAssembly's
module=$build/explorer.wasm
if [[ ! -e $module || -n $(find include analysis/explorer/{build.sh,*.?pp} -newer $module) ]]; then
  # Warnings as in CMakeLists.txt, except that indices of 64 bits may become addresses of 32 bits. No fused
  # multiply-add, as in the other kernels.
  clang++ --target=wasm32-wasi -std=c++20 -O2 -mllvm -inline-threshold=100 -msimd128 -ffp-contract=off -fno-math-errno -fno-rtti \
    -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-bitwise-instead-of-logical -Wno-unknown-attributes \
    -Wno-shorten-64-to-32 -Werror -Iinclude -isystem $build/include -c -o $build/explorer.o analysis/explorer/explorer.cpp
  # The stack comes first, so that an overflow is an error instead of overwriting data.
  clang++ --target=wasm32-wasi -mexec-model=reactor -Wl,--strip-all,--stack-first,-z,stack-size=1048576 \
    -o $module $build/explorer.o
fi

python=$([[ -x /usr/bin/python3 ]] && echo /usr/bin/python3 || echo python3)
$python -B analysis/explorer/bundle.py $module "$page" ${archive:+--archive "$archive"} "${options[@]}"
echo "$page"
