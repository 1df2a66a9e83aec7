#!/bin/sh
# The promise in full: the same state hash after 1,000 steps for every combination of grid, threads,
# scheme, backend and distribution, with random delays.
#
#   matrix.sh LARIAT JSON SCRATCH SOURCE [EVERY]
#
# With EVERY only each EVERY-th combination; a number without a factor in common with 2, 3 and 5
# takes them from all over. Backends that this build or machine lacks are named and left out.
. "$(dirname "$0")/lib.sh"
every=${5:-1}
steps=1000
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo
scene=demo/uterus.yaml
expect 0 "$LARIAT" run $scene --steps $steps --json
hash=$(value_of state_hash)

export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export ASAN_OPTIONS=detect_leaks=0

# The command that runs so many processors with a backend: lariat itself, or mpirun with it.
launcher() {
    case $1 in
    mpi.*) echo "mpirun.${1#mpi.} -n $2" ;;
    esac
}

backends=threads
for backend in shm tcp ucx mpi.openmpi mpi.mpich; do
    # shellcheck disable=SC2046
    if timeout 60 $(launcher $backend 2) "$LARIAT" run $scene --steps 1 --grid 2x1x1 \
        --comm ${backend%.*} >out 2>err; then
        backends="$backends $backend"
    else
        echo "left out: $backend: $(tail -n 1 err)"
    fi
done

# A distribution is made once, not by every process.
distribution() {
    [ -f "$1.$2" ] || "$LARIAT" partition $scene --grid "$1" --method "$2" --generations 60 \
        --out "$1.$2" >out 2>err || return 1
    echo "$1.$2"
}

number=0 tried=0
for backend in $backends; do
    for grid in 1x1x1 2x1x1 2x2x1 2x2x3 3x3x3; do
        processors=$(echo $grid | tr x ' ' | { read -r x y z && echo $((x * y * z)); })
        for method in cut genetic metis random; do
            for scheme in all local one two; do
                for threads in 1 2 3; do
                    number=$((number + 1))
                    [ $((number % every)) -eq 0 ] || continue
                    file=$(distribution $grid $method) || continue # built without METIS
                    channels=
                    [ $scheme$((number % 2)) = local1 ] && channels="--channels concurrent"
                    tried=$((tried + 1))
                    # shellcheck disable=SC2046
                    expect 0 timeout 120 $(launcher $backend "$processors") "$LARIAT" run $scene \
                        --steps $steps --json --comm ${backend%.*} --distribution "$file" \
                        --scheme $scheme $channels --threads $threads --delays $number
                    [ "$(value_of state_hash)" = "$hash" ] || fail "$(value_of state_hash) instead" \
                        "of $hash: $backend $grid $method $scheme $channels $threads threads"
                done
            done
        done
    done
done
finish "$tried combinations of $number, by $backends: one hash"
