/* Fig 8.16 in hand-written scalar C: classical Runge-Kutta with equal steps that are divided at every kink.
 * cc -O3 -march=native fig_8_16_located.c -o fig_8_16_located -lm
 *
 * Between kinks the rates are smooth, and the active piece is fixed before a step. After the step the kinks are tested. If one was
 * passed, the step is repeated up to the kink, which is located on the cubic through the ends of the step. Then the piece changes. */
#include "slideway.h"

struct constants { double stiff, damp, solid, per_tc, vcl; };

/* The active piece. The dead zone passes a (through = 1) shifted by the level of friction (side = -1, 0, 1). The share of friction
 * at a velocity is rest - slope v. `sign` is that of the velocity; `beyond` means a speed above VcL. */
struct piece { double through, side, rest, slope; int sign, beyond; };

enum kink { NONE, EDGE_PLUS, EDGE_MINUS, STANDING, CORNER };

static inline struct state rates(const struct constants *c, const struct piece *p, double v_i, struct state s) {
    double level = c->solid * (s.u * s.u);
    double dead_zone = p->through * s.a - p->side * level;
    return (struct state){c->stiff * (v_i - s.v), dead_zone - c->damp * s.v,
                          (p->rest - p->slope * s.v - s.u) * c->per_tc};
}

static inline struct state euler_step(struct state s, struct state k, double h) {
    return (struct state){s.a + h * k.a, s.v + h * k.v, s.u + h * k.u};
}

static void set_piece(const struct constants *c, struct piece *p) {
    p->through = p->side != 0;
    p->rest = !p->beyond;
    p->slope = p->beyond ? 0 : p->sign / c->vcl;
}

/* The distance to a kink. It is negative if the kink is passed. */
static inline double margin(const struct constants *c, const struct piece *p, enum kink kink, struct state s) {
    double level = c->solid * (s.u * s.u);
    switch (kink) {
    case EDGE_PLUS: return p->side > 0 ? s.a - level : level - s.a;
    case EDGE_MINUS: return p->side < 0 ? -level - s.a : s.a + level;
    case STANDING: return p->sign * s.v;
    case CORNER: return p->beyond ? p->sign * s.v - c->vcl : c->vcl - p->sign * s.v;
    default: return 0;
    }
}

/* Whether a state is within the piece. */
static inline int is_within(const struct constants *c, const struct piece *p, struct state s) {
    double level = c->solid * (s.u * s.u), speed = p->sign * s.v;
    double plus = s.a - level, minus = s.a + level;
    int edges = p->side == 0 ? plus <= 0 && minus >= 0 : p->side > 0 ? plus >= 0 : minus <= 0;
    return edges && (p->beyond ? speed >= c->vcl : speed >= 0 && speed <= c->vcl);
}

static void change(const struct constants *c, struct piece *p, enum kink kink) {
    switch (kink) {
    case EDGE_PLUS: p->side = p->side > 0 ? 0 : 1; break;
    case EDGE_MINUS: p->side = p->side < 0 ? 0 : -1; break;
    case STANDING: p->sign = -p->sign; break;
    case CORNER: p->beyond = !p->beyond; break;
    default: break;
    }
    set_piece(c, p);
}

static inline struct state runge_kutta_step(const struct constants *c, const struct piece *p, struct state s, double start,
                                   double rise, double h) {
    double middle = start + 0.5 * h * rise, end = start + h * rise;
    struct state k1 = rates(c, p, start, s);
    struct state k2 = rates(c, p, middle, euler_step(s, k1, h / 2));
    struct state k3 = rates(c, p, middle, euler_step(s, k2, h / 2));
    struct state k4 = rates(c, p, end, euler_step(s, k3, h));
    double third = h / 3, sixth = h / 6;
    return (struct state){s.a + sixth * (k1.a + k4.a) + third * (k2.a + k3.a),
                          s.v + sixth * (k1.v + k4.v) + third * (k2.v + k3.v),
                          s.u + sixth * (k1.u + k4.u) + third * (k2.u + k3.u)};
}

/* The cubic through both ends and their rates, at a share of the step. */
static struct state cubic_at(struct state s, struct state k, struct state t, struct state l, double h, double x) {
    double y = 1 - x, s0 = y * y * (1 + 2 * x), s1 = x * x * (3 - 2 * x), d0 = h * x * y * y, d1 = -h * x * x * y;
    return (struct state){s0 * s.a + s1 * t.a + d0 * k.a + d1 * l.a, s0 * s.v + s1 * t.v + d0 * k.v + d1 * l.v,
                          s0 * s.u + s1 * t.u + d0 * k.u + d1 * l.u};
}

/* The share of the step at the first kink, by the method of false position (Illinois), and the kink. */
static double locate_first_kink(const struct constants *c, const struct piece *p, struct state s, struct state t, double start,
                    double rise, double h, enum kink *which) {
    struct state k = rates(c, p, start, s), l = rates(c, p, start + h * rise, t);
    double earliest = 2;
    *which = NONE;
    for (enum kink kink = EDGE_PLUS; kink <= CORNER; kink++) {
        double low = 0, high = 1, at_low = margin(c, p, kink, s), at_high = margin(c, p, kink, t);
        /* From one side of the dead zone, its other edge cannot be the first kink. */
        if (at_high >= 0 || (kink == EDGE_PLUS && p->side < 0) || (kink == EDGE_MINUS && p->side > 0)) continue;
        if (at_low <= 0) high = 0;
        for (int look = 0, side = 0; look < 30 && high - low > 1e-9; look++) {
            double x = (low * at_high - high * at_low) / (at_high - at_low);
            double at_x = margin(c, p, kink, cubic_at(s, k, t, l, h, x));
            if (fabs(at_x) < 1e-12) { high = x; break; }
            if (at_x < 0) {
                high = x, at_high = at_x;
                if (side < 0) at_low /= 2;
                side = -1;
            } else {
                low = x, at_low = at_x;
                if (side > 0) at_high /= 2;
                side = 1;
            }
        }
        if (high < earliest) earliest = high, *which = kink;
    }
    return earliest;
}

static long integrate(const struct setting *set, double h, long steps, long per_row, double (*row)[SIGNALS]) {
    struct constants c = {K / M, VISCOUS / M, FS / M, 1 / set->Tc, set->VcL};
    struct piece p = {.sign = 1};
    set_piece(&c, &p);
    struct state s = AT_REST;
    double rise = set->v_rate;
    long kinks = 0;
    for (long i = 0; i < steps; i++) {
        double start = rise * (i * h);
        if (i % per_row == 0) record(row[i / per_row], start, s, rates(&c, &p, start, s).v);
        double left = h;
        for (;;) {
            struct state next = runge_kutta_step(&c, &p, s, start, rise, left);
            if (is_within(&c, &p, next)) {
                s = next;
                break;
            }
            enum kink which;
            double part = locate_first_kink(&c, &p, s, next, start, rise, left, &which) * left;
            s = runge_kutta_step(&c, &p, s, start, rise, part);
            start += rise * part, left -= part, kinks++;
            change(&c, &p, which);
        }
    }
    return kinks;
}
