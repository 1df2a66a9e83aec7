/* Writes the demonstration organ: FOLDER/uterus.vtu and FOLDER/uterus.yaml. */
#include "model/demo/demo.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/folder.h"
#include "model/format/mesh_io.h"

/* The moduli are chosen for the explicit scheme: the stable step is that of a pressure wave across
 * the smallest element, and 1840 elements in 12 cm leave them about 4 mm. */
static const char scene_text[] =
    "# The demonstration organ of Lariat: a uterus with tubes, ovaries and ligaments, about 12 cm\n"
    "# from left to right, 1840 hexahedra. Try\n"
    "#\n"
    "#     lariat info uterus.yaml\n"
    "#     lariat run uterus.yaml --out results\n"
    "#\n"
    "# All numbers are in SI units: metres, kilograms, seconds, newtons, pascals.\n"
    "# x points to the patient's left, y to the back, z up.\n"
    "lariat: 1\n"
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
    "  - { cells: uterus,    law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.5e3, bulk_modulus: 3.0e5 }\n"
    "  - { cells: tubes,     law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.4e3, bulk_modulus: 2.8e5 }\n"
    "  - { cells: ovaries,   law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.5e3, bulk_modulus: 3.0e5 }\n"
    "  - { cells: ligaments, law: neo-hookean, density: 1050,\n"
    "      shear_modulus: 1.2e3, bulk_modulus: 2.4e5 }\n"
    "\n"
    "# Named sets come with the mesh. Nodes: cervix, ligament_ends (and ligament_end_left,\n"
    "# ligament_end_right), fundus, posterior, ovary_left, ovary_right. Cells: uterus, tubes,\n"
    "# ovaries, ligaments.\n"
    "fix:\n"
    "  - { nodes: cervix, axes: xyz }\n"
    "  - { nodes: ligament_ends, axes: xyz }      # the round ligaments end at the body wall\n"
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

/* First under another name, so that a full disk leaves no half file. */
static lar_status write_scene(const char *path, const char *part, lar_error *error) {
    FILE *file = fopen(part, "wb");
    bool good = file && fputs(scene_text, file) >= 0;
    int cause = errno;
    if (file && fclose(file) != 0 && good) good = false, cause = errno;
    if (good && rename(part, path) != 0) good = false, cause = errno;
    if (good) return LAR_OK;
    if (file) remove(part);
    return lar_fail(error, LAR_ERROR_IO,
                    "%s: cannot be written: %s; check the folder, its permissions and the free "
                    "space",
                    path, strerror(cause));
}

lar_status lar_demo_write(const char *folder, lar_error *error) {
    if (!folder || !*folder)
        return lar_fail(error, LAR_ERROR_ARGUMENT,
                        "no folder is given for the demonstration organ; name one, for example "
                        "demo");
    lar_status status = lar_folder_make(folder, error);
    if (status) return status;
    lar_mesh mesh = {0};
    char *mesh_path = lar_folder_join(folder, "uterus.vtu"),
         *scene_path = lar_folder_join(folder, "uterus.yaml");
    char *part_path = lar_folder_join(folder, "uterus.yaml.part");
    if (!mesh_path || !scene_path || !part_path)
        status = lar_fail_memory(error, strlen(folder), "a path");
    if (!status) status = lar_demo_mesh(&mesh, error);
    if (!status) status = lar_vtu_write(mesh_path, &(lar_vtu_frame){.mesh = &mesh}, error);
    if (!status) status = write_scene(scene_path, part_path, error);
    lar_mesh_clear(&mesh);
    free(mesh_path);
    free(scene_path);
    free(part_path);
    return status;
}
