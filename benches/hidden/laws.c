/* What may be hidden: every law draws its numbers, writes them down as truth and sets them in the plant. Sizes are shares of
 * what the base shows in the same record (rms force of the drive and so on), times the size that the case asks for. */
#include "hidden.h"

static double noted(struct drawing *d, const char *name, const char *unit, double value) {
    struct quantity *q = &d->effect->q[d->effect->n++];
    snprintf(q->name, sizeof q->name, "%s", name);
    q->unit = unit, q->value = value;
    return value;
}

static double share(struct drawing *d, double low, double high) { return d->size * scaled(d->c, low, high); }

static enum shape one_of(struct drawing *d, int n, const enum shape *shapes) {
    static const char *NAMES[] = {
        [NONE] = "", [EXPONENTIAL] = "exponential", [GAUSSIAN] = "Gaussian", [LORENTZIAN] = "Lorentzian", [THESIS] = "share lagged, then squared",
        [LEVEL] = "level lagged", [DISTANCE] = "speed lagged over a distance", [DAHL] = "Dahl", [LUGRE] = "LuGre", [ELASTOPLASTIC] = "elastoplastic",
        [LOGARITHMIC] = "logarithmic", [HARD] = "hard", [SOFT] = "tanh", [SPRING] = "one-sided spring and damper",
        [REBOUND] = "restitution", [LINEAR] = "linear", [CURVED] = "saturating exponential",
        [ROOT] = "square root", [LIMIT] = "limit", [WEIR] = "weir"};
    enum shape shape = shapes[below(d->c, n)];
    d->effect->shape = NAMES[shape];
    return shape;
}
#define SHAPE(d, ...) one_of(d, sizeof((enum shape[]){__VA_ARGS__}) / sizeof(enum shape), (enum shape[]){__VA_ARGS__})

static int mechanical(const struct drawing *d) { return d->system->family <= OSCILLATOR; }
static const char *force_unit(const struct drawing *d) {
    return mechanical(d) ? "N" : d->system->family == HEATER ? "W" : "m3/s";
}
static const char *force_rate_unit(const struct drawing *d) {
    return mechanical(d) ? "N/s" : d->system->family == HEATER ? "W/s" : "m3/s2";
}
static void behind_drive(struct drawing *d) { d->effect->junction = d->system->drive; }

/* Flows may go into either of two tanks. */
static void into_a_tank(struct drawing *d) {
    if (d->system->family == TANKS && odds(d->c, 0.5)) d->plant->second = 1;
    if (d->plant->second) d->effect->junction = d->system->second_junction;
}

/* ---- friction */

/* F = -Fc sign v; at rest whatever balances, up to Fc (Coulomb 1785). */
static void coulomb(struct drawing *d) { d->plant->coulomb = noted(d, "Fc", "N", d->at->force * share(d, 0.03, 0.3)); }

/* F = -f v. */
static void viscous(struct drawing *d) {
    double ratio = share(d, 0.01, 0.1), spring = 2 * ratio * sqrt(d->plant->k * d->plant->M);
    d->plant->f += noted(d, "c", "N s/m", d->system->family == OSCILLATOR ? spring : 5 * ratio * d->at->force / d->at->velocity);
}

/* F = -(Fc + dF g(|v| / Vs)) sign v (Stribeck 1902); over a base with Coulomb friction the fall alone. */
static void falling(struct drawing *d) {
    struct plant *p = d->plant;
    double most = d->at->force * share(d, 0.06, 0.4), rest = p->Fc > 0 ? 0 : even(d->c, 0.1, 0.6);
    p->falling = SHAPE(d, EXPONENTIAL, GAUSSIAN, LORENTZIAN);
    p->falling_to = noted(d, "Fc", "N", most * rest);
    p->falling_by = noted(d, "dF", "N", most * (1 - rest));
    p->falling_velocity = noted(d, "Vs", "m/s", d->at->velocity * scaled(d->c, 0.1, 0.7));
}

/* Friction follows its steady level with a lag: thesis Fig 8.15 and 8.16; or over a distance (Ruina's slip law 1983). Where the base
 * has no falling friction, one comes with it, and the level lags. */
static void memory(struct drawing *d) {
    struct plant *p = d->plant;
    double time = d->system->dt * d->inner * scaled(d->c, 3, 40);
    if (p->Fs == 0) falling(d), p->memory = LEVEL;
    else time *= d->size, p->memory = SHAPE(d, THESIS, LEVEL, DISTANCE);
    if (p->memory == DISTANCE) p->memory_distance = noted(d, "L", "m", time * p->VcL);
    else p->memory_time = noted(d, "Tc", "s", time);
}

/* A Coulomb friction that comes with an effect where the base has none. */
static double own_coulomb(struct drawing *d) {
    return d->plant->Fc > 0 ? d->plant->Fc : noted(d, "Fc", "N", d->at->force * share(d, 0.06, 0.3));
}

/* Friction at rest grows with the time of rest, 1 - exp (Kato 1972) or ln (Rabinowicz 1958), and falls back at once in motion. */
static void growth(struct drawing *d) {
    struct plant *p = d->plant;
    double sliding = own_coulomb(d);
    if (p->Fc == 0) p->coulomb = sliding;
    p->growing = SHAPE(d, EXPONENTIAL, LOGARITHMIC);
    p->growth = noted(d, "dF", "N", sliding * fmin(2.5, (p->Fc > 0 ? d->size : d->inner) * scaled(d->c, 0.2, 1.5)));
    p->growth_time = noted(d, "Tg", "s", d->system->dt * d->system->period * scaled(d->c, 0.1, 1.5));
}

/* F = -(f + a sign v) v. */
static void asymmetric(struct drawing *d) {
    d->plant->asymmetry = noted(d, "d", "N s/m", sign_of_chance(d->c) * d->plant->f * fmin(0.8, share(d, 0.08, 0.7)));
}

/* F = -c v |v|. */
static void quadratic(struct drawing *d) {
    d->plant->quadratic = noted(d, "c", "N s2/m2", share(d, 0.03, 0.4) * d->at->force / (d->at->velocity * d->at->velocity));
}

/* Friction yields over a way D before it slides: bristles, in the place of the base's brake. They are long enough for the steps
 * of a run: at full speed one bends to its most in 1.2 steps. */
static void presliding(struct drawing *d) {
    struct plant *p = d->plant;
    double fastest = 1.3 * fmax(d->at->top[V], -d->at->low[V]), least = 1.2 * fastest * d->system->dt / TRUTH_STEPS;
    double reach = d->system->family == SLIDE ? d->at->force / p->K : 0.05 * (d->at->top[X] - d->at->low[X]);
    double by = p->Fc > 0 ? d->size : d->inner;
    p->bristle_level = own_coulomb(d), p->Fc = 0;
    p->bristle = SHAPE(d, DAHL, LUGRE, ELASTOPLASTIC);
    p->bristle_stiffness = p->bristle_level / noted(d, "D", "m", fmax(least, reach * by * scaled(d->c, 0.02, 0.3)));
    if (p->bristle != DAHL) p->bristle_damping = noted(d, "damping", "N s/m", 0.3 * sqrt(p->bristle_stiffness * p->M));
}

/* Level mu |force of the drive| (Amontons: the load is what the drive presses on). */
static void load_dependent(struct drawing *d) { d->plant->load = noted(d, "mu", "1", fmin(0.6, share(d, 0.03, 0.3))); }

/* ---- forces of position */

/* Play operator (Krasnosel'skii, Pokrovskii): in the way of a drive that gives a velocity, else in what the drive gives. */
static void backlash(struct drawing *d) {
    int slide = d->system->family == SLIDE;
    double reach = slide ? d->at->force / d->plant->K : d->at->drive;
    d->plant->play = noted(d, slide ? "w" : "b", slide ? "m" : d->system->drive_unit, 2 * reach * share(d, 0.03, 0.3)) / 2;
    behind_drive(d);
}

/* F = -k3 x^3 (Duffing 1918); slide: the drive's spring hardens, F = K e - k3 e^3 with k3 below 0. */
static void cubic(struct drawing *d) {
    struct plant *p = d->plant;
    int slide = d->system->family == SLIDE;
    double spring = slide ? -p->K : p->k, reach = slide ? d->at->force / p->K : 0.35 * (d->at->top[X] - d->at->low[X]);
    d->effect->shape = slide ? "of the error" : "of the position";
    p->cubic = noted(d, "k3", "N/m3", spring * share(d, 0.05, 0.6) / (reach * reach));
}

/* One-sided spring with damper, or Newton's restitution, where the position passes the stop. */
static void hard_stop(struct drawing *d) {
    struct plant *p = d->plant;
    double up = d->at->top[X] - d->at->first[X], down = d->at->first[X] - d->at->low[X];
    double side = fmin(up, down) < 0.5 * fmax(up, down) ? (up > down ? 1 : -1) : sign_of_chance(d->c);
    double inside = fmax(0.3, 1 - 0.3 * share(d, 0.2, 1)), rate = 2 * M_PI / (d->system->dt * even(d->c, 8, 30));
    p->stop = SHAPE(d, SPRING, REBOUND), p->stop_side = side;
    p->stop_at = side * d->at->first[X] + inside * (side > 0 ? up : down);
    noted(d, "xs", "m", p->stop_at), noted(d, "side", "1", side);
    if (p->stop == REBOUND) p->rebound = noted(d, "restitution", "1", even(d->c, 0, 0.8));
    else {
        p->stop_stiffness = noted(d, "k", "N/m", p->M * rate * rate);
        p->stop_damping = noted(d, "damping", "N s/m", 2 * even(d->c, 0.05, 0.4) * p->M * rate);
    }
}

/* ---- behind the drive */

/* The drive gives no more than a limit: cut off, or L tanh(u / L). */
static void saturation(struct drawing *d) {
    struct plant *p = d->plant;
    double top = d->at->drive_peak, how = share(d, 0.05, 0.5);
    p->limiting = SHAPE(d, HARD, SOFT);
    p->limit = noted(d, "L", d->system->drive_unit, p->limiting == HARD ? top * fmax(0.3, 1 - how) : top / fmin(2.5, 3 * how));
    behind_drive(d);
}

/* Nothing within +-b, u - b beyond; or u - b tanh(u / b), whose ends are the same. */
static void dead_zone(struct drawing *d) {
    d->plant->dead_shape = SHAPE(d, HARD, SOFT);
    d->plant->dead = noted(d, "b", d->system->drive_unit, d->at->drive * share(d, 0.03, 0.35));
    behind_drive(d);
}

/* u(t - T); before the record the drive stood at its first value. */
static void delay(struct drawing *d) {
    d->plant->delay = noted(d, "T", "s", d->system->dt * fmin(0.25 * d->system->period, share(d, 0.4, 10)));
    behind_drive(d);
}

/* T y' = u - y. */
static void lag(struct drawing *d) {
    d->plant->lag = noted(d, "T", "s", d->system->dt * share(d, 0.4, 12));
    behind_drive(d);
}

/* ---- forces of time */

static void bias(struct drawing *d) {
    into_a_tank(d);
    d->plant->bias = noted(d, "b", force_unit(d), sign_of_chance(d->c) * d->at->force * share(d, 0.02, 0.25));
}

/* Linear in time, or F (1 - exp(-t / T)). */
static void drift(struct drawing *d) {
    struct plant *p = d->plant;
    double top = sign_of_chance(d->c) * d->at->force * share(d, 0.04, 0.4);
    into_a_tank(d);
    p->drifting = SHAPE(d, LINEAR, CURVED), p->drift = top;
    if (p->drifting == LINEAR) p->drift_time = d->length, noted(d, "r", force_rate_unit(d), top / d->length);
    else noted(d, "end", force_unit(d), top), p->drift_time = noted(d, "T", "s", d->length * even(d->c, 0.3, 0.8));
}

/* a sin(2 pi f t) + b cos(2 pi f t). */
static void periodic(struct drawing *d) {
    struct plant *p = d->plant;
    into_a_tank(d);
    p->wave = d->at->force * share(d, 0.03, 0.35), p->wave_phase = even(d->c, 0, 2 * M_PI);
    noted(d, "a", force_unit(d), p->wave * cos(p->wave_phase)), noted(d, "b", force_unit(d), p->wave * sin(p->wave_phase));
    p->wave_rate = 2 * M_PI * noted(d, "f", "Hz", scaled(d->c, 0.2, 3) / (d->system->period * d->system->dt));
}

/* Another mass from an instant on; from the beginning where the mass is not fitted. Momentum is not kept: velocity is. */
static void mass_change(struct drawing *d) {
    struct plant *p = d->plant;
    p->mass_factor = 1 + share(d, 0.05, 0.6);
    if (odds(d->c, 0.4)) p->mass_factor = 1 / p->mass_factor;
    if (!d->mass_known) p->mass_time = d->system->dt * round(even(d->c, 0.15, 0.4) * d->length / d->system->dt);
    d->effect->shape = d->mass_known ? "from the beginning" : "step";
    noted(d, "r", "1", p->mass_factor - 1);
    if (!d->mass_known) noted(d, "t1", "s", p->mass_time);
}

/* ---- tanks and heater */

/* Out of a tank c h or c sqrt(h) (Torricelli 1643); out of a body c T. */
static void leak(struct drawing *d) {
    struct plant *p = d->plant;
    double top = d->at->top[0], content = d->system->family == HEATER ? p->capacity : p->A1;
    double linear = d->system->family == TANKS ? share(d, 0.04, 0.4) / p->R1 : content / d->length * share(d, 0.1, 2);
    p->leaking = d->system->family == HEATER ? SHAPE(d, LINEAR) : SHAPE(d, LINEAR, ROOT);
    const char *unit = d->system->family == HEATER ? "W/K" : p->leaking == ROOT ? "m2.5/s" : "m2/s";
    p->leak = noted(d, p->leaking == ROOT ? "c" : "g", unit, p->leaking == ROOT ? linear * sqrt(0.5 * top) : linear);
}

/* The upper tank holds no more than a height, or flows over a weir (Poleni 1717); a share of it falls into the lower one. */
static void overflow(struct drawing *d) {
    struct plant *p = d->plant;
    p->overflowing = SHAPE(d, LIMIT, WEIR);
    p->overflow_at = noted(d, "L", "m", d->at->top[H1] * fmax(0.4, 1 - 0.3 * share(d, 0.3, 1.5)));
    p->overflow_share = noted(d, "s", "1", even(d->c, 0.2, 1));
    if (p->overflowing == WEIR) p->weir = noted(d, "w", "m1.5/s", d->at->force / pow(even(d->c, 0.02, 0.06) * d->at->top[H1], 1.5));
}

/* ---- not in the library */

/* Gaussian hills of force over position, as worn or dirty guides have them. */
static void position_bumps(struct drawing *d) {
    struct plant *p = d->plant;
    double low = d->at->low[X], range = d->at->top[X] - low, height = d->at->force * share(d, 0.1, 0.6);
    p->bump_width = noted(d, "width", "m", range / even(d->c, 15, 40));
    for (int i = 0; i < BUMPS; i++) {
        char name[16];
        snprintf(name, sizeof name, "at%d", i + 1);
        p->bump_at[i] = noted(d, name, "m", low + range * (i + even(d->c, 0, 1)) / BUMPS);
        snprintf(name, sizeof name, "height%d", i + 1);
        p->bump[i] = noted(d, name, "N", height * sign_of_chance(d->c) * even(d->c, 0.4, 1));
    }
}

/* Force that wanders as a random walk; another one in every record. */
static void random_walk(struct drawing *d) { d->plant->walk = noted(d, "rms", force_unit(d), d->at->force * share(d, 0.03, 0.3)); }

/* A relay with hysteresis adds its side to the drive. */
static void relay(struct drawing *d) {
    d->plant->relay = noted(d, "height", d->system->drive_unit, d->at->drive * share(d, 0.03, 0.4));
    d->plant->relay_at = noted(d, "threshold", d->system->drive_unit, d->at->drive * even(d->c, 0.1, 0.6));
    behind_drive(d);
}

/* The base's friction or loss (tanks: lower resistance) begins too large by a share, which dies away. */
static void thaw(struct drawing *d) {
    d->plant->thaw = noted(d, "share", "1", share(d, 0.3, 2));
    d->plant->thaw_time = noted(d, "T", "s", d->length * even(d->c, 0.1, 0.35));
    if (d->system->family == TANKS) d->effect->junction = d->system->second_junction;
}

/* Short blows at instants of chance; others in every record. */
static void shocks(struct drawing *d) { d->plant->shock = noted(d, "height", force_unit(d), d->at->force * share(d, 0.3, 2)); }

const struct law LAWS[] = {
    {"coulomb-friction", coulomb}, {"viscous-friction", viscous}, {"stribeck-friction", falling}, {"friction-memory", memory},
    {"static-friction-growth", growth}, {"asymmetric-viscous-friction", asymmetric}, {"quadratic-drag", quadratic},
    {"presliding-stiffness", presliding}, {"backlash", backlash}, {"cubic-stiffness", cubic}, {"hard-stop", hard_stop},
    {"saturation", saturation}, {"drive-dead-zone", dead_zone}, {"time-delay", delay}, {"actuator-lag", lag}, {"constant-bias", bias},
    {"drift", drift}, {"periodic-disturbance", periodic}, {"mass-change", mass_change}, {"load-dependent-friction", load_dependent},
    {"leak", leak}, {"overflow", overflow},
    {"unknown:bumps", position_bumps}, {"unknown:random-walk", random_walk}, {"unknown:relay-hysteresis", relay},
    {"unknown:slow-thaw", thaw}, {"unknown:shocks", shocks},
};
const int LAW_COUNT = sizeof LAWS / sizeof *LAWS;

const struct law *law_named(const char *name) {
    for (int i = 0; i < LAW_COUNT; i++)
        if (!strcmp(LAWS[i].name, name)) return &LAWS[i];
    fprintf(stderr, "%s: no such law\n", name);
    exit(2);
}
