# A Debian package and a source tarball, by CPack:
#
#   jobs/build.sh --package                                                  -> build/package/trebsweep_1.0.0_amd64.deb
#   cpack --config build/package/CPackSourceConfig.cmake -B build/package    -> build/package/trebsweep-1.0.0.tar.gz
set(CPACK_PACKAGE_VENDOR "the trebsweep authors")
set(CPACK_PACKAGE_CONTACT "The trebsweep authors <authors@trebsweep.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "explorer of the design space of a trebuchet")
set(CPACK_PACKAGE_DESCRIPTION
"Integrates the swing of every design of a trebuchet on a lattice of lengths, in
parallel with MPI and SIMD, stores maps of the results in one HDF5 file, and
searches for the best design that can be built.")
set(CPACK_STRIP_FILES ON)

set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "openmpi-bin, python3, python3-h5py, python3-matplotlib, python3-numpy, python3-pandas, python3-xarray")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-ezdxf")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-dask")
set(documents ${CMAKE_INSTALL_DATADIR}/doc/trebsweep)
install(FILES README.md DESTINATION ${documents})
install(FILES LICENSE DESTINATION ${documents} RENAME copyright)
execute_process(COMMAND gzip -9nc ${CMAKE_CURRENT_SOURCE_DIR}/CHANGELOG.md
                OUTPUT_FILE ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz COMMAND_ERROR_IS_FATAL ANY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz DESTINATION ${documents})

# Of jobs/build.sh --package: whoever only uses the page needs no compiler.
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/explorer.html DESTINATION ${CMAKE_INSTALL_DATADIR}/trebsweep OPTIONAL)

set(CPACK_SOURCE_GENERATOR TGZ)
set(CPACK_SOURCE_PACKAGE_FILE_NAME trebsweep-${PROJECT_VERSION})
string(REGEX REPLACE "([][+.*()^$?|])" "\\\\\\1" top "${PROJECT_SOURCE_DIR}")
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_SOURCE_IGNORE_FILES "^${top}/build/" "^${top}/results/" "^${top}/[.]git/" "/__pycache__/" "[.]h5$" "[.]h5[.]partial/")
include(CPack)
