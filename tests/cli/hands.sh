#!/bin/sh
# Random hands that once stopped the simulation: a thin wall between a grasper and a pulling hand.
HANDS=$5
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
wall=$SOURCE/../shared/data/surfaces/uterus_posterior_wall.obj
if [ ! -f "$wall" ]; then
    finish "skipped: ../shared/data is not there"
    exit 0
fi
expect 0 "$LARIAT" mesh "$wall" --elements 1000 --title wall --out wall
expect 0 "$HANDS" wall/wall.yaml --name wall --seed 1000 --sessions 1 --seconds 0.3 --coupled --rows
# | body | elements | seed | stops | resets | grips | inside | inside | inverted
says '^| wall | [0-9]* | 1000 | 0 | 0 | [0-9]* | 0 | 0 | 0 |'
says '| no |$'
finish "random hands"
