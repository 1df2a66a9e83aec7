#!/bin/sh
# lariat mesh: from an image and from surfaces to scenes that run; lariat info tells their quality.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1

# An ellipsoid of 40 x 32 x 24 mm, cut through the middle into two labels, in voxels of 2 mm; it
# ends where the image does at its low x when `cut` is 1.
image() {
    awk -v cut="$1" 'BEGIN {
        print "NRRD0004\ntype: uchar\ndimension: 3\nspace: right-anterior-superior"
        print "sizes: " 24 - 10 * cut " 20 16\nencoding: text"
        print "space directions: (2,0,0) (0,2,0) (0,0,2)\nspace origin: (-23,-19,-15)"
        print "Segment0_LabelValue:=1\nSegment0_Name:=liver"
        print "Segment1_LabelValue:=7\nSegment1_Name:=left kidney"
        print "Segment2_LabelValue:=9\nSegment2_Name:=speck\n"
        for (k = 0; k < 16; k++) for (j = 0; j < 20; j++) for (i = 10 * cut; i < 24; i++) {
            x = (i - 11.5) / 10; y = (j - 9.5) / 8; z = (k - 7.5) / 6
            v = x * x + y * y + z * z < 1 ? (x < 0.3 ? 1 : 7) : 0
            print (i == 23 && j == 19 && k == 15 ? 9 : v)
        }
    }'
}
image 0 >two.nrrd
image 1 >cut.nrrd

# A bipyramid with a belt of 24 corners, closed, in millimetres; `open` leaves one side out.
surface() {
    awk -v open="$1" -v shift="$2" 'BEGIN {
        n = 24; turn = 6.283185307179586 / n
        print "# a spinning top\nv " shift " 0 30\nv " shift " 0 -30"
        for (i = 0; i < n; i++) print "v", shift + 25 * cos(i * turn), 25 * sin(i * turn), 0
        for (i = 0; i < n; i++) {
            a = 3 + i; b = 3 + (i + 1) % n
            print "f 1", a, b
            if (i || !open) print "f 2", b, a
        }
    }'
}
surface 0 0 >top.obj
surface 0 12 >other.obj

expect 0 "$LARIAT" mesh two.nrrd --list
says '24 x 20 x 16 voxels of 2 x 2 x 2 mm, 3 labels'
says ' 7  left kidney '
expect 0 "$LARIAT" mesh two.nrrd --list --json
has_keys file labels.0.name --numbers voxels.0 labels.2.label labels.2.voxels labels.0.volume
[ "$(value_of labels.2.voxels)" = 1 ] || fail "the speck has $(value_of labels.2.voxels) voxels"

expect 0 "$LARIAT" mesh two.nrrd --label liver --label 7 --elements 600 --title "Two organs"
[ ! -s "$SCRATCH/err" ] || fail "messages while all was well: $(cat "$SCRATCH/err")"
says '^Two organs: [56][0-9][0-9] elements of about [23][.0-9]* mm'
says 'left kidney (7): [0-9]* elements'
says '^held  *at the back, and on [1-9] extra supports* that bears* its weight: [0-9]* nodes'
says '^volume  *[12][0-9.]* mL, the true surface holds'
says '^shortest edge  *[0-9.]* mm$'
says '^deviation  *mean 0\.[0-9]* mm ('
says 'all of the elements are above 0.2'
says '^lariat view Two_organs/Two_organs.yaml$'
expect 0 "$LARIAT" mesh two.nrrd --label liver --elements 100 --voxel --out 'the liver'
says "^lariat view 'the liver/liver.yaml'$"
for file in .vtu .yaml _surface.vtp; do
    [ -s "Two_organs/Two_organs$file" ] || fail "no Two_organs$file"
done
find . -name '*.part' | grep -q . && fail "a part file is left"
grep -q 'law: coupled-neo-hookean, *# a guess' Two_organs/Two_organs.yaml &&
    grep -q '^ *shear_modulus: 2100,$' Two_organs/Two_organs.yaml &&
    grep -q 'lariat fit' Two_organs/Two_organs.yaml || fail "the scene does not say what is a guess"

# Tissue files in place of the table's figures: their lines stand in the scene, and everything that
# follows from a stiffness follows from theirs.
printf '# Fitted, 95 %% between 690 and 710.\nlariat-tissue: 1\nname: "gel"\nlaw: neo-hookean\ndensity: 1000\nshear_modulus: 700\nbulk_modulus: 7000\nviscous:\n  part: isochoric\n  terms:\n    - { g: 1, time: 0.5 }\n' >gel.tissue.yaml
expect 0 "$LARIAT" mesh two.nrrd --label liver --label 7 --elements 300 --title both \
    --tissue gel.tissue.yaml --json
[ "$(value_of regions.1.source)" = '"gel.tissue.yaml"' ] && [ "$(value_of regions.1.shear_modulus)" = 1400 ] ||
    fail "another tissue: $(value_of regions.1.source), $(value_of regions.1.shear_modulus)"
[ "$(grep -c 'shear_modulus: 700$' both/both.yaml)" = 2 ] &&
    grep -q '# Fitted, 95 % between 690 and 710' both/both.yaml || fail "the tissue is not in the scene"
expect 0 "$LARIAT" info both/both.yaml --no-speed --json
[ "$(value_of materials.1.shear_modulus)" = 700 ] || fail "$(value_of materials.1.shear_modulus) Pa"
# A file whose own name has a "=", for all regions.
cp gel.tissue.yaml a=gel.yaml
expect 0 "$LARIAT" mesh two.nrrd --label liver --elements 100 --title equals --tissue =a=gel.yaml --json
[ "$(value_of regions.0.source)" = '"a=gel.yaml"' ] || fail "not a=gel.yaml: $(value_of regions.0.source)"
printf 'lariat-tissue: 1\nlaw: neo-hookean\ndensity: 1000\nshear_modulus: 700\nbulk_modulus: 7000\nfibres:\n  law: exp-pow\n  part: isochoric\n  ksi: 500\n  alpha: 1\n  beta: 2\n' >fibrous.yaml
expect 0 "$LARIAT" mesh two.nrrd --label liver --label 7 --elements 300 --title one \
    --tissue 'left kidney=fibrous.yaml' --fibres 'axis: [0, 0, 1]' --fibres-in 'left kidney'
grep -q '^      shear_modulus: 2100,' one/one.yaml && grep -q '^      shear_modulus: 700$' one/one.yaml &&
    grep -q '^        direction: { axis: \[0, 0, 1\] }$' one/one.yaml || fail "tissues: $(cat one/one.yaml)"
expect 0 "$LARIAT" run one/one.yaml --time 0.01

# The pull moves the handle alike whatever the mesh; frames hold the embedded surface when asked to.
furthest() { # the largest mean displacement of the handle in a run's probes
    awk -F, 'NR == 1 { for (c = 1; c <= NF; c++) if ($c ~ /^"*handle/) at[++n] = c; next }
        { d = 0; for (c = 1; c <= n; c++) d += $at[c] ^ 2; if (d > most) most = d }
        END { print sqrt(most) }' "$1/probes.csv"
}
for elements in 150 600 2400; do
    expect 0 "$LARIAT" mesh two.nrrd --label liver --label 7 --elements $elements --title pull \
        --out pull$elements
    expect 0 "$LARIAT" run pull$elements/pull.yaml --time 1 --out pull$elements/out
done
awk "BEGIN { a = $(furthest pull150/out); b = $(furthest pull600/out); c = $(furthest pull2400/out)
    exit !(a > 0.5e-3 && b / a < 1.25 && a / b < 1.25 && c / b < 1.25 && b / c < 1.25) }" ||
    fail "pulls of $(furthest pull150/out), $(furthest pull600/out), $(furthest pull2400/out) m"
[ ! -e pull600/out/surface_000000.vtp ] || fail "an embedded surface that nobody asked for"
expect 0 "$LARIAT" run pull600/pull.yaml --time 0.05 --surface --out pull600/fine
[ -s pull600/fine/surface_000000.vtp ] && [ -s pull600/fine/surface.pvd ] || fail "no embedded surface"
sed 's/^# surface: true.*/  surface: true/' pull600/pull.yaml >pull600/asks.yaml
expect 0 "$LARIAT" run pull600/asks.yaml --time 0.05 --out pull600/asked
[ -s pull600/asked/surface_000000.vtp ] || fail "the scene asks for the embedded surface in vain"

# One core or many: the same files.
if taskset -c 0 true 2>/dev/null; then
    expect 0 taskset -c 0 "$LARIAT" mesh two.nrrd --label liver --label 7 --elements 600 \
        --title "Two organs" --out alone
    for file in Two_organs/*; do
        cmp "$file" "alone/${file#*/}" || fail "$file depends on the number of cores"
    done
fi

# What is written does what is said of it.
expect 0 "$LARIAT" info Two_organs/Two_organs.yaml
says '^title  *Two organs'
says '^deviation  *mean'
says '^crossing  *none'
says '^speed  *[0-9.]* times as fast'
says 'liver_left_kidney: [0-9]* faces'
says 'support: [0-9]* nodes'
expect 0 "$LARIAT" info Two_organs/Two_organs.yaml --json
has_keys speed.why_not --numbers quality.jacobian_histogram.9 quality.above_02 quality.above_05 \
    quality.mean_edge quality.volume quality.true_volume quality.deviation_mean \
    quality.deviation_95 quality.deviation_max quality.crossings quality.crossing_depth \
    speed.real_time_factor speed.wall_per_step_us
expect 0 "$LARIAT" info Two_organs/Two_organs.yaml --json --no-speed
value_of speed.why_not >/dev/null 2>&1 && fail "the speed was measured with --no-speed"
expect 0 "$LARIAT" info Two_organs/Two_organs.vtu --no-speed
grep -q '^deviation' "$SCRATCH/out" && fail "a deviation from nothing"
expect 0 "$LARIAT" info Two_organs/Two_organs.vtu --against Two_organs/Two_organs_surface.vtp
says '^deviation  *mean 0\.[0-9]* mm ('
expect 0 "$LARIAT" info Two_organs/Two_organs.vtu --against top.obj --scale 0.001
expect 1 "$LARIAT" info Two_organs/Two_organs.vtu --against none.stl
complains 'none.stl'
expect 2 "$LARIAT" info Two_organs/Two_organs.vtu --scale 0.001
expect 0 "$LARIAT" run Two_organs/Two_organs.yaml --out results --json
[ "$(value_of frames)" = 101 ] || fail "$(value_of frames) frames"
awk -F, '$1 > 0.6 && $1 < 0.7 { moved = $3 > 1e-4 } END { exit !moved }' results/probes.csv ||
    fail "the handle did not move to the front: $(head -n 40 results/probes.csv | tail -n 2)"

# Two instruments wait beside it, and the run is the same without them.
expect 0 "$LARIAT" info Two_organs/Two_organs.yaml --no-speed
says 'probe: sphere, radius'
says 'grasper: grasper, radius'
expect 0 "$LARIAT" run Two_organs/Two_organs.yaml --time 1 --json
hash=$(value_of state_hash)
sed '/^tools:/,/towards/d' Two_organs/Two_organs.yaml >Two_organs/bare.yaml
grep -q 'name: probe' Two_organs/bare.yaml && fail "the instruments are still in the scene"
expect 0 "$LARIAT" run Two_organs/bare.yaml --time 1 --json
[ "$(value_of state_hash)" = "$hash" ] || fail "with instruments $hash, without $(value_of state_hash)"

# With its whole weight for two seconds.
sed 's/^gravity: .*/gravity: [0, -9.81, 0]/' Two_organs/Two_organs.yaml >Two_organs/heavy.yaml
expect 0 "$LARIAT" run Two_organs/heavy.yaml --time 2

# A scene of the user's is not replaced; the rest of the folder's files is his, too.
echo "# mine" >>Two_organs/Two_organs.yaml
expect 1 "$LARIAT" mesh two.nrrd --label liver --elements 100 --title "Two organs"
complains 'Two_organs.yaml is there already.*--force'
tail -n 1 Two_organs/Two_organs.yaml | grep -q mine || fail "the user's scene was replaced"
expect 0 "$LARIAT" mesh two.nrrd --label liver --elements 100 --title "Two organs" --force
grep -q mine Two_organs/Two_organs.yaml && fail "--force replaced nothing"

# A disk that is full for one of the files: what was there stays, and nothing half is left.
if [ -c /dev/full ]; then
    for file in liver.vtu liver_surface.vtp liver.yaml; do
        rm -rf full
        mkdir full
        echo old >full/liver.vtu
        ln -s /dev/full full/$file.new.part
        expect 1 "$LARIAT" mesh two.nrrd --label liver --elements 100 --force --out full
        complains 'No space left'
        [ "$(ls full)$(cat full/liver.vtu)" = liver.vtuold ] || fail "full for $file: $(ls full)"
    done
fi

# A link in the place of one of them stays, and so does everything else.
rm -rf linked
mkdir linked
ln -s ../behind linked/liver_surface.vtp
expect 1 "$LARIAT" mesh two.nrrd --label liver --elements 100 --force --out linked
complains 'liver_surface.vtp: is there and is no plain file'
[ "$(ls linked)" = liver_surface.vtp ] && [ ! -e behind ] || fail "beside a link: $(ls linked)"

# The same input, the same bytes; figures as JSON.
for out in first second; do
    expect 0 "$LARIAT" mesh cut.nrrd --label liver --size 0.004 --out $out --json
done
cmp -s first/liver.vtu second/liver.vtu || fail "the same input gave two meshes"
cmp -s first/liver.yaml second/liver.yaml || fail "the same input gave two scenes"
has_keys scene title fix regions.0.name regions.0.tissue regions.0.source --numbers elements nodes \
    size regions.0.tag regions.0.elements regions.0.volume regions.0.true_volume \
    regions.0.shear_modulus regions.0.bulk_modulus regions.0.density cleaning.islands \
    cleaning.island_cells cleaning.pinholes cleaning.pinhole_cells cleaning.added \
    cleaning.removed cuts pads fixed_nodes scaled_jacobian.min scaled_jacobian.mean \
    quality.deviation_max shortest_edge stable_step time_step speed.real_time_factor seconds
[ "$(value_of fix)$(value_of cuts)$(value_of size)" = '"cut"10.0040000000000000001' ] ||
    [ "$(value_of fix)$(value_of cuts)" = '"cut"1' ] || fail "a cut: $(value_of fix) $(value_of cuts)"
[ "$(value_of scene)" = '"second/liver.yaml"' ] || fail "scene $(value_of scene)"
value_of quality.above_02 | grep -qx '1.*' || fail "bad elements"

# Names from a file, all labels as one, the image's own voxels, principal axes.
printf 'label,name\n1,liver\n7,spleen\n' >names.csv
expect 0 "$LARIAT" mesh cut.nrrd --names names.csv --label Spleen --elements 200
[ -s spleen/spleen.yaml ] || fail "names.csv was not heard"
expect 0 "$LARIAT" mesh cut.nrrd --label 1 --label 7 --fuse --voxel --out cubes --title cubes
says '^cubes: [0-9]* elements of about 2 mm'
expect 0 "$LARIAT" mesh cut.nrrd --label 1 --label 7 --elements 400 --apart --out apart --title apart
[ ! -e apart/apart_surface.vtp ] || fail "bodies of their own have a true surface"
grep -q '^contact: ' apart/apart.yaml || fail "bodies of their own without contact"
expect 0 "$LARIAT" run apart/apart.yaml --time 0.05
expect 2 "$LARIAT" mesh cut.nrrd --apart --fuse
expect 0 "$LARIAT" mesh two.nrrd --label liver --principal --elements 200 --fix none --out free
says '^held  *nowhere'
expect 0 "$LARIAT" run free/liver.yaml

# Surfaces: one and several.
expect 0 "$LARIAT" mesh top.obj --scale 0.001 --elements 500 --fix bottom
says '^held  *at the bottom'
says '^speed'
expect 0 "$LARIAT" run top/top.yaml --steps 100
expect 0 "$LARIAT" mesh top.obj other.obj --scale 0.001 --elements 500 --title tops
says 'other (2): [0-9]* elements'
awk '/^v/ { print $1, $2 / 2, $3 / 2, $4 / 2; next } { print }' top.obj >core.obj
expect 0 "$LARIAT" mesh core.obj top.obj --scale 0.001 --elements 500 --title swallowed
says 'core (1): left out: a later surface covers all of it; name the outer one first'
expect 0 "$LARIAT" mesh top.obj core.obj --scale 0.001 --elements 500 --title kept
says 'core (2): [0-9]* elements'

# box X Y Z LOW: facets of a box with its least corner at LOW, 0, 0.
box() {
    awk -v x="$1" -v y="$2" -v z="$3" -v low="$4" '
    function facet(a, b, c) { print "facet normal 0 0 0\nouter loop\nvertex " p[a] "\nvertex " p[b] "\nvertex " p[c] "\nendloop\nendfacet" }
    BEGIN {
        for (i = 0; i < 8; i++)
            p[i] = sprintf("%.9g %.9g %.9g", low + x * (i % 2), y * (int(i / 2) % 2), z * int(i / 4))
        split("0 2 3 1 4 5 7 6 0 1 5 4 2 6 7 3 0 4 6 2 1 3 7 5", q, " ")
        for (f = 0; f < 6; f++) { facet(q[4*f+1], q[4*f+2], q[4*f+3]); facet(q[4*f+1], q[4*f+3], q[4*f+4]) }
    }'
}
# Two boxes 1 um apart become one body, and that is said.
{ echo 'solid near'; box 0.04 0.04 0.04 0; box 0.04 0.04 0.04 0.040001; echo 'endsolid near'; } >near.stl
expect 0 "$LARIAT" mesh near.stl --elements 500 --title near
complains 'note: the surface has 2 bodies and the mesh 1: gaps between them .* are closed'
expect 0 "$LARIAT" mesh top.obj --scale 0.001 --elements 500 --title whole
if grep -q 'bodies and the mesh' "$SCRATCH/err"; then fail "$(cat "$SCRATCH/err")"; fi
# A plate aslant, thinner than an element, has no holes.
turned() {
    awk '
    $1 == "vertex" {
        u = $2 * cos(0.5) - $4 * sin(0.5); w = $2 * sin(0.5) + $4 * cos(0.5)
        $0 = sprintf("vertex %.9g %.9g %.9g", u * cos(0.7) - $3 * sin(0.7), u * sin(0.7) + $3 * cos(0.7), w)
    }
    { print }'
}
{ echo 'solid plate'; box 0.03 0.03 0.002 0; echo 'endsolid plate'; } | turned >plate.stl
for size in 0.0013 0.0022 0.004; do
    expect 0 "$LARIAT" mesh plate.stl --size $size --title plate --force
    if grep -q . "$SCRATCH/err"; then fail "$(cat "$SCRATCH/err")"; fi
done
# Nor does one of two get lost, of twelve triangles each: their corners are far from the cells.
{ echo 'solid two'; box 0.03 0.03 0.0044 0; box 0.03 0.03 0.0044 0.04; echo 'endsolid two'; } | turned >two.stl
for size in 0.0018 0.002 0.0022; do
    expect 0 "$LARIAT" mesh two.stl --size $size --title two --force
    if grep -q . "$SCRATCH/err"; then fail "$(cat "$SCRATCH/err")"; fi
done

finish "mesh: images, surfaces, figures, scenes that run"
