/* The laws of hidden effects. Each draws its parameters, records them as truth and sets them in the plant. Sizes are shares of
 * quantities of the base in the same record (such as the rms force of the drive), times the size factor of the case. */
#include "hidden.h"

static double record_quantity(struct draw_context *d, const char *name, const char *unit, double value) {
    struct quantity *q = &d->effect->q[d->effect->n++];
    snprintf(q->name, sizeof q->name, "%s", name);
    q->unit = unit, q->value = value;
    return value;
}

static double random_share(struct draw_context *d, double low, double high) { return d->size * log_uniform(d->c, low, high); }

static enum shape choose_shape(struct draw_context *d, int n, const enum shape *shapes) {
    static const char *NAMES[] = {
        [NONE] = "", [EXPONENTIAL] = "exponential", [GAUSSIAN] = "Gaussian", [LORENTZIAN] = "Lorentzian", [THESIS] = "share lagged, then squared",
        [LEVEL] = "level lagged", [DISTANCE] = "speed lagged over a distance", [DAHL] = "Dahl", [LUGRE] = "LuGre", [ELASTOPLASTIC] = "elastoplastic",
        [LOGARITHMIC] = "logarithmic", [HARD] = "hard", [SOFT] = "tanh", [SPRING] = "one-sided spring and damper",
        [REBOUND] = "restitution", [LINEAR] = "linear", [CURVED] = "saturating exponential",
        [ROOT] = "square root", [LIMIT] = "limit", [WEIR] = "weir"};
    enum shape shape = shapes[random_below(d->c, n)];
    d->effect->shape = NAMES[shape];
    return shape;
}
#define SHAPE(d, ...) choose_shape(d, sizeof((enum shape[]){__VA_ARGS__}) / sizeof(enum shape), (enum shape[]){__VA_ARGS__})

static int mechanical(const struct draw_context *d) { return d->system->family <= OSCILLATOR; }
static const char *force_unit(const struct draw_context *d) {
    return mechanical(d) ? "N" : d->system->family == HEATER ? "W" : "m3/s";
}
static const char *force_rate_unit(const struct draw_context *d) {
    return mechanical(d) ? "N/s" : d->system->family == HEATER ? "W/s" : "m3/s2";
}
static void act_on_drive(struct draw_context *d) { d->effect->junction = d->system->drive; }

/* An inflow acts on one of two tanks, chosen at random. */
static void choose_tank(struct draw_context *d) {
    if (d->system->family == TANKS && bernoulli(d->c, 0.5)) d->plant->second = 1;
    if (d->plant->second) d->effect->junction = d->system->second_junction;
}

/* ---- friction */

/* F = -Fc sign v; at rest it balances the other forces up to Fc (Coulomb 1785). */
static void coulomb(struct draw_context *d) { d->plant->coulomb = record_quantity(d, "Fc", "N", d->at->force * random_share(d, 0.03, 0.3)); }

/* F = -f v. */
static void viscous(struct draw_context *d) {
    double ratio = random_share(d, 0.01, 0.1), spring = 2 * ratio * sqrt(d->plant->k * d->plant->M);
    d->plant->f += record_quantity(d, "c", "N s/m", d->system->family == OSCILLATOR ? spring : 5 * ratio * d->at->force / d->at->velocity);
}

/* F = -(Fc + dF g(|v| / Vs)) sign v (Stribeck 1902); over a base with Coulomb friction only the fall. */
static void falling(struct draw_context *d) {
    struct plant *p = d->plant;
    double most = d->at->force * random_share(d, 0.06, 0.4), rest = p->Fc > 0 ? 0 : uniform(d->c, 0.1, 0.6);
    p->falling = SHAPE(d, EXPONENTIAL, GAUSSIAN, LORENTZIAN);
    p->falling_to = record_quantity(d, "Fc", "N", most * rest);
    p->falling_by = record_quantity(d, "dF", "N", most * (1 - rest));
    p->falling_velocity = record_quantity(d, "Vs", "m/s", d->at->velocity * log_uniform(d->c, 0.1, 0.7));
}

/* Friction follows its steady level with a lag: thesis Fig 8.15 and 8.16; or over a distance (Ruina's slip law 1983). If the base
 * has no falling friction, Stribeck friction is added, and its level lags. */
static void memory(struct draw_context *d) {
    struct plant *p = d->plant;
    double time = d->system->dt * d->inner * log_uniform(d->c, 3, 40);
    if (p->Fs == 0) falling(d), p->memory = LEVEL;
    else time *= d->size, p->memory = SHAPE(d, THESIS, LEVEL, DISTANCE);
    if (p->memory == DISTANCE) p->memory_distance = record_quantity(d, "L", "m", time * p->VcL);
    else p->memory_time = record_quantity(d, "Tc", "s", time);
}

/* The Coulomb friction of the base, or one that is added with the effect. */
static double own_coulomb(struct draw_context *d) {
    return d->plant->Fc > 0 ? d->plant->Fc : record_quantity(d, "Fc", "N", d->at->force * random_share(d, 0.06, 0.3));
}

/* Friction grows with the time at rest, as 1 - exp (Kato 1972) or ln (Rabinowicz 1958), and loses the growth at once in motion. */
static void growth(struct draw_context *d) {
    struct plant *p = d->plant;
    double sliding = own_coulomb(d);
    if (p->Fc == 0) p->coulomb = sliding;
    p->growing = SHAPE(d, EXPONENTIAL, LOGARITHMIC);
    p->growth = record_quantity(d, "dF", "N", sliding * fmin(2.5, (p->Fc > 0 ? d->size : d->inner) * log_uniform(d->c, 0.2, 1.5)));
    p->growth_time = record_quantity(d, "Tg", "s", d->system->dt * d->system->period * log_uniform(d->c, 0.1, 1.5));
}

/* F = -(f + a sign v) v. */
static void asymmetric(struct draw_context *d) {
    d->plant->asymmetry = record_quantity(d, "d", "N s/m", random_sign(d->c) * d->plant->f * fmin(0.8, random_share(d, 0.08, 0.7)));
}

/* F = -c v |v|. */
static void quadratic(struct draw_context *d) {
    d->plant->quadratic = record_quantity(d, "c", "N s2/m2", random_share(d, 0.03, 0.4) * d->at->force / (d->at->velocity * d->at->velocity));
}

/* Friction yields elastically over a distance D before it slides: bristles replace the base's Coulomb friction. D is large enough for
 * the steps of a run: at full speed a bristle is fully bent after 1.2 steps. */
static void presliding(struct draw_context *d) {
    struct plant *p = d->plant;
    double fastest = 1.3 * fmax(d->at->top[V], -d->at->low[V]), least = 1.2 * fastest * d->system->dt / TRUE_RUN_STEPS;
    double reach = d->system->family == SLIDE ? d->at->force / p->K : 0.05 * (d->at->top[X] - d->at->low[X]);
    double by = p->Fc > 0 ? d->size : d->inner;
    p->bristle_level = own_coulomb(d), p->Fc = 0;
    p->bristle = SHAPE(d, DAHL, LUGRE, ELASTOPLASTIC);
    p->bristle_stiffness = p->bristle_level / record_quantity(d, "D", "m", fmax(least, reach * by * log_uniform(d->c, 0.02, 0.3)));
    if (p->bristle != DAHL) p->bristle_damping = record_quantity(d, "damping", "N s/m", 0.3 * sqrt(p->bristle_stiffness * p->M));
}

/* Level mu |force of the drive| (Amontons; the drive's force is the load). */
static void load_dependent(struct draw_context *d) { d->plant->load = record_quantity(d, "mu", "1", fmin(0.6, random_share(d, 0.03, 0.3))); }

/* ---- forces of position */

/* Play operator (Krasnosel'skii, Pokrovskii): in the distance of a drive that gives a velocity, otherwise in the drive's value. */
static void backlash(struct draw_context *d) {
    int slide = d->system->family == SLIDE;
    double reach = slide ? d->at->force / d->plant->K : d->at->drive;
    d->plant->play = record_quantity(d, slide ? "w" : "b", slide ? "m" : d->system->drive_unit, 2 * reach * random_share(d, 0.03, 0.3)) / 2;
    act_on_drive(d);
}

/* F = -k3 x^3 (Duffing 1918); slide: the drive's spring hardens, F = K e - k3 e^3 with k3 below 0. */
static void cubic(struct draw_context *d) {
    struct plant *p = d->plant;
    int slide = d->system->family == SLIDE;
    double spring = slide ? -p->K : p->k, reach = slide ? d->at->force / p->K : 0.35 * (d->at->top[X] - d->at->low[X]);
    d->effect->shape = slide ? "of the error" : "of the position";
    p->cubic = record_quantity(d, "k3", "N/m3", spring * random_share(d, 0.05, 0.6) / (reach * reach));
}

/* A stop: a one-sided spring with damper, or Newton's restitution. */
static void hard_stop(struct draw_context *d) {
    struct plant *p = d->plant;
    double up = d->at->top[X] - d->at->first[X], down = d->at->first[X] - d->at->low[X];
    double side = fmin(up, down) < 0.5 * fmax(up, down) ? (up > down ? 1 : -1) : random_sign(d->c);
    double inside = fmax(0.3, 1 - 0.3 * random_share(d, 0.2, 1)), rate = 2 * M_PI / (d->system->dt * uniform(d->c, 8, 30));
    p->stop = SHAPE(d, SPRING, REBOUND), p->stop_side = side;
    p->stop_at = side * d->at->first[X] + inside * (side > 0 ? up : down);
    record_quantity(d, "xs", "m", p->stop_at), record_quantity(d, "side", "1", side);
    if (p->stop == REBOUND) p->rebound = record_quantity(d, "restitution", "1", uniform(d->c, 0, 0.8));
    else {
        p->stop_stiffness = record_quantity(d, "k", "N/m", p->M * rate * rate);
        p->stop_damping = record_quantity(d, "damping", "N s/m", 2 * uniform(d->c, 0.05, 0.4) * p->M * rate);
    }
}

/* ---- after the drive */

/* The drive is limited: clipped, or L tanh(u / L). */
static void saturation(struct draw_context *d) {
    struct plant *p = d->plant;
    double top = d->at->drive_peak, how = random_share(d, 0.05, 0.5);
    p->limiting = SHAPE(d, HARD, SOFT);
    p->limit = record_quantity(d, "L", d->system->drive_unit, p->limiting == HARD ? top * fmax(0.3, 1 - how) : top / fmin(2.5, 3 * how));
    act_on_drive(d);
}

/* 0 within +-b and u -+ b outside; or u - b tanh(u / b), which has the same asymptotes. */
static void dead_zone(struct draw_context *d) {
    d->plant->dead_shape = SHAPE(d, HARD, SOFT);
    d->plant->dead = record_quantity(d, "b", d->system->drive_unit, d->at->drive * random_share(d, 0.03, 0.35));
    act_on_drive(d);
}

/* u(t - T); before the record the drive has its first value. */
static void delay(struct draw_context *d) {
    d->plant->delay = record_quantity(d, "T", "s", d->system->dt * fmin(0.25 * d->system->period, random_share(d, 0.4, 10)));
    act_on_drive(d);
}

/* T y' = u - y. */
static void lag(struct draw_context *d) {
    d->plant->lag = record_quantity(d, "T", "s", d->system->dt * random_share(d, 0.4, 12));
    act_on_drive(d);
}

/* ---- forces of time */

static void bias(struct draw_context *d) {
    choose_tank(d);
    d->plant->bias = record_quantity(d, "b", force_unit(d), random_sign(d->c) * d->at->force * random_share(d, 0.02, 0.25));
}

/* Linear in time, or F (1 - exp(-t / T)). */
static void drift(struct draw_context *d) {
    struct plant *p = d->plant;
    double top = random_sign(d->c) * d->at->force * random_share(d, 0.04, 0.4);
    choose_tank(d);
    p->drifting = SHAPE(d, LINEAR, CURVED), p->drift = top;
    if (p->drifting == LINEAR) p->drift_time = d->length, record_quantity(d, "r", force_rate_unit(d), top / d->length);
    else record_quantity(d, "end", force_unit(d), top), p->drift_time = record_quantity(d, "T", "s", d->length * uniform(d->c, 0.3, 0.8));
}

/* a sin(2 pi f t) + b cos(2 pi f t). */
static void periodic(struct draw_context *d) {
    struct plant *p = d->plant;
    choose_tank(d);
    p->wave = d->at->force * random_share(d, 0.03, 0.35), p->wave_phase = uniform(d->c, 0, 2 * M_PI);
    record_quantity(d, "a", force_unit(d), p->wave * cos(p->wave_phase)), record_quantity(d, "b", force_unit(d), p->wave * sin(p->wave_phase));
    p->wave_rate = 2 * M_PI * record_quantity(d, "f", "Hz", log_uniform(d->c, 0.2, 3) / (d->system->period * d->system->dt));
}

/* Another mass from an instant on, or from the beginning if the mass is not fitted. The velocity is continuous, the momentum is not. */
static void mass_change(struct draw_context *d) {
    struct plant *p = d->plant;
    p->mass_factor = 1 + random_share(d, 0.05, 0.6);
    if (bernoulli(d->c, 0.4)) p->mass_factor = 1 / p->mass_factor;
    if (!d->mass_known) p->mass_time = d->system->dt * round(uniform(d->c, 0.15, 0.4) * d->length / d->system->dt);
    d->effect->shape = d->mass_known ? "from the beginning" : "step";
    record_quantity(d, "r", "1", p->mass_factor - 1);
    if (!d->mass_known) record_quantity(d, "t1", "s", p->mass_time);
}

/* ---- tanks and heater */

/* A leak of a tank, c h or c sqrt(h) (Torricelli 1643); a loss of a body, c T. */
static void leak(struct draw_context *d) {
    struct plant *p = d->plant;
    double top = d->at->top[0], content = d->system->family == HEATER ? p->capacity : p->A1;
    double linear = d->system->family == TANKS ? random_share(d, 0.04, 0.4) / p->R1 : content / d->length * random_share(d, 0.1, 2);
    p->leaking = d->system->family == HEATER ? SHAPE(d, LINEAR) : SHAPE(d, LINEAR, ROOT);
    const char *unit = d->system->family == HEATER ? "W/K" : p->leaking == ROOT ? "m2.5/s" : "m2/s";
    p->leak = record_quantity(d, p->leaking == ROOT ? "c" : "g", unit, p->leaking == ROOT ? linear * sqrt(0.5 * top) : linear);
}

/* The level of the upper tank is limited, or water flows over a weir (Poleni 1717). A share of it falls into the lower tank. */
static void overflow(struct draw_context *d) {
    struct plant *p = d->plant;
    p->overflowing = SHAPE(d, LIMIT, WEIR);
    p->overflow_at = record_quantity(d, "L", "m", d->at->top[H1] * fmax(0.4, 1 - 0.3 * random_share(d, 0.3, 1.5)));
    p->overflow_share = record_quantity(d, "s", "1", uniform(d->c, 0.2, 1));
    if (p->overflowing == WEIR) p->weir = record_quantity(d, "w", "m1.5/s", d->at->force / pow(uniform(d->c, 0.02, 0.06) * d->at->top[H1], 1.5));
}

/* ---- not in the library */

/* Gaussian bumps of force over position, as of worn or dirty guides. */
static void position_bumps(struct draw_context *d) {
    struct plant *p = d->plant;
    double low = d->at->low[X], range = d->at->top[X] - low, height = d->at->force * random_share(d, 0.1, 0.6);
    p->bump_width = record_quantity(d, "width", "m", range / uniform(d->c, 15, 40));
    for (int i = 0; i < BUMPS; i++) {
        char name[16];
        snprintf(name, sizeof name, "at%d", i + 1);
        p->bump_at[i] = record_quantity(d, name, "m", low + range * (i + uniform(d->c, 0, 1)) / BUMPS);
        snprintf(name, sizeof name, "height%d", i + 1);
        p->bump[i] = record_quantity(d, name, "N", height * random_sign(d->c) * uniform(d->c, 0.4, 1));
    }
}

/* A random-walk force; different in every record. */
static void random_walk(struct draw_context *d) { d->plant->walk = record_quantity(d, "rms", force_unit(d), d->at->force * random_share(d, 0.03, 0.3)); }

/* A relay with hysteresis adds +-height to the drive. */
static void relay(struct draw_context *d) {
    d->plant->relay = record_quantity(d, "height", d->system->drive_unit, d->at->drive * random_share(d, 0.03, 0.4));
    d->plant->relay_at = record_quantity(d, "threshold", d->system->drive_unit, d->at->drive * uniform(d->c, 0.1, 0.6));
    act_on_drive(d);
}

/* The base's friction or loss (tanks: the lower resistance) is initially too large by a share that decays exponentially. */
static void thaw(struct draw_context *d) {
    d->plant->thaw = record_quantity(d, "share", "1", random_share(d, 0.3, 2));
    d->plant->thaw_time = record_quantity(d, "T", "s", d->length * uniform(d->c, 0.1, 0.35));
    if (d->system->family == TANKS) d->effect->junction = d->system->second_junction;
}

/* Short shocks at random instants; different in every record. */
static void shocks(struct draw_context *d) { d->plant->shock = record_quantity(d, "height", force_unit(d), d->at->force * random_share(d, 0.3, 2)); }

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
