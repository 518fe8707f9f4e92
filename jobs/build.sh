#!/usr/bin/env bash
# Installs missing Debian packages and builds build/release/trebsweep.
# --tests: also installs the packages of the tests and builds the tests, with warnings as errors.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(cmake g++ libboost-dev libboost-program-options-dev libeigen3-dev libfmt-dev libhdf5-openmpi-dev
          libnlopt-cxx-dev libopenmpi-dev libxxhash-dev ninja-build nlohmann-json3-dev openmpi-bin python3-h5py
          python3-matplotlib python3-numpy)
options=(-DTREBSWEEP_TESTS=OFF) # other cached options are kept, which avoids a rebuild
[[ -e build/release/CMakeCache.txt ]] || options+=(-DTREBSWEEP_INSTRUCTION_SETS=native)
if [[ ${1:-} == --tests ]]; then
  options=(-DTREBSWEEP_TESTS=ON -DTREBSWEEP_WERROR=ON -DTREBSWEEP_INSTRUCTION_SETS=all)
  packages+=(catch2 libgsl-dev libsundials-dev python3-h5netcdf python3-netcdf4 python3-xarray)
fi

install_missing() {
  local missing=() package
  for package in "${packages[@]}"; do
    [[ $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
      missing+=("$package")
  done
  [[ ${#missing[@]} -gt 0 ]] || return 0
  local as_root=()
  if [[ $(id -u) -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
      echo "Packages are missing. Ask an administrator to run:" >&2
      echo "  apt-get install ${missing[*]}" >&2
      exit 1
    fi
    as_root=(sudo)
  fi
  echo "Installing ${missing[*]}" >&2
  export DEBIAN_FRONTEND=noninteractive
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" apt-get install -q -y --no-install-recommends "${missing[@]}"
}

if command -v dpkg-query >/dev/null; then
  install_missing
else
  echo "Not a Debian system; the build needs the equivalents of these packages: ${packages[*]}" >&2
fi
cmake --preset release "${options[@]}"
cmake --build --preset release
