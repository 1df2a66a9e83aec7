/* Lariat in C++: a grasper takes hold of tissue, lifts it, and the way back is free.
 *     c++ -std=c++17 organ.cpp $(pkg-config --cflags --libs lariat) -o organ && ./organ
 * lariat.hpp is lariat.h with destructors: nothing is freed by hand, also where something throws.
 */
#include <lariat.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

using lariat::Vec3;

static constexpr int NX = 8, NY = 6, NZ = 3; // cells of a slab
static constexpr double EDGE = 0.01;         // of a cell [m]

static const char SCENE[] = R"(lariat: 1
title: A slab in C++
damping: 20
materials:
  - { cells: all, law: neo-hookean, density: 1050, shear_modulus: 3.0e3, bulk_modulus: 3.0e4 }
fix: [ { nodes: floor, axes: xyz } ]
)";

static lariat::Model make_slab() {
    std::vector<Vec3> position;
    std::vector<std::array<std::int32_t, 8>> element;
    std::vector<std::int32_t> floor;
    auto node = [](int i, int j, int k) { return (k * (NY + 1) + j) * (NX + 1) + i; };
    for (int k = 0; k <= NZ; k++)
        for (int j = 0; j <= NY; j++)
            for (int i = 0; i <= NX; i++) {
                if (k == 0) floor.push_back(node(i, j, k));
                position.push_back({i * EDGE, j * EDGE, k * EDGE});
            }
    for (int k = 0; k < NZ; k++)
        for (int j = 0; j < NY; j++)
            for (int i = 0; i < NX; i++)
                element.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k),
                                   node(i, j + 1, k), node(i, j, k + 1), node(i + 1, j, k + 1),
                                   node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)});
    lar_array_set set{};
    set.name = "floor";
    set.count = static_cast<std::int32_t>(floor.size());
    set.index = floor.data();
    lar_mesh_arrays mesh{};
    mesh.nodes = static_cast<std::int32_t>(position.size());
    mesh.elements = static_cast<std::int32_t>(element.size());
    mesh.sets = 1;
    mesh.position = reinterpret_cast<const double(*)[3]>(position.data());
    mesh.element = reinterpret_cast<const std::int32_t(*)[8]>(element.data());
    mesh.set = &set;
    return lariat::Model::from_arrays(mesh, SCENE); // everything is copied
}

int main() {
    try {
        lariat::Model model = make_slab();
        lar_options options = lariat::options();
        options.hands = 1;
        lariat::Simulation simulation(model, options);
        lariat::Saved rest(simulation);
        simulation.save_to(rest);
        std::printf("slab   %d nodes, hash %016llx\n", model.node_count(),
                    static_cast<unsigned long long>(simulation.hash()));

        // A hand takes hold of the middle of the top, and goes up.
        lar_tool_pose pose{{NX * EDGE / 2, NY * EDGE / 2, NZ * EDGE}, {1, 0, 0, 0}, 0};
        simulation.tool_move(0, pose, 1);
        int held = simulation.grasp(0, Vec3{pose.position[0], pose.position[1], pose.position[2]});
        pose.position[2] += 0.01;
        simulation.tool_move(0, pose, 2000);
        simulation.advance(2500);
        double highest = 0;
        for (const Vec3 &u : simulation.displacements()) highest = std::max(highest, u[2]);
        std::printf("hand   holds %d, lifts by %.1f mm, feels %.3f N\n", held, 1e3 * highest,
                    simulation.tool_force(0).force[2]);

        // Until a callback says that it is enough.
        std::uint64_t begin = simulation.steps();
        simulation.advance_with(1000, [&](std::uint64_t step) { return step < begin + 100; });
        std::printf("steps  %llu, as the callback wanted\n",
                    static_cast<unsigned long long>(simulation.steps() - begin));

        simulation.load_from(rest);
        std::printf("back   hash %016llx\n", static_cast<unsigned long long>(simulation.hash()));

        // What the library refuses is thrown, with its sentence.
        simulation.set_stiffness(0, 1e6);
    } catch (const lariat::Error &error) {
        std::printf("error  %d: %s\n", static_cast<int>(error.status()), error.what());
        return error.status() != LAR_ERROR_ARGUMENT;
    }
    return 1;
}
