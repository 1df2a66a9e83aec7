/* What lariat.hpp promises: moved and never copied, exceptions that go through a callback, freed
 * once whatever happens, the calls of a session. */
#include <lariat.hpp>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

template <class T> constexpr bool moves() {
    return std::is_nothrow_move_constructible_v<T> && std::is_nothrow_move_assignable_v<T> &&
           !std::is_copy_constructible_v<T> && !std::is_copy_assignable_v<T>;
}
static_assert(moves<lariat::Model>() && moves<lariat::Simulation>() && moves<lariat::Saved>());
static_assert(moves<lariat::Session>() && moves<lariat::Snapshot>() && moves<lariat::Server>());
static_assert(moves<lariat::Results>() && moves<lariat::Meshing>() && moves<lariat::Image>());

static void expect(bool what, const char *said) {
    if (what) return;
    std::printf("moves: %s\n", said);
    std::exit(1);
}

/* Status of what a call throws; LAR_OK when it throws nothing. */
template <class Call> lar_status thrown(Call &&call) {
    try {
        call();
    } catch (const lariat::Error &error) {
        expect(*error.what() != '\0', "an error has no sentence");
        return error.status();
    }
    return LAR_OK;
}

static void simulate(const lariat::Model &model, const std::string &results) {
    lariat::Simulation first(model), other(model);
    first.advance(50);
    lariat::Simulation simulation = std::move(first);
    expect(!first.get() && simulation.steps() == 50, "moving leaves something behind");
    expect(thrown([&] { first.advance(1); }) == LAR_ERROR_ARGUMENT, "what was moved from advances");
    other = std::move(simulation); // what `other` had is freed
    expect(other.steps() == 50, "assigning loses the state");

    int calls = 0;
    bool through = false;
    try {
        other.advance_with(50, [&](std::uint64_t) -> bool {
            if (++calls == 7) throw std::runtime_error("enough");
            return true;
        });
    } catch (const std::runtime_error &error) {
        through = std::string(error.what()) == "enough";
    }
    expect(through && calls == 7 && other.steps() == 57,
           "an exception does not come out of a callback");

    lariat::Simulation clone = other.clone();
    clone.advance(1);
    expect(clone.steps() == 58 && other.steps() == 57, "a clone is not its own");
    other.advance(1);
    expect(clone.hash() == other.hash(), "a clone goes another way");

    other.set_gravity({0, 0, -1});
    expect(other.gravity()[2] == -1, "gravity was not set");
    other.set_gravity(nullptr);
    lar_energy energy = other.energy();
    expect(energy.kinetic > 0, "nothing moves");
    auto u = other.displacements();
    expect(u.size() == model.positions().size(), "not every node is there");
    expect(other.field(LAR_FIELD_VON_MISES, u.data()).size() == u.size(),
           "a field has another size");
    expect(thrown([&] { other.tool_force(99); }) == LAR_ERROR_ARGUMENT, "tool 99 was accepted");
    expect(thrown([&] { other.load("/none/such"); }) == LAR_ERROR_IO, "a missing file was loaded");

    lariat::Results frames(results, other);
    frames.add(other);
    frames.close();
}

static void play(const lariat::Model &model) {
    lar_options options = lariat::options();
    options.hands = 1;
    lariat::Simulation simulation(model, options);
    lariat::Session session(simulation);
    lariat::Snapshot snapshot(session);
    session.start();
    session.set_gravity({0, 0, 1});
    session.snapshot(snapshot, 5);
    expect(snapshot.displacements().size() == model.positions().size(),
           "a snapshot has another size");
    expect(thrown([&] { simulation.advance(1); }) == LAR_ERROR_ARGUMENT,
           "advanced beside a session");
    expect(session.inspect().simulation == simulation.get(),
           "the session is of another simulation");
    expect(session.status().state == LAR_SESSION_PLAYING, "it does not play");
    session.close();
    session.close(); // of nothing
    expect(thrown([&] { session.reset(); }) == LAR_ERROR_ARGUMENT, "what was closed is reset");
    simulation.advance(1);
}

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    expect(thrown([] { lariat::Model none("none.yaml"); }) == LAR_ERROR_IO, "none.yaml was opened");
    lariat::Model model(argv[1]);
    simulate(model, argv[2]);
    play(model);
    return 0;
}
