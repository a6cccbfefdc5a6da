/* Fig 8.16 in hand-written scalar C: classical Runge-Kutta with equal steps that ignore kinks.
 * cc -O3 -march=native fig_8_16.c -o fig_8_16 -lm */
#include "slideway.h"

/* The constants of a step.
 *
 * Minima and maxima use branches: almost all are predicted, and the chain of dependent operations is shorter than with vminsd and
 * vmaxsd. */
struct constants { double stiff, damp, solid, per_vcl, per_tc; };

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

static inline struct state rates(const struct constants *c, double v_i, struct state s) {
    double u = larger(s.u, 0), level = c->solid * (u * u);
    double dead_zone = s.a > level ? s.a - level : s.a < -level ? s.a + level : 0;
    double share = 1 - smaller(fabs(s.v) * c->per_vcl, 1);
    return (struct state){c->stiff * (v_i - s.v), dead_zone - c->damp * s.v, (share - s.u) * c->per_tc};
}

static inline struct state euler_step(struct state s, struct state k, double h) {
    return (struct state){s.a + h * k.a, s.v + h * k.v, s.u + h * k.u};
}

static long integrate(const struct setting *set, double h, long steps, long per_row, double (*row)[SIGNALS]) {
    struct constants c = {K / M, VISCOUS / M, FS / M, 1 / set->VcL, 1 / set->Tc};
    double half = h / 2, third = h / 3, sixth = h / 6, rate = set->v_rate;
    struct state s = AT_REST;
    for (long first = 0; first < steps; first += per_row, row++) {
        long last = first + per_row < steps ? first + per_row : steps;
        record(*row, rate * (first * h), s, rates(&c, rate * (first * h), s).v);
        for (long i = first; i < last; i++) {
            double start = rate * (i * h), middle = start + rate * half, end = start + rate * h;
            struct state k1 = rates(&c, start, s);
            struct state k2 = rates(&c, middle, euler_step(s, k1, half));
            struct state k3 = rates(&c, middle, euler_step(s, k2, half));
            struct state k4 = rates(&c, end, euler_step(s, k3, h));
            s.a += sixth * (k1.a + k4.a) + third * (k2.a + k3.a);
            s.v += sixth * (k1.v + k4.v) + third * (k2.v + k3.v);
            s.u += sixth * (k1.u + k4.u) + third * (k2.u + k3.u);
        }
    }
    return 0;
}
