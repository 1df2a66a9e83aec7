#!/bin/sh
# Makes the pictures of docs/images from Lariat's own results.
#
#   tools/render/pictures.sh [LARIAT [FOLDER]]      default: build/lariat docs/images
#
# Needs python3-vtk9, xvfb and xauth (see render.py), and imagemagick.
set -eu
here=$(dirname "$0")
lariat=${1:-$here/../../build/lariat}
images=${2:-$here/../../docs/images}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$images"

render() {
    xvfb-run -a /usr/bin/python3 "$here/render.py" "$@"
}

# The demonstration organ: at rest, and at its largest deflection (frame 18, 0.36 s).
"$lariat" demo-model "$work/demo" >"$work/log"
"$lariat" run "$work/demo/uterus.yaml" --out "$work/demo/results" >"$work/log"
rest=$work/demo/results/uterus_000000.vtu
pulled=$work/demo/results/uterus_000018.vtu
render --out "$images/uterus.png" "$rest" "$pulled" --size 1200 520 \
    --azimuth 36 --elevation 20 --zoom 1.36 --shift 0.015 \
    --caption "at rest" --caption "pulled with 0.16 N" \
    --arrow 1 0.0092 0.0215 0.078 0.0055 0.0137 0.0164
render --out "$images/uterus_von_mises.png" "$pulled" --size 900 520 \
    --color von_mises --range 0 1200 --legend 'von Mises\nstress [Pa]' \
    --azimuth 36 --elevation 20 --zoom 1.42

# The organ divided among 2 x 2 x 3 processors.
"$lariat" partition "$work/demo/uterus.yaml" --grid 2x2x3 --method genetic --generations 800 \
    --vtu "$work/processors.vtu" >"$work/log"
render --out "$images/uterus_processors.png" "$work/processors.vtu" --size 900 560 \
    --color processor --apart 0.4 --crease 50 --azimuth 36 --elevation 20 --zoom 1.75

# A soft cantilever of 40 x 4 x 4 elements, 0.1 x 0.01 x 0.01 m, E = 3 kPa, at rest under growing
# shares of its weight: the beam of docs/validation.md.
awk 'BEGIN {
    nx = 40; n = 4; h = 0.0025
    print "# vtk DataFile Version 3.0\nbeam\nASCII\nDATASET UNSTRUCTURED_GRID"
    print "POINTS", (nx + 1) * (n + 1) * (n + 1), "double"
    for (k = 0; k <= n; k++) for (j = 0; j <= n; j++) for (i = 0; i <= nx; i++)
        print i * h, j * h, k * h
    cells = nx * n * n
    print "CELLS", cells, 9 * cells
    for (k = 0; k < n; k++) for (j = 0; j < n; j++) for (i = 0; i < nx; i++) {
        a = i + (nx + 1) * (j + (n + 1) * k); b = a + (nx + 1) * (n + 1); r = nx + 1
        print 8, a, a + 1, a + 1 + r, a + r, b, b + 1, b + 1 + r, b + r
    }
    print "CELL_TYPES", cells
    for (c = 0; c < cells; c++) print 12
}' >"$work/beam.vtk"
frames=""
for gravity in 0.0196 0.0785 0.196 0.392 0.981; do
    cat >"$work/beam_$gravity.yaml" <<SCENE
lariat: 1
mesh: beam.vtk
gravity: [0, 0, -$gravity]
damping: 4.0
duration: 12
materials:
  - { cells: all, law: neo-hookean, density: 1000, youngs_modulus: 3.0e3, poisson_ratio: 0.45 }
sets: [ { name: wall, nodes: { plane: { point: [0, 0, 0], normal: [1, 0, 0] } } } ]
fix: [ { nodes: wall, axes: xyz } ]
SCENE
    "$lariat" run "$work/beam_$gravity.yaml" --out "$work/$gravity" >"$work/log"
    frames="$frames $work/$gravity/beam_${gravity}_000000.vtu"
done
# shellcheck disable=SC2086
render --out "$images/cantilever.png" $frames --together --size 900 560 \
    --color von_mises --legend 'von Mises\nstress [Pa]' --range 0 240 \
    --crease 60 --azimuth 14 --elevation 10 --zoom 1.3

# Contact: the scenes of examples/scenes, at rest, when they meet, and at the end.
for scene in blocks strip; do
    "$lariat" run "$here/../../examples/scenes/$scene.yaml" --out "$work/$scene" >"$work/log"
done
render --out "$images/contact_blocks.png" "$work/blocks/blocks_000000.vtu" \
    "$work/blocks/blocks_000006.vtu" "$work/blocks/blocks_000100.vtu" --size 1200 400 \
    --color von_mises --range 0 800 --legend 'von Mises\nstress [Pa]' --crease 60 \
    --azimuth 25 --elevation 12 --zoom 1.05 --caption "at rest" --caption "0.06 s" --caption "1 s"
render --out "$images/contact_strip.png" "$work/strip/strip_000000.vtu" \
    "$work/strip/strip_000015.vtu" "$work/strip/strip_000100.vtu" --size 1200 400 \
    --color von_mises --range 0 600 --legend 'von Mises\nstress [Pa]' --crease 60 \
    --azimuth 15 --elevation 10 --zoom 1.05 --caption "at rest" --caption "0.15 s" --caption "1 s"

# Muscles, moving: scene, part of the pictures that is kept, hundredths of a second for each of
# them, every how manieth frame, how it is drawn.
moving() {
    scene=$1 part=$2 delay=$3 every=$4
    shift 4
    "$lariat" run "$here/../../examples/scenes/$scene.yaml" --out "$work/$scene" >"$work/log"
    render --film --out "$work/film_$scene" --size 280 280 --azimuth 36 --elevation 25 "$@" \
        "$work/$scene/$scene.pvd" >"$work/log"
    # shellcheck disable=SC2046
    convert -delay "$delay" -loop 0 \
        $(find "$work/film_$scene" -name '*.png' | sort | awk "(NR - 1) % $every == 0") \
        -crop "$part" +repage -colors 20 -layers optimize "$images/$scene.gif"
}
moving contracting 190x180+25+50 6 1 --zoom 0.8 --color parts
moving beating 160x260+55+5 8 2 --zoom 1.3 --color von_mises --range 0 4000
moving twisting 200x220+10+30 6 1 --zoom 1 --color von_mises --range 0 8000
moving peristalsis 130x280+75+0 8 2 --zoom 0.95 --color von_mises --range 0 1500
ls -l "$images"
