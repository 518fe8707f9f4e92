"""A recipe for Spack 1.0 or later. Copy it to packages/trebsweep/ of a repository of recipes. Spack looks for the source
tarball (see cpack.cmake) in the directory in which `spack install --no-checksum trebsweep` runs, or builds a source
tree: spack dev-build trebsweep@1.0.0."""

import os

from spack_repo.builtin.build_systems.cmake import CMakePackage, generator
from spack.package import depends_on, variant, version


class Trebsweep(CMakePackage):
    """Explorer of the design space of a trebuchet: parallel sweeps over its lengths into one HDF5 file, and a search
    for the best design that can be built."""

    manual_download = True
    url = f"file://{os.getcwd()}/trebsweep-1.0.0.tar.gz"

    version("1.0.0")

    generator("ninja")
    variant("native", default=True, description="Build only the kernel for the best instruction set of this machine")

    depends_on("cmake@3.25:", type="build")
    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("boost@1.74: +program_options")
    depends_on("eigen@3.3:3")
    depends_on("fmt")
    depends_on("hdf5 +mpi +hl")
    depends_on("mpi")
    depends_on("nlohmann-json@3.9:")
    depends_on("xxhash")
    depends_on("py-h5py", type="run")
    depends_on("py-matplotlib", type="run")
    depends_on("py-numpy", type="run")
    depends_on("py-pandas", type="run")
    depends_on("py-xarray", type="run")

    def cmake_args(self):
        return [self.define("TREBSWEEP_INSTRUCTION_SETS", "native" if "+native" in self.spec else "all")]
