/* Drive signals, and what a drive does to them before they reach the plant. */
#include "hidden.h"

static double *zeros(int n) { return calloc((size_t)n, sizeof(double)); }

struct record new_record(int n) {
    struct record r = {.n = n, .u = zeros(n), .behind = zeros(FINE * n), .way = zeros(FINE * n), .force = zeros(n),
                       .turns = calloc((size_t)n * TRUTH_STEPS, 1)};
    for (int i = 0; i < MAX_OUTPUTS; i++) r.out[i] = zeros(n), r.noisy[i] = zeros(n);
    return r;
}

void free_record(struct record *r) {
    free(r->u), free(r->behind), free(r->way), free(r->turns), free(r->force);
    for (int i = 0; i < MAX_OUTPUTS; i++) free(r->out[i]), free(r->noisy[i]);
}

/* ---- pieces of a drive, about -1 ... 1, of m samples */

static void sines(struct chance *c, double *w, int m, double period) {
    enum { WAVES = 5 };
    double rate[WAVES], phase[WAVES], height[WAVES];
    for (int k = 0; k < WAVES; k++) {
        rate[k] = 2 * M_PI / scaled(c, 0.5 * period, 8 * period);
        phase[k] = even(c, 0, 2 * M_PI), height[k] = even(c, 0.2, 0.5);
    }
    for (int i = 0; i < m; i++) {
        w[i] = 0;
        for (int k = 0; k < WAVES; k++) w[i] += height[k] * sin(rate[k] * i + phase[k]);
    }
}

static void steps(struct chance *c, double *w, int m, double period) {
    double level = 0;
    for (int i = 0, until = 0; i < m; i++) {
        if (i == until) level = even(c, -1, 1), until += 1 + (int)scaled(c, 0.3 * period, 3 * period);
        w[i] = level;
    }
}

/* Slow ramps which turn back. */
static void ramps(struct chance *c, double *w, int m, double period) {
    double from = 0, to = 0;
    for (int i = 0, start = 0, until = 0; i < m; i++) {
        if (i == until) from = to, to = sign_of_chance(c) * even(c, 0.1, 1), start = i, until += 2 + (int)scaled(c, period, 6 * period);
        w[i] = from + (to - from) * (i - start) / (until - start);
    }
}

static void rest(double *w, int m, double level) {
    for (int i = 0; i < m; i++) w[i] = level;
}

/* One piece; where the drive must come back, its negative follows. Returns how many samples it filled. */
static int piece(struct chance *c, const struct system *s, double *w, int room, int kind) {
    double period = s->period;
    int m = kind == 3 ? (int)scaled(c, 0.3 * period, 3 * period) : (int)even(c, 3 * period, 7 * period);
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

/* All kinds in turn, in an order of chance, each followed by a rest now and then. It begins with a short rest. Rests: most pieces
 * are ramps, and a rest follows every one. */
static void pieces(struct chance *c, const struct system *s, double *w, int n, int rests) {
    int first = (int)(0.3 * s->period), kind = below(c, 3);
    rest(w, first, s->positive ? -1 : 0);
    for (int i = first; i < n;) {
        if (rests && odds(c, 0.6)) kind = 2;
        i += piece(c, s, w + i, n - i, kind);
        if (i < n && (odds(c, 0.6) || rests)) i += piece(c, s, w + i, n - i, 3);
        kind = (kind + 1 + below(c, 2)) % 3;
    }
}

/* Running mean over so many samples. */
static void smoothed(double *w, int n, int over) {
    double *sum = zeros(n + 1);
    for (int i = 0; i < n; i++) sum[i + 1] = sum[i] + w[i];
    for (int i = 0; i < n; i++) {
        int from = i - over / 2 > 0 ? i - over / 2 : 0, to = i + over / 2 < n - 1 ? i + over / 2 : n - 1;
        w[i] = (sum[to + 1] - sum[from]) / (to + 1 - from);
    }
    free(sum);
}

/* A force that would give a mass with some friction the velocity w: it keeps the position from walking away. */
static void force_for_velocity(const struct system *s, const double *params, double *w, int n) {
    struct plant p = base_plant(s, params);
    smoothed(w, n, (int)(s->period / 2.5)), smoothed(w, n, (int)(s->period / 2.5));
    double before = w[0];
    for (int i = 0; i < n; i++) {
        double rate = (w[i] - before) / s->dt;
        before = w[i];
        w[i] = p.M * rate + p.f * w[i];
    }
}

/* Brings what comes nearest to full scale in the base, without solid friction and from rest, to a chosen share of it. */
static void set_height(double share, const struct system *s, const double *params, struct record *r) {
    double start[STATES];
    struct plant p = base_plant(s, params);
    p.Fc = p.Fs = 0;
    memcpy(start, r->start, sizeof start), memset(r->start, 0, sizeof start);
    through_chain(&p, r);
    double met = simulate(&p, r, 2).share;
    memcpy(r->start, start, sizeof start);
    for (int i = 0; i < r->n; i++) r->u[i] *= share / met;
}

/* Rounded to six digits of its height, so that the file says exactly what was simulated. */
static void rounded(double *u, int n) {
    double top = 0;
    for (int i = 0; i < n; i++) top = fmax(top, fabs(u[i]));
    double grain = pow(10, floor(log10(top)) - 5);
    for (int i = 0; i < n; i++) u[i] = round(u[i] / grain) * grain;
}

/* Gain: makes it higher or lower than it would be. */
void draw_drive(struct chance *c, const struct system *s, const double *params, double gain, int rests, struct record *r) {
    pieces(c, s, r->u, r->n, rests);
    if (s->family == AXIS) force_for_velocity(s, params, r->u, r->n);
    if (s->positive)
        for (int i = 0; i < r->n; i++) r->u[i] = fmax(0, (1 + r->u[i]) / 2);
    set_height(gain * even(c, 0.3, 0.45), s, params, r);
    rounded(r->u, r->n);
}

/* Force over time that no formula tells: a random walk about 0, pulled back over a third of the record, and shocks of a few samples. */
void draw_force(struct chance *c, const struct plant *p, struct record *r) {
    double at = 0, sum = 0;
    memset(r->force, 0, sizeof(double) * r->n);
    if (p->walk > 0) {
        for (int i = 0; i < r->n; i++) at += gauss(c) - at * 3 / r->n, r->force[i] = at, sum += at * at;
        for (int i = 0; i < r->n; i++) r->force[i] *= p->walk / sqrt(sum / r->n);
    }
    if (p->shock > 0)
        for (int k = 0; k < r->n / 250; k++) {
            int from = 20 + below(c, r->n - 60), length = 4 + below(c, 12);
            double height = p->shock * sign_of_chance(c) * even(c, 0.5, 1);
            for (int i = 0; i < length; i++) r->force[from + i] = height * sin(M_PI * (i + 0.5) / length);
        }
}

/* ---- the chain behind the drive */

static double between(const struct record *r, double sample) {
    if (sample <= 0) return r->u[0];
    if (sample >= r->n - 1) return r->u[r->n - 1];
    int i = (int)sample;
    return r->u[i] + (r->u[i + 1] - r->u[i]) * (sample - i);
}

static double dead(const struct plant *p, double u) {
    if (p->dead_shape == SOFT) return u - p->dead * tanh(u / p->dead);
    return fabs(u) <= p->dead ? 0 : u - copysign(p->dead, u);
}

static double limited(const struct plant *p, double u) {
    return p->limiting == SOFT ? p->limit * tanh(u / p->limit) : fmax(-p->limit, fmin(p->limit, u));
}

/* Play operator: follows once the play is taken up. */
static double played(double at, double u, double half) { return fmax(u - half, fmin(u + half, at)); }

/* Relay with hysteresis: switches over where the drive has passed the threshold on the other side. */
static double relayed(const struct plant *p, double u, double *side) {
    if (*side * u < -p->relay_at) *side = -*side;
    return u + p->relay * *side;
}

/* First-order lag over one fine step in which the input goes straight: exact. */
struct lagging { double out, before, time, decay; };

static double lagged(struct lagging *l, double u, double h) {
    double rise = (u - l->before) / h, lead = rise * l->time;
    l->out = u - lead + (l->out - l->before + lead) * l->decay;
    l->before = u;
    return l->out;
}

/* The way that a drive goes which gives a velocity; with play it stays behind. */
static void go(const struct plant *p, struct record *r) {
    double h = p->system->dt / FINE, command = 0, end = 0;
    for (int i = 0; i < FINE * r->n; i++) {
        if (i) command += h * (r->behind[i - 1] + r->behind[i]) / 2;
        r->way[i] = end = played(end, command, p->play);
    }
}

/* Marks the steps around points at which a table bends by more than a share of what it changes in a sample at most. */
static void mark_turns(const double *table, struct record *r) {
    double top = 0;
    for (int i = FINE; i < FINE * r->n; i++) top = fmax(top, fabs(table[i] - table[i - FINE]));
    for (int i = 1; i + 1 < FINE * r->n; i++)
        if (fabs(table[i + 1] - 2 * table[i] + table[i - 1]) > 1e-3 * top)
            for (int k = i - 1; k <= i + 1; k++) r->turns[k * TRUTH_STEPS / FINE] = 1;
}

void through_chain(const struct plant *p, struct record *r) {
    double h = p->system->dt / FINE, delay = p->delay / p->system->dt, side = 1, at = r->u[0];
    int slide = p->system->family == SLIDE;
    struct lagging lag = {r->u[0], r->u[0], p->lag, exp(-h / p->lag)};
    for (int i = 0; i < FINE * r->n; i++) {
        double u = between(r, (double)i / FINE - delay);
        if (p->dead > 0) u = dead(p, u);
        if (p->play > 0 && !slide) u = at = played(at, u, p->play);
        if (p->relay > 0) u = relayed(p, u, &side);
        if (p->limit > 0) u = limited(p, u);
        if (p->lag > 0) u = lagged(&lag, u, h);
        r->behind[i] = u;
    }
    memset(r->turns, 0, (size_t)r->n * TRUTH_STEPS);
    mark_turns(r->behind, r);
    if (slide) go(p, r);
    if (slide && p->play > 0) mark_turns(r->way, r);
}
