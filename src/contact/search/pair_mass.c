#include "contact/search/pair_mass.h"

#include "base/vector.h"

static const double EQUAL = 1e-9; /* masses that differ by no more than rounding */

void lar_corner_masses_of(const lar_contact_surface *surface, int32_t node, int32_t face,
                          const uint8_t *held, lar_corner_masses *of) {
    const bool free = surface->node[node].bound > 0;
    for (int a = 0; a < 4; a++) {
        const lar_contact_node *corner = &surface->node[surface->face[face].corner[a]];
        of->mass[a] = free && lar_contact_still(corner, held) ? INFINITY : corner->mass;
        of->thin[a] = corner->area / of->mass[a];
    }
}

static void lighten(const lar_corner_masses *of, double light[4]) {
    for (int a = 0; a < 4; a++) light[a] = 1 / of->mass[a];
}

void lar_point_mass_ease(const lar_corner_masses *of, const double weight[4],
                         lar_point_mass *point) {
    double part = (weight[0] + weight[1]) + (weight[2] + weight[3]), in[4], light[4], change[5];
    if (!(part > 0)) return;
    for (int a = 0; a < 4; a++) in[a] = weight[a] / part;
    lighten(of, light);
    point->light += part * lar_face_eased(in, light, change);
    point->thin += part * lar_face_eased(in, of->thin, change);
}

bool lar_pair_slope(const lar_contact_node *node, const lar_corner_masses *of,
                    const lar_point_mass *point, double moved, const lar_pair_press *press,
                    double slope[4][3]) {
    /* Of 1 / (1/m + L) and of A / T the mass falls by its square, by T's part of it. */
    const bool thin = moved * point->thin > node->area * (1 - EQUAL);
    double per[4], light[4], change[5], force[5][3], most = 0, least = INFINITY, largest = 0;
    lighten(of, light);
    for (int a = 0; a < 4; a++) {
        per[a] = moved * (thin ? of->thin[a] / node->area : light[a]);
        most = fmax(most, per[a]);
        least = fmin(least, per[a]);
    }
    if (!(most - least > EQUAL * most)) return false;
    lar_face_eased(press->closest->weight, per, change);
    lar_face_slope(press->x, press->corner, press->closest, change, force);
    for (int a = 0; a < 5; a++) {
        for (int i = 0; i < 3; i++) force[a][i] *= press->energy;
        largest = fmax(largest, lar_dot(force[a], force[a]));
    }
    largest = sqrt(largest);
    /* Of a face that is crushed slopes have no bound. */
    const double within = largest <= press->force ? 1 : press->force / largest;
    for (int a = 0; a < 4; a++)
        for (int i = 0; i < 3; i++) slope[a][i] += within * force[a][i];
    return true;
}
