/* What the tests of planes, tools and grasps share: bodies with planes and tools, energies, and
 * what is inside a body. Include engine_test.h first. */
#ifndef LAR_TESTS_TOOL_CONTACT_TEST_H
#define LAR_TESTS_TOOL_CONTACT_TEST_H

/* All outer faces of the model against the half-space behind a plane. */
TEST_UNUSED static void add_plane(lar_model *model, const double through[3],
                                  const double direction[3]) {
    lar_error error;
    if (lar_surface_build(&model->mesh, &model->surface, &error)) fail_msg("%s", error.message);
    lar_contact *contact = LAR_MODEL_APPEND(model, contact);
    double length = 0;
    *contact = (lar_contact){.kind = LAR_CONTACT_PLANE, .face_count = model->surface.face_count};
    contact->face = lar_calloc((size_t)contact->face_count, sizeof *contact->face);
    memcpy(contact->face, model->surface.face, (size_t)contact->face_count * sizeof(int32_t));
    for (int i = 0; i < 3; i++) length += direction[i] * direction[i];
    for (int i = 0; i < 3; i++) {
        contact->through[i] = through[i];
        contact->normal[i] = direction[i] / sqrt(length);
    }
}

TEST_UNUSED static void fall(lar_model *model, const double velocity[3]) {
    lar_initial_velocity *initial = LAR_MODEL_APPEND(model, initial);
    int32_t count = model->mesh.node_count;
    initial->nodes = (lar_node_list){count, lar_calloc((size_t)count, sizeof(int32_t))};
    for (int32_t n = 0; n < count; n++) initial->nodes.node[n] = n;
    memcpy(initial->velocity, velocity, sizeof initial->velocity);
}

/* Sends a tool on its way; it is there after so many steps. */
TEST_UNUSED static void place(lar_simulation *simulation, int32_t tool, const double position[3],
                              const double orientation[4], double opening, uint64_t steps) {
    lar_error error;
    lar_tool_pose pose = {.opening = opening};
    memcpy(pose.position, position, sizeof pose.position);
    memcpy(pose.orientation, orientation, sizeof pose.orientation);
    if (lar_simulation_tool_move(simulation, tool, &pose, steps, &error))
        fail_msg("%s", error.message);
}

/* Adds a tool at rest at `at`, upright and open. */
TEST_UNUSED static void touch_tool(lar_model *model, const char *name, lar_tool tool,
                                   const double at[3]) {
    lar_tool *added = LAR_MODEL_APPEND(model, tool);
    *added = tool;
    added->name = lar_strdup(name);
    added->rest = (lar_tool_pose){.orientation = {1, 0, 0, 0}, .opening = 1};
    memcpy(added->rest.position, at, sizeof added->rest.position);
}

/* What the body has. */
TEST_UNUSED static double body_energy(lar_simulation *simulation, lar_energy *e) {
    lar_simulation_energy(simulation, e);
    return e->kinetic + e->strain + e->hourglass;
}

TEST_UNUSED static double stable_step_of(lar_model *model) {
    lar_model_info info;
    lar_error error;
    if (lar_model_check(model, &error) || lar_model_inspect(model, &info, &error))
        fail_msg("%s", error.message);
    return info.stable_step;
}

TEST_UNUSED static double size_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The solid angle of a triangle, seen from the origin (Van Oosterom and Strackee 1983). */
TEST_UNUSED static double angle_seen(const double a[3], const double b[3], const double c[3]) {
    double la = size_of(a), lb = size_of(b), lc = size_of(c), ab = 0, bc = 0, ca = 0, volume = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        ab += a[i] * b[i];
        bc += b[i] * c[i];
        ca += c[i] * a[i];
        volume += a[i] * (b[j] * c[k] - b[k] * c[j]);
    }
    return 2 * atan2(volume, la * lb * lc + ab * lc + bc * la + ca * lb);
}

/* How often the deformed surface goes round a point: 1 inside, 0 outside. */
TEST_UNUSED static double winding(const lar_simulation *simulation, const double point[3]) {
    const lar_model *model = simulation->domain.model;
    double sum = 0;
    for (int32_t f = 0; f < model->surface.face_count; f++) {
        double x[4][3];
        for (int a = 0; a < 4; a++) {
            int32_t node = model->surface.corner[f][a];
            const double *u = node_u(simulation, node);
            for (int i = 0; i < 3; i++) x[a][i] = model->mesh.position[node][i] + u[i] - point[i];
        }
        sum += angle_seen(x[0], x[1], x[2]) + angle_seen(x[0], x[2], x[3]);
    }
    return sum / (4 * 3.14159265358979);
}

#endif
