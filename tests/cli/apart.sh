#!/bin/sh
# Two lungs and what is around them, meshed apart and pulled at: points of edges that came past faces
# they do not see were pushed by the next ones with all that a spring stores, from nowhere.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
data=$SOURCE/../shared/data/labels
if [ ! -d "$data" ]; then
    finish "skipped: ../shared/data is not there"
    exit 0
fi
expect 0 "$LARIAT" mesh "$data/slicerio_chest.seg.nrrd" --apart --label "right lung" \
    --label "left lung" --label tissue --elements 3000 --title chest --out chest
expect 0 "$LARIAT" run chest/chest.yaml --time 1.2
says '^contact  *[1-9][0-9]* nodes touch'
finish "a chest of three bodies"
