/* Makes a case from its number: base, drives, hidden effects, clean records, refit of the base, noise. */
#include "hidden.h"

enum { TRAIN = 2400, DRAWS = 4, TRIES = 12, SHRINKS = 8 };
static const double MAX_SHARE = 0.75;                /* no signal may exceed this share of full scale */
static const double MIN_SIGMA = 1e-6, MAX_SIGMA = 0.03, MIN_MISFIT = 1e-4;    /* shares of an output's range */
static const double MIN_PART = 0.15;             /* share of the gap that must remain without one of two effects */

/* With only the lower level measured, the tank of a constant or periodic inflow cannot be determined. */
static int flows_into_a_tank(const struct hidden_case *c) {
    if (c->plan.system->family != TANKS || !c->plan.count) return 0;
    const char *name = c->plan.effects[c->plan.count - 1];
    return !strcmp(name, "constant-bias") || !strcmp(name, "drift") || !strcmp(name, "periodic-disturbance");
}

/* Draws the true values of the fitted parameters, near the middle of their ranges. Known parameters have the patch's values. */
static void draw_base(struct hidden_case *c, struct rng *rng) {
    const struct system *s = c->plan.system;
    int all = params_of(s), known = -1;
    if (c->plan.mass_known) known = 0;
    else if (s->family == SLIDE && bernoulli(rng, 0.5)) known = 1;
    c->fit.outputs = s->outputs[1].signal && bernoulli(rng, s->family == TANKS ? 0.6 : s->family == SLIDE ? 0.3 : 0.1) ? 2 : 1;
    if (flows_into_a_tank(c)) c->fit.outputs = 2;
    c->fit.first_output = c->fit.outputs == 1 && s->second_output_alone;
    if (c->fit.first_output) known = 1;            /* the lower level alone cannot distinguish the two outlets */
    for (int i = 0; i < all; i++) {
        double drawn = s->params[i].value * log_uniform(rng, 1 / 1.5, 1.5);
        c->params[i] = i == known ? s->params[i].value : drawn;
        if (i != known) c->fit.params[c->fit.count++] = i;
    }
}

static void draw_start(struct hidden_case *c, struct rng *rng, struct record *r) {
    const struct system *s = c->plan.system;
    for (int i = 0; i < s->states; i++) {
        double full = s->full[s->free[i]], at = uniform(rng, 0.02, 0.15) * random_sign(rng);
        if (s->family == AXIS) at *= 0.3;
        if (s->positive) at = uniform(rng, 0.05, 0.3);
        if (s->family == TANK) at = uniform(rng, 0.3, 0.45);
        r->start[s->free[i]] = at * full;
    }
}

/* An axis and an integrating vessel have a free initial position, which an offset cannot be distinguished from. With a bias or drift
 * it cannot be distinguished from the effect. */
static int may_have_offset(const struct hidden_case *c) {
    const struct system *s = c->plan.system;
    if (s->family == AXIS || s->family == TANK || (s->family == HEATER && s->wanders)) return 0;
    for (int i = 0; i < c->plan.count; i++)
        if (!strcmp(c->plan.effects[i], "constant-bias") || !strcmp(c->plan.effects[i], "drift")) return 0;
    return 1;
}

static void draw_effect(const struct hidden_case *c, struct rng *rng, const struct survey *survey, double size, double inner, const char *name,
                        struct plant *plant, struct effect *effect) {
    *effect = (struct effect){.name = name, .shape = "", .junction = c->plan.system->first_junction};
    struct draw_context d = {rng, c->plan.system, survey, size, inner, TRAIN * c->plan.system->dt, c->plan.mass_known, plant, effect};
    law_named(name)->draw(&d);
}

static void draw_effects(struct hidden_case *c, struct rng *rng, const double *sizes) {
    struct record base = c->train;
    struct plant plain = base_plant(c->plan.system, c->params);
    struct effect unused;
    apply_drive_chain(&plain, &base);
    struct survey survey = simulate(&plain, &base, 2);
    c->plant = c->only[0] = c->only[1] = plain;
    double inner = c->plan.count == 1 ? sizes[1] : 1;
    for (int i = 0; i < c->plan.count; i++) {
        struct rng again = *rng;
        draw_effect(c, rng, &survey, sizes[i], inner, c->plan.effects[i], &c->plant, &c->effects[i]);
        draw_effect(c, &again, &survey, sizes[i], inner, c->plan.effects[i], &c->only[i], &unused);
    }
}

/* Moves initial states to the permitted side of a stop or brim. */
static void respect_limits(const struct plant *p, struct record *r) {
    if (p->stop) r->start[X] = p->stop_side * fmin(p->stop_side * r->start[X], p->stop_at - 0.02 * p->system->full[X]);
    if (p->overflowing) r->start[H1] = fmin(r->start[H1], 0.8 * p->overflow_at);
}

/* Runs a record with all hidden effects. Returns the largest share of full scale. */
static double run(const struct plant *p, struct rng *rng, struct record *r) {
    draw_force(rng, p, r);
    respect_limits(p, r);
    apply_drive_chain(p, r);
    return simulate(p, r, TRUE_RUN_STEPS).share;
}

static void range_of(const double *y, int n, double *range) {
    double low = y[0], high = y[0];
    for (int i = 1; i < n; i++) low = fmin(low, y[i]), high = fmax(high, y[i]);
    *range = high - low;
}

/* Friction that grows at rest is visible only if rests end slowly. */
static int needs_rests(const struct hidden_case *c) {
    return c->plan.count && !strcmp(c->plan.effects[0], "static-friction-growth");
}

struct attempt { double gain, sizes[MAX_EFFECTS], misfit, rival[MAX_EFFECTS], range[MAX_OUTPUTS]; };

/* Draws the whole case, always in the same order. Returns the largest share of full scale. */
static double attempt_case(struct hidden_case *c, struct attempt *a, struct rng *rng) {
    const struct system *s = c->plan.system;
    c->fit = (struct fit){0};
    draw_base(c, rng);
    struct record *records[] = {&c->train, &c->test};
    for (int k = 0; k < 2; k++) {
        draw_start(c, rng, records[k]);
        draw_drive(rng, s, c->params, a->gain, needs_rests(c), records[k]);
    }
    c->fit.offset = bernoulli(rng, 0.1) && may_have_offset(c);
    c->sigma_given = bernoulli(rng, 0.5);
    draw_effects(c, rng, a->sizes);
    struct rng forces = *rng;                 /* a copy, so that random forces do not change later numbers */
    double share = fmax(run(&c->plant, &forces, &c->train), run(&c->plant, &forces, &c->test));
    for (int k = 0; k < c->fit.outputs; k++) range_of(c->train.out[c->fit.first_output + k], TRAIN, &a->range[k]);
    return share;
}

static double residual_with(const struct hidden_case *c, const struct attempt *a, const struct plant *with, int coulomb) {
    struct job job = {c->plan.system, c->params, &c->fit, &c->train, a->range, with, coulomb, 6};
    return refit_base(&job).misfit;
}

/* The friction without its details (fall, growth, presliding): a Coulomb friction. Returns 0 if there is none. */
static int without_inner(const struct hidden_case *c, struct plant *rough) {
    const struct plant *p = &c->plant;
    double level = p->falling ? p->falling_to + p->falling_by / 2 : p->growth > 0 ? p->coulomb : p->bristle_level;
    *rough = base_plant(c->plan.system, c->params);
    if (has_brake(rough) || !(level > 0)) return 0;
    rough->coulomb = level;
    return 1;
}

/* The residual without one of two effects, with the other one at its true values; with Coulomb friction in place of a friction
 * that falls, grows or yields; or without a memory. */
static void examine_rivals(struct hidden_case *c, struct attempt *a) {
    struct plant rough;
    a->rival[0] = a->rival[1] = 0;
    if (c->plan.count == 2) {
        for (int i = 0; i < 2; i++) a->rival[i] = residual_with(c, a, &c->only[1 - i], 0);
    } else if (c->plant.memory && c->plant.falling) {
        rough = c->plant, rough.memory = NONE;
        a->rival[0] = residual_with(c, a, &rough, 0);
    } else if (without_inner(c, &rough)) a->rival[0] = residual_with(c, a, &rough, 1);
}

static void examine(struct hidden_case *c, struct attempt *a) {
    struct job job = {c->plan.system, c->params, &c->fit, &c->train, a->range, NULL, 0, 30};
    c->best = refit_base(&job);
    a->misfit = c->best.misfit;
    examine_rivals(c, a);
}

/* Scales both effects of a pair, or the whole of a single effect, not its details. */
static void resize(const struct hidden_case *c, struct attempt *a, double by) {
    a->sizes[0] *= by;
    if (c->plan.count == 2) a->sizes[1] *= by;
}

/* Whether the case is acceptable. If not, changes the sizes or the height of the drive for the next try. A case is not acceptable if
 * a signal exceeds the limit, if the gap is too small, if one of two effects or the detail of a friction is masked by the rest, or,
 * in the first tries, if the gap is too large for the target EGNR. */
static int is_acceptable(const struct hidden_case *c, struct attempt *a, double share, int try) {
    if (!(share <= MAX_SHARE)) return a->gain *= 0.8, resize(c, a, 0.8), 0;
    if (!c->plan.count) return 1;
    if (a->misfit < MIN_MISFIT) return resize(c, a, 1.6), 0;
    if (c->plan.count == 1 && a->rival[0] > 0 && a->rival[0] < MIN_PART * a->misfit)
        return a->sizes[1] *= 1.5, a->sizes[0] *= needs_rests(c) ? 1.3 : 1, 0;
    for (int i = 0; c->plan.count == 2 && i < 2; i++)
        if (a->rival[i] < MIN_PART * a->misfit) return a->sizes[i] *= 1.5, a->sizes[1 - i] *= 0.8, 0;
    if (a->misfit / c->target > MAX_SIGMA && try < SHRINKS && a->misfit > 4 * MIN_MISFIT) return resize(c, a, 0.6), 0;
    return 1;
}

static void draw_noise(struct hidden_case *c, struct rng *rng, const struct attempt *a) {
    double plain = log_uniform(rng, 1e-4, 1e-2);
    double sigma = c->plan.count ? fmax(MIN_SIGMA, fmin(MAX_SIGMA, a->misfit / c->target)) : plain;
    int quantised = bernoulli(rng, 0.25);
    c->egnr = c->plan.count ? a->misfit / sigma : 0;
    for (int i = 0; i < c->plan.count; i++) c->rival[i] = a->rival[i] / sigma;
    for (int k = 0; k < c->fit.outputs; k++) {
        c->sigma[k] = sigma * a->range[k];
        c->quantum[k] = quantised ? c->sigma[k] * uniform(rng, 0.2, 1) : 0;
        c->offset[k] = c->fit.offset ? a->range[k] * uniform(rng, 0.01, 0.1) * random_sign(rng) : 0;
        struct record *records[] = {&c->train, &c->test};
        for (int r = 0; r < 2; r++)
            add_noise(rng, records[r]->out[c->fit.first_output + k], records[r]->n, c->sigma[k], c->quantum[k], c->offset[k], records[r]->noisy[k]);
    }
}

/* If no size of TRIES is acceptable, the case is drawn again. The last of DRAWS is accepted in any case, unless a signal exceeds the
 * limit, because its gap has not been determined then. */
struct hidden_case make_case(uint64_t seed, int number) {
    struct hidden_case c = {.number = number, .seed = seed, .plan = plan_case(seed, number)};
    struct rng aside = rng_of(seed, 2u << 30 | (uint64_t)number);
    struct attempt a = {0};
    c.target = log_uniform(&aside, 0.3, 30);
    c.train = new_record(TRAIN), c.test = new_record(800 + 100 * random_below(&aside, 5));
    double share = 0;
    for (int draw = 0, good = 0; (draw < DRAWS || !(share <= MAX_SHARE)) && !good; draw++) {
        a.gain = a.sizes[0] = a.sizes[1] = 1;
        for (int k = 0; k < TRIES && !good; k++) {
            struct rng rng = rng_of(seed, (uint64_t)draw << 32 | (uint64_t)number);
            share = attempt_case(&c, &a, &rng);
            if (share <= MAX_SHARE && c.plan.count) examine(&c, &a);
            good = is_acceptable(&c, &a, share, k);
        }
    }
    draw_noise(&c, &aside, &a);
    return c;
}

void free_case(struct hidden_case *c) { free_record(&c->train), free_record(&c->test); }
