#!/usr/bin/env bash
# `make report`: makes every run that the report needs, keeps what each prints, and writes the
# pages from it.
#
#   tools/report/run.sh [--quick] [--work FOLDER] [--pages FOLDER] [--lariat COMMAND]
#
#   --quick    does it work? few samples, no other compilers; its figures are worth nothing
#   --work     what runs print, one file each, and the other builds (out/report)
#   --pages    where the pages go (docs/report)
#   --lariat   the command (build/lariat)
#
# About ten minutes. For quiet figures run nothing else on the machine.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
source=$(cd "$here/../.." && pwd)
quick=no work=$source/out/report pages=$source/docs/report lariat=$source/build/lariat
while [ $# -gt 0 ]; do
    case $1 in
    --quick) quick=yes ;;
    --work) work=$2 && shift ;;
    --pages) pages=$2 && shift ;;
    --lariat) lariat=$2 && shift ;;
    *)
        echo "report: unknown option '$1'; see the head of $0" >&2
        exit 2
        ;;
    esac
    shift
done
for tool in gnuplot python3; do
    command -v $tool >/dev/null || {
        echo "report: $tool is missing; run tools/setup.sh report" >&2
        exit 1
    }
done
[ -x "$lariat" ] || {
    echo "report: there is no $lariat; run make first" >&2
    exit 1
}
lariat=$(realpath "$lariat")
mkdir -p "$work" "$pages"
work=$(cd "$work" && pwd) pages=$(cd "$pages" && pwd)
data=$work/data
rm -rf "$data"
mkdir -p "$data"

# What --quick makes shorter.
kernel="--repeat 15" step="--repeat 15" comm="" scaling="" many=31 generations=800
jitter="--seconds 10 --repeat 3" precision="--steps 20000" pulled=0.1 critical=64000
sizes="100,1000,10000" sweep="--elements 1000000 --repeat 5"
if [ $quick = yes ]; then
    kernel="--elements 200 --repeat 2" step="--steps 20 --repeat 2" comm=--quick scaling=--quick
    many=2 generations=20 jitter="--seconds 0.2 --repeat 2" precision="--steps 200" pulled=0.002
    critical=27 sizes="10,100" sweep="--elements 600 --repeat 2"
fi

# record NAME PROGRAM ARGUMENTS...: keeps what the program prints as NAME.json, and as
# NAME.command how a reader gets the same.
record() {
    local name=$1 program=$2 words=()
    shift 2
    for word in "$@"; do words+=("${word#"$work"/}"); done
    printf 'report: %s: lariat %s\n' "$name" "${words[*]}" >&2
    printf 'lariat %s\n' "${words[*]}" >"$data/$name.command"
    "$program" "$@" </dev/null >"$data/$name.json" || {
        rm -f "$data/$name.json"
        echo "report: the run $name failed; its messages are above" >&2
        return 1
    }
}

# ---- the model ------------------------------------------------------------------------------

"$lariat" demo-model "$work/demo" >/dev/null
organ=$work/demo/uterus.yaml
"$lariat" partition "$organ" --grid 2x2x3 --method genetic --generations $generations \
    --out "$work/uterus.dist" >/dev/null

# ---- chapter 4: requirements ----------------------------------------------------------------

record requirements "$lariat" requirements "$organ" --grid 2x2x3 --thesis --json
record searched "$lariat" requirements "$organ" --distribution "$work/uterus.dist" --no-speed --json

# ---- chapter 6: compilers and instruction sets ----------------------------------------------

# other_build NAME COMPILER FLAGS: the command alone.
other_build() {
    cmake -S "$source" -B "$work/build-$1" -G Ninja --log-level=ERROR -DCMAKE_C_COMPILER="$2" \
        -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE="$3" >/dev/null &&
        cmake --build "$work/build-$1" --target lariat >/dev/null
}
isas=
for isa in c neon avx2 avx512; do
    "$lariat" bench kernel --elements 8 --repeat 1 --isa $isa >/dev/null 2>&1 && isas="$isas $isa"
done
# compiled NAME PROGRAM: its kernels, and whether they come to the same state.
compiled() {
    local isa
    for isa in $isas; do
        # shellcheck disable=SC2086
        record "kernel.$1.$isa" "$2" bench kernel --isa $isa $kernel --json
        record "same.$1.$isa" "$2" bench step "$organ" --isa $isa --steps 200 --repeat 1 --json
    done
    record "slow.$1" "$2" requirements "$organ" --json
}
compiled default "$lariat"
if [ $quick = no ]; then
    for build in "gcc-O3 gcc -O3" "gcc-O1 gcc -O1" "clang-O3 clang -O3" "clang-O1 clang -O1"; do
        read -r name compiler flags <<<"$build"
        if command -v "$compiler" >/dev/null && other_build "$name" "$compiler" "$flags -DNDEBUG"; then
            compiled "$name" "$work/build-$name/lariat"
        else
            echo "report: no build with $compiler $flags; table 6.1 lacks it" >&2
        fi
    done
fi
# shellcheck disable=SC2086
record box "$lariat" bench kernel --shape box $kernel --json
# shellcheck disable=SC2086
record sweep "$lariat" bench kernel --sweep $sweep --svg "$work/roofline.svg" --json
# shellcheck disable=SC2086
record step "$lariat" bench step "$organ" $step --json
# shellcheck disable=SC2086
record touched "$lariat" bench step "$work/demo/uterus_live.yaml" $step --json

# ---- chapter 7: messages --------------------------------------------------------------------

# under_mpi NAME ARGUMENTS...: the same with two processes of MPI, where there is one.
under_mpi() {
    local name=$1 mpirun
    shift
    mpirun=$(command -v mpirun.mpich || command -v mpirun) || return 0
    printf '#!/bin/sh\nexec %s -n 2 %s "$@"\n' "$mpirun" "$lariat" >"$work/two_processes"
    chmod +x "$work/two_processes"
    record "$name" "$work/two_processes" "$@" && sed -i 's/^/mpirun -n 2 /' "$data/$name.command" ||
        echo "report: MPI is left out" >&2
}
# shellcheck disable=SC2086
record comm "$lariat" bench comm $comm --json
# shellcheck disable=SC2086
under_mpi comm_mpi bench comm --backend mpi $comm --json

# ---- chapter 5.1.7: the network of other machines -------------------------------------------

# predict NAME MACHINE GRID THREADS
predict() {
    record "$1" "$lariat" predict "$organ" --machine "$2" --grid "$3" --threads "$4" --json
}
predict network.12x2_fast thesis 2x2x3 2
predict network.24x1_fast thesis 2x3x4 1
predict network.24x2_moderate thesis-moderate 2x3x4 2
predict network.48x1_moderate thesis-moderate 3x4x4 1
predict network.48x2_slow thesis-slow 3x4x4 2

# ---- chapter 8: several processors ----------------------------------------------------------

# shellcheck disable=SC2086
record scaling.organ "$lariat" bench scaling "$organ" --comm threads,shm,tcp,ucx \
    --repeat $many $scaling --json
# shellcheck disable=SC2086
under_mpi scaling.organ_mpi bench scaling "$organ" --repeat $many $scaling --json
elements=20000
[ $quick = no ] || elements=400
# shellcheck disable=SC2086
record scaling.large "$lariat" bench scaling --elements $elements --comm threads,shm,tcp,ucx \
    --repeat $many $scaling --json
record check "$lariat" predict "$organ" --grid 2x1x1 --measure --check --repeat $many --json
for grid in 1x1x1 2x1x1 2x2x1 2x2x2 2x2x3 2x2x4 2x3x4 3x4x4; do
    predict "speed.thesis.$grid" thesis $grid 1
    predict "speed.thesis2.$grid" thesis $grid 2
    predict "speed.infiniband.$grid" infiniband $grid 1
    predict "speed.ethernet.$grid" ethernet $grid 1
done
for machine in "thesis 150" "infiniband 1000" "infiniband 20000" "roce 20000" "ethernet 20000"; do
    read -r name elements <<<"$machine"
    [ $quick = no ] || elements=27
    record "size.$name.$elements" "$lariat" predict --scale-to "$sizes" --machine "$name" \
        --elements-per-processor "$elements" --json
done
record critical "$lariat" predict --critical --elements-per-processor $critical --json

# ---- what the thesis asked, and did not measure ---------------------------------------------

# shellcheck disable=SC2086
record jitter "$lariat" bench jitter $jitter --json
# shellcheck disable=SC2086
record jitter_loaded "$lariat" bench jitter --load 210 $jitter --json
# shellcheck disable=SC2086
record precision "$lariat" bench precision $precision --json
record implicit.slow "$lariat" bench implicit --json
record implicit.buckle "$lariat" bench implicit --case buckle --static --step 0.02 --json
record implicit.loose "$lariat" bench implicit --case loose --static --json
record implicit.organ "$lariat" bench implicit "$organ" --time $pulled --step 0.005 --json

python3 -B "$here/report.py" --data "$data" --pages "$pages" --quick $quick
echo "report: $pages/README.md" >&2
