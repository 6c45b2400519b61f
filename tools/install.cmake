# Defines the installation (`cmake --install build --prefix DIR`) and the Debian package (tools/package). The program finds all files relative to
# itself, so the installed folder can be moved.
include(GNUInstallDirs)
set(doc ${CMAKE_INSTALL_DATADIR}/doc/raya)

install(TARGETS raya RUNTIME)
# lib/raya, without a multiarch folder: the folder in which host/base/module.cpp searches for modules and raya_import.
if(TARGET raya_mpi)
    list(APPEND modules raya_mpi)
endif()
install(TARGETS ${modules} LIBRARY DESTINATION lib/raya RUNTIME DESTINATION lib/raya)

# The Python module with the laboratory, for Debian's Python. `pip install .` puts module, laboratory and program into one package of a wheel.
if(TARGET raya_python)
    set(package lib/python3/dist-packages/raya)
    if(SKBUILD)
        set(package raya)
        install(TARGETS raya RUNTIME DESTINATION ${package} COMPONENT wheel)
        if(RAYA_LIGHT)  # a wheel for other machines, which may have no loader of OpenCL: tools/package --wheel
            set_target_properties(raya raya_python PROPERTIES INSTALL_RPATH "$ORIGIN/lib")
            file(REAL_PATH ${OpenCL_LIBRARIES} loader)
            install(FILES ${loader} DESTINATION ${package}/lib RENAME libOpenCL.so.1 COMPONENT wheel)
            foreach(library IN ITEMS libstdc++6 libfmt-dev libxxhash-dev zlib1g-dev ocl-icd-libopencl1 libcli11-dev nlohmann-json3-dev pybind11-dev)
                install(FILES /usr/share/doc/${library}/copyright DESTINATION ${package}/licences RENAME ${library} COMPONENT wheel OPTIONAL)
            endforeach()
        endif()
    endif()
    install(TARGETS raya_python ${modules} LIBRARY DESTINATION ${package} COMPONENT wheel RUNTIME DESTINATION ${package} COMPONENT wheel)
    install(DIRECTORY host/python/raya/ DESTINATION ${package} COMPONENT wheel PATTERN __pycache__ EXCLUDE)
    install(DIRECTORY tools/lab DESTINATION ${package} COMPONENT wheel PATTERN __pycache__ EXCLUDE)
    install(FILES host/report/page/style.css DESTINATION ${package}/lab/templates COMPONENT wheel)
endif()

# Manual pages from the help of the installed program; help2man is sought when raya is installed, because it may come later than the build.
install(CODE "find_program(HELP2MAN help2man)
    if(HELP2MAN)
        execute_process(COMMAND_ERROR_IS_FATAL ANY COMMAND ${PROJECT_SOURCE_DIR}/tools/manual_pages
            \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/raya \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1)
    endif()")
install(FILES tools/raya.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME raya)

install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/raya/scenes FILES_MATCHING PATTERN "*.nff" PATTERN "README.md")
# Documents are installed in the folder structure of the sources, so that their links work.
install(FILES README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md LICENSE DESTINATION ${doc})
install(DIRECTORY docs DESTINATION ${doc} FILES_MATCHING REGEX "\\.(md|png|svg|dot|yml|json|ipynb|py|csv|bib|cff|toml|txt)$|raya-health$")
install(DIRECTORY ${PROJECT_BINARY_DIR}/schema DESTINATION ${doc}/docs)
install(CODE "find_program(PYTHON3 python3)
    if(PYTHON3)
        execute_process(COMMAND \${PYTHON3} ${PROJECT_SOURCE_DIR}/tools/report_doc ${PROJECT_BINARY_DIR}/schema COMMAND_ERROR_IS_FATAL ANY
            OUTPUT_FILE \$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${doc}/docs/report.md)
    endif()")
install(FILES scenes/README.md DESTINATION ${doc}/scenes)
install(FILES kernels/README.md DESTINATION ${doc}/kernels)
install(FILES kernels/number/README.md DESTINATION ${doc}/kernels/number)

# The number layer for other projects: headers, an example, and kernel build options by `pkg-config --cflags raya-number`.
set(number ${CMAKE_INSTALL_INCLUDEDIR}/raya)
set(number_from_prefix ${number})
configure_file(tools/raya-number.pc.in raya-number.pc @ONLY)
file(GLOB number_headers CONFIGURE_DEPENDS kernels/number/*.clh)
install(FILES ${number_headers} DESTINATION ${number}/number)
install(FILES kernels/number/example/harmonic.cpp kernels/number/example/harmonic.cl DESTINATION ${doc}/kernels/number/example)
install(FILES ${PROJECT_BINARY_DIR}/raya-number.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig)

# The Debian package. CPack packs the installation of an existing build. debhelper would compile everything again from a source package, and would
# need the version in a second file.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "the raya authors")
set(CPACK_PACKAGE_CONTACT "the raya authors <raya@example.org>")  # a placeholder: tools/debian.cmake uses the packager's address
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "ray tracing on models of distributed-memory array machines")
set(CPACK_PACKAGE_DESCRIPTION
    "raya renders NFF scenes on models of two array machines from the
literature, a ring of DSPs and a torus of transputers, written as OpenCL
kernels. Every device gives the same image, bit for bit. raya measures the
load balance of these machines, and verifies OpenCL devices, drivers and
compilers by single operations, ray hits and whole images.

raya writes PNG, PPM and PFM files, and TIFF, JPEG and OpenEXR files if
OpenImageIO is installed.")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/tools/debian.cmake)
set(CPACK_RAYA_SOURCES ${PROJECT_SOURCE_DIR})
include(CPack)
