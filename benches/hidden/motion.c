/* Motion of a plant: classical Runge-Kutta with equal steps. Events (coming to rest, breaking loose, stops, brims) are located by
 * bisection, and a step ends at each. Between events the equations are smooth except for corners of small forces. */
#include "hidden.h"

enum mode { FREE, SLIDES, STANDS };

struct motion {
    const struct plant *p;
    const struct record *r;
    int brake;
    double mass_share;
    enum mode mode;
    double side;               /* SLIDES: sign of the velocity */
    int touching;              /* the spring of the stop is compressed */
    int pressed;               /* held at the stop, or the tank is full to the brim */
};

static double interpolate(const double *table, double at, int last) {
    if (at <= 0) return table[0];
    if (at >= last) return table[last];
    int i = (int)at;
    return table[i] + (table[i + 1] - table[i]) * (at - i);
}

static double drive_at(const struct motion *m, double t) {
    return interpolate(m->r->chain_output, t / m->p->system->dt * FINE, FINE * m->r->n - 1);
}

/* Sum of the constant, slow, periodic and random forces. The drift is linear, or 1 - exp. */
static double force_of_time(const struct motion *m, double t) {
    const struct plant *p = m->p;
    double sum = p->bias;
    if (p->drift != 0) sum += p->drift * (p->drifting == CURVED ? 1 - exp(-t / p->drift_time) : t / p->drift_time);
    if (p->wave > 0) sum += p->wave * sin(p->wave_rate * t + p->wave_phase);
    if (p->walk > 0 || p->shock > 0) sum += interpolate(m->r->force, t / p->system->dt, m->r->n - 1);
    return sum;
}

/* Factor of a coefficient under a slow thaw: 1 + thaw at the start, then 1. */
static double thaw_factor(const struct plant *p, double t) { return p->thaw > 0 ? 1 + p->thaw * exp(-t / p->thaw_time) : 1; }

/* ---- friction */

/* Share of the Stribeck rise that remains at a speed: Tustin exp(-v), Bo and Pavelescu exp(-v^2), Hess and Soom 1 / (1 + v^2). */
static double stribeck_share(enum shape shape, double ratio) {
    if (shape == GAUSSIAN) return exp(-ratio * ratio);
    if (shape == LORENTZIAN) return 1 / (1 + ratio * ratio);
    return exp(-ratio);
}

/* Falling friction of the base (thesis, Fig 8.14): Fs (1 - |v|/VcL)^2. Memory (Fig 8.16): the share follows 1 - |v|/VcL with the
 * lag Tc and is then squared; or the level itself lags; or the speed in the level lags over a distance. */
static double steady(const struct plant *p, double speed) {
    double share = fmax(0, 1 - speed / p->VcL);
    return p->Fs * share * share;
}

static double falling_level(const struct plant *p, double speed, double z) {
    if (p->memory == THESIS) return p->Fs * fmax(z, 0) * fmax(z, 0);
    if (p->memory == LEVEL) return z;
    return steady(p, p->memory == DISTANCE ? z : speed);
}

/* The level of the hidden Stribeck friction at a speed. With memory, the level lags behind this value. */
static double stribeck(const struct plant *p, double speed) {
    return p->falling_to + p->falling_by * stribeck_share(p->falling, speed / p->falling_velocity);
}

/* Level at which solid friction slides; drive: the force that comes from the drive (load-dependent friction: mu |drive|). */
static double level(const struct plant *p, double speed, double z, double drive) {
    double sum = p->Fc + p->coulomb + p->load * fabs(drive);
    if (p->Fs > 0) sum += falling_level(p, speed, z);
    if (p->falling) sum += p->memory ? z : stribeck(p, speed);
    return sum;
}

/* Growth of friction at rest: dF (1 - exp(-t/T)), or dF ln(1 + t/T) (Rabinowicz; Dieterich). */
static double growth_at_rest(const struct plant *p, double rested) {
    if (p->growth == 0) return 0;
    return p->growth * (p->growing == LOGARITHMIC ? log1p(rested / p->growth_time) : 1 - exp(-rested / p->growth_time));
}

/* Rate of a bristle: Dahl 1968; LuGre (Canudas de Wit 1995) with a level for all speeds, so Dahl's with damping; elastoplastic
 * (Dupont 2002): a bristle bent by less than 0.7 of its maximum springs back. */
static double bristle_rate(const struct plant *p, double v, double z) {
    double most = p->bristle_level / p->bristle_stiffness, bent = z / most;
    if (p->bristle != ELASTOPLASTIC) return v - fabs(v) * bent;
    double share = v * z <= 0 || fabs(bent) < 0.7 ? 0 : fabs(bent) >= 1 ? 1 : 0.5 + 0.5 * sin(M_PI * (fabs(bent) - 0.85) / 0.3);
    return v * (1 - share * fabs(bent));
}

static double bristle(const struct plant *p, double v, double z) {
    return p->bristle_stiffness * z + p->bristle_damping * bristle_rate(p, v, z);
}

/* Rate of the inner state of friction: bristle, time at rest, or memory. */
static double inner_rate(const struct motion *m, double v, double z) {
    const struct plant *p = m->p;
    double speed = fabs(v);
    if (p->bristle) return bristle_rate(p, v, z);
    if (p->growth > 0) return m->mode == STANDS;
    if (p->memory == DISTANCE) return (speed + 1e-3 * p->VcL) / p->memory_distance * (speed - z);
    if (p->memory == THESIS) return (1 - fmin(speed / p->VcL, 1) - z) / p->memory_time;
    if (p->memory == LEVEL) return ((p->falling ? stribeck(p, speed) : steady(p, speed)) - z) / p->memory_time;
    return 0;
}

/* ---- forces on the mass */

/* Stop as a spring that pushes and never pulls (Kelvin-Voigt, cut off at 0). */
static double depth(const struct plant *p, double x) { return p->stop_side * x - p->stop_at; }

static double stop_force(const struct plant *p, double x, double v) {
    return -p->stop_side * fmax(0, p->stop_stiffness * depth(p, x) + p->stop_damping * p->stop_side * v);
}

static double bumps(const struct plant *p, double x) {
    double sum = 0;
    for (int i = 0; i < BUMPS; i++) {
        double d = (x - p->bump_at[i]) / p->bump_width;
        sum += p->bump[i] * exp(-d * d / 2);
    }
    return sum;
}

/* Position in the fine tables. */
struct place { int i; double share, step; };

static struct place place_at(const struct motion *m, double t) {
    double step = m->p->system->dt / FINE, at = t / step;
    int last = FINE * m->r->n - 2, i = at < 0 ? 0 : at > last ? last : (int)at;
    return (struct place){i, at - i, step};
}

/* Whether the slide's drive, after its play, follows the command in a fine step. `mean` is the mean velocity over the step, which
 * applies in the step in which the play is taken up, and is 0 within the play. */
static int follows_drive(const struct motion *m, struct place at, double *mean) {
    const double *distance = m->r->distance + at.i, *u = m->r->chain_output + at.i;
    *mean = (distance[1] - distance[0]) / at.step;
    return fabs(*mean - (u[0] + u[1]) / 2) < 1e-6 * fabs(u[0] + u[1]);
}

static double drive_velocity(const struct motion *m, double t, double u) {
    double mean;
    return follows_drive(m, place_at(m, t), &mean) ? u : mean;
}

static double drive_distance(const struct motion *m, double t) {
    struct place at = place_at(m, t);
    double mean, from = m->r->distance[at.i], *u = m->r->chain_output + at.i, s = at.share * at.step;
    if (!follows_drive(m, at, &mean)) return from + mean * s;
    return from + u[0] * s + (u[1] - u[0]) * at.share * s / 2;
}

/* Force of the drive on the mass: that of the slide's spring and damper, or the drive itself. */
static double from_drive(const struct motion *m, double t, const double *y, double u) {
    const struct plant *p = m->p;
    if (p->system->family != SLIDE) return u;
    double stretch = y[E] + drive_distance(m, t), speed = (p->play > 0 ? drive_velocity(m, t, u) : u) - y[V];
    return p->K * stretch - p->cubic * stretch * stretch * stretch + p->C * speed;
}

/* Net force without solid friction. The viscous coefficient is larger by the asymmetry at positive velocity, and smaller at negative. */
static double net_force(const struct motion *m, double t, const double *y, double drive) {
    const struct plant *p = m->p;
    double x = y[X], v = y[V];
    double viscous = p->f * thaw_factor(p, t) + (v > 0 ? p->asymmetry : -p->asymmetry);
    double sum = drive - viscous * v - p->quadratic * v * fabs(v) - p->k * x + force_of_time(m, t);
    if (p->system->family == OSCILLATOR) sum -= p->cubic * x * x * x;
    if (m->touching) sum += stop_force(p, x, v);
    if (p->bump_width > 0) sum += bumps(p, x);
    if (p->bristle) sum -= bristle(p, v, y[Z]);
    return sum;
}

static void mass_rates(const struct motion *m, double t, const double *y, double *dy) {
    const struct plant *p = m->p;
    double u = drive_at(m, t);
    dy[Z] = inner_rate(m, y[V], y[Z]);
    if (m->mode == STANDS || m->pressed) {
        dy[E] = dy[X] = dy[V] = 0;
        return;
    }
    double drive = from_drive(m, t, y, u), force = net_force(m, t, y, drive);
    if (m->mode == SLIDES) force -= m->side * level(p, fabs(y[V]), y[Z], drive);
    dy[E] = -y[V], dy[X] = y[V];
    dy[V] = force / (p->M * m->mass_share);
}

/* ---- tanks and heater */

/* Leak: linear in the level, or Torricelli's root of it. */
static double leak_flow(const struct plant *p, double content) {
    if (p->leaking == ROOT) return p->leak * sqrt(fmax(content, 0));
    return p->leak * content;
}

/* Flow over a weir: a coefficient times the height above the weir to the power 3/2. */
static double weir_flow(const struct plant *p, double height) {
    double above = height - p->overflow_at;
    return p->overflowing == WEIR && above > 0 ? p->weir * above * sqrt(above) : 0;
}

static void tank_rates(const struct motion *m, double t, const double *y, double *dy) {
    const struct plant *p = m->p;
    double extra = force_of_time(m, t), over = weir_flow(p, y[H1]), out = p->system->family == TANKS ? y[H1] / p->R1 : 0;
    double first = p->ku * drive_at(m, t) - out - over + (p->second ? 0 : extra - leak_flow(p, y[H1]));
    if (m->pressed) over = first, first = 0;
    dy[H1] = first / p->A1, dy[H2] = dy[V] = dy[Z] = 0;
    if (p->system->family == TANKS)
        dy[H2] = (out - y[H2] / (p->R2 * thaw_factor(p, t)) + p->overflow_share * over + (p->second ? extra - leak_flow(p, y[H2]) : 0)) / p->A2;
}

static void heater_rates(const struct motion *m, double t, const double *y, double *dy) {
    const struct plant *p = m->p;
    double power = drive_at(m, t) - p->G * thaw_factor(p, t) * y[TEMPERATURE] - leak_flow(p, y[TEMPERATURE]) + force_of_time(m, t);
    dy[TEMPERATURE] = power / p->capacity, dy[X] = dy[V] = dy[Z] = 0;
}

/* ---- steps */

static void rates(const struct motion *m, double t, const double *y, double *dy) {
    enum family family = m->p->system->family;
    if (family == HEATER) heater_rates(m, t, y, dy);
    else if (family == TANK || family == TANKS) tank_rates(m, t, y, dy);
    else mass_rates(m, t, y, dy);
}

static void runge_kutta_step(const struct motion *m, double t, const double *y, double h, double *to) {
    double k1[STATES], k2[STATES], k3[STATES], k4[STATES], at[STATES];
    rates(m, t, y, k1);
    for (int i = 0; i < STATES; i++) at[i] = y[i] + h / 2 * k1[i];
    rates(m, t + h / 2, at, k2);
    for (int i = 0; i < STATES; i++) at[i] = y[i] + h / 2 * k2[i];
    rates(m, t + h / 2, at, k3);
    for (int i = 0; i < STATES; i++) at[i] = y[i] + h * k3[i];
    rates(m, t + h, at, k4);
    for (int i = 0; i < STATES; i++) to[i] = y[i] + h / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
}

enum event { NOTHING, BREAKS_LOOSE, COMES_TO_REST, MEETS, LEAVES, TOUCHES };

/* Force on a mass at rest or at its stop, and the largest friction that can hold it. */
static double holding_friction(const struct motion *m, double t, const double *y, double *force) {
    double drive = from_drive(m, t, y, drive_at(m, t));
    *force = net_force(m, t, y, drive);
    return level(m->p, 0, y[Z], drive) + growth_at_rest(m->p, y[Z]);
}

static double inflow(const struct motion *m, double t, const double *y) {
    struct motion open = *m;
    double dy[STATES];
    open.pressed = 0, tank_rates(&open, t, y, dy);
    return dy[H1];
}

static enum event mass_event(const struct motion *m, double t, const double *y) {
    const struct plant *p = m->p;
    double force;
    if (m->pressed) {
        double hold = holding_friction(m, t, y, &force);
        return -p->stop_side * force > hold ? LEAVES : NOTHING;
    }
    if (m->mode == STANDS) {
        double hold = holding_friction(m, t, y, &force);
        return fabs(force) > hold ? BREAKS_LOOSE : NOTHING;
    }
    if (p->stop == REBOUND && depth(p, y[X]) > 0 && p->stop_side * y[V] > 0) return MEETS;
    if (p->stop == SPRING && (depth(p, y[X]) > 0) != m->touching) return TOUCHES;
    return m->mode == SLIDES && m->side * y[V] < 0 ? COMES_TO_REST : NOTHING;
}

static enum event event(const struct motion *m, double t, const double *y) {
    enum family family = m->p->system->family;
    if (family <= OSCILLATOR) return m->brake || m->p->stop ? mass_event(m, t, y) : NOTHING;
    if (m->p->overflowing != LIMIT) return NOTHING;
    if (m->pressed) return inflow(m, t, y) < 0 ? LEAVES : NOTHING;
    return y[H1] > m->p->overflow_at ? MEETS : NOTHING;
}

static void start_sliding(struct motion *m, double force) { m->mode = m->brake ? SLIDES : FREE, m->side = force < 0 ? -1 : 1; }

/* The mass comes to rest, or reverses at once. */
static void stop_motion(struct motion *m, double t, double *y) {
    double force;
    y[V] = 0;
    if (m->p->growth > 0) y[Z] = 0;
    double hold = holding_friction(m, t, y, &force);
    if (fabs(force) <= hold) m->mode = STANDS;
    else start_sliding(m, force);
}

/* Reflection with a share of the velocity (Newton). Below a thousandth of full scale the mass stays at the stop. */
static void hit_limit(struct motion *m, double *y) {
    const struct plant *p = m->p;
    if (p->overflowing == LIMIT) {
        m->pressed = 1, y[H1] = p->overflow_at;
        return;
    }
    y[V] *= -p->rebound, y[X] = p->stop_side * p->stop_at;
    if (fabs(y[V]) < 1e-3 * p->system->full[V]) m->pressed = 1, y[V] = 0;
    else m->side = -p->stop_side;
}

static void handle_event(struct motion *m, enum event what, double t, double *y) {
    double force;
    if (what == TOUCHES) m->touching = !m->touching;
    else if (what == MEETS) hit_limit(m, y);
    else if (what == COMES_TO_REST) stop_motion(m, t, y);
    else if (m->p->overflowing == LIMIT) m->pressed = 0;
    else holding_friction(m, t, y, &force), m->pressed = 0, start_sliding(m, force);
}

/* The time from t to the first event within h, by bisection (44 halvings). */
static double time_to_event(const struct motion *m, double t, const double *y, double h, enum event *what) {
    double low = 0, high = h, to[STATES];
    for (int i = 0; i < 44; i++) {
        double middle = (low + high) / 2;
        runge_kutta_step(m, t, y, middle, to);
        enum event now = event(m, t + middle, to);
        if (now) high = middle, *what = now;
        else low = middle;
    }
    return high;
}

static void advance(struct motion *m, double t, double *y, double h) {
    double to[STATES];
    for (int count = 0; h > 0 && count < 100; count++) {
        runge_kutta_step(m, t, y, h, to);
        enum event what = event(m, t + h, to);
        if (!what) break;
        double part = time_to_event(m, t, y, h, &what);
        runge_kutta_step(m, t, y, part, to);
        t += part, h -= part;
        memcpy(y, to, sizeof to);
        handle_event(m, what, t, y);
        runge_kutta_step(m, t, y, h, to);
    }
    memcpy(y, to, sizeof to);
}

/* ---- a run */

static void update_survey(struct survey *s, const struct motion *m, double t, const double *y) {
    const struct plant *p = m->p;
    const struct system *sys = p->system;
    double u = drive_at(m, t), drive = u, net = u;
    for (int i = 0; i < STATES; i++) {
        double at = i == E && sys->family == SLIDE ? y[E] + drive_distance(m, t) : y[i];
        if (sys->full[i] > 0) s->share = fmax(s->share, fabs(at) / sys->full[i]);
        s->top[i] = fmax(s->top[i], at), s->low[i] = fmin(s->low[i], at);
    }
    if (sys->family <= OSCILLATOR) {
        drive = from_drive(m, t, y, u);
        net = fmax(fabs(drive - p->f * y[V] - p->k * y[X]), fmax(fabs(drive), fabs(p->k * y[X])));
        s->velocity += y[V] * y[V];
    }
    if (sys->family == TANK || sys->family == TANKS) drive = net = p->ku * u;
    s->share = fmax(s->share, fmax(fabs(net) / sys->full_force, fabs(u) / sys->full_drive));
    s->force += drive * drive, s->drive += u * u, s->drive_peak = fmax(s->drive_peak, fabs(u));
}

static void begin(struct motion *m, double *y) {
    const struct plant *p = m->p;
    double speed = fabs(y[V]), force;
    if (p->memory == THESIS) y[Z] = 1 - fmin(speed / p->VcL, 1);
    if (p->memory == LEVEL) y[Z] = p->falling ? stribeck(p, speed) : steady(p, speed);
    if (p->memory == DISTANCE) y[Z] = speed;
    if (!m->brake) return;
    m->mode = SLIDES, m->side = y[V] < 0 ? -1 : 1;
    if (y[V] != 0) return;
    double hold = holding_friction(m, 0, y, &force);
    if (fabs(force) <= hold) m->mode = STANDS;
    else start_sliding(m, force);
}

/* One step. A step of a true run with a sharp corner of the drive is divided into 16. */
static void advance_step(struct motion *m, double t, double *y, double h, int step, int fine) {
    int parts = fine == TRUE_RUN_STEPS && m->r->sharp_steps[step] ? 16 : 1;
    for (int k = 0; k < parts; k++) advance(m, t + k * h / parts, y, h / parts);
}

/* Fills the outputs of a record, with `fine` steps per sample. */
struct survey simulate(const struct plant *p, struct record *r, int fine) {
    const struct system *s = p->system;
    struct motion m = {.p = p, .r = r, .brake = s->family <= OSCILLATOR && has_brake(p), .mass_share = 1};
    struct survey survey = {0};
    double y[STATES];
    memcpy(y, r->start, sizeof y);
    for (int k = 0; k < STATES; k++) survey.first[k] = survey.top[k] = survey.low[k] = y[k];
    begin(&m, y);
    for (int i = 0; i < r->n; i++) {
        double t = i * s->dt;
        m.mass_share = p->mass_factor != 1 && t >= p->mass_time ? p->mass_factor : 1;
        for (int k = 0; k < MAX_OUTPUTS && s->outputs[k].signal; k++) r->out[k][i] = y[s->outputs[k].state];
        if (s->family == SLIDE) r->out[0][i] += drive_distance(&m, t);
        update_survey(&survey, &m, t, y);
        for (int k = 0; k < fine && i + 1 < r->n; k++) advance_step(&m, t + k * s->dt / fine, y, s->dt / fine, i * fine + k, fine);
    }
    survey.force = sqrt(survey.force / r->n), survey.velocity = sqrt(survey.velocity / r->n);
    survey.drive = sqrt(survey.drive / r->n);
    return survey;
}
