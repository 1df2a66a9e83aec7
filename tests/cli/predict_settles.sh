#!/bin/sh
# lariat predict simulates until the start is forgotten: as many steps as that takes are found, so
# the answer is that of many steps within half a percent. Cases that eight steps get wrong.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo

# settles KEY ARGUMENTS...: the default beside --steps 200.
settles() {
    key=$1
    shift
    expect 0 "$LARIAT" predict "$@" --json
    found=$(value_of "$key")
    expect 0 "$LARIAT" predict "$@" --steps 200 --json
    long=$(value_of "$key")
    awk "BEGIN { x = $found / $long - 1; exit !(x * x < 0.005 * 0.005) }" ||
        fail "$*: $found us, and $long with --steps 200"
}

settles step_us demo/uterus.yaml --grid 4x6x8 --threads 2
for processors in 100 1000; do
    settles scaling.0.step_us --scale-to $processors --machine roce --elements-per-processor 1000 \
        --scheme local
    settles scaling.0.step_us --scale-to $processors --machine roce --elements-per-processor 1000 \
        --scheme local --channels concurrent
done
settles scaling.0.step_us --scale-to 1000 --machine ethernet --elements-per-processor 20000 \
    --scheme local
settles scaling.0.step_us --scale-to 1000 --machine ethernet --elements-per-processor 20000 \
    --scheme all
finish "predict: the default is that of 200 steps"
