#!/bin/sh
# lariat partition: figures, files that are read back, and what it refuses.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
expect 0 "$LARIAT" demo-model demo

expect 0 "$LARIAT" partition demo/uterus.yaml --grid 2x2x3 --method cut --json \
    --out cut.dist --vtu cut.vtu
has_keys method balanced --numbers processors diameter elements nodes elements_min elements_max n_pav \
    cost_before cost_after cost_reduction costs.cut.worst costs.cut.total shared_nodes
[ "$(value_of elements_min)$(value_of elements_max)" = 153154 ] || fail "not 153 to 154 elements"
[ "$(value_of cost_before)" = 950 ] || fail "the plain cut costs $(value_of cost_before), not 950"
grep -q 'Name="processor"' cut.vtu || fail "no cell field processor"
expect 0 "$LARIAT" info cut.vtu
[ ! -e cut.dist.part ] || fail "a half file is left"

# A search of so many generations is the same every time, on every machine; the file gives it back.
expect 0 "$LARIAT" partition demo/uterus.yaml --grid 2x2x3 --method genetic --generations 30 \
    --out first.dist --json
[ "$(value_of cost_after)" -lt 950 ] || fail "the search found nothing"
found=$(value_of cost_after)
expect 0 "$LARIAT" partition demo/uterus.yaml --grid 2x2x3 --method genetic --generations 30 \
    --out second.dist
cmp -s first.dist second.dist || fail "two searches with one seed differ"
expect 0 "$LARIAT" partition demo/uterus.yaml --distribution first.dist --json --out third.dist
[ "$(value_of cost_after)$(value_of method)" = "$found\"file\"" ] || fail "read back otherwise"
cmp -s first.dist third.dist || fail "reading and writing changed the file"

expect 0 "$LARIAT" partition demo/uterus.yaml --grid 3x3x3 --method random
says 'bytes per packet'
expect 0 "$LARIAT" partition demo/uterus.vtu --grid 2x1x1 --seconds 0.2
says 'before (plain cut)'
expect 0 "$LARIAT" partition demo/uterus.yaml --grid 1x1x1 --method best

# METIS, or how to get it.
"$LARIAT" partition demo/uterus.yaml --grid 2x2x3 --method metis >out 2>err ||
    grep -q libmetis-dev err || fail "no METIS, and no word about it"

expect 2 "$LARIAT" partition demo/uterus.yaml
complains 'grid is missing'
expect 2 "$LARIAT" partition demo/uterus.yaml --distribution first.dist --method cut
expect 2 "$LARIAT" partition demo/uterus.yaml --grid 2x2
complains "'2x2' is no grid"
silent
expect 2 "$LARIAT" partition demo/uterus.yaml --grid 2x2x2 --distribution first.dist
complains 'is for the grid 2x2x3'
expect 1 "$LARIAT" partition demo/uterus.yaml --distribution demo/uterus.yaml
complains 'this is no distribution file'
expect 1 "$LARIAT" partition demo/uterus.yaml --grid 2x2x3 --method cut --out none/x.dist
complains 'none/x.dist'
head -n 100 first.dist >short.dist
expect 1 "$LARIAT" partition demo/uterus.yaml --distribution short.dist
complains 'short.dist:'
finish "partition: figures, files, refusals"
