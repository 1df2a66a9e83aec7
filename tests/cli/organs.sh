#!/bin/sh
# Two organs of a scan that lie in a corner: the liver's rim is pressed flat beneath the spleen, and
# nodes that come between its walls once made energy from nowhere.
. "$(dirname "$0")/lib.sh"
cd "$SCRATCH" || exit 1
data=$SOURCE/../shared/data/labels
if [ ! -d "$data" ]; then
    finish "skipped: ../shared/data is not there"
    exit 0
fi
expect 0 "$LARIAT" mesh "$data/totalseg_abdomen_pelvis_3mm.nii.gz" \
    --names "$data/totalseg_total_labels.csv" --label liver --label spleen --elements 2000 \
    --title organs --out organs
cat >organs/corner.yaml <<'END'
lariat: 1
mesh: organs.vtu
gravity: [-6, -5, -6]
damping: 55
materials:
  - { cells: 5, law: coupled-neo-hookean, density: 1060, shear_modulus: 2100, bulk_modulus: 2.03e+04 }
  - { cells: 1, law: coupled-neo-hookean, density: 1060, shear_modulus: 3600, bulk_modulus: 3.48e+04 }
contact:
  - { between: [liver_surface, spleen_surface] }
  - { faces: all, plane: { through: [-0.155, 0, 0], normal: [1, 0, 0] } }
  - { faces: all, plane: { through: [0, 0.07, 0], normal: [0, 1, 0] } }
  - { faces: all, plane: { through: [0, 0, 0.298], normal: [0, 0, 1] } }
END
expect 0 "$LARIAT" run organs/corner.yaml --time 2.5
says '^contact  *[1-9][0-9]* nodes touch'
finish "organs on each other"
