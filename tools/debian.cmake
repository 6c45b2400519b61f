# Adapts the staged installation to Debian's policy and finds the packages that raya depends on. CPack runs this script before it packs the files.
set(staged ${CPACK_TEMPORARY_INSTALL_DIRECTORY})
set(doc ${staged}/usr/share/doc/raya)

if(DEFINED ENV{DEBEMAIL})
    set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
    set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CPACK_PACKAGE_CONTACT})
endif()

function(run)
    execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(GLOB pages ${staged}/usr/share/man/man1/*.1)
run(gzip -9n ${pages})

# Licences of raya, and of the headers whose code is in the program.
file(READ ${CPACK_RAYA_SOURCES}/LICENSE licence)
string(REGEX REPLACE "^MIT License\n\nCopyright \\(c\\) ([^\n]*)\n\n" "" licence "${licence}")
set(copyright "${CMAKE_MATCH_1}")
string(STRIP "${licence}" licence)
string(REPLACE "\n\n" "\n.\n" licence "${licence}")
string(REPLACE "\n" "\n " licence "${licence}")
file(WRITE ${doc}/copyright
     "Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: raya
Comment: The program contains code of headers of other packages; their terms are in /usr/share/doc/raya/licences/.

Files: *
Copyright: ${copyright}
License: Expat

License: Expat
 ${licence}
")
foreach(package IN ITEMS opencl-clhpp-headers libcli11-dev nlohmann-json3-dev)
    file(COPY_FILE /usr/share/doc/${package}/copyright ${doc}/licences-${package})
    file(MAKE_DIRECTORY ${doc}/licences)
    file(RENAME ${doc}/licences-${package} ${doc}/licences/${package})
endforeach()

# Only `raya study` and the Python module need Python.
if(IS_DIRECTORY ${staged}/usr/lib/python3)
    file(WRITE ${staged}/usr/share/lintian/overrides/raya
         "# python3 is suggested, not needed: raya renders without it.\nraya: python-package-missing-depends-on-python\n")
endif()

# Debian's changelog, with the date of the release.
file(STRINGS ${doc}/CHANGELOG.md headings REGEX "^## ${CPACK_PACKAGE_VERSION}, ")
string(REGEX REPLACE "^## [^,]*, ([0-9-]+).*" "\\1" released "${headings}")
execute_process(COMMAND date -u -R -d "${released}" OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND date -u +%s -d "${released}" OUTPUT_VARIABLE seconds OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
file(WRITE ${doc}/changelog
     "raya (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * CHANGELOG.md in this folder lists the changes.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
run(gzip -9n ${doc}/changelog)

# The package depends on the program's libraries. raya needs the libraries for images, meshes and MPI only for these, and
# reports missing ones.
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "python3-numpy, python3-scipy, python3-pandas, python3-matplotlib, python3-jinja2, python3-tqdm, openmpi-bin")
set(modules -dRecommends -e${staged}/usr/lib/raya/raya_pictures.so -e${staged}/usr/lib/raya/raya_import)
if(EXISTS ${staged}/usr/lib/raya/raya_mpi.so)
    list(APPEND modules -dSuggests -e${staged}/usr/lib/raya/raya_mpi.so)
endif()
set(scratch ${CPACK_TOPLEVEL_DIRECTORY}/shlibdeps)
file(WRITE ${scratch}/debian/control "")  # dpkg-shlibdeps requires this file
execute_process(COMMAND dpkg-shlibdeps -O -dDepends -e${staged}/usr/bin/raya ${modules} WORKING_DIRECTORY ${scratch} OUTPUT_VARIABLE dependencies
                COMMAND_ERROR_IS_FATAL ANY)
foreach(field IN ITEMS Depends Recommends Suggests)
    string(TOUPPER ${field} upper)
    if(dependencies MATCHES "shlibs:${field}=([^\n]*)")
        list(PREPEND CPACK_DEBIAN_PACKAGE_${upper} "${CMAKE_MATCH_1}")
        list(JOIN CPACK_DEBIAN_PACKAGE_${upper} ", " CPACK_DEBIAN_PACKAGE_${upper})
    endif()
endforeach()

# All files get the date of the release, so that the same files give the same bytes.
run(find ${staged} -exec touch -h -d @${seconds} {} +)
