/* Lariat for C++17: lariat.h with destructors and exceptions, in this header alone.
 *
 *     lariat::Model model("organ.yaml");
 *     lariat::Simulation simulation(model);
 *     simulation.advance(1000);
 *
 * Every class owns one thing of lariat.h, is moved and never copied, and has its calls by their
 * names: lar_simulation_set_gravity is Simulation::set_gravity, and its comment there holds here.
 * What returns a lar_status there throws lariat::Error here, with the library's sentence. Structs
 * are those of lariat.h. `get` hands out what is owned. What was moved from or closed owns nothing,
 * and its calls do what those of lariat.h do with NULL: they throw, or answer 0; only a snapshot's
 * `->` needs one that is there.
 *
 * What is made of something else must go first: a Simulation before its Model, a Session before its
 * Simulation, a Server before its Session. Variables of one block, in the order in which they are
 * made, do so by themselves.
 */
#ifndef LARIAT_HPP
#define LARIAT_HPP

#include <lariat.h>

#if defined(__GNUC__) && !defined(__EXCEPTIONS)
#error "lariat.hpp throws; without exceptions use lariat.h, whose calls return a status"
#endif

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lariat {

/* x, y, z; an array of them is a `double (*)[3]` of lariat.h. */
using Vec3 = std::array<double, 3>;
static_assert(sizeof(Vec3) == sizeof(double[3]), "lariat: Vec3 must be three doubles");
/* xx, yy, zz, xy, yz, zx of a symmetric tensor. */
using Vec6 = std::array<double, 6>;
static_assert(sizeof(Vec6) == sizeof(double[6]), "lariat: Vec6 must be six doubles");

class Error : public std::runtime_error {
  public:
    explicit Error(const lar_error &error)
        : std::runtime_error(error.message), status_(error.status) {}
    lar_status status() const noexcept { return status_; }

  private:
    lar_status status_;
};

/* Memory of somebody else, as long as that lives. */
template <class T> class Span {
  public:
    Span(const T *data, std::size_t size) : data_(data), size_(size) {}
    const T *data() const { return data_; }
    std::size_t size() const { return size_; }
    const T *begin() const { return data_; }
    const T *end() const { return data_ + size_; }
    const T &operator[](std::size_t i) const { return data_[i]; }

  private:
    const T *data_;
    std::size_t size_;
};

namespace detail {

/* A call of lariat.h whose last argument is the error. */
template <class Call, class... Arguments> void call(Call call, Arguments... arguments) {
    lar_error error;
    error.status = LAR_OK;
    if (call(arguments..., &error) != LAR_OK) throw Error(error);
}
/* The same for one that fills in a T before the error. */
template <class T, class Call, class... Arguments> T ask(Call call, Arguments... arguments) {
    T answer{};
    detail::call(call, arguments..., &answer);
    return answer;
}

inline double (*raw(Vec3 *v))[3] {
    return reinterpret_cast<double(*)[3]>(v);
}
inline const double (*raw(const Vec3 *v))[3] {
    return reinterpret_cast<const double(*)[3]>(v);
}
inline const Vec3 *vectors(const double (*v)[3]) {
    return reinterpret_cast<const Vec3 *>(v);
}

/* What is owned: freed by `destroy`. */
template <class T, void (*destroy)(T *)> class Handle {
  public:
    T *get() const noexcept { return owned_.get(); }

  protected:
    Handle() = default;
    struct Destroy {
        void operator()(T *owned) const noexcept { destroy(owned); }
    };
    std::unique_ptr<T, Destroy> owned_;
};
inline void close(lar_session *session) {
    lar_session_close(session, nullptr);
}
inline void close(lar_results *results) {
    lar_results_close(results, nullptr);
}

/* Steps told to a callable; what it throws is kept until the library has returned, because nothing
 * can be thrown through it. */
template <class Callable> struct Steps {
    Callable &callable;
    std::exception_ptr thrown{};
    static int told(void *context, std::uint64_t step) {
        auto *me = static_cast<Steps *>(context);
        try {
            return me->callable(step) ? 1 : 0;
        } catch (...) {
            me->thrown = std::current_exception();
            return 0;
        }
    }
};

} // namespace detail

inline const char *version() {
    return lar_version();
}
inline std::int32_t version_number() {
    return lar_version_number();
}
/* That the calling thread may use. */
inline std::int32_t usable_cores() {
    return lar_usable_cores();
}
inline void memory_set(const lar_memory_hooks &hooks) {
    detail::call(lar_memory_set, &hooks);
}
/* nullptr: the library's own again. */
inline void threads_set(const lar_thread_hooks *hooks) {
    detail::call(lar_threads_set, hooks);
}
inline void demo_write(const std::string &folder) {
    detail::call(lar_demo_write, folder.c_str());
}
inline lar_options options() {
    return lar_options_default();
}
inline lar_session_options session_options() {
    return lar_session_options_default();
}
inline lar_meshing_options meshing_options() {
    return lar_meshing_options_default();
}
inline lar_checkpoint_info checkpoint_inspect(const std::string &path) {
    return detail::ask<lar_checkpoint_info>(lar_checkpoint_inspect, path.c_str());
}
inline lar_recording_info recording_inspect(const std::string &path) {
    return detail::ask<lar_recording_info>(lar_recording_inspect, path.c_str());
}
inline double time_bin(int bin) {
    return lar_time_bin(bin);
}

/* ---- models -------------------------------------------------------------------------------- */

class Model : public detail::Handle<lar_model, lar_model_destroy> {
  public:
    explicit Model(const std::string &path) {
        owned_.reset(detail::ask<lar_model *>(lar_model_open, path.c_str()));
    }
    static Model from_arrays(const lar_mesh_arrays &mesh, const char *scene = nullptr) {
        Model model;
        model.owned_.reset(detail::ask<lar_model *>(lar_model_from_arrays, &mesh, scene));
        return model;
    }

    lar_model_info inspect() const { return detail::ask<lar_model_info>(lar_model_inspect, get()); }
    std::int32_t node_count() const { return lar_model_node_count(get()); }
    std::int32_t element_count() const { return lar_model_element_count(get()); }
    std::int32_t material_count() const { return lar_model_material_count(get()); }
    const char *source() const { return lar_model_source(get()); }
    Span<Vec3> positions() const {
        return {detail::vectors(lar_model_positions(get())),
                static_cast<std::size_t>(node_count())};
    }
    std::int64_t node_id(std::int32_t node) const { return lar_model_node_id(get(), node); }
    std::int64_t element_id(std::int32_t element) const {
        return lar_model_element_id(get(), element);
    }
    lar_material_info material(std::int32_t index) const {
        return detail::ask<lar_material_info>(lar_model_material, get(), index);
    }
    std::int32_t set_count() const { return lar_model_set_count(get()); }
    lar_set_info set(std::int32_t index) const {
        return detail::ask<lar_set_info>(lar_model_set, get(), index);
    }
    std::int32_t notice_count() const { return lar_model_notice_count(get()); }
    const char *notice_text(std::int32_t index) const {
        return lar_model_notice_text(get(), index);
    }
    lar_surface_info surface() const {
        lar_surface_info info;
        lar_model_surface(get(), &info);
        return info;
    }
    std::int32_t element_material(std::int32_t element) const {
        return lar_model_element_material(get(), element);
    }
    std::int32_t element_fibres(std::int32_t element, double fibre[2][3]) const {
        return lar_model_element_fibres(get(), element, fibre);
    }
    const std::int32_t *element_nodes(std::int32_t element) const {
        return lar_model_element_nodes(get(), element);
    }
    bool embedded(lar_embedded_info &info) const { return lar_model_embedded(get(), &info) != 0; }
    void embedded_move(const Vec3 *u, Vec3 *place) const {
        lar_model_embedded_move(get(), detail::raw(u), detail::raw(place));
    }
    void surface_move(const Vec3 *u, float (*place)[3], float (*normal)[3]) const {
        lar_model_surface_move(get(), detail::raw(u), place, normal);
    }
    /* u NULL: at rest. */
    std::vector<lar_ray_hit> rays(const std::vector<Vec3> &origin,
                                  const std::vector<Vec3> &direction, double longest,
                                  const Vec3 *u = nullptr) const {
        if (origin.size() != direction.size())
            throw std::invalid_argument("rays: as many directions as origins");
        std::vector<lar_ray_hit> hit(origin.size());
        detail::call(lar_model_rays, get(), detail::raw(u), static_cast<std::int32_t>(hit.size()),
                     detail::raw(origin.data()), detail::raw(direction.data()), longest,
                     hit.data());
        return hit;
    }
    bool view(Vec3 &from) const { return lar_model_view(get(), from.data()) != 0; }
    std::int32_t contact_count() const { return lar_model_contact_count(get()); }
    lar_model_contact_info contact(std::int32_t index) const {
        return detail::ask<lar_model_contact_info>(lar_model_contact, get(), index);
    }
    std::int32_t tool_count() const { return lar_model_tool_count(get()); }
    lar_tool_info tool(std::int32_t index) const {
        return detail::ask<lar_tool_info>(lar_model_tool, get(), index);
    }
    unsigned tool_free(std::int32_t index) const { return lar_model_tool_free(get(), index); }
    lar_mesh_quality quality(const char *against = nullptr, double scale = 1) const {
        return detail::ask<lar_mesh_quality>(lar_model_quality, get(), against, scale);
    }
    double output_interval() const { return lar_model_output_interval(get()); }
    double duration() const { return lar_model_duration(get()); }
    double damping() const { return lar_model_damping(get()); }
    bool gravity(double time, Vec3 &gravity) const {
        return lar_model_gravity(get(), time, gravity.data()) != 0;
    }
    bool until_rest() const { return lar_model_until_rest(get()) != 0; }

  private:
    Model() = default;
};

inline lar_grid_choice grid_choose(const Model &model,
                                   const lar_options &options = lariat::options(),
                                   const lar_grid_aim &aim = lar_grid_aim()) {
    return detail::ask<lar_grid_choice>(lar_grid_choose, model.get(), &options, &aim);
}
inline void grid_take(const lar_grid_choice &choice, lar_options &options) {
    lar_grid_take(&choice, &options);
}

/* ---- meshing ------------------------------------------------------------------------------- */

class Image : public detail::Handle<lar_image, lar_image_destroy> {
  public:
    explicit Image(const std::string &path) {
        owned_.reset(detail::ask<lar_image *>(lar_image_open, path.c_str()));
    }
    /* Of memory: from.names of its labels have names. */
    explicit Image(const lar_image_info &from, const char *const *name = nullptr,
                   const std::int32_t *named = nullptr) {
        owned_.reset(detail::ask<lar_image *>(lar_image_create, &from, name, named));
    }
    lar_image_info inspect() const {
        lar_image_info info;
        lar_image_inspect(get(), &info);
        return info;
    }
    const char *name(std::int32_t index, std::int32_t *label = nullptr) const {
        return lar_image_name(get(), index, label);
    }
};

class Meshing : public detail::Handle<lar_meshing, lar_meshing_destroy> {
  public:
    explicit Meshing(const std::vector<std::string> &paths,
                     const lar_meshing_options &options = meshing_options()) {
        std::vector<const char *> path;
        for (const std::string &each : paths) path.push_back(each.c_str());
        owned_.reset(detail::ask<lar_meshing *>(lar_meshing_create, path.data(),
                                                static_cast<std::int32_t>(path.size()), &options));
    }
    explicit Meshing(const Image &image, const lar_meshing_options &options = meshing_options()) {
        owned_.reset(detail::ask<lar_meshing *>(lar_meshing_of_image, image.get(), &options));
    }
    explicit Meshing(const std::vector<lar_surface_arrays> &surfaces,
                     const lar_meshing_options &options = meshing_options()) {
        owned_.reset(detail::ask<lar_meshing *>(lar_meshing_of_surfaces, surfaces.data(),
                                                static_cast<std::int32_t>(surfaces.size()),
                                                &options));
    }
    lar_meshing_info inspect() const {
        lar_meshing_info info;
        lar_meshing_inspect(get(), &info);
        return info;
    }
    lar_region_info region(std::int32_t index) const {
        return detail::ask<lar_region_info>(lar_meshing_region, get(), index);
    }
    /* The triangles of a region's true boundary; *boundary, that may be null, has them too. */
    std::vector<std::array<std::int32_t, 3>> region_boundary(
        std::int32_t index, lar_surface_arrays *boundary = nullptr) const {
        const auto count = lar_meshing_region_boundary(get(), index, nullptr, boundary);
        std::vector<std::array<std::int32_t, 3>> triangles(
            static_cast<std::size_t>(count > 0 ? count : 0));
        if (count > 0)
            lar_meshing_region_boundary(
                get(), index, reinterpret_cast<std::int32_t(*)[3]>(triangles.data()), boundary);
        return triangles;
    }
    /* Both live as long as the meshing. */
    lar_mesh_arrays mesh() const {
        lar_mesh_arrays mesh;
        lar_meshing_arrays(get(), &mesh, nullptr);
        return mesh;
    }
    lar_surface_arrays surface() const {
        lar_surface_arrays surface;
        lar_meshing_arrays(get(), nullptr, &surface);
        return surface;
    }
    std::string scene() const { return detail::ask<const char *>(lar_meshing_scene, get()); }
    /* The path of the scene. */
    std::string write(const std::string &folder) {
        return detail::ask<const char *>(lar_meshing_write, get(), folder.c_str());
    }
};

/* ---- simulations --------------------------------------------------------------------------- */

class Saved;

class Simulation : public detail::Handle<lar_simulation, lar_simulation_destroy> {
  public:
    explicit Simulation(const Model &model, const lar_options &options = lariat::options()) {
        owned_.reset(detail::ask<lar_simulation *>(lar_simulation_create, model.get(), &options));
    }
    /* Another one in the same state, without compiling the model again. */
    Simulation clone() const {
        return Simulation(detail::ask<lar_simulation *>(lar_simulation_clone, get()));
    }
    lar_simulation_info inspect() const {
        lar_simulation_info info;
        lar_simulation_inspect(get(), &info);
        return info;
    }

    void advance(std::uint64_t steps) { detail::call(lar_simulation_advance, get(), steps); }
    /* `callable(step)` after every step; false ends the advance. What it throws comes out of here.
     */
    template <class Callable> void advance_with(std::uint64_t steps, Callable &&callable) {
        detail::Steps<Callable> context{callable};
        lar_error error;
        lar_status status =
            lar_simulation_advance_with(get(), steps, context.told, &context, &error);
        if (context.thrown) std::rethrow_exception(context.thrown);
        if (status != LAR_OK) throw Error(error);
    }
    void serve() { detail::call(lar_simulation_serve, get()); }

    std::int32_t processors() const { return lar_simulation_processors(get()); }
    std::int32_t threads() const { return lar_simulation_threads(get()); }
    std::uint64_t steps() const { return lar_simulation_steps(get()); }
    double time() const { return lar_simulation_time(get()); }
    double time_step() const { return lar_simulation_time_step(get()); }
    const char *isa() const { return lar_simulation_isa(get()); }
    std::uint64_t hash() const { return lar_simulation_hash(get()); }
    lar_energy energy() const {
        lar_energy energy;
        lar_simulation_energy(get(), &energy);
        return energy;
    }
    /* Into an array of all nodes, or into a new one. */
    void displacements(Vec3 *out) const { lar_simulation_displacements(get(), detail::raw(out)); }
    std::vector<Vec3> displacements() const {
        std::vector<Vec3> out(nodes());
        displacements(out.data());
        return out;
    }
    void velocities(Vec3 *out) const { lar_simulation_velocities(get(), detail::raw(out)); }
    std::vector<Vec3> velocities() const {
        std::vector<Vec3> out(nodes());
        velocities(out.data());
        return out;
    }
    std::vector<float> field(lar_field field, const Vec3 *u) const {
        std::vector<float> out(nodes());
        detail::call(lar_simulation_field, get(), field, detail::raw(u), out.data());
        return out;
    }
    double node_value(lar_field field, std::int32_t node, const Vec3 *u) const {
        return detail::ask<double>(lar_simulation_node_value, get(), field, node, detail::raw(u));
    }
    double element_value(lar_field field, std::int32_t element, const Vec3 *u) const {
        return detail::ask<double>(lar_simulation_element_value, get(), field, element,
                                   detail::raw(u));
    }
    /* Cauchy stress [Pa] and Green-Lagrange strain of every element; see lariat.h. */
    std::vector<Vec6> stresses() const { return tensors(true); }
    std::vector<Vec6> strains() const { return tensors(false); }
    /* Forces on all nodes by one cause [N]. */
    std::vector<Vec3> nodal_forces(lar_cause cause, std::int32_t tool = -1) const {
        std::vector<Vec3> force(nodes());
        detail::call(lar_simulation_nodal_forces, get(), cause, tool,
                     reinterpret_cast<double(*)[3]>(force.data()));
        return force;
    }
    /* What touches nodes, per area [Pa], and as a vector; see lariat.h. */
    std::vector<double> contact_pressure() const {
        std::vector<double> pressure(nodes());
        detail::call(lar_simulation_contact_pressure, get(), nullptr, pressure.data());
        return pressure;
    }
    std::vector<Vec3> contact_traction() const {
        std::vector<Vec3> traction(nodes());
        detail::call(lar_simulation_contact_pressure, get(),
                     reinterpret_cast<double(*)[3]>(traction.data()), nullptr);
        return traction;
    }
    void stored_energy(const Vec3 *u, double &strain, double &hourglass) const {
        detail::call(lar_simulation_stored_energy, get(), detail::raw(u), &strain, &hourglass);
    }

    void set_gravity(const Vec3 &g) { detail::call(lar_simulation_set_gravity, get(), g.data()); }
    void set_gravity(std::nullptr_t) { detail::call(lar_simulation_set_gravity, get(), nullptr); }
    void set_damping(double damping) { detail::call(lar_simulation_set_damping, get(), damping); }
    void set_stiffness(std::int32_t material, double factor) {
        detail::call(lar_simulation_set_stiffness, get(), material, factor);
    }
    /* nullptr: all of that material are the model's again. */
    void set_parameter(std::int32_t material, const char *name, double value = 0) {
        detail::call(lar_simulation_set_parameter, get(), material, name, value);
    }
    void activate(std::int32_t material, double value) {
        detail::call(lar_simulation_activate, get(), material, value);
    }
    void set_force(std::int32_t node, const Vec3 &force) {
        detail::call(lar_simulation_set_force, get(), node, force.data());
    }
    void set_force(std::int32_t node, std::nullptr_t) {
        detail::call(lar_simulation_set_force, get(), node, nullptr);
    }
    void set_force_on(const std::string &set, const Vec3 &force) {
        detail::call(lar_simulation_set_force_on, get(), set.c_str(), force.data());
    }
    void set_force_on(const std::string &set, std::nullptr_t) {
        detail::call(lar_simulation_set_force_on, get(), set.c_str(), nullptr);
    }
    void set_support(std::int32_t node, unsigned axes, bool held) {
        detail::call(lar_simulation_set_support, get(), node, axes, held);
    }
    void set_support_on(const std::string &set, unsigned axes, bool held) {
        detail::call(lar_simulation_set_support_on, get(), set.c_str(), axes, held);
    }
    Vec3 gravity() const {
        Vec3 gravity{};
        lar_simulation_gravity(get(), gravity.data());
        return gravity;
    }
    double damping() const { return lar_simulation_damping(get()); }
    double stiffness(std::int32_t material) const {
        return lar_simulation_stiffness(get(), material);
    }
    double parameter(std::int32_t material, const char *name) const {
        return lar_simulation_parameter(get(), material, name);
    }
    double activation(std::int32_t material) const {
        return lar_simulation_activation(get(), material);
    }
    Vec3 force(std::int32_t node) const {
        Vec3 force{};
        lar_simulation_force(get(), node, force.data());
        return force;
    }
    unsigned support(std::int32_t node) const { return lar_simulation_support(get(), node); }

    std::int32_t tool_count() const { return lar_simulation_tool_count(get()); }
    lar_tool_info tool(std::int32_t index) const {
        return detail::ask<lar_tool_info>(lar_simulation_tool, get(), index);
    }
    void tool_move(std::int32_t tool, const lar_tool_pose &pose, std::uint64_t steps) {
        detail::call(lar_simulation_tool_move, get(), tool, &pose, steps);
    }
    /* A hand needs a point. How many points of the surface it has got. */
    std::int32_t grasp(std::int32_t tool, const Vec3 &point, std::uint64_t steps = 0) {
        return detail::ask<std::int32_t>(lar_simulation_grasp, get(), tool, point.data(), steps);
    }
    std::int32_t grasp(std::int32_t tool, std::uint64_t steps) {
        return detail::ask<std::int32_t>(lar_simulation_grasp, get(), tool, nullptr, steps);
    }
    void release(std::int32_t tool, std::uint64_t steps = 0) {
        detail::call(lar_simulation_release, get(), tool, steps);
    }
    lar_tool_pose tool_pose(std::int32_t tool) const {
        return detail::ask<lar_tool_pose>(lar_simulation_tool_pose, get(), tool);
    }
    lar_tool_force tool_force(std::int32_t tool) const {
        return detail::ask<lar_tool_force>(lar_simulation_tool_force, get(), tool);
    }
    std::vector<lar_touch> tool_touches(std::int32_t tool) const {
        auto touches = [&](std::vector<lar_touch> &touch) {
            return detail::ask<std::int32_t>(lar_simulation_tool_touches, get(), tool,
                                             static_cast<std::int32_t>(touch.size()), touch.data());
        };
        std::vector<lar_touch> touch;
        touch.resize(static_cast<std::size_t>(touches(touch)));
        touches(touch);
        return touch;
    }
    std::int32_t add_tool(const lar_tool_info &wanted) {
        return detail::ask<std::int32_t>(lar_simulation_add_tool, get(), &wanted);
    }
    void remove_tool(std::int32_t tool) { detail::call(lar_simulation_remove_tool, get(), tool); }
    std::int32_t step_parts() const { return lar_simulation_step_parts(get()); }
    std::uint64_t divided_steps(std::int32_t *max = nullptr) const {
        return lar_simulation_divided_steps(get(), max);
    }
    std::uint64_t redivisions() const { return lar_simulation_redivisions(get()); }
    lar_heavier heavier() const {
        lar_heavier heavier;
        lar_simulation_heavier(get(), &heavier);
        return heavier;
    }
    lar_contact_info contact() const {
        lar_contact_info info;
        lar_simulation_contact(get(), &info);
        return info;
    }
    /* Nodes that lie inside another body where contact does not see them. */
    std::int32_t contact_inside() const {
        std::int32_t count = 0;
        detail::call(lar_simulation_contact_inside, get(), &count, nullptr);
        return count;
    }
    double contact_distance() const { return lar_simulation_contact_distance(get()); }

    void reset() { detail::call(lar_simulation_reset, get()); }
    void save(const std::string &path) const {
        detail::call(lar_simulation_save, get(), path.c_str());
    }
    void load(const std::string &path) { detail::call(lar_simulation_load, get(), path.c_str()); }
    void save_to(Saved &saved) const;
    void load_from(const Saved &saved);

    double rest_damp() {
        double damping = 0;
        detail::call(lar_rest_damp, get(), &damping);
        return damping;
    }
    void rest_begin(lar_rest &rest) const { lar_rest_begin(&rest, get()); }
    bool rest_look(lar_rest &rest) const { return lar_rest_look(&rest, get()) != 0; }
    /* Throws where the recording and the run differ; `report` says where. */
    void replay(const std::string &path, lar_replay_report *report = nullptr) {
        lar_replay_report mine;
        detail::call(lar_replay, get(), path.c_str(), nullptr, nullptr, report ? report : &mine);
    }

  private:
    explicit Simulation(lar_simulation *owned) { owned_.reset(owned); }
    std::size_t nodes() const {
        return static_cast<std::size_t>(lar_model_node_count(inspect().model));
    }
    std::vector<Vec6> tensors(bool stress) const {
        std::vector<Vec6> all(static_cast<std::size_t>(lar_model_element_count(inspect().model)));
        auto *out = reinterpret_cast<double(*)[6]>(all.data());
        detail::call(lar_simulation_stresses, get(), stress ? out : nullptr,
                     stress ? nullptr : out);
        return all;
    }
};

class Saved : public detail::Handle<lar_saved, lar_saved_destroy> {
  public:
    explicit Saved(const Simulation &simulation) {
        owned_.reset(detail::ask<lar_saved *>(lar_saved_create, simulation.get()));
    }
};
inline void Simulation::save_to(Saved &saved) const {
    detail::call(lar_simulation_save_to, get(), saved.get());
}
inline void Simulation::load_from(const Saved &saved) {
    detail::call(lar_simulation_load_from, get(), saved.get());
}

class Results : public detail::Handle<lar_results, detail::close> {
    Results() = default;

  public:
    /* `surface`: the embedded surface too (lar_results_open_surface). */
    Results(const std::string &folder, const Simulation &simulation, bool surface = false) {
        owned_.reset(
            detail::ask<lar_results *>(surface ? lar_results_open_surface : lar_results_open,
                                       folder.c_str(), simulation.get()));
    }
    /* Behind what the folder has of the run that this simulation goes on from. */
    static Results resume(const std::string &folder, const Simulation &simulation,
                          bool surface = false) {
        Results results;
        results.owned_.reset(detail::ask<lar_results *>(lar_results_resume, folder.c_str(),
                                                        simulation.get(), surface));
        return results;
    }
    void add(const Simulation &simulation) {
        detail::call(lar_results_add, get(), simulation.get());
    }
    int frames() const { return lar_results_frames(get()); }
    /* The destructor does this too, and cannot say what went wrong. */
    void close() { detail::call(lar_results_close, owned_.release()); }
};

/* ---- sessions ------------------------------------------------------------------------------ */

class Session;

class Snapshot : public detail::Handle<lar_snapshot, lar_snapshot_destroy> {
  public:
    explicit Snapshot(const Session &session);
    const lar_snapshot *operator->() const { return get(); }
    Span<Vec3> displacements() const {
        if (!get()) return {nullptr, 0};
        return {detail::vectors(get()->u), static_cast<std::size_t>(get()->nodes)};
    }
    Span<lar_snapshot_tool> tools() const {
        if (!get()) return {nullptr, 0};
        return {get()->tool, static_cast<std::size_t>(get()->tools)};
    }
};

class Session : public detail::Handle<lar_session, detail::close> {
  public:
    explicit Session(Simulation &simulation,
                     const lar_session_options &options = session_options()) {
        owned_.reset(detail::ask<lar_session *>(lar_session_open, simulation.get(), &options));
    }
    void start() { detail::call(lar_session_start, get()); }
    void tick() { detail::call(lar_session_tick, get()); }
    /* The destructor does this too, and cannot say what went wrong. */
    void close() { detail::call(lar_session_close, owned_.release()); }
    lar_session_info inspect() const {
        lar_session_info info;
        lar_session_inspect(get(), &info);
        return info;
    }

    void play() { lar_session_play(get()); }
    void pause() { lar_session_pause(get()); }
    void step(std::uint64_t steps) { lar_session_step(get(), steps); }
    void set_pace(double pace) { lar_session_set_pace(get(), pace); }
    void reset() { detail::call(lar_session_reset, get()); }
    void save(const std::string &path) { detail::call(lar_session_save, get(), path.c_str()); }
    void load(const std::string &path) { detail::call(lar_session_load, get(), path.c_str()); }
    void save_to(Saved &saved) { detail::call(lar_session_save_to, get(), saved.get()); }
    void load_from(const Saved &saved) { detail::call(lar_session_load_from, get(), saved.get()); }
    /* NULL ends a recording. */
    void record(const char *path) { detail::call(lar_session_record, get(), path); }
    void replay(const char *path) { detail::call(lar_session_replay, get(), path); }
    void seek(double seconds) { lar_session_seek(get(), seconds); }

    void set_gravity(const Vec3 &g) { detail::call(lar_session_set_gravity, get(), g.data()); }
    void set_gravity(std::nullptr_t) { detail::call(lar_session_set_gravity, get(), nullptr); }
    void set_damping(double damping) { detail::call(lar_session_set_damping, get(), damping); }
    void set_stiffness(std::int32_t material, double factor) {
        detail::call(lar_session_set_stiffness, get(), material, factor);
    }
    /* nullptr: all of that material are the model's again. */
    void set_parameter(std::int32_t material, const char *name, double value = 0) {
        detail::call(lar_session_set_parameter, get(), material, name, value);
    }
    void activate(std::int32_t material, double value) {
        detail::call(lar_session_activate, get(), material, value);
    }
    void set_force(std::int32_t node, const Vec3 &force) {
        detail::call(lar_session_set_force, get(), node, force.data());
    }
    void set_force(std::int32_t node, std::nullptr_t) {
        detail::call(lar_session_set_force, get(), node, nullptr);
    }
    void set_force_on(const std::string &set, const Vec3 &force) {
        detail::call(lar_session_set_force_on, get(), set.c_str(), force.data());
    }
    void set_force_on(const std::string &set, std::nullptr_t) {
        detail::call(lar_session_set_force_on, get(), set.c_str(), nullptr);
    }
    void set_support(std::int32_t node, unsigned axes, bool held) {
        detail::call(lar_session_set_support, get(), node, axes, held);
    }
    void set_support_on(const std::string &set, unsigned axes, bool held) {
        detail::call(lar_session_set_support_on, get(), set.c_str(), axes, held);
    }
    Vec3 gravity() const {
        Vec3 gravity{};
        lar_session_gravity(get(), gravity.data());
        return gravity;
    }
    double damping() const { return lar_session_damping(get()); }
    double stiffness(std::int32_t material) const { return lar_session_stiffness(get(), material); }
    double activation(std::int32_t material) const {
        return lar_session_activation(get(), material);
    }

    std::int32_t add_tool(const lar_tool_info &wanted) {
        return detail::ask<std::int32_t>(lar_session_add_tool, get(), &wanted);
    }
    void remove_tool(std::int32_t tool) { detail::call(lar_session_remove_tool, get(), tool); }
    lar_tool_info tool_info(std::int32_t tool) const {
        return detail::ask<lar_tool_info>(lar_session_tool_info, get(), tool);
    }
    void tool_move(std::int32_t tool, const lar_tool_pose &pose) {
        detail::call(lar_session_tool_move, get(), tool, &pose);
    }
    /* A hand needs a point. */
    std::int32_t grasp(std::int32_t tool, const Vec3 &point) {
        return detail::ask<std::int32_t>(lar_session_grasp, get(), tool, point.data());
    }
    std::int32_t grasp(std::int32_t tool) {
        return detail::ask<std::int32_t>(lar_session_grasp, get(), tool, nullptr);
    }
    void release(std::int32_t tool) { detail::call(lar_session_release, get(), tool); }
    void ask_grasp(std::int32_t tool, const Vec3 &point, std::uint64_t ticket) {
        detail::call(lar_session_ask_grasp, get(), tool, point.data(), ticket);
    }
    void ask_release(std::int32_t tool) { detail::call(lar_session_ask_release, get(), tool); }
    lar_grasp_answer grasp_answer(std::int32_t tool) const {
        return detail::ask<lar_grasp_answer>(lar_session_grasp_answer, get(), tool);
    }
    lar_tool_force tool_force(std::int32_t tool, lar_tool_pose *pose = nullptr) const {
        return detail::ask<lar_tool_force>(lar_session_tool_force, get(), tool, pose);
    }
    Vec3 tool_felt(std::int32_t tool, Vec3 *torque = nullptr) const {
        Vec3 force{};
        detail::call(lar_session_tool_felt, get(), tool, force.data(),
                     torque ? torque->data() : static_cast<double *>(nullptr));
        return force;
    }
    /* At most `max` points. */
    std::vector<lar_touch> tool_touches(std::int32_t tool, std::int32_t max = 1024) {
        std::vector<lar_touch> touch(static_cast<std::size_t>(max > 0 ? max : 0));
        auto count =
            detail::ask<std::int32_t>(lar_session_tool_touches, get(), tool, max, touch.data());
        if (count < max) touch.resize(static_cast<std::size_t>(count));
        return touch;
    }
    lar_tool_load tool_load(std::int32_t tool) const {
        return detail::ask<lar_tool_load>(lar_session_tool_load, get(), tool);
    }
    void attach(std::int32_t tool, const std::string &device) {
        detail::call(lar_session_attach, get(), tool, device.c_str());
    }
    lar_device_status device(std::int32_t tool) const {
        return detail::ask<lar_device_status>(lar_session_device, get(), tool);
    }
    lar_session_status status() const {
        lar_session_status status;
        lar_session_status_get(get(), &status);
        return status;
    }
    void snapshot(Snapshot &snapshot, double seconds) {
        detail::call(lar_session_snapshot, get(), snapshot.get(), seconds);
    }
    /* Whether what was asked for has come. */
    bool snapshot_poll(Snapshot &snapshot) {
        return detail::ask<std::int32_t>(lar_session_snapshot_poll, get(), snapshot.get()) != 0;
    }
    std::int32_t force_history(std::int32_t tool, std::uint64_t after, std::int32_t max,
                               float (*force)[3], std::uint64_t *last) const {
        return lar_session_force_history(get(), tool, after, max, force, last);
    }
};
inline Snapshot::Snapshot(const Session &session) {
    owned_.reset(detail::ask<lar_snapshot *>(lar_snapshot_create, session.get()));
}

class Server : public detail::Handle<lar_server, lar_server_close> {
  public:
    Server(Session &session, const Model &model,
           const lar_server_options &options = lar_server_options()) {
        owned_.reset(
            detail::ask<lar_server *>(lar_server_open, session.get(), model.get(), &options));
    }
    const char *url() const { return lar_server_url(get()); }
    const char *watch_url() const { return lar_server_watch_url(get()); }
    std::int32_t viewers() const { return lar_server_viewers(get()); }
    static bool has_page() { return lar_server_has_page() != 0; }
};

} // namespace lariat

#endif
