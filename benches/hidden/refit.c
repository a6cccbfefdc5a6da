/* The best fit of the base to a record: its parameters, initial states and offsets are fitted to the clean outputs by the
 * Levenberg-Marquardt method. Linear bases use their exact transition over a sample. */
#include "hidden.h"

enum { MAX_LINEAR = 4, MAX_UNKNOWNS = MAX_PARAMS + 2 + MAX_OUTPUTS + 1 };

typedef double matrix[MAX_LINEAR][MAX_LINEAR];

static void product(int n, matrix a, matrix b, matrix to) {
    matrix c = {{0}};
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int j = 0; j < n; j++) c[i][j] += a[i][k] * b[k][j];
    memcpy(to, c, sizeof c);
}

/* exp(a) by the Taylor series of a / 2^k, squared k times. */
static void exponential(int n, matrix a, matrix to) {
    double size = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) size = fmax(size, fabs(a[i][j]));
    int halvings = size > 0.1 ? (int)ceil(log2(size / 0.1)) : 0;
    matrix term = {{0}}, sum = {{0}};
    for (int i = 0; i < n; i++) {
        term[i][i] = sum[i][i] = 1;
        for (int j = 0; j < n; j++) a[i][j] = ldexp(a[i][j], -halvings);
    }
    for (int k = 1; k < 16; k++) {
        product(n, term, a, term);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) term[i][j] /= k, sum[i][j] += term[i][j];
    }
    while (halvings--) product(n, sum, sum, sum);
    memcpy(to, sum, sizeof sum);
}

/* Rates of the base's free states. Each row has the coefficients of the states, then that of the drive. */
static void linear_rates(const struct plant *p, matrix a) {
    switch (p->system->family) {
    case SLIDE:                                     /* e' = u - v, M v' = K e + C (u - v) - f v */
        a[0][1] = -1, a[0][2] = 1;
        a[1][0] = p->K / p->M, a[1][1] = -(p->C + p->f) / p->M, a[1][2] = p->C / p->M;
        break;
    case AXIS: case OSCILLATOR:                     /* M x'' = u - f x' - k x */
        a[0][1] = 1, a[1][0] = -p->k / p->M, a[1][1] = -p->f / p->M, a[1][2] = 1 / p->M;
        break;
    case TANKS:                                     /* A1 h1' = ku u - h1 / R1, A2 h2' = h1 / R1 - h2 / R2 */
        a[0][0] = -1 / (p->A1 * p->R1), a[0][2] = p->ku / p->A1;
        a[1][0] = 1 / (p->A2 * p->R1), a[1][1] = -1 / (p->A2 * p->R2);
        break;
    case TANK: a[0][1] = p->ku / p->A1; break;
    case HEATER: a[0][0] = -p->G / p->capacity, a[0][1] = 1 / p->capacity; break;
    }
}

static int state_index(const struct system *s, enum state state) {
    for (int i = 0; i < s->states; i++)
        if (s->free[i] == state) return i;
    return 0;
}

/* Outputs of a base without solid friction. `start` has the initial values of its free states. */
void linear_base(const struct system *s, const double *params, const double *start, const double *u, int n, const struct fit *fit,
                 double *const *out) {
    struct plant p = base_plant(s, params);
    int states = s->states, all = states + 2, places[MAX_OUTPUTS];
    matrix a = {{0}}, over = {{0}};
    linear_rates(&p, a);
    a[states][states + 1] = 1;                      /* the drive is linear over a sample */
    for (int i = 0; i < states; i++)
        for (int j = 0; j <= states; j++) a[i][j] *= s->dt;
    exponential(all, a, over);
    for (int k = 0; k < fit->outputs; k++) places[k] = state_index(s, s->outputs[fit->first_output + k].state);
    double y[2] = {start[0], states > 1 ? start[1] : 0};
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < fit->outputs; k++) out[k][i] = y[places[k]];
        if (i + 1 == n) break;
        double rise = u[i + 1] - u[i], next[2] = {0};
        for (int r = 0; r < states; r++) {
            next[r] = over[r][states] * u[i] + over[r][states + 1] * rise;
            for (int c = 0; c < states; c++) next[r] += over[r][c] * y[c];
        }
        y[0] = next[0], y[1] = next[1];
    }
}

/* ---- the fit */

struct unknowns { int count; double at[MAX_UNKNOWNS], unit[MAX_UNKNOWNS], low[MAX_UNKNOWNS], high[MAX_UNKNOWNS]; };
struct work {
    const struct job *job;
    int stepped;                                    /* runs by steps, because of solid friction or of effects in addition to the base */
    struct record run;
    double *base, *other, *slopes;                  /* residuals, residuals of a trial, derivatives by every unknown */
};

static void add_unknown(struct unknowns *u, double at, double unit, double low, double high) {
    int i = u->count++;
    u->at[i] = at, u->unit[i] = unit, u->low[i] = low, u->high[i] = high;
}

static struct unknowns unknowns_of(const struct job *j) {
    struct unknowns u = {0};
    const struct system *s = j->system;
    for (int i = 0; i < j->fit->count; i++) {
        const struct parameter *q = &s->params[j->fit->params[i]];
        add_unknown(&u, j->params[j->fit->params[i]], q->value, q->low, q->high);
    }
    for (int i = 0; i < s->states; i++) add_unknown(&u, j->data->start[s->free[i]], s->full[s->free[i]], -INFINITY, INFINITY);
    for (int k = 0; j->fit->offset && k < j->fit->outputs; k++) add_unknown(&u, 0, j->full[k], -INFINITY, INFINITY);
    if (j->coulomb) add_unknown(&u, j->with->coulomb, j->with->coulomb, 0, INFINITY);
    return u;
}

static void run_by_steps(struct work *w, const double *params, double coulomb, double *const *out) {
    const struct job *j = w->job;
    struct plant p = j->with ? *j->with : base_plant(j->system, params);
    set_base(&p, params);
    if (j->coulomb) p.coulomb = coulomb;
    simulate(&p, &w->run, p.bristle ? TRUE_RUN_STEPS : 2);
    for (int k = 0; k < j->fit->outputs; k++) memcpy(out[k], w->run.out[j->fit->first_output + k], j->data->n * sizeof(double));
}

/* Residuals as shares of full scale, one output after the other. Returns the sum of their squares. */
static double residuals(struct work *w, const struct unknowns *u, double *to) {
    const struct job *j = w->job;
    int n = j->data->n, next = j->fit->count;
    double params[MAX_PARAMS], start[2], *out[MAX_OUTPUTS], sum = 0;
    memcpy(params, j->params, sizeof params);
    for (int i = 0; i < j->fit->count; i++) params[j->fit->params[i]] = u->at[i];
    for (int i = 0; i < j->system->states; i++) w->run.start[j->system->free[i]] = start[i] = u->at[next++];
    for (int k = 0; k < j->fit->outputs; k++) out[k] = to + k * n;
    if (w->stepped) run_by_steps(w, params, u->at[u->count - 1], out);
    else linear_base(j->system, params, start, j->data->u, n, j->fit, out);
    for (int k = 0; k < j->fit->outputs; k++) {
        double offset = j->fit->offset ? u->at[next++] : 0;
        for (int i = 0; i < n; i++) {
            out[k][i] = (out[k][i] + offset - j->data->out[j->fit->first_output + k][i]) / j->full[k];
            sum += out[k][i] * out[k][i];
        }
    }
    return sum;
}

/* Solves a x = b for a symmetric positive definite a by Cholesky factors. Returns 0 if a is not positive definite. */
static int cholesky_solve(int n, double a[MAX_UNKNOWNS][MAX_UNKNOWNS], const double *b, double *x) {
    double l[MAX_UNKNOWNS][MAX_UNKNOWNS];
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double sum = a[i][j];
            for (int k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 0)) return 0;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    for (int i = 0; i < n; i++) {
        x[i] = b[i];
        for (int k = 0; k < i; k++) x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
    return 1;
}

/* Derivatives of the residuals by differences over a small share of each unknown's unit, and their normal equations. */
static void normal_equations(struct work *w, const struct unknowns *u, double a[MAX_UNKNOWNS][MAX_UNKNOWNS], double *b) {
    int n = w->job->data->n * w->job->fit->outputs;
    double by = w->stepped ? 1e-4 : 1e-6;
    for (int i = 0; i < u->count; i++) {
        struct unknowns moved = *u;
        double step = by * u->unit[i] * (u->at[i] + by * u->unit[i] > u->high[i] ? -1 : 1);
        moved.at[i] += step;
        residuals(w, &moved, w->other);
        for (int k = 0; k < n; k++) w->slopes[i * n + k] = (w->other[k] - w->base[k]) / (step / u->unit[i]);
    }
    for (int i = 0; i < u->count; i++) {
        b[i] = 0;
        for (int k = 0; k < n; k++) b[i] -= w->slopes[i * n + k] * w->base[k];
        for (int m = 0; m <= i; m++) {
            double sum = 0;
            for (int k = 0; k < n; k++) sum += w->slopes[i * n + k] * w->slopes[m * n + k];
            a[i][m] = a[m][i] = sum;
        }
    }
}

/* One step: the damping increases until the sum of squares falls. Returns the share by which it fell; 0 if it did not. */
static double marquardt_step(struct work *w, struct unknowns *u, double *sum, double *damping) {
    double a[MAX_UNKNOWNS][MAX_UNKNOWNS], b[MAX_UNKNOWNS], x[MAX_UNKNOWNS];
    normal_equations(w, u, a, b);
    for (int tries = 0; tries < 8; tries++, *damping *= 10) {
        double damped[MAX_UNKNOWNS][MAX_UNKNOWNS];
        memcpy(damped, a, sizeof a);
        for (int i = 0; i < u->count; i++) damped[i][i] += *damping * a[i][i] + 1e-300;
        if (!cholesky_solve(u->count, damped, b, x)) continue;
        struct unknowns moved = *u;
        for (int i = 0; i < u->count; i++) moved.at[i] = fmax(u->low[i], fmin(u->high[i], u->at[i] + x[i] * u->unit[i]));
        double now = residuals(w, &moved, w->other);
        if (!(now < *sum)) continue;
        double share = (*sum - now) / *sum, *kept = w->base;
        *u = moved, *sum = now, *damping = fmax(1e-12, *damping / 30);
        w->base = w->other, w->other = kept;
        return share;
    }
    return 0;
}

static struct fit_result minimise(struct work *w, struct unknowns u) {
    const struct job *j = w->job;
    int n = j->data->n;
    double sum = residuals(w, &u, w->base), damping = 1e-6;
    struct fit_result best = {0};
    for (int round = 0; round < j->rounds && sum > 1e-24 * n; round++)
        if (marquardt_step(w, &u, &sum, &damping) < 1e-5) break;
    best.misfit = sqrt(sum / (n * j->fit->outputs));
    for (int k = 0; k < j->fit->outputs; k++) {
        double squares = 0;
        for (int i = 0; i < n; i++) squares += w->base[k * n + i] * w->base[k * n + i];
        best.rms[k] = j->full[k] * sqrt(squares / n);
    }
    memcpy(best.params, j->params, sizeof best.params);
    for (int i = 0; i < j->fit->count; i++) best.params[j->fit->params[i]] = u.at[i];
    return best;
}

/* The best fit: rms residual as a share of full scale, rms of every output in its unit, parameters. Linear bases start from the true
 * parameters and from eight neighbouring points. Others take a hundred times longer and start only from the true parameters. */
struct fit_result refit_base(const struct job *job) {
    struct plant plain = base_plant(job->system, job->params);
    const struct plant *p = job->with ? job->with : &plain;
    struct unknowns u = unknowns_of(job);
    size_t n = (size_t)job->data->n * job->fit->outputs;
    struct work w = {job, job->with || has_brake(p), new_record(job->data->n), malloc(n * sizeof(double)), malloc(n * sizeof(double)),
                     malloc(n * u.count * sizeof(double))};
    memcpy(w.run.u, job->data->u, job->data->n * sizeof(double));
    apply_drive_chain(p, &w.run);
    struct fit_result best = minimise(&w, u);
    for (int start = 0; start < (w.stepped ? 0 : 8); start++) {
        struct unknowns neighbour = u;
        for (int i = 0; i < job->fit->count; i++)
            neighbour.at[i] = fmax(u.low[i], fmin(u.high[i], u.at[i] * (start >> i & 1 ? 1.15 : 0.87)));
        struct fit_result other = minimise(&w, neighbour);
        if (other.misfit < best.misfit) best = other;
    }
    free_record(&w.run), free(w.base), free(w.other), free(w.slopes);
    return best;
}
