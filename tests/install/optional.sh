#!/bin/sh
# Optional libraries: what is half installed counts as not there, is said in one line, and what is
# built without it compiles.
#
#   optional.sh SOURCE SCRATCH
#
# Half installed is made up: compiler wrappers without mpi.h, pkg-config files without headers,
# libraries without headers and headers without libraries.
set -eu
source=$1 scratch=$2
cmake=${CMAKE:-cmake}
rm -rf "$scratch"
mkdir -p "$scratch/bin" "$scratch/pc" "$scratch/include"
command -v ninja >/dev/null || { echo "skipped: ninja is missing"; exit 77; }

failures=0
fail() {
    echo "optional: $*" >&2
    failures=$((failures + 1))
}

# Wrappers that answer and have no mpi.h, as Debian's openmpi-bin and mpich have without the -dev.
cat >"$scratch/bin/mpicc.openmpi" <<'END'
#!/bin/sh
case $1 in
--showme:incdirs) echo /nowhere/include ;;
--showme) echo gcc -I/nowhere/include -L/nowhere/lib -lmpi-of-nowhere ;;
*) exit 1 ;;
esac
END
cat >"$scratch/bin/mpicc.mpich" <<'END'
#!/bin/sh
[ "$1" = -link_info ] && echo gcc -I/nowhere/include -L/nowhere/lib -lmpich-of-nowhere
END
printf '#!/bin/sh\nexit 1\n' >"$scratch/bin/mpicc" # this machine's own may be whole
chmod +x "$scratch"/bin/*

# What is needed is there; of what is optional only the pkg-config file.
for module in yaml-0.1 cmocka; do
    from=$(pkg-config --variable=pcfiledir "$module") || { echo "skipped: no $module"; exit 77; }
    cp "$from/$module.pc" "$scratch/pc/"
done
half() {
    printf 'Name: %s\nDescription: half of it\nVersion: %s\nCflags: -I/nowhere\nLibs: -l%s-of-nowhere\n' \
        "$1" "$2" "$1" >"$scratch/pc/$1.pc"
}
half hwloc 2.9.0
half ucx 1.13.1
half sdl2 2.26.5
half libwebsockets 4.1.6
half PETSc 3.18.5
half cminpack 1.3.6
half libpng 1.6.39
echo '#include <this_header_is_not_there.h>' >"$scratch/include/metis.h"
echo '#include <this_header_is_not_there.h>' >"$scratch/include/Python.h"

# configure FOLDER OPTION...
configure() {
    folder=$scratch/$1
    shift
    env PATH="$scratch/bin:$PATH" PKG_CONFIG_PATH= PKG_CONFIG_LIBDIR="$scratch/pc" \
        "$cmake" -S "$source" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Debug \
        -DCMAKE_C_COMPILER="${CC:-cc}" -DCMAKE_C_FLAGS_DEBUG=-O0 "$@" >"$folder.log" 2>&1 || {
        fail "cmake failed:"
        cat "$folder.log" >&2
        exit 1
    }
}

# The sources that look at what there is.
compile() {
    ninja -C "$scratch/$1" src/CMakeFiles/lariat_core.dir/base/pin.c.o \
        src/CMakeFiles/lariat_core.dir/comm/mpi.c.o src/CMakeFiles/lariat_core.dir/comm/ucx.c.o \
        src/CMakeFiles/lariat_core.dir/comm/ucx_open.c.o \
        src/CMakeFiles/lariat_core.dir/divide/distribution_metis.c.o \
        src/CMakeFiles/lariat_core.dir/meshing/image/nifti.c.o \
        src/CMakeFiles/lariat_core.dir/session/device/gamepad.c.o \
        src/CMakeFiles/lariat_study.dir/study/frames/image_png.c.o \
        src/CMakeFiles/lariat_core.dir/server/absent.c.o >"$scratch/$1.build" 2>&1 || {
        fail "$1: what is built without the optional libraries does not compile:"
        cat "$scratch/$1.build" >&2
    }
}

# Each is named in one line that says what is lost and how to get it.
says_once() {
    [ "$(grep -c -e "$2" "$scratch/$1.log")" -eq 1 ] || fail "$1: not one line like '$2'"
}
no_target() {
    ! grep -q "$2" "$scratch/$1/build.ninja" || fail "$1: $2 is built"
}

configure half -DPYTHON_INCLUDE_FIRST="$scratch/include" -DMETIS_INCLUDE="$scratch/include" -DNIFTI_INCLUDE=/nowhere
compile half
for name in 'Open MPI' MPICH cminpack libpng hwloc METIS libnifti UCX SDL2 libwebsockets PETSc 'Python headers'; do
    says_once half "^$name is only half installed and not used: .*(apt-get install [a-z0-9-]*)$"
done
for target in liblariat-mpi-openmpi liblariat-mpi-mpich liblariat-petsc _lariat.abi3.so of-nowhere; do
    no_target half $target
done

# The same by wish; nothing is looked for then.
configure without '-DLARIAT_WITHOUT=cminpack;png;hwloc;metis;nifti;ucx;sdl2;libwebsockets;petsc;mpi;python'
compile without
for name in cminpack libpng hwloc METIS libnifti UCX SDL2 libwebsockets PETSc MPI 'Python headers'; do
    says_once without "^-- $name left out"
done
for target in liblariat-mpi liblariat-petsc _lariat.abi3.so of-nowhere nifti2; do
    no_target without $target
done

# No headers of Python anywhere: the module is not built, and all else is.
printf '#!/bin/sh\nexit 1\n' >"$scratch/bin/python3"
chmod +x "$scratch/bin/python3"
configure headless -DPYTHON_INCLUDE_ROOT="$scratch/nowhere"
rm "$scratch/bin/python3"
says_once headless "^-- Python headers not found: .*(apt-get install python3-dev)$"
no_target headless _lariat.abi3.so

# A name that is none is a slip.
if "$cmake" -S "$source" -B "$scratch/slip" -G Ninja -DLARIAT_WITHOUT=metiss >"$scratch/slip.log" 2>&1
then
    fail "LARIAT_WITHOUT=metiss was accepted"
fi
grep -q 'metiss' "$scratch/slip.log" || fail "the message does not name metiss"

[ $failures -eq 0 ] || exit 1
rm -rf "$scratch"
echo "optional: half installed is not there, and what is built without it compiles"
