#!/bin/sh
# lariat mesh and files that cannot be meshed: one sentence, status 1, nothing written, little memory.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

# A box of labels in a text NRRD: header(field lines) voxels
header='NRRD0004
type: uchar
dimension: 3
space: right-anterior-superior
sizes: 8 8 8
encoding: text
space directions: (2,0,0) (0,2,0) (0,0,2)
space origin: (0,0,0)
'
voxels() { # a box of label 3, a single voxel of label 5
    awk 'BEGIN { for (k = 0; k < 8; k++) for (j = 0; j < 8; j++) for (i = 0; i < 8; i++)
        print (i > 1 && i < 6 && j > 1 && j < 6 && k > 1 && k < 6 ? 3 : i + j + k == 0 ? 5 : 0) }'
}
{ echo "$header"; voxels; } >good.nrrd

# refused WORDS ARGUMENTS...: status 1, the sentence has the words, no file appears.
refused() {
    words=$1
    shift
    expect 1 "$LARIAT" mesh "$@" --out made
    complains "^lariat mesh: .*$words"
    silent
    [ ! -e made ] || fail "something was written: $*"
}

refused 'there is no label "liver"' good.nrrd --label liver
grep -q '3  *64 ' "$SCRATCH/err" || fail "the labels that there are were not listed"
grep -q 'note: .*--names' "$SCRATCH/err" || fail "no word about --names"
refused 'label "4" has no voxel' good.nrrd --label 4
refused '1 voxel only' good.nrrd --label 5
refused 'label 0' good.nrrd --label 0
refused 'smaller size' good.nrrd --label 3 --size 0.02
refused 'larger size' good.nrrd --label 3 --size 0.000001
refused 'more elements' good.nrrd --label 3 --elements 1
refused 'flat cut' good.nrrd --label 3 --fix cut --elements 100
refused 'for surfaces only' good.nrrd --label 3 --scale 0.001
refused 'principal' good.nrrd --label 3 --voxel --principal
refused 'names.csv' good.nrrd --label 3 --names names.csv
refused 'this vector has no direction' good.nrrd --label 3 --elements 20 --fibres 'axis: [0, 0, 0]'
refused 'the set "away" is unknown' good.nrrd --label 3 --elements 20 \
    --fibres 'path: {from: support, to: away}'
refused 'fibres are asked for in "left"' good.nrrd --label 3 --elements 20 --fibres 'axis: [0, 0, 1]' \
    --fibres-in left
printf 'lariat-tissue: 1\nlaw: neo-hookean\ndensity: 1000\nshear_modulus: 700\nbulk_modulus: 7000\n' >soft.yaml
{ cat soft.yaml; printf 'fibres: { law: exp-pow, part: isochoric, ksi: 500, alpha: 1, beta: 2 }\n'; } >fibrous.yaml
printf '{ lariat-tissue: 1, law: neo-hookean, density: 1000, shear_modulus: 700, bulk_modulus: 7000 }\n' >braces.yaml
sed 's/hookean/hokean/' soft.yaml >slip.yaml
refused 'no.yaml: cannot be opened' good.nrrd --label 3 --elements 20 --tissue no.yaml
refused 'a tissue file is given for "liver", but the regions are' good.nrrd --label 3 --elements 20 \
    --tissue liver=soft.yaml
refused 'slip.yaml:2:6: the law "neo-hokean" is unknown' good.nrrd --label 3 --elements 20 --tissue slip.yaml
refused 'braces.yaml: write each key on a line' good.nrrd --label 3 --elements 20 --tissue braces.yaml
refused 'fibrous.yaml: it has fibres; say along what' good.nrrd --label 3 --elements 20 --tissue fibrous.yaml
expect 2 "$LARIAT" mesh good.nrrd --fibres-in left
complains 'add --fibres RULE'
expect 2 "$LARIAT" mesh good.nrrd --size 0.004 --elements 100
complains 'give one'
expect 2 "$LARIAT" mesh good.nrrd --fix sideways
expect 2 "$LARIAT" mesh good.nrrd --size 0
expect 2 "$LARIAT" mesh
complains 'INPUT'
expect 2 "$LARIAT" mesh good.nrrd good.nrrd --list

# Images that are none, or lie.
{ echo "$header"; voxels | sed 's/^3$/2.5/'; } >scan.nrrd
refused 'no label map' scan.nrrd
{ echo "$header"; voxels | sed 's/^3$/-3/'; } >negative.nrrd
refused 'no label map' negative.nrrd
{ echo "$header"; voxels | sed 's/^.$/0/'; } >empty.nrrd
refused 'no voxel has a label' empty.nrrd
{ echo "$header"; voxels | head -n 100; } >short.nrrd
refused 'short.nrrd' short.nrrd
echo "$header" | sed 's/8 8 8/10000 10000 10000/; s/text/raw/' >vast.nrrd
refused 'vast.nrrd' vast.nrrd
echo "$header" | sed 's/8 8 8/8000 8000 8000/; s/text/raw/' >large.nrrd
refused 'large.nrrd: 8000 x 8000 x 8000 voxels are more' large.nrrd
echo "$header" | sed 's/8 8 8/2000000 1 1/; s/text/raw/' >long.nrrd
head -c 2000000 /dev/zero >>long.nrrd
refused 'long.nrrd: .* 2000000 voxels along axis i' long.nrrd
echo "$header" | sed 's/dimension: 3/dimension: 4/; s/8 8 8/8 8 8 5/; s/(0,0,2)$/(0,0,2) none/' >series.nrrd
refused 'series.nrrd' series.nrrd
echo "$header" | sed 's/(0,2,0)/(2,0,0)/' >flat.nrrd
refused 'flat.nrrd' flat.nrrd
echo 'something else' >text.nii.gz
refused 'text.nii' text.nii.gz
: >nothing.nrrd
refused 'nothing.nrrd' nothing.nrrd
refused 'none.nrrd' none.nrrd
refused 'extension' "$SCRATCH"
cp good.nrrd good.png
refused 'extension' good.png
refused 'mesh one image' good.nrrd good.nrrd
# More than the header promises, and a flipped bit that makes the data longer.
echo "$header" | sed 's/text/raw/' >long_raw.nrrd
head -c 600 /dev/zero | tr '\0' '\3' >>long_raw.nrrd
refused 'long_raw.nrrd: .*512 bytes of voxels, but 88 more' long_raw.nrrd --list
cases=$SOURCE/../shared/cases
if [ -d "$cases" ]; then
    refused 'sheet.stl: the body is too thin' "$cases/sheet.stl"
    in_short_if_sanitized || refused 'needle.stl: .* no element near' "$cases/needle.stl"
    expect 0 "$LARIAT" mesh "$cases/goodgz.nrrd" --list
    refused 'gzflip2.nrrd: .*damaged' "$cases/gzflip2.nrrd" --list
    refused 'short_raw.nrrd: .*more follow' "$cases/short_raw.nrrd" --list
    "$LARIAT" mesh "$cases/nii_badcrc_long.nii.gz" --list 2>&1 | grep -q 'reads no NIfTI' ||
        refused 'nii_badcrc_long.nii.gz: .*check sum' "$cases/nii_badcrc_long.nii.gz" --list
else
    echo "skipped: ../shared/cases is not there"
fi

# Surfaces: open, crossing themselves, a mesh, without volume.
octahedron() {
    echo 'v 1 0 0
v -1 0 0
v 0 1 0
v 0 -1 0
v 0 0 1
v 0 0 -1
f 1 3 5
f 3 2 5
f 2 4 5
f 4 1 5
f 3 1 6
f 2 3 6
f 4 2 6'
}
octahedron >open.obj
refused 'not closed' open.obj
{ octahedron; echo 'f 1 4 6'; } >closed.obj
expect 0 "$LARIAT" mesh closed.obj --scale 0.05 --elements 100
# Units: no liver has 166,667 cubic metres, no organ less than a cubic millimetre.
cp closed.obj liver.obj
expect 0 "$LARIAT" mesh liver.obj --scale 50 --elements 100 --out units
complains 'note: liver holds 1.667e+05 m^3, and no liver is larger than 10000 mL: the file may be in'
in_short_if_sanitized || {
    expect 0 "$LARIAT" mesh liver.obj --scale 5 --size 0.8 --force --out units
    ! grep -q 'such as' "$SCRATCH/err" || fail 'a unit that makes no liver'
    expect 0 "$LARIAT" mesh liver.obj --scale 100 --elements 100 --force --out units
    complains 'such as millimetres (--scale 0.001)'
    expect 0 "$LARIAT" mesh liver.obj --scale 0.05 --elements 100 --force --out units
    [ ! -s "$SCRATCH/err" ] || fail "doubts about a liver of 167 mL"
    expect 0 "$LARIAT" mesh liver.obj --scale 0.0005 --elements 100 --force --out units
    complains 'note: the body holds 0.1667 mm^3, less than a cubic millimetre'
}
# Too thin: told before the work; a needle of which half would be lost before most of it.
leaf() { sed "s/^v 0 0 \(-*\)1\$/v 0 0 \1$1/" closed.obj; }
leaf 0.00001 >sheet.obj
refused 'sheet.obj: the body is too thin for solid elements: .* mm thick' sheet.obj --scale 0.05
sed 's/^v \(-*\)1 0 0$/v \10.0001 0 0/; s/^v 0 \(-*\)1 0$/v 0 \10.0001 0/' closed.obj >needle.obj
refused 'needle.obj: [0-9]* % of the surface would have no element near it' needle.obj --scale 0.05
# Another unit, and what is too thin for the grid, are meshed and doubted.
leaf 0.005 >leaf_lost.obj
refused "leaf_lost.obj: [45][0-9] % of the surface would have no" leaf_lost.obj --scale 0.05 --size 0.0015
in_short_if_sanitized || {
    expect 0 "$LARIAT" mesh closed.obj --scale 50 --elements 100 --out large
    complains 'm long; if the file is in millimetres, say --scale 0.001'
    leaf 0.02 >leaf_thin.obj
    expect 0 "$LARIAT" mesh leaf_thin.obj --scale 0.05 --size 0.0015 --out thin
    complains 'the mesh has [0-9]* holes\{0,1\} that the surface has not' # its rim is as thin as an element
    [ "$(wc -l <"$SCRATCH/err")" -eq 1 ] || fail "other doubts about a leaf that is meshed"
    leaf 0.01 >leaf_thinner.obj
    expect 0 "$LARIAT" mesh leaf_thinner.obj --scale 0.05 --size 0.0015 --out thinner
    complains 'off the true surface in the mean: parts of it are thinner than an element'
}
# A hollow ball, and a corner of something else: walls among several regions are no thicker than they
# are, and the first hole in one only joins its sides. A speck where the image ends holds nothing.
awk 'BEGIN {
    print "NRRD0004\ntype: uchar\ndimension: 3\nspace: right-anterior-superior"
    print "sizes: 24 24 24\nencoding: text\nspace origin: (0,0,0)"
    print "space directions: (2,0,0) (0,2,0) (0,0,2)\n"
    for (k = 0; k < 24; k++) for (j = 0; j < 24; j++) for (i = 0; i < 24; i++) {
        r = sqrt((i - 11.5) ^ 2 + (j - 11.5) ^ 2 + (k - 11.5) ^ 2)
        print (r > 6 && r < 9 ? 1 : i + j + k < 5 ? 2 : 0)
    }
}' >hollow.nrrd
in_short_if_sanitized || {
    expect 0 "$LARIAT" mesh hollow.nrrd --elements 150 --out walls
    complains 'label_1 encloses 1 hollow and its mesh 0: its wall has holes'
    expect 0 "$LARIAT" mesh hollow.nrrd --elements 150 --label 1 --out wall
    [ ! -s "$SCRATCH/err" ] || fail "doubts about a wall that is closed"
    sed 's/^2$/0/; 10,11s/^0$/1/' hollow.nrrd >speck.nrrd
    expect 0 "$LARIAT" mesh speck.nrrd --elements 400 --out speck
    # A cup: what is in it touches what is around it only where the cup has holes.
    awk 'NR < 10 { print; next } {
        n = NR - 10; i = n % 24; j = int(n / 24) % 24; k = int(n / 576)
        r = sqrt((i - 11.5) ^ 2 + (j - 11.5) ^ 2 + (k - 11.5) ^ 2)
        print (k > 13 ? 0 : r > 9 ? 2 : r > 7.5 ? 1 : 3)
    }' hollow.nrrd >cup.nrrd
    expect 0 "$LARIAT" mesh cup.nrrd --elements 300 --out cup
    complains 'label_2 and label_3 touch over [0-9.]* mm^2 instead of 0'
    expect 0 "$LARIAT" mesh cup.nrrd --elements 6000 --out fine
    ! grep -q 'instead of' "$SCRATCH/err" || fail "regions that touch in a fine mesh"
}
leaf 0.002 >leaf_thinnest.obj
refused 'smaller or thinner than that' leaf_thinnest.obj --scale 0.05 --size 0.0015
{ # the same twice, a little apart
    octahedron
    echo 'f 1 4 6'
    octahedron | sed -n 's/^v \([^ ]*\) \([^ ]*\) \([^ ]*\)/\1 \2 \3/p' |
        awk '{ print "v", $1 + 0.3, $2 + 0.2, $3 + 0.1 }'
    { octahedron; echo 'f 1 4 6'; } | sed -n 's/^f //p' |
        awk '{ print "f", $1 + 6, $2 + 6, $3 + 6 }'
} >crossing.obj
refused 'crossing.obj' crossing.obj --scale 0.05
refused 'no labels' closed.obj --label 1
refused 'flat cut' closed.obj --fix cut --elements 100 --scale 0.05
expect 0 "$LARIAT" demo-model demo
cp demo/uterus.vtu uterus.vtp
refused 'uterus.vtp' uterus.vtp
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n' >leaf.obj
refused 'leaf.obj' leaf.obj

# What is there already: a mesh of one's own, or what is being meshed.
mkdir own
cp closed.obj own/liver.vtu
expect 1 "$LARIAT" mesh closed.obj --scale 0.05 --elements 100 --title liver --out own
complains 'own/liver.vtu is there already'
mv own/liver.vtu own/liver_surface.vtp
expect 1 "$LARIAT" mesh closed.obj --scale 0.05 --elements 100 --title liver --out own
complains 'own/liver_surface.vtp is there already'
cmp closed.obj own/liver_surface.vtp || fail "a file that was there is gone"
[ "$(ls own)" = liver_surface.vtp ] || fail "something was written"

# Folders that cannot be.
expect 1 "$LARIAT" mesh closed.obj --scale 0.05 --elements 100 --out good.nrrd/x
complains 'good.nrrd/x'
finish "mesh: bad input is answered"
