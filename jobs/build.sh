#!/usr/bin/env bash
# Installs missing Debian packages and builds build/release/trebsweep.
# --tests: also installs the packages of the tests and builds those of the numerical core and of scripts, with warnings
# as errors.
# --package: builds a Debian package with kernels for all instruction sets and the explorer, build/package/*.deb.
set -euo pipefail
cd "$(dirname "$0")/.."

packages=(cmake g++ libboost-dev libboost-program-options-dev libeigen3-dev libfmt-dev libhdf5-openmpi-dev
          libopenmpi-dev libxxhash-dev ninja-build nlohmann-json3-dev openmpi-bin python3-h5py
          python3-matplotlib python3-numpy python3-pandas python3-xarray)
options=(-DTREBSWEEP_TESTS=OFF) # other cached options are kept, which avoids a rebuild
if [[ ${1:-} == --tests ]]; then
  options=(-DTREBSWEEP_TESTS=numerics -DTREBSWEEP_WERROR=ON -DTREBSWEEP_INSTRUCTION_SETS=supported)
  packages+=(catch2 libgsl-dev libnlopt-dev libsundials-dev libudunits2-dev mypy python3-dask python3-ezdxf
             python3-h5netcdf python3-ipykernel python3-nbclient python3-netcdf4 python3-pip python3-setuptools
             python3-venv)
fi

if [[ ${1:-} == --package ]]; then
  jobs/install.sh "${packages[@]}" dpkg-dev file
  analysis/explorer/build.sh -o build/package/explorer.html --overwrite
  cmake --preset package
  cmake --build --preset package
  exec cpack --preset package
fi
jobs/install.sh "${packages[@]}"
cmake --preset release "${options[@]}"
cmake --build --preset release
