/* Comparisons with closed solutions. Each returns the largest error as a share of the largest value. */
#include "hidden.h"

enum { N = 2400 };
struct check { const char *what; double (*error)(void); double most; };

static struct plant plant_of(const char *name, const double *params) { return base_plant(system_named(name), params); }

static struct record run_plant(const struct plant *p, double (*drive)(double t), const double *start) {
    struct record r = new_record(N);
    for (int i = 0; i < N; i++) r.u[i] = drive(i * p->system->dt);
    memcpy(r.start, start, sizeof r.start);
    apply_drive_chain(p, &r);
    simulate(p, &r, TRUE_RUN_STEPS);
    return r;
}

static double largest_error(struct record *r, int output, double dt, double (*solution)(double t)) {
    double most = 0, top = 0;
    for (int i = 0; i < N; i++) {
        most = fmax(most, fabs(r->out[output][i] - solution(i * dt)));
        top = fmax(top, fabs(solution(i * dt)));
    }
    free_record(r);
    return most / top;
}

static double nothing(double t) { return 0 * t; }
static double fifty(double t) { return 50 + 0 * t; }
static double rising(double t) { return 10 * t; }
static double swinging(double t) { return 10 * sin(20 * t); }
static double slow_sine(double t) { return 4 * sin(0.02 * t); }

/* A mass on a spring with Coulomb friction: the amplitude falls by 2 Fc / k per half period, until friction holds the mass. */
static double half_periods(double t) {
    double loss = 2 * 8.0 / 500, rate = sqrt(500 / 3.0), x0 = 0.1;
    for (int n = 0;; n++) {
        double from = x0 - n * loss, side = n % 2 ? -1 : 1, since = t - n * M_PI / rate;
        if (from <= loss / 2) return side * from;
        if (since <= M_PI / rate) return side * ((from - loss / 2) * cos(rate * since) + loss / 2);
    }
}
static double coulomb_decay(void) {
    struct plant p = plant_of("oscillator-undamped", (double[]){3, 500});
    p.coulomb = 8;
    struct record r = run_plant(&p, nothing, (double[STATES]){[X] = 0.1});
    return largest_error(&r, 0, p.system->dt, half_periods);
}

/* A mass with an initial velocity: v = (v0 + Fc / f) exp(-f t / M) - Fc / f until it is at rest. */
static double thrown(double t) {
    double M = 20, f = 40, Fc = 8, v0 = 1, lag = M / f, end = lag * log1p(f * v0 / Fc), s = fmin(t, end);
    return (v0 + Fc / f) * lag * (1 - exp(-s / lag)) - Fc / f * s;
}
static double sliding_to_rest(void) {
    struct plant p = plant_of("axis-coulomb", (double[]){20, 40, 8});
    struct record r = run_plant(&p, nothing, (double[STATES]){[V] = 1});
    return largest_error(&r, 0, p.system->dt, thrown);
}

/* Force 10 N/s x t on a mass at rest: it breaks loose at Fc / rate and moves by rate s^3 / (6 M). */
static double broken_loose(double t) { return t > 0.8 ? 10 * pow(t - 0.8, 3) / (6 * 20) : 0; }
static double breaking_loose(void) {
    struct plant p = plant_of("axis-ideal", (double[]){20});
    p.coulomb = 8;
    struct record r = run_plant(&p, rising, (double[STATES]){0});
    return largest_error(&r, 0, p.system->dt, broken_loose);
}

/* Friction that grows at rest to 8 + 10 (1 - exp(-t / 0.5)): 10 t exceeds it at the root of 10 t = 18 - 10 exp(-2 t). */
static double loose_after_growth(double t) {
    double at = 1.5;
    for (int i = 0; i < 50; i++) at = (18 - 10 * exp(-2 * at)) / 10;
    double s = t - at, jump = 10 * at - 8;
    return s > 0 ? (jump * s * s / 2 + 10 * s * s * s / 6) / 20 : 0;
}
static double growth(void) {
    struct plant p = plant_of("axis-ideal", (double[]){20});
    p.coulomb = 8, p.growth = 10, p.growth_time = 0.5, p.growing = EXPONENTIAL;
    struct record r = run_plant(&p, rising, (double[STATES]){0});
    return largest_error(&r, 0, p.system->dt, loose_after_growth);
}

/* First order: T = P / G + (T0 - P / G) exp(-t G / C). */
static double heated(double t) { return 20 - 15 * exp(-t / 200); }
static double first_order(void) {
    struct plant p = plant_of("heater", (double[]){500, 2.5});
    struct record r = run_plant(&p, fifty, (double[STATES]){5});
    return largest_error(&r, 0, p.system->dt, heated);
}

/* At resonance the amplitude is F / (c w0). Linear interpolation of a sine lowers it by sinc^2 of half a sample, and its corners
 * change the motion by 1e-7. */
static double resonance(void) {
    struct plant p = plant_of("oscillator", (double[]){1.25, 500, 20});
    struct record r = run_plant(&p, swinging, (double[STATES]){0});
    double half = 20 * p.system->dt / 2, amplitude = 10 / (20.0 * 20) * pow(sin(half) / half, 2), most = 0;
    for (int i = N - 600; i < N; i++) most = fmax(most, fabs(r.out[0][i] + amplitude * cos(20 * i * p.system->dt)));
    free_record(&r);
    return most / amplitude;
}

/* Runs of the linear bases by exact transition and by steps agree. */
static double transition(void) {
    double most = 0;
    for (int k = 0; k < SYSTEM_COUNT; k++) {
        const struct system *s = &SYSTEMS[k];
        double params[MAX_PARAMS], start[2] = {0.1 * s->full[s->free[0]], s->states > 1 ? 0.05 * s->full[s->free[1]] : 0};
        for (int i = 0; i < MAX_PARAMS; i++) params[i] = s->params[i].value;
        struct plant p = base_plant(s, params);
        p.Fc = p.Fs = 0;
        double states[STATES] = {0};
        for (int i = 0; i < s->states; i++) states[s->free[i]] = start[i];
        struct record r = run_plant(&p, s->wanders ? slow_sine : rising, states), exact = new_record(N);
        struct fit fit = {.outputs = s->outputs[1].signal ? 2 : 1};
        linear_base(s, params, start, r.u, N, &fit, exact.out);
        for (int o = 0; o < fit.outputs; o++) {
            double top = 0, difference = 0;
            for (int i = 0; i < N; i++) top = fmax(top, fabs(exact.out[o][i])), difference = fmax(difference, fabs(exact.out[o][i] - r.out[o][i]));
            most = fmax(most, difference / top);
        }
        free_record(&r), free_record(&exact);
    }
    return most;
}

/* The output of a lag for a ramp is t - T + T exp(-t / T). The vessel integrates it. */
static double lagged_ramp(double t) {
    double T = 30, sum = t * t / 2 - T * t + T * T * (1 - exp(-t / T));
    return 10 / 500.0 * sum;
}
static double lag(void) {
    struct plant p = plant_of("heater-ideal", (double[]){500});
    p.lag = 30;
    struct record r = run_plant(&p, rising, (double[STATES]){0});
    return largest_error(&r, 0, p.system->dt, lagged_ramp);
}

static double delayed_ramp(double t) { return t > 31 ? 10 / 500.0 * (t - 31) * (t - 31) / 2 : 0; }
static double delay(void) {
    struct plant p = plant_of("heater-ideal", (double[]){500});
    p.delay = 31;
    struct record r = run_plant(&p, rising, (double[STATES]){0});
    return largest_error(&r, 0, p.system->dt, delayed_ramp);
}

/* Free motion to the stop and back. */
static double rebounded(double t) { return t < 1 ? 0.3 * t : 0.3 - 0.18 * (t - 1); }
static double rebound(void) {
    struct plant p = plant_of("axis-ideal", (double[]){20});
    p.stop = REBOUND, p.stop_side = 1, p.stop_at = 0.3, p.rebound = 0.6;
    struct record r = run_plant(&p, nothing, (double[STATES]){[V] = 0.3});
    return largest_error(&r, 0, p.system->dt, rebounded);
}

/* Torricelli: the root of the level falls linearly. */
static double emptied(double t) {
    double root = sqrt(0.5) - 1e-5 * t / (2 * 0.02);
    return root > 0 ? root * root : 0;
}
static double torricelli(void) {
    struct plant p = plant_of("tank", (double[]){20e-6});
    p.leak = 1e-5, p.leaking = ROOT;
    struct record r = run_plant(&p, nothing, (double[STATES]){0.5});
    return largest_error(&r, 0, p.system->dt, emptied);
}

/* An inflow of 1e-3 m3/s fills a tank with an outlet up to its brim at 0.6 m. The lower tank gets the outflow and half of the
 * overflow. */
static double lower_level(double t) {
    double T1 = 0.02 * 1500, T2 = 0.03 * 1500, full = 1e-3 * 1500, brim = 0.6, at = -T1 * log(1 - brim / full), s = fmin(t, at);
    double level = full * (1 - (T2 * exp(-s / T2) - T1 * exp(-s / T1)) / (T2 - T1));
    double end = 1500 * (brim / 1500 + 0.5 * (1e-3 - brim / 1500));
    return t < at ? level : end + (level - end) * exp(-(t - at) / T2);
}
static double overflow(void) {
    struct plant p = plant_of("tanks", (double[]){20e-6, 1500, 1500});
    p.overflowing = LIMIT, p.overflow_at = 0.6, p.overflow_share = 0.5;
    struct record r = run_plant(&p, fifty, (double[STATES]){0});
    return largest_error(&r, 1, p.system->dt, lower_level);
}

/* A play of +-1 after 4 sin(0.02 t): u - 1 up to the peak, then constant at 3, then u + 1 on the way down. */
static double play(void) {
    struct plant p = plant_of("tank", (double[]){20e-6});
    p.play = 1;
    struct record r = run_plant(&p, slow_sine, (double[STATES]){0});
    double most = 0, top = M_PI / 2 / 0.02, from = (M_PI - asin(0.5)) / 0.02, until = 1.5 * M_PI / 0.02;
    for (int i = 0; i < FINE * (int)until; i++) {
        double t = (double)i / FINE, u = slow_sine(t), due = t < top ? fmax(0, u - 1) : t < from ? 3 : u + 1;
        most = fmax(most, fabs(r.chain_output[i] - due));
    }
    free_record(&r);
    return most / 4;
}

/* A refit that starts 4 % from the truth returns to it, with solid friction too. Its steps are longer than those of the true run. */
static double refit(void) {
    double most = 0;
    const char *names[] = {"slide", "axis", "oscillator", "tanks", "heater", "slide-coulomb", "axis-coulomb", "slide-falling"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const struct system *s = system_named(names[k]);
        struct rng c = rng_of(1, k);
        struct record r = new_record(N);
        struct fit fit = {.count = params_of(s), .outputs = 1};
        double params[MAX_PARAMS], start[MAX_PARAMS], top = s->full[s->outputs[0].state];
        if (s->family == TANKS) fit.outputs = 2, fit.count = 2;
        for (int i = 0; i < MAX_PARAMS; i++) params[i] = start[i] = s->params[i].value;
        for (int i = 0; i < fit.count; i++) fit.params[i] = i, start[i] *= i % 2 ? 0.96 : 1.04;
        struct plant p = base_plant(s, params);
        r.start[s->free[0]] = 0.1 * s->full[s->free[0]];
        draw_drive(&c, s, params, 1, 0, &r);
        apply_drive_chain(&p, &r), simulate(&p, &r, TRUE_RUN_STEPS);
        struct job job = {s, start, &fit, &r, (double[]){top, top}, NULL, 0, 30};
        double left = refit_base(&job).misfit;
        printf("    %-16s misfit %.1e of full scale\n", names[k], left);
        most = fmax(most, left);
        free_record(&r);
    }
    return most;
}

/* Tests mean 0, variance 1 and kurtosis 3 of a million Gaussian numbers. */
static double rng(void) {
    struct rng c = rng_of(7, 7);
    double one = 0, two = 0, four = 0;
    for (int i = 0; i < 1000000; i++) {
        double g = gaussian(&c);
        one += g, two += g * g, four += g * g * g * g;
    }
    return fmax(fabs(one / 1e6), fmax(fabs(two / 1e6 - 1), fabs(four / 3e6 - 1)));
}

/* Each hundred cases have the planned shares, and 1100 cases contain every effect. */
static double shares(void) {
    int met[4] = {0}, wrong = 0;
    for (int n = 1; n <= 100; n++) {
        struct plan p = plan_case(7, n);
        met[p.count == 0 ? 0 : p.count == 2 ? 1 : strncmp(p.effects[0], "unknown:", 8) ? 2 : 3]++;
    }
    wrong += met[0] != 35 || met[1] != 12 || met[2] != 40 || met[3] != 13;
    for (int k = 0; k < LAW_COUNT; k++) {
        int seen = 0;
        for (int n = 1; n <= 1100; n++) {
            struct plan p = plan_case(7, n);
            seen |= p.count == 1 && !strcmp(p.effects[0], LAWS[k].name);
        }
        wrong += !seen;
    }
    return wrong;
}

int self_test(void) {
    static const struct check CHECKS[] = {
        {"free decay with Coulomb friction", coulomb_decay, 1e-8}, {"sliding to rest", sliding_to_rest, 1e-9},
        {"breaking loose", breaking_loose, 1e-9}, {"friction grown at rest", growth, 1e-8}, {"first order", first_order, 1e-10},
        {"resonance", resonance, 1e-6}, {"steps and exact transition", transition, 1e-7}, {"lag of a ramp", lag, 1e-8},
        {"delay of a ramp", delay, 1e-6}, {"restitution", rebound, 1e-10}, {"Torricelli", torricelli, 1e-6}, {"overflow", overflow, 1e-8},
        {"play", play, 1e-4}, {"refit", refit, 1e-6}, {"random numbers", rng, 5e-3}, {"shares of the plan", shares, 0},
    };
    int failed = 0;
    for (size_t i = 0; i < sizeof CHECKS / sizeof *CHECKS; i++) {
        double error = CHECKS[i].error();
        int good = error <= CHECKS[i].most;
        failed += !good;
        printf("%-34s %8.1e of at most %.0e %s\n", CHECKS[i].what, error, CHECKS[i].most, good ? "" : "FAILED");
    }
    return failed > 0;
}
