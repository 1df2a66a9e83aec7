/* Lariat inside another program: let the beam hang for a tenth of a second.
 *     cc embed.c $(pkg-config --cflags --libs lariat) -o embed && ./embed beam.yaml */
#include <inttypes.h>
#include <lariat.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
    lar_error error;
    lar_model *model = NULL;
    lar_model_info info;
    lar_simulation *simulation = NULL;
    double(*displacement)[3] = NULL;
    int failed = lar_model_open(argc > 1 ? argv[1] : "beam.yaml", &model, &error) ||
                 lar_model_inspect(model, &info, &error) ||
                 lar_simulation_create(model, NULL, &simulation, &error) ||
                 lar_simulation_advance(
                     simulation, (uint64_t)(0.1 / lar_simulation_time_step(simulation)), &error);
    if (failed) {
        fprintf(stderr, "%s\n", error.message);
    } else if ((displacement = calloc((size_t)info.nodes, sizeof *displacement))) {
        const double(*position)[3] = lar_model_positions(model);
        int tip = 0; /* the node farthest along x */
        for (int i = 1; i < info.nodes; i++)
            if (position[i][0] > position[tip][0]) tip = i;
        lar_simulation_displacements(simulation, displacement);
        printf("tip %.9f m\nhash %016" PRIx64 "\n", displacement[tip][2],
               lar_simulation_hash(simulation));
    }
    failed = failed || !displacement;
    free(displacement);
    lar_simulation_destroy(simulation);
    lar_model_destroy(model);
    return failed;
}
