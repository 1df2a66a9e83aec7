#include "model/demo/demo_scene.h"

#define UNITS                                                                                      \
    "# All numbers are in SI units: metres, kilograms, seconds, newtons, pascals.\n"               \
    "# x points to the patient's left, y to the back, z up.\n"

/* ---- uterus.yaml: pulled by a force ---------------------------------------------------------- */

/* The moduli are chosen for the explicit scheme: the stable step is that of a pressure wave across
 * the smallest element, and 1840 elements in 12 cm leave them about 4 mm. */
static const char pulled_head[] =
    "# The demonstration organ of Lariat: a uterus with tubes, ovaries and ligaments, about 12 cm\n"
    "# from left to right, 1840 hexahedra. Try\n"
    "#\n"
    "#     lariat info uterus.yaml\n"
    "#     lariat run uterus.yaml --out results\n"
    "#\n"
    "# To take hold of it: lariat view uterus_live.yaml\n" UNITS "lariat: 1\n"
    "title: Uterus\n"
    "mesh: uterus.vtu\n"
    "\n"
    "# The organ is shown as in laparoscopy, held up by its neighbours: no weight of its own.\n"
    "# With [0, 0, -1.0] it sags a little, with [0, 1.0, 0] it leans back as with the patient\n"
    "# lying down; under its full weight, 9.81, and nothing around it, it falls over.\n"
    "gravity: [0, 0, 0]\n"
    "time_step: auto          # about 0.1 milliseconds\n"
    "damping: 4.0             # 1/s; motion dies away within a second\n"
    "duration: 0.6            # s; a run lasts so long unless --time says otherwise\n"
    "\n"
    "# Approximate shear moduli; magnetic resonance elastography of living women finds 2 to 3\n"
    "# kPa for the uterus, here it is softer, so that the stable step stays above 0.1 ms\n"
    "# (doubling both moduli divides it by 1.4). Nearly incompressible: bulk / shear modulus = "
    "200.\n"
    "materials:\n"
    "  - { name: uterus,    cells: uterus,    law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.5e3, bulk_modulus: 3.0e5 }\n"
    "  - { name: tubes,     cells: tubes,     law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.4e3, bulk_modulus: 2.8e5 }\n"
    "  - { name: ovaries,   cells: ovaries,   law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.5e3, bulk_modulus: 3.0e5 }\n"
    "  - { name: ligaments, cells: ligaments, law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.2e3, bulk_modulus: 2.4e5 }\n"
    "\n";

static const char pulled_end[] =
    "\n"
    "# A forceps at the fundus: the force grows smoothly over 0.2 seconds and then stays. It is\n"
    "# the total, shared equally by the nodes of the set.\n"
    "load:\n"
    "  - { nodes: fundus, force: [0.04, 0.10, 0.12], over: 0.2 }\n"
    "\n"
    "output:\n"
    "  every: 0.02\n"
    "  fields: [displacement, von_mises]\n"
    "  probes:\n"
    "    - { name: fundus, set: fundus }                         # mean displacement\n"
    "    - { name: ovary_left, set: ovary_left }\n"
    "    - { name: cervix_reaction, set: cervix, sum: reaction } # force of the supports\n";

/* ---- uterus_live.yaml: pulled by a person ---------------------------------------------------- */

/* The slowest motion, the fundus swaying back and forth, takes about 0.4 s: 20 1/s is 0.7 of what
 * would just keep it from swaying. */
static const char live_head[] =
    "# The demonstration organ of Lariat to take hold of: no load but your hand and two tools.\n"
    "#\n"
    "#     lariat view uterus_live.yaml\n"
    "#\n"
    "# uterus.yaml is the same organ, pulled by a force.\n" UNITS "lariat: 1\n"
    "title: Uterus\n"
    "mesh: uterus.vtu\n"
    "\n"
    "gravity: [0, 0, 0]       # held up by its neighbours\n"
    "time_step: auto          # about 0.1 milliseconds\n"
    "damping: 20.0            # 1/s; let go, it is back within half a second and sways once\n"
    "\n"
    "# What the tools squeeze moves with more mass meanwhile, up to 2 % of all, so that steps are\n"
    "# divided into fewer parts: it keeps the clock longer.\n"
    "mass_scaling: { strained: 0.02 }\n"
    "\n"
    "# Approximate shear moduli: magnetic resonance elastography of living women finds 2 to 3 kPa\n"
    "# for the uterus. Tubes and ligaments are firmer, so that one can pull at them. The stable\n"
    "# step depends on the bulk moduli: with 4 times as much it is half as long.\n"
    "materials:\n"
    "  - { name: uterus,    cells: uterus,    law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 3.0e3, bulk_modulus: 3.0e5 }\n"
    "  - { name: tubes,     cells: tubes,     law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 5.0e3, bulk_modulus: 3.0e5 }\n"
    "  - { name: ovaries,   cells: ovaries,   law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 3.0e3, bulk_modulus: 3.0e5 }\n"
    "  - { name: ligaments, cells: ligaments, law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 5.0e3, bulk_modulus: 3.0e5 }\n"
    "\n";

static const char live_end[] = "\n"
                               "# The organ does not pass through itself.\n"
                               "contact: [ { self: true } ]\n"
                               "\n"
                               "output:\n"
                               "  every: 0.02\n"
                               "  fields: [displacement, von_mises]\n"
                               "  probes: [ { name: fundus, set: fundus } ]\n";

/* ---- both ------------------------------------------------------------------------------------ */

static const char middle[] =
    "# Named sets come with the mesh. Nodes: cervix, ligament_ends (and ligament_end_left,\n"
    "# ligament_end_right), fundus, posterior, ovary_left, ovary_right. Cells: uterus, tubes,\n"
    "# ovaries, ligaments.\n"
    "fix:\n"
    "  - { nodes: cervix, axes: xyz }\n"
    "  - { nodes: ligament_ends, axes: xyz }      # the round ligaments end at the body wall\n"
    "\n"
    "# Instruments, which wait in front of the organ until a device or the mouse moves them.\n"
    "tools:\n"
    "  - { name: probe, shape: sphere, radius: 0.005, at: [0.045, -0.045, 0.075] }\n"
    "  - { name: grasper, shape: grasper, radius: 0.002, length: 0.02, spread: 50,\n"
    "      at: [-0.035, -0.055, 0.09], towards: [0.35, 0.75, -0.5] }\n";

const lar_demo_scene lar_demo_scene_of[LAR_DEMO_SCENES] = {
    {"uterus.yaml", {pulled_head, middle, pulled_end}},
    {"uterus_live.yaml", {live_head, middle, live_end}}};
