/* How well the base alone can explain a record: its parameters, states at the start and offset are fitted to the clean
 * outputs by Levenberg's and Marquardt's method. Linear bases run by their exact transition over a sample. */
#include "hidden.h"

enum { MAX_LINEAR = 4, MAX_UNKNOWNS = MAX_PARAMS + 2 + MAX_OUTPUTS };

typedef double matrix[MAX_LINEAR][MAX_LINEAR];

static void product(int n, matrix a, matrix b, matrix to) {
    matrix c = {{0}};
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++)
            for (int j = 0; j < n; j++) c[i][j] += a[i][k] * b[k][j];
    memcpy(to, c, sizeof c);
}

/* exp(a) by Taylor's series of a / 2^k, squared k times. */
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

/* Rates of the states that the base frees: a row of the states, then the drive. */
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

static int place_of(const struct system *s, enum state state) {
    for (int i = 0; i < s->states; i++)
        if (s->free[i] == state) return i;
    return 0;
}

/* Outputs of a base without solid friction; start: its free states. */
void linear_base(const struct system *s, const double *params, const double *start, const double *u, int n, const struct fit *fit,
                 double *const *out) {
    struct plant p = base_plant(s, params);
    int states = s->states, all = states + 2, places[MAX_OUTPUTS];
    matrix a = {{0}}, over = {{0}};
    linear_rates(&p, a);
    a[states][states + 1] = 1;                      /* the drive goes straight over a sample */
    for (int i = 0; i < states; i++)
        for (int j = 0; j <= states; j++) a[i][j] *= s->dt;
    exponential(all, a, over);
    for (int k = 0; k < fit->outputs; k++) places[k] = place_of(s, s->outputs[fit->first_output + k].state);
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
struct job {
    const struct system *system;
    const double *params, *full;
    const struct fit *fit;
    const struct record *data;
    struct record run;                              /* of a base with solid friction */
    int brake;
};

static void unknown(struct unknowns *u, double at, double unit, double low, double high) {
    int i = u->count++;
    u->at[i] = at, u->unit[i] = unit, u->low[i] = low, u->high[i] = high;
}

static struct unknowns unknowns_of(const struct job *j) {
    struct unknowns u = {0};
    const struct system *s = j->system;
    for (int i = 0; i < j->fit->count; i++) {
        const struct parameter *q = &s->params[j->fit->params[i]];
        unknown(&u, j->params[j->fit->params[i]], q->value, q->low, q->high);
    }
    for (int i = 0; i < s->states; i++) unknown(&u, j->data->start[s->free[i]], s->full[s->free[i]], -INFINITY, INFINITY);
    for (int k = 0; j->fit->offset && k < j->fit->outputs; k++) unknown(&u, 0, j->full[k], -INFINITY, INFINITY);
    return u;
}

/* Residuals in full scales of the outputs, one output behind the other. */
static double residuals(struct job *j, const struct unknowns *u, double *to) {
    const struct system *s = j->system;
    int n = j->data->n, next = j->fit->count;
    double params[MAX_PARAMS], start[2], *out[MAX_OUTPUTS], sum = 0;
    memcpy(params, j->params, sizeof params);
    for (int i = 0; i < j->fit->count; i++) params[j->fit->params[i]] = u->at[i];
    for (int i = 0; i < s->states; i++) j->run.start[s->free[i]] = start[i] = u->at[next++];
    for (int k = 0; k < j->fit->outputs; k++) out[k] = to + k * n;
    if (j->brake) {
        struct plant p = base_plant(s, params);
        simulate(&p, &j->run, 2);
        for (int k = 0; k < j->fit->outputs; k++) memcpy(out[k], j->run.out[j->fit->first_output + k], n * sizeof(double));
    } else linear_base(s, params, start, j->data->u, n, j->fit, out);
    for (int k = 0; k < j->fit->outputs; k++) {
        double offset = j->fit->offset ? u->at[next++] : 0;
        for (int i = 0; i < n; i++) {
            out[k][i] = (out[k][i] + offset - j->data->out[j->fit->first_output + k][i]) / j->full[k];
            sum += out[k][i] * out[k][i];
        }
    }
    return sum;
}

/* Solves a x = b for a symmetric positive a, by Cholesky's factors. */
static int solved(int n, double a[MAX_UNKNOWNS][MAX_UNKNOWNS], const double *b, double *x) {
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

/* Slopes of the residuals by differences over a small share of each unknown's unit; normal equations of them. */
static void normal(struct job *j, const struct unknowns *u, const double *base, double *slopes, double *other,
                   double a[MAX_UNKNOWNS][MAX_UNKNOWNS], double *b) {
    int n = j->data->n * j->fit->outputs;
    double by = j->brake ? 1e-4 : 1e-6;
    for (int i = 0; i < u->count; i++) {
        struct unknowns moved = *u;
        double step = by * u->unit[i] * (u->at[i] + by * u->unit[i] > u->high[i] ? -1 : 1);
        moved.at[i] += step;
        residuals(j, &moved, other);
        for (int k = 0; k < n; k++) slopes[i * n + k] = (other[k] - base[k]) / (step / u->unit[i]);
    }
    for (int i = 0; i < u->count; i++) {
        b[i] = 0;
        for (int k = 0; k < n; k++) b[i] -= slopes[i * n + k] * base[k];
        for (int m = 0; m <= i; m++) {
            double sum = 0;
            for (int k = 0; k < n; k++) sum += slopes[i * n + k] * slopes[m * n + k];
            a[i][m] = a[m][i] = sum;
        }
    }
}

/* One step downhill: more damping until it leads down. Returns the share by which the sum of squares fell. */
static double improved(struct job *j, struct unknowns *u, double *base, double *sum, double *damping, double *slopes, double *other) {
    double a[MAX_UNKNOWNS][MAX_UNKNOWNS], b[MAX_UNKNOWNS], x[MAX_UNKNOWNS];
    int n = j->data->n * j->fit->outputs;
    normal(j, u, base, slopes, other, a, b);
    for (int tries = 0; tries < 8; tries++, *damping *= 10) {
        double damped[MAX_UNKNOWNS][MAX_UNKNOWNS];
        memcpy(damped, a, sizeof a);
        for (int i = 0; i < u->count; i++) damped[i][i] += *damping * a[i][i] + 1e-300;
        if (!solved(u->count, damped, b, x)) continue;
        struct unknowns moved = *u;
        for (int i = 0; i < u->count; i++) moved.at[i] = fmax(u->low[i], fmin(u->high[i], u->at[i] + x[i] * u->unit[i]));
        double now = residuals(j, &moved, other);
        if (!(now < *sum)) continue;
        double share = (*sum - now) / *sum;
        *u = moved, *sum = now, *damping = fmax(1e-12, *damping / 30);
        memcpy(base, other, n * sizeof(double));
        return share;
    }
    return 0;
}

/* Rms that the best base leaves, as a share of full (one number an output); rms of every output alone in its unit; its parameters. */
double refitted(const struct system *s, const double *params, const struct fit *fit, const struct record *r,
                const double *full, double *rms, double *fitted) {
    struct plant p = base_plant(s, params);
    struct job job = {s, params, full, fit, r, {0}, has_brake(&p)};
    int n = r->n * fit->outputs;
    struct unknowns u = unknowns_of(&job);
    double *base = calloc(n, sizeof(double)), *other = calloc(n, sizeof(double)), *slopes = calloc((size_t)n * u.count, sizeof(double));
    if (job.brake) {
        job.run = new_record(r->n);
        memcpy(job.run.u, r->u, r->n * sizeof(double));
        through_chain(&p, &job.run);
    }
    double sum = residuals(&job, &u, base), damping = 1e-6;
    for (int round = 0; round < 30 && sum > 1e-24 * n; round++)
        if (improved(&job, &u, base, &sum, &damping, slopes, other) < 1e-5) break;
    for (int k = 0; k < fit->outputs; k++) {
        double squares = 0;
        for (int i = 0; i < r->n; i++) squares += base[k * r->n + i] * base[k * r->n + i];
        rms[k] = full[k] * sqrt(squares / r->n);
    }
    memcpy(fitted, params, MAX_PARAMS * sizeof(double));
    for (int i = 0; i < fit->count; i++) fitted[fit->params[i]] = u.at[i];
    free(base), free(other), free(slopes);
    if (job.brake) free_record(&job.run);
    return sqrt(sum / n);
}
