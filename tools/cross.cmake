# Toolchain file of the presets for other architectures: Debian's cross-compiler g++-TRIPLET, the architecture's packages in CMAKE_SYSROOT, and qemu-user,
# which runs programs during the build. RAYA_TRIPLET: GNU's name of the architecture. RAYA_QEMU: qemu's name.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES RAYA_TRIPLET RAYA_QEMU CMAKE_SYSROOT)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${RAYA_QEMU})
set(CMAKE_CXX_COMPILER ${RAYA_TRIPLET}-g++)
string(REPLACE i686 i386 CMAKE_LIBRARY_ARCHITECTURE ${RAYA_TRIPLET})  # the names of the compiler and of Debian's folder differ
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-${RAYA_QEMU} -L ${CMAKE_SYSROOT})
if(RAYA_QEMU STREQUAL i386)
    set(CMAKE_CXX_FLAGS_INIT "-msse2 -mfpmath=sse")  # the x87 computes double-precision numbers with more bits
endif()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
foreach(kind IN ITEMS LIBRARY INCLUDE PACKAGE)
    set(CMAKE_FIND_ROOT_PATH_MODE_${kind} ONLY)
endforeach()
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${CMAKE_SYSROOT})
set(ENV{PKG_CONFIG_LIBDIR} ${CMAKE_SYSROOT}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/pkgconfig:${CMAKE_SYSROOT}/usr/share/pkgconfig)
