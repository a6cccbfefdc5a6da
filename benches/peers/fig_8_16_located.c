/* Fig 8.16 by hand: scalar C, classical Runge-Kutta with equal steps that end at every kink.
 * cc -O3 -march=native fig_8_16_located.c -o fig_8_16_located -lm
 *
 * Between kinks the rates are smooth: which piece holds is fixed before a step. After the step the kinks are looked at; where
 * one was passed, the step is done again up to where the cubic through its ends meets it, and the piece is changed. */
#include "slideway.h"

struct folded { double stiff, damp, solid, per_tc, vcl; };

/* The dead zone passes a (through = 1) shifted by the level of friction (side = -1, 0, 1); the share of friction at a
 * velocity is rest - slope v. */
struct piece { double through, side, rest, slope; int sign, beyond; };

enum kink { NONE, EDGE_PLUS, EDGE_MINUS, STANDING, CORNER };

static inline struct state rates(const struct folded *c, const struct piece *p, double v_i, struct state s) {
    double level = c->solid * (s.u * s.u);
    double beyond = p->through * s.a - p->side * level;
    return (struct state){c->stiff * (v_i - s.v), beyond - c->damp * s.v,
                          (p->rest - p->slope * s.v - s.u) * c->per_tc};
}

static inline struct state ahead(struct state s, struct state k, double h) {
    return (struct state){s.a + h * k.a, s.v + h * k.v, s.u + h * k.u};
}

static void set_piece(const struct folded *c, struct piece *p) {
    p->through = p->side != 0;
    p->rest = !p->beyond;
    p->slope = p->beyond ? 0 : p->sign / c->vcl;
}

/* Below 0 once the piece holds no longer on this side. */
static inline double margin(const struct folded *c, const struct piece *p, enum kink kink, struct state s) {
    double level = c->solid * (s.u * s.u);
    switch (kink) {
    case EDGE_PLUS: return p->side > 0 ? s.a - level : level - s.a;
    case EDGE_MINUS: return p->side < 0 ? -level - s.a : s.a + level;
    case STANDING: return p->sign * s.v;
    case CORNER: return p->beyond ? p->sign * s.v - c->vcl : c->vcl - p->sign * s.v;
    default: return 0;
    }
}

static inline int holds(const struct folded *c, const struct piece *p, struct state s) {
    double level = c->solid * (s.u * s.u), speed = p->sign * s.v;
    double plus = s.a - level, minus = s.a + level;
    int edges = p->side == 0 ? plus <= 0 && minus >= 0 : p->side > 0 ? plus >= 0 : minus <= 0;
    return edges && (p->beyond ? speed >= c->vcl : speed >= 0 && speed <= c->vcl);
}

static void change(const struct folded *c, struct piece *p, enum kink kink) {
    switch (kink) {
    case EDGE_PLUS: p->side = p->side > 0 ? 0 : 1; break;
    case EDGE_MINUS: p->side = p->side < 0 ? 0 : -1; break;
    case STANDING: p->sign = -p->sign; break;
    case CORNER: p->beyond = !p->beyond; break;
    default: break;
    }
    set_piece(c, p);
}

static inline struct state stepped(const struct folded *c, const struct piece *p, struct state s, double start,
                                   double rise, double h) {
    double middle = start + 0.5 * h * rise, end = start + h * rise;
    struct state k1 = rates(c, p, start, s);
    struct state k2 = rates(c, p, middle, ahead(s, k1, h / 2));
    struct state k3 = rates(c, p, middle, ahead(s, k2, h / 2));
    struct state k4 = rates(c, p, end, ahead(s, k3, h));
    double third = h / 3, sixth = h / 6;
    return (struct state){s.a + sixth * (k1.a + k4.a) + third * (k2.a + k3.a),
                          s.v + sixth * (k1.v + k4.v) + third * (k2.v + k3.v),
                          s.u + sixth * (k1.u + k4.u) + third * (k2.u + k3.u)};
}

/* The cubic through both ends and their rates, at a share of the step. */
static struct state within(struct state s, struct state k, struct state t, struct state l, double h, double x) {
    double y = 1 - x, s0 = y * y * (1 + 2 * x), s1 = x * x * (3 - 2 * x), d0 = h * x * y * y, d1 = -h * x * x * y;
    return (struct state){s0 * s.a + s1 * t.a + d0 * k.a + d1 * l.a, s0 * s.v + s1 * t.v + d0 * k.v + d1 * l.v,
                          s0 * s.u + s1 * t.u + d0 * k.u + d1 * l.u};
}

/* The share of the step at which the first kink is met, by the method of false position (Illinois), and which it is. */
static double first(const struct folded *c, const struct piece *p, struct state s, struct state t, double start,
                    double rise, double h, enum kink *which) {
    struct state k = rates(c, p, start, s), l = rates(c, p, start + h * rise, t);
    double earliest = 2;
    *which = NONE;
    for (enum kink kink = EDGE_PLUS; kink <= CORNER; kink++) {
        double low = 0, high = 1, at_low = margin(c, p, kink, s), at_high = margin(c, p, kink, t);
        /* The end of the dead zone that the piece is not at, and the corner while v turns, cannot be met first. */
        if (at_high >= 0 || (kink == EDGE_PLUS && p->side < 0) || (kink == EDGE_MINUS && p->side > 0)) continue;
        if (at_low <= 0) high = 0;
        for (int look = 0, side = 0; look < 30 && high - low > 1e-9; look++) {
            double x = (low * at_high - high * at_low) / (at_high - at_low);
            double at_x = margin(c, p, kink, within(s, k, t, l, h, x));
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
    struct folded c = {K / M, VISCOUS / M, FS / M, 1 / set->Tc, set->VcL};
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
            struct state next = stepped(&c, &p, s, start, rise, left);
            if (holds(&c, &p, next)) {
                s = next;
                break;
            }
            enum kink which;
            double part = first(&c, &p, s, next, start, rise, left, &which) * left;
            s = stepped(&c, &p, s, start, rise, part);
            start += rise * part, left -= part, kinks++;
            change(&c, &p, which);
        }
    }
    return kinks;
}
