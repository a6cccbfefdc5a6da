/* Drive signals, and the chain (dead zone, backlash, relay, limit, lag) between a drive and the plant. */
#include "hidden.h"

static double *zeros(int n) { return calloc((size_t)n, sizeof(double)); }

struct record new_record(int n) {
    struct record r = {.n = n, .u = zeros(n), .chain_output = zeros(FINE * n), .distance = zeros(FINE * n), .force = zeros(n),
                       .sharp_steps = calloc((size_t)n * TRUE_RUN_STEPS, 1)};
    for (int i = 0; i < MAX_OUTPUTS; i++) r.out[i] = zeros(n), r.noisy[i] = zeros(n);
    return r;
}

void free_record(struct record *r) {
    free(r->u), free(r->chain_output), free(r->distance), free(r->sharp_steps), free(r->force);
    for (int i = 0; i < MAX_OUTPUTS; i++) free(r->out[i]), free(r->noisy[i]);
}

/* ---- pieces of a drive: m samples, about -1 ... 1 */

static void sines(struct rng *c, double *w, int m, double period) {
    enum { WAVES = 5 };
    double rate[WAVES], phase[WAVES], height[WAVES];
    for (int k = 0; k < WAVES; k++) {
        rate[k] = 2 * M_PI / log_uniform(c, 0.5 * period, 8 * period);
        phase[k] = uniform(c, 0, 2 * M_PI), height[k] = uniform(c, 0.2, 0.5);
    }
    for (int i = 0; i < m; i++) {
        w[i] = 0;
        for (int k = 0; k < WAVES; k++) w[i] += height[k] * sin(rate[k] * i + phase[k]);
    }
}

static void steps(struct rng *c, double *w, int m, double period) {
    double level = 0;
    for (int i = 0, until = 0; i < m; i++) {
        if (i == until) level = uniform(c, -1, 1), until += 1 + (int)log_uniform(c, 0.3 * period, 3 * period);
        w[i] = level;
    }
}

/* Slow ramps with changing direction. */
static void ramps(struct rng *c, double *w, int m, double period) {
    double from = 0, to = 0;
    for (int i = 0, start = 0, until = 0; i < m; i++) {
        if (i == until) from = to, to = random_sign(c) * uniform(c, 0.1, 1), start = i, until += 2 + (int)log_uniform(c, period, 6 * period);
        w[i] = from + (to - from) * (i - start) / (until - start);
    }
}

static void rest(double *w, int m, double level) {
    for (int i = 0; i < m; i++) w[i] = level;
}

/* One piece. If the drive must return to 0, the negative of the piece follows. Returns the number of filled samples. */
static int piece(struct rng *c, const struct system *s, double *w, int room, int kind) {
    double period = s->period;
    int m = kind == 3 ? (int)log_uniform(c, 0.3 * period, 3 * period) : (int)uniform(c, 3 * period, 7 * period);
    if (m > room) m = room;
    if (kind == 0) sines(c, w, m, period);
    if (kind == 1) steps(c, w, m, period);
    if (kind == 2) ramps(c, w, m, period);
    if (kind == 3) rest(w, m, s->positive ? -1 : 0);
    if (!s->wanders || kind == 3) return m;
    int back = m < room - m ? m : room - m;
    for (int i = 0; i < back; i++) w[m + i] = -w[i];
    return m + back;
}

/* Pieces of all kinds in random order, often followed by a rest. The drive begins with a short rest. With `rests`, most pieces are
 * ramps, and a rest follows each. */
static void pieces(struct rng *c, const struct system *s, double *w, int n, int rests) {
    int first = (int)(0.3 * s->period), kind = random_below(c, 3);
    rest(w, first, s->positive ? -1 : 0);
    for (int i = first; i < n;) {
        if (rests && bernoulli(c, 0.6)) kind = 2;
        i += piece(c, s, w + i, n - i, kind);
        if (i < n && (bernoulli(c, 0.6) || rests)) i += piece(c, s, w + i, n - i, 3);
        kind = (kind + 1 + random_below(c, 2)) % 3;
    }
}

/* Running mean over `over` samples. */
static void smooth(double *w, int n, int over) {
    double *sum = zeros(n + 1);
    for (int i = 0; i < n; i++) sum[i + 1] = sum[i] + w[i];
    for (int i = 0; i < n; i++) {
        int from = i - over / 2 > 0 ? i - over / 2 : 0, to = i + over / 2 < n - 1 ? i + over / 2 : n - 1;
        w[i] = (sum[to + 1] - sum[from]) / (to + 1 - from);
    }
    free(sum);
}

/* The force that gives a mass with viscous friction the velocity w. It keeps the position within a range. */
static void force_for_velocity(const struct system *s, const double *params, double *w, int n) {
    struct plant p = base_plant(s, params);
    smooth(w, n, (int)(s->period / 2.5)), smooth(w, n, (int)(s->period / 2.5));
    double before = w[0];
    for (int i = 0; i < n; i++) {
        double rate = (w[i] - before) / s->dt;
        before = w[i];
        w[i] = p.M * rate + p.f * w[i];
    }
}

/* Scales the drive so that the largest signal of the base is a given share of full scale, without solid friction and from rest. */
static void set_height(double share, const struct system *s, const double *params, struct record *r) {
    double start[STATES];
    struct plant p = base_plant(s, params);
    p.Fc = p.Fs = 0;
    memcpy(start, r->start, sizeof start), memset(r->start, 0, sizeof start);
    apply_drive_chain(&p, r);
    double met = simulate(&p, r, 2).share;
    memcpy(r->start, start, sizeof start);
    for (int i = 0; i < r->n; i++) r->u[i] *= share / met;
}

/* Rounds to six digits of the peak, so that the file has exactly the simulated values. */
static void round_drive(double *u, int n) {
    double top = 0;
    for (int i = 0; i < n; i++) top = fmax(top, fabs(u[i]));
    double grain = pow(10, floor(log10(top)) - 5);
    for (int i = 0; i < n; i++) u[i] = round(u[i] / grain) * grain;
}

/* Draws the drive of a record. `gain` scales its height. */
void draw_drive(struct rng *c, const struct system *s, const double *params, double gain, int rests, struct record *r) {
    pieces(c, s, r->u, r->n, rests);
    if (s->family == AXIS) force_for_velocity(s, params, r->u, r->n);
    if (s->positive)
        for (int i = 0; i < r->n; i++) r->u[i] = fmax(0, (1 + r->u[i]) / 2);
    set_height(gain * uniform(c, 0.3, 0.45), s, params, r);
    round_drive(r->u, r->n);
}

/* Random forces over time: a random walk with a restoring time of a third of the record, and shocks of a few samples. */
void draw_force(struct rng *c, const struct plant *p, struct record *r) {
    double at = 0, sum = 0;
    memset(r->force, 0, sizeof(double) * r->n);
    if (p->walk > 0) {
        for (int i = 0; i < r->n; i++) at += gaussian(c) - at * 3 / r->n, r->force[i] = at, sum += at * at;
        for (int i = 0; i < r->n; i++) r->force[i] *= p->walk / sqrt(sum / r->n);
    }
    if (p->shock > 0)
        for (int k = 0; k < r->n / 250; k++) {
            int from = 20 + random_below(c, r->n - 60), length = 4 + random_below(c, 12);
            double height = p->shock * random_sign(c) * uniform(c, 0.5, 1);
            for (int i = 0; i < length; i++) r->force[from + i] = height * sin(M_PI * (i + 0.5) / length);
        }
}

/* ---- the chain after the drive */

static double interpolate_drive(const struct record *r, double sample) {
    if (sample <= 0) return r->u[0];
    if (sample >= r->n - 1) return r->u[r->n - 1];
    int i = (int)sample;
    return r->u[i] + (r->u[i + 1] - r->u[i]) * (sample - i);
}

static double dead_zone_output(const struct plant *p, double u) {
    if (p->dead_shape == SOFT) return u - p->dead * tanh(u / p->dead);
    return fabs(u) <= p->dead ? 0 : u - copysign(p->dead, u);
}

static double limiter_output(const struct plant *p, double u) {
    return p->limiting == SOFT ? p->limit * tanh(u / p->limit) : fmax(-p->limit, fmin(p->limit, u));
}

/* Play operator: the output follows the input outside a play of +-half. */
static double play_operator(double at, double u, double half) { return fmax(u - half, fmin(u + half, at)); }

/* Relay with hysteresis: switches when the drive passes the threshold of the other side. */
static double relay_output(const struct plant *p, double u, double *side) {
    if (*side * u < -p->relay_at) *side = -*side;
    return u + p->relay * *side;
}

/* First-order lag over one fine step. Exact for an input that is linear over the step. */
struct lag_state { double out, before, time, decay; };

static double lag_output(struct lag_state *l, double u, double h) {
    double rise = (u - l->before) / h, lead = rise * l->time;
    l->out = u - lead + (l->out - l->before + lead) * l->decay;
    l->before = u;
    return l->out;
}

/* The distance of a drive that gives a velocity; with play, the output of the play operator. */
static void integrate_distance(const struct plant *p, struct record *r) {
    double h = p->system->dt / FINE, command = 0, end = 0;
    for (int i = 0; i < FINE * r->n; i++) {
        if (i) command += h * (r->chain_output[i - 1] + r->chain_output[i]) / 2;
        r->distance[i] = end = play_operator(end, command, p->play);
    }
}

/* Marks the steps around points where the slope of a table changes by more than a thousandth of the largest change per sample. */
static void mark_turns(const double *table, struct record *r) {
    double top = 0;
    for (int i = FINE; i < FINE * r->n; i++) top = fmax(top, fabs(table[i] - table[i - FINE]));
    for (int i = 1; i + 1 < FINE * r->n; i++)
        if (fabs(table[i + 1] - 2 * table[i] + table[i - 1]) > 1e-3 * top)
            for (int k = i - 1; k <= i + 1; k++) r->sharp_steps[k * TRUE_RUN_STEPS / FINE] = 1;
}

void apply_drive_chain(const struct plant *p, struct record *r) {
    double h = p->system->dt / FINE, delay = p->delay / p->system->dt, side = 1, at = r->u[0];
    int slide = p->system->family == SLIDE;
    struct lag_state lag = {r->u[0], r->u[0], p->lag, exp(-h / p->lag)};
    for (int i = 0; i < FINE * r->n; i++) {
        double u = interpolate_drive(r, (double)i / FINE - delay);
        if (p->dead > 0) u = dead_zone_output(p, u);
        if (p->play > 0 && !slide) u = at = play_operator(at, u, p->play);
        if (p->relay > 0) u = relay_output(p, u, &side);
        if (p->limit > 0) u = limiter_output(p, u);
        if (p->lag > 0) u = lag_output(&lag, u, h);
        r->chain_output[i] = u;
    }
    memset(r->sharp_steps, 0, (size_t)r->n * TRUE_RUN_STEPS);
    mark_turns(r->chain_output, r);
    if (slide) integrate_distance(p, r);
    if (slide && p->play > 0) mark_turns(r->distance, r);
}
