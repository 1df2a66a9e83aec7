#!/usr/bin/env bash
# Pushes instruments into real organs and prints a table of what came of it (push.c says what the
# columns are), with a line that sums it up.
#
#     tools/instruments/matrix.sh DATA [--quick] [OPTION...] [-- OPTIONS OF push...]
#
#     --quick          24 cases that stand for the others, a minute or two on one core
#     --bodies LIST    of all that are named below; without it all
#     --elements LIST  default "1000 5000"; the demonstration organ is as it is
#     --tools LIST     default sphere3,sphere5,sphere10,shaft,shaft-lying,grasper
#     --speeds LIST    default 0.02,0.1,0.5
#     --sides LIST     default +x,-y,+z
#     --build FOLDER   default build
#     --work FOLDER    default /tmp/instruments: meshes are kept there, and made when missing
#     --jobs N         so many processes at once; default 1
#
# DATA holds labels/totalseg_abdomen_pelvis_3mm.nii.gz with labels/totalseg_total_labels.csv
# (TotalSegmentator's test files) and the closed surfaces named below; what is not there is left
# out. All of it takes hours: choose. Exit status 1: a case could not be run.
set -euo pipefail
usage() {
    sed -n '2,20s/^# \{0,1\}//p' "$0" >&2
    exit 2
}
[ $# -ge 1 ] || usage
[ -d "$1" ] || usage
DATA=$1
shift
quick=0 build=build work=/tmp/instruments jobs=1 elements="1000 5000" bodies=
tools=sphere3,sphere5,sphere10,shaft,shaft-lying,grasper speeds=0.02,0.1,0.5 sides=+x,-y,+z
while [ $# -gt 0 ]; do
    case $1 in
    --quick) quick=1 ;;
    --) shift && break ;;
    --bodies | --elements | --tools | --speeds | --sides | --build | --work | --jobs)
        [ $# -ge 2 ] || usage
        printf -v "${1#--}" %s "${2}"
        shift
        ;;
    *) usage ;;
    esac
    shift
done
extra=("$@")
IMAGE=$DATA/labels/totalseg_abdomen_pelvis_3mm.nii.gz
NAMES=$DATA/labels/totalseg_total_labels.csv
PUSH=$build/tools/instruments/push
LARIAT=$build/lariat
for program in "$LARIAT" "$PUSH"; do
    [ -x "$program" ] || {
        echo "$program is not there: cmake --build --preset release --target lariat instruments" >&2
        exit 2
    }
done
mkdir -p "$work"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

surfaces="liver_surface spleen_surface uterus_wall coarse_liver"
labels="liver spleen kidney_left gallbladder urinary_bladder stomach pancreas duodenum
    iliac_artery_left portal_vein_and_splenic_vein gluteus_medius_left prostate"
[ -n "$bodies" ] || bodies="$surfaces $labels demo"

# What `lariat mesh` is to read for a body.
input_of() {
    case $1 in
    liver_surface) input=("$DATA/surfaces/liver_female.stl") ;;
    spleen_surface) input=("$DATA/surfaces/spleen_female.obj") ;;
    uterus_wall) input=("$DATA/surfaces/uterus_posterior_wall.obj") ;;
    coarse_liver) input=("$DATA/surfaces/coarse_liver.obj" --scale 0.05) ;;
    *) input=("$IMAGE" --names "$NAMES" --label "$1") ;;
    esac
}

# Sets `scene` to that of a body with so many elements, and makes it when it is missing.
scene_of() {
    local folder=$work/$1_$2
    if [ "$1" = demo ]; then
        scene=$work/demo/uterus_live.yaml
        [ -e "$scene" ] || "$LARIAT" demo-model "$work/demo" >/dev/null
        return
    fi
    scene=$folder/$1.yaml
    [ ! -e "$scene" ] || return 0
    input_of "$1"
    [ -e "${input[0]}" ] || return 1
    "$LARIAT" mesh "${input[@]}" --elements "$2" --title "$1" --out "$folder.new" >/dev/null
    mv "$folder.new" "$folder"
}

# add BODY ELEMENTS OPTIONS...: one line of work.
add() {
    local body=$1 count=$2
    shift 2
    scene_of "$body" "$count" || return 0
    [ "$body" != demo ] || set -- "$@" --contact
    printf '%q ' "$PUSH" "$scene" --name "$body" --rows "$@" ${extra[@]+"${extra[@]}"} \
        >>"$scratch/work"
    echo >>"$scratch/work"
}

if [ $quick = 1 ]; then
    add liver_surface 5000 --tool sphere5,sphere10,grasper --speed 0.1 --from +z
    add liver_surface 5000 --tool sphere5 --speed 0.5 --from +y --through
    add liver_surface 5000 --tool sphere5 --speed 0.02 --from -x
    add liver_surface 1000 --tool sphere5,shaft --speed 0.1 --from +z
    add liver 1000 --tool shaft-lying --speed 0.5 --from +y
    add liver 5000 --tool sphere10 --speed 0.1 --from +y --coupled
    add spleen_surface 1000 --tool sphere3,shaft --speed 0.5 --from +x
    add kidney_left 1000 --tool sphere10 --speed 0.1 --from +z
    add kidney_left 1000 --tool grasper --speed 0.1 --from +y --grasp
    add gallbladder 1000 --tool sphere5 --speed 0.1 --from +y
    add stomach 1000 --tool shaft,sphere10 --speed 0.1 --from +y
    add pancreas 1000 --tool sphere5 --speed 0.5 --from +x --slant 45
    add urinary_bladder 1000 --tool sphere10,shaft --speed 0.5 --from +z
    add urinary_bladder 5000 --tool sphere3 --speed 0.5 --from +y
    add uterus_wall 1000 --tool sphere5 --speed 0.1 --from +z
    add demo 0 --tool sphere5,grasper --speed 0.1 --from +z
    add demo 0 --tool sphere10 --speed 0.5 --from -y --through
else
    for body in $bodies; do
        for count in $elements; do
            add "$body" "$count" --tool "$tools" --speed "$speeds" --from "$sides"
            [ "$body" != demo ] || break
        done
    done
fi
[ -e "$scratch/work" ] || {
    echo "there is nothing to push in $DATA" >&2
    exit 1
}

"$PUSH" --head
status=0
tr '\n' '\0' <"$scratch/work" | xargs -0 -P "$jobs" -I{} bash -c {} | tee "$scratch/rows" ||
    status=1
awk -F ' *[|] *' '
    { cases++; inside += $8 > 0; stops += $18 !~ /^no/; inverted += $13 > 0; negative += $15 > 0
      left += $16 != "-" && $16 > 1; if ($9 > peak) peak = $9 }
    END { printf "%d cases: tool inside in %d, stopped %d, inverted elements in %d, " \
                 "negative corners in %d, not back within 1 %% in %d; largest force %.3g N\n",
                 cases, inside, stops, inverted, negative, left, peak }' "$scratch/rows"
exit $status
