#include "session/coupling.h"

#include <math.h>
#include <string.h>

#include "base/quaternion.h"

/* A device like a PHANToM (Massie and Salisbury 1994) gives 8.5 N at most and weighs 75 g. */
static const double STIFFNESS = 1000, MASS = 0.02; /* [N/m] [kg] */
static const double FEEL_MAX = 8;                  /* [N] */
static const double TORQUE_MAX = 0.2;              /* [N m] */
static const double TURN_MAX = 20;                 /* [rad/s] */
static const double LEVER_MIN = 0.05;              /* [m] */
static const double ACCELERATION = 100;            /* of a hand, at most [m/s^2] */
static const double LIVELY = 4;                    /* times the change of lately */
static const double SMOOTH = 0.004;                /* of the hand's velocity [s] */
static const double REMEMBER = 0.1;                /* how far the hand went in a tick [s] */
static const double JUMP = 2;                      /* no hand goes so fast [m/s] */
static const double FORGET = 0.05;                 /* how stiff the tissue was [s] */
static const double CREDIT = 5e-4, REFILL = 1e-3;  /* [J] [W] */
static const double PAID_MAX = 0.1;                /* that a hand has put in, at most [J] */
static const double STIFFEST = 1e5;                /* [N/m] */
static const double REACH = 0.5; /* of its radius, a tool's way in a step (lariat.h) */
static const double CLOSES = 0.25;

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Shortens a vector to `max`. True when it was longer. */
static bool shorten(double v[3], double max) {
    double length = length_of(v);
    if (length <= max) return false;
    for (int i = 0; i < 3; i++) v[i] *= max / length;
    return true;
}

void lar_coupling_create(lar_coupling *coupling, const lar_tool_info *tool,
                         const lar_coupling_limits *limits) {
    /* Some room below what the engine refuses: the turn and the jaws take their parts too. */
    double engine = REACH * tool->radius / limits->time_step;
    double jaw = 0.5 * tool->length * tool->spread; /* way of a jaw's end from open to closed */
    double share = jaw > 0 ? 0.3 : 0.4;             /* of a way, a turn, and jaws */
    double pull = tool->shape == LAR_TOOL_HAND ? limits->hand_force : FEEL_MAX;
    *coupling = (lar_coupling){.shape = tool->shape,
                               .mass = MASS,
                               .stiffness = STIFFNESS,
                               .damping = 2 * sqrt(STIFFNESS * MASS),
                               .lever = fmax(tool->length, LEVER_MIN),
                               .jaw = jaw,
                               .speed_max = fmin(limits->tool_speed, share * engine),
                               .pull = pull,
                               .feel = fmin(pull, FEEL_MAX),
                               .feel_torque = TORQUE_MAX,
                               .rate = LAR_COUPLING_RATE,
                               .seconds = limits->seconds,
                               .credit = CREDIT};
    lar_coupling_set_speed(coupling, INFINITY);
    lar_coupling_reset(coupling, &tool->rest);
}

void lar_coupling_set_speed(lar_coupling *c, double speed) {
    c->speed = fmin(speed, c->speed_max);
    c->turn = fmin(TURN_MAX, c->speed / c->lever);
    c->squeeze = c->jaw > 0 ? c->speed / c->jaw : INFINITY;
    c->drag = c->pull / c->speed;
}

void lar_coupling_greet(lar_coupling *c) {
    c->energy = fmax(c->energy, c->credit);
    c->paid = fmax(c->paid, c->credit);
    c->turn_paid = fmax(c->turn_paid, c->credit);
    c->held_back[0] = c->held_back[1] = 0;
    c->steps = c->turns = (lar_coupling_ways){.last = {0}};
}

void lar_coupling_reset(lar_coupling *c, const lar_tool_pose *pose) {
    c->hand = c->end = c->tool = *pose;
    c->begun = false;
    c->held = 0;
    c->energy = c->paid = c->turn_paid = c->credit;
    c->share = 1;
    c->given = c->tissue_stiffness = c->held_back[0] = c->held_back[1] = 0;
    c->steps = c->turns = (lar_coupling_ways){.last = {0}};
    for (int i = 0; i < 3; i++)
        c->hand_velocity[i] = c->tool_velocity[i] = c->tissue[i] = c->way[i] = c->spring[i] =
            c->felt[i] = c->turned[i] = 0;
}

/* ---- where the tool goes --------------------------------------------------------------------- */

/* The hand goes so far in this tick; the farthest of the last time, to both sides of each axis. */
static void remember(const lar_coupling *c, lar_coupling_ways *ways, const double step[3],
                     double jump) {
    double keep = 1 - c->seconds / (REMEMBER + c->seconds), change[3];
    for (int i = 0; i < 3; i++) {
        double back = fabs(step[i]) > jump ? -step[i] : 0; /* it may jump back */
        change[i] = step[i] - ways->last[i];
        ways->last[i] = step[i];
        ways->most[i] = fmax(fmax(step[i], back), ways->most[i] * keep);
        ways->least[i] = fmin(fmin(step[i], back), ways->least[i] * keep);
    }
    ways->change = fmax(length_of(change), ways->change * keep);
}

/* How fast the spring's end goes on the hand's side. */
static void move_end(lar_coupling *c, const lar_tool_pose *end) {
    double share = c->seconds / (SMOOTH + c->seconds), change[3];
    for (int i = 0; i < 3; i++) {
        double step = c->begun ? end->position[i] - c->end.position[i] : 0;
        change[i] = share * (step / c->seconds - c->hand_velocity[i]);
    }
    /* Positions that come late come in bunches: that is a jump, not a blow. */
    shorten(change, ACCELERATION * c->seconds);
    for (int i = 0; i < 3; i++) c->hand_velocity[i] += change[i];
    c->end = *end;
}

/* The hand has moved, with the force that it was given before, and still holds: what it has put in.
 */
static void move_hand(lar_coupling *c, const lar_tool_pose *hand) {
    double step[3] = {0}, turn[3] = {0};
    if (c->begun) {
        lar_quaternion_turn(c->hand.orientation, hand->orientation, turn);
        for (int i = 0; i < 3; i++) step[i] = hand->position[i] - c->hand.position[i];
    }
    remember(c, &c->steps, step, JUMP * c->seconds);
    remember(c, &c->turns, turn, JUMP * c->seconds / c->lever);
    double work = dot(c->felt, step);
    c->energy -= work;
    c->paid -= work;
    c->turn_paid -= dot(c->turned, turn);
    c->hand = *hand;
    c->begun = true;
}

/* The velocity at the end of the tick, when a spring of force `s0 + ds v` acts: ds < 0. */
static void solve(const lar_coupling *c, const double s0[3], double ds, double v[3]) {
    double inertia = c->mass / c->seconds;
    /* The force came with the last tick's motion: half of it is older still. */
    double tissue = 1.5 * c->tissue_stiffness * c->seconds;
    for (int i = 0; i < 3; i++)
        v[i] = (inertia * c->tool_velocity[i] + s0[i] + c->tissue[i]) / (inertia - ds + tissue);
}

static void pull_tool(lar_coupling *c) {
    double apart[3], s0[3], v[3];
    double k = c->stiffness, b = c->damping, t = c->seconds;
    for (int i = 0; i < 3; i++) {
        apart[i] = c->end.position[i] - c->tool.position[i];
        s0[i] = k * apart[i] + b * c->hand_velocity[i];
    }
    solve(c, s0, -(k * t + b), v);
    for (int i = 0; i < 3; i++) c->spring[i] = s0[i] - (k * t + b) * v[i];
    if (shorten(c->spring, c->pull)) solve(c, c->spring, -c->drag, v);
    shorten(v, c->speed);
    for (int i = 0; i < 3; i++) {
        c->tool_velocity[i] = v[i];
        c->way[i] = t * v[i];
        c->tool.position[i] += c->way[i];
    }
}

static void turn_tool(lar_coupling *c) {
    double angle = lar_quaternion_angle(c->tool.orientation, c->end.orientation);
    double max = c->turn * c->seconds;
    lar_quaternion_blend(c->tool.orientation, c->end.orientation, angle > max ? max / angle : 1,
                         c->tool.orientation);
}

/* A hand that holds nothing has nothing to feel: it is where it is wanted. */
static void put_hand(lar_coupling *c) {
    double jump[3];
    for (int i = 0; i < 3; i++) jump[i] = c->end.position[i] - c->tool.position[i];
    bool closes = c->tool.opening >= CLOSES && c->end.opening < CLOSES;
    double opening = closes && length_of(jump) > 0 ? c->tool.opening : c->end.opening;
    c->tool = c->end;
    c->tool.opening = opening;
    for (int i = 0; i < 3; i++) c->tool_velocity[i] = c->way[i] = c->spring[i] = c->tissue[i] = 0;
}

/* What moves nodes goes where it is asked to, as fast as tools go: it has no limit to stay behind,
 * and a spring between it and the hand would swing with the tissue. */
static void lead_nodes(lar_coupling *c) {
    for (int i = 0; i < 3; i++) c->way[i] = c->end.position[i] - c->tool.position[i];
    shorten(c->way, c->speed * c->seconds);
    for (int i = 0; i < 3; i++) {
        c->tool.position[i] += c->way[i];
        c->tool_velocity[i] = c->spring[i] = 0;
    }
}

void lar_coupling_follow(lar_coupling *coupling, const lar_tool_pose *hand,
                         const lar_tool_pose *evenly, lar_tool_pose *tool) {
    move_end(coupling, evenly ? evenly : hand);
    move_hand(coupling, hand);
    if (coupling->shape == LAR_TOOL_HAND && coupling->held == 0) {
        put_hand(coupling);
    } else {
        if (coupling->shape == LAR_TOOL_RIGID)
            lead_nodes(coupling);
        else
            pull_tool(coupling);
        turn_tool(coupling);
        double max = coupling->squeeze * coupling->seconds;
        double change = hand->opening - coupling->tool.opening;
        coupling->tool.opening += fmax(-max, fmin(max, change));
    }
    *tool = coupling->tool;
}

/* ---- what the hand feels --------------------------------------------------------------------- */

/* From two forces and the way between them; forgotten slowly, for a touch comes and goes. */
static void see_stiffness(lar_coupling *c, const double force[3]) {
    enum { MIN_WAY_NM = 1000 };
    double change[3], way = length_of(c->way);
    for (int i = 0; i < 3; i++) change[i] = force[i] - c->tissue[i];
    c->tissue_stiffness *= 1 - c->seconds / (FORGET + c->seconds);
    if (way > 1e-9 * MIN_WAY_NM)
        c->tissue_stiffness = fmax(c->tissue_stiffness, length_of(change) / way);
    c->tissue_stiffness = fmin(c->tissue_stiffness, STIFFEST);
}

/* The tissue has done this work on the tool, or the tool on the tissue. What the hand has felt only
 * a share of, it has paid only that share of; the rest was given, and comes back to nobody. */
static void settle(lar_coupling *c, double work) {
    if (work < 0) {
        c->energy += c->share * work;
        c->given -= (1 - c->share) * work;
    } else {
        double back = fmin(work, c->given);
        c->given -= back;
        c->energy += work - back;
    }
}

static double refill(const lar_coupling *c, double account, double max) {
    if (account < c->credit) account += REFILL * c->seconds;
    return fmin(account, max);
}

/* How much farther than in the last tick the hand may go in the next one: `strength` is what its
 * strength allows. Accounts at rest bear that with any force when it is no more than `rest`. Else
 * it goes by what the hand did lately, and by `still`, which the credit bears. */
static double may_change(const lar_coupling_ways *ways, double strength, double rest,
                         double still) {
    if (strength <= rest) return strength;
    return fmin(strength, fmax(still, LIVELY * ways->change));
}

/* Shortens a force or torque to what an account bears when the hand goes on with it as far as in
 * any tick of the last time, or as in the last one and what a hand's strength may change. Returns
 * the share that is lost: all while the account is overdrawn. */
static double hold_back(double felt[3], double account, const lar_coupling_ways *ways,
                        double change) {
    double far = 0, share = 1;
    double next = dot(felt, ways->last) + length_of(felt) * change;
    for (int i = 0; i < 3; i++) far += fmax(felt[i] * ways->most[i], felt[i] * ways->least[i]);
    far = fmax(far, next);
    if (account < far) share = fmax(0, account / far);
    for (int i = 0; i < 3; i++) felt[i] *= share;
    return 1 - share;
}

/* No more than what the hand and the tissue have put in: see the head of coupling.h. */
static void pay(lar_coupling *c) {
    double stored = 0.5 * dot(c->spring, c->spring) / c->stiffness +
                    0.5 * c->mass * dot(c->tool_velocity, c->tool_velocity);
    double strength = ACCELERATION * c->seconds * c->seconds, turned = c->credit / TORQUE_MAX;
    /* At rest the account has f^2 / 2 k + credit: that pays for f times this way, and more. */
    double rest = sqrt(0.5 * c->credit / c->stiffness);
    double step = may_change(&c->steps, strength, rest, c->credit / FEEL_MAX);
    double turn = may_change(&c->turns, strength / c->lever, turned, turned);
    c->paid = refill(c, c->paid, PAID_MAX);
    c->turn_paid = refill(c, c->turn_paid, PAID_MAX);
    c->energy = refill(c, c->energy, stored + c->credit);
    /* An overdraft is forgiven to a hand that has not got more than it gave all the same. */
    c->energy = fmax(c->energy, fmin(0, c->paid));
    /* Without a spring nothing is stored between hand and tissue. */
    if (c->shape == LAR_TOOL_RIGID) c->energy = c->paid;
    c->held_back[0] = hold_back(c->felt, c->energy, &c->steps, step);
    c->held_back[1] = hold_back(c->turned, c->turn_paid, &c->turns, turn);
}

void lar_coupling_approach(double felt[3], const double wanted[3], double max) {
    double change[3];
    for (int i = 0; i < 3; i++) change[i] = wanted[i] - felt[i];
    shorten(change, max);
    for (int i = 0; i < 3; i++) felt[i] += change[i];
}

void lar_coupling_set_rate(lar_coupling *coupling, double rate) {
    coupling->rate = rate;
}

void lar_coupling_feel(lar_coupling *coupling, const lar_tool_force *force, double passed,
                       lar_tool_force *felt) {
    lar_coupling *c = coupling;
    settle(c, dot(force->force, c->way));
    see_stiffness(c, force->force);
    memcpy(c->tissue, force->force, sizeof c->tissue);
    c->held = force->held;
    double wanted[3], torque[3], max = c->rate * passed;
    const bool moves = c->shape == LAR_TOOL_RIGID;
    for (int i = 0; i < 3; i++) wanted[i] = moves ? force->force[i] : -c->spring[i];
    shorten(wanted, c->feel);
    lar_coupling_approach(c->felt, wanted, max);
    memcpy(torque, force->torque, sizeof torque);
    shorten(torque, c->feel_torque);
    lar_coupling_approach(c->turned, torque, LAR_COUPLING_RATE_LEVER * max);
    pay(c);
    double all = length_of(wanted);
    c->share = all > 0 ? fmin(1, length_of(c->felt) / all) : 1;
    *felt = *force;
    memcpy(felt->force, c->felt, sizeof felt->force);
    memcpy(felt->torque, c->turned, sizeof felt->torque);
}
