#!/bin/sh
# Meshes real organs, runs their starter scenes, and prints a table of what came of it: that of
# docs/meshing.md.
#
#     tools/mesh_matrix.sh DATA [LARIAT [ELEMENTS...]]
#
# DATA holds labels/totalseg_abdomen_pelvis_3mm.nii.gz with labels/totalseg_total_labels.csv
# (TotalSegmentator's test files), other label images and the closed surfaces surfaces/*.{obj,stl}
# named below; what is not there is left out. LARIAT is build/lariat without it, ELEMENTS 1000 5000
# 20000. Takes half an hour, on one core. Exit status 1: something failed, or did not come to rest.
#
# Columns: processor time and memory of `lariat mesh`; mean deviation in edges; least scaled
# Jacobian; error of the volume; pads; damping and duration that the scene chose; how far the pull
# moves the handle, and what is left of that at the end; two seconds of the whole weight with the
# automatic time step, towards the back, the feet and the right side.
set -u
[ $# -ge 1 ] || {
    sed -n '2,16s/^# \{0,1\}//p' "$0" >&2
    exit 2
}
DATA=$1
LARIAT=${2:-build/lariat}
[ $# -le 2 ] || { shift 2 && sizes=$*; }
sizes=${sizes:-1000 5000 20000}
IMAGE=$DATA/labels/totalseg_abdomen_pelvis_3mm.nii.gz
NAMES=$DATA/labels/totalseg_total_labels.csv
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT TERM
failed=0

# The largest distance of the handle [mm], and the last one in per cent of it.
returned() {
    awk -F, 'NR > 1 { d = sqrt($2 * $2 + $3 * $3 + $4 * $4); if (d > most) most = d }
             END { printf "%.1f | %.2f", 1000 * most, (most > 0 ? 100 * d / most : 0) }' "$1"
}

# Two seconds under a weight (a YAML list): "stable", or when it ended.
weigh() {
    sed "s/^gravity: .*/gravity: [$1]/" "$scratch/x/x.yaml" >"$scratch/x/weight.yaml"
    if "$LARIAT" run "$scratch/x/weight.yaml" --time 2 >"$scratch/run" 2>&1; then
        echo stable
    else
        sed -n 's/.*unstable at step [0-9]* (\([0-9.]* s\)).*/\1/p' "$scratch/run" | head -n 1
    fi
}

# A figure of the report that `lariat mesh` printed.
said() {
    sed -n "s/$1/\\1/p" "$scratch/report" | head -n 1
}

# one NAME ELEMENTS INPUT AND OPTIONS...
one() {
    name=$1 elements=$2
    shift 2
    [ -e "$1" ] || return
    rm -rf "$scratch/x"
    if ! /usr/bin/time -f '%U %M' -o "$scratch/time" "$LARIAT" mesh "$@" --elements "$elements" \
        --title x --out "$scratch/x" >"$scratch/report" 2>"$scratch/err"; then
        echo "| $name | $elements | $(tail -n 1 "$scratch/err") |"
        failed=1
        return
    fi
    scene=$scratch/x/x.yaml
    damping=$(sed -n 's/^damping: \([0-9.]*\).*/\1/p' "$scene")
    duration=$(sed -n 's/^duration: \([0-9.]*\).*/\1/p' "$scene")
    "$LARIAT" run "$scene" --out "$scratch/x/r" >"$scratch/run" 2>&1 || failed=1
    pull=$(returned "$scratch/x/r/probes.csv")
    back=$(weigh '0, -9.81, 0')
    feet=$(weigh '0, 0, -9.81')
    side=$(weigh '9.81, 0, 0')
    [ "$back$feet$side" = stablestablestable ] || failed=1
    awk -v left="${pull##* }" 'BEGIN { exit !(left < 1) }' || failed=1
    pads=$(said '.* on \([0-9]*\) extra supports* that .*')
    cost=$(awk '{ printf "%.1f s, %d MB", $1, $2 / 1024 }' "$scratch/time")
    echo "| $name | $elements | $cost |" \
        "$(said '^deviation .*mean [^(]*(\([0-9.]* %\).*') |" \
        "$(said '^scaled Jacobian .*worst \([0-9.]*\).*') |" \
        "$(said '^volume .*holds [^(]*(\([-+0-9.]* %\)).*') |" \
        "${pads:-0} | $damping | $duration | $pull | $back | $feet | $side |"
}

echo "| body | elements | meshed in | deviation | least Jacobian | volume | pads | damping, 1/s | duration, s | pull, mm | left, % | weight to the back | to the feet | to the side |"
echo "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
for n in $sizes; do
    for organ in liver spleen kidney_left gallbladder urinary_bladder stomach pancreas \
        portal_vein_and_splenic_vein iliac_artery_left; do
        one "$organ" "$n" "$IMAGE" --names "$NAMES" --label "$organ"
    done
    one "spleen (surface)" "$n" "$DATA/surfaces/spleen_female.obj"
    one "liver (surface)" "$n" "$DATA/surfaces/liver_female.stl"
    one "uterus, back wall (surface)" "$n" "$DATA/surfaces/uterus_posterior_wall.obj"
    one "liver, coarse (surface)" "$n" "$DATA/surfaces/coarse_liver.obj" --scale 0.05
    one "chest, 7 labels" "$n" "$DATA/labels/slicerio_chest.seg.nrrd"
    one "cortex, 41 labels" "$n" "$DATA/labels/mricron_brodmann.nii.gz"
    one "abdomen, 61 labels" "$n" "$IMAGE" --names "$NAMES"
done
exit $failed
