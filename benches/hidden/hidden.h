/* What the files of the simulator share: see main.c for what it is. SI units throughout. */
#ifndef HIDDEN_H
#define HIDDEN_H
#define _XOPEN_SOURCE 700 /* M_PI, realpath */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- noise.c: chance */
struct chance { uint64_t s[4]; int spare_set; double spare; };
struct chance chance_of(uint64_t seed, uint64_t stream);
double even(struct chance *c, double low, double high);     /* uniform */
double scaled(struct chance *c, double low, double high);   /* log-uniform */
double gauss(struct chance *c);
int below(struct chance *c, int n);                         /* 0 ... n - 1 */
int odds(struct chance *c, double share);                   /* 1 with this probability */
double sign_of_chance(struct chance *c);
void measured(struct chance *c, const double *clean, int n, double sigma, double quantum, double offset, double *out);

/* ---- systems.c: the base systems */
enum family { SLIDE, AXIS, OSCILLATOR, TANKS, TANK, HEATER };
enum { MAX_PARAMS = 6, MAX_OUTPUTS = 2, MAX_RATES = 16 };
/* States of a plant. Mechanical ones: error (in motion.c less the way of the drive), position, velocity, inner state of friction;
 * tanks: two levels; heater: temperature. */
enum state { E, X, V, Z, STATES, H1 = 0, H2 = 1, TEMPERATURE = 0 };

struct parameter { const char *name, *unit; double value, low, high; int fitted; };
struct output { const char *signal; enum state state; };
struct system {
    const char *name, *drive, *drive_unit, *first_junction, *second_junction;
    enum family family;
    struct parameter params[MAX_PARAMS];
    struct output outputs[MAX_OUTPUTS];
    double dt, period;               /* s; the slow end of what is quick in the system, in samples */
    double full_drive, full_force, full[STATES];    /* what 100 V stand for; 0: no such signal in the patch */
    enum state free[2];              /* states of the base, free at the start */
    int states;
    int wanders, positive;           /* the drive must come back; is never below 0 */
    int second_output_alone;         /* 1: may be measured by its second output alone; 0: by the first alone */
};
extern const struct system SYSTEMS[];
extern const int SYSTEM_COUNT;
const struct system *system_named(const char *name);
int params_of(const struct system *s);

/* ---- plant: the base and all that may be hidden in it; 0 or NONE where absent */
enum shape { NONE, EXPONENTIAL, GAUSSIAN, LORENTZIAN, THESIS, LEVEL, DISTANCE, DAHL, LUGRE, ELASTOPLASTIC, LOGARITHMIC,
             HARD, SOFT, SPRING, REBOUND, LINEAR, CURVED, ROOT, LIMIT, WEIR };
enum { BUMPS = 5 };
struct plant {
    const struct system *system;
    /* base */
    double M, K, C, k, f, Fc, Fs, VcL;             /* mechanical; Fc: level of a brake; Fs, VcL: of a falling brake */
    double A1, A2, ku, R1, R2, capacity, G;        /* tanks, heater */
    /* friction */
    double coulomb, load, growth, growth_time;
    double falling_to, falling_by, falling_velocity, memory_time, memory_distance, bristle_level, bristle_stiffness, bristle_damping;
    enum shape falling, growing, memory, bristle;
    /* forces */
    double asymmetry, quadratic, cubic, stop_at, stop_side, stop_stiffness, stop_damping, rebound;
    double bias, drift, drift_time, wave, wave_rate, wave_phase, mass_factor, mass_time;
    enum shape stop, drifting;
    int second;                                    /* 1: bias, drift, wave and leak act on the lower tank */
    /* tanks, heater */
    double leak, overflow_at, overflow_share, weir;
    enum shape leaking, overflowing;
    /* drive */
    double limit, dead, delay, lag, play, relay, relay_at;
    enum shape limiting, dead_shape;
    /* not in the library */
    double thaw, thaw_time, bump[BUMPS], bump_at[BUMPS], bump_width;
    double walk, shock;                            /* rms of a random-walk force; height of shocks */
};
struct plant base_plant(const struct system *s, const double *params);
void set_base(struct plant *p, const double *params);
int has_brake(const struct plant *p);

/* ---- drive.c */
enum { FINE = 40 };                                /* points of the drive behind its chain, a sample */
enum { TRUTH_STEPS = 10 };                         /* steps of a true run, a sample */
struct record {
    int n;
    double *u;                                     /* the drive, one a sample, linear between */
    double *behind;                                /* behind the chain, FINE a sample */
    double *way;                                   /* slide: the way that the drive has gone behind the chain, FINE a sample */
    unsigned char *turns;                          /* steps of a true run within which the drive turns sharply */
    double *force;                                 /* random-walk and shock force, one a sample */
    double start[STATES];
    double *out[MAX_OUTPUTS];                      /* every output of the system */
    double *noisy[MAX_OUTPUTS];                    /* those that are measured */
};
struct record new_record(int n);
void free_record(struct record *r);
void draw_drive(struct chance *c, const struct system *s, const double *params, double gain, int rests, struct record *r);
void draw_force(struct chance *c, const struct plant *p, struct record *r);
void through_chain(const struct plant *p, struct record *r);

/* ---- motion.c */
/* What a run met: the largest share of 100 V; rms of the drive's force, of velocity and of the drive; the drive's peak; states
 * at the start and their ranges. */
struct survey { double share, force, velocity, drive, drive_peak, first[STATES], top[STATES], low[STATES]; };
struct survey simulate(const struct plant *p, struct record *r, int fine);

/* ---- laws.c */
enum { MAX_QUANTITIES = 18, MAX_EFFECTS = 2 };
struct quantity { char name[16]; const char *unit; double value; };
struct effect { const char *name, *shape, *junction; struct quantity q[MAX_QUANTITIES]; int n; };
struct drawing {                                   /* what a law is drawn from */
    struct chance *c;
    const struct system *system;
    const struct survey *at;
    double size, inner, length;                    /* size: of the whole; inner: of what friction has beside its level; s of the train record */
    int mass_known;
    struct plant *plant;
    struct effect *effect;
};
struct law { const char *name; void (*draw)(struct drawing *d); };
extern const struct law LAWS[];
extern const int LAW_COUNT;
const struct law *law_named(const char *name);

/* ---- refit.c */
struct fit { int params[MAX_PARAMS], count, offset, first_output, outputs; };
struct job {                                       /* what is fitted to what */
    const struct system *system;
    const double *params;                          /* where to begin, and what is known */
    const struct fit *fit;
    const struct record *data;
    const double *full;                            /* of every measured output */
    const struct plant *with;                      /* what acts beside the base; NULL: nothing */
    int coulomb;                                   /* 1: a Coulomb friction is fitted too, from the one in `with` */
    int rounds;
};
struct best { double misfit, rms[MAX_OUTPUTS], params[MAX_PARAMS]; };
struct best refitted(const struct job *job);
void linear_base(const struct system *s, const double *params, const double *start, const double *u, int n, const struct fit *fit,
                 double *const *out);

/* ---- plan.c */
struct plan { const struct system *system; const char *effects[MAX_EFFECTS]; int count, mass_known; };
struct plan planned(uint64_t seed, int number);

/* ---- cases.c */
struct hidden_case {
    int number;
    uint64_t seed;
    struct plan plan;
    double params[MAX_PARAMS];
    struct fit fit;
    struct plant plant;
    struct effect effects[MAX_EFFECTS];
    struct plant only[MAX_EFFECTS];                /* with one of two effects */
    struct record train, test;
    double sigma[MAX_OUTPUTS], quantum[MAX_OUTPUTS], offset[MAX_OUTPUTS], target, egnr;
    double rival[MAX_EFFECTS];                     /* EGNR that is left when all but this effect is named; 0: not examined */
    struct best best;
    int sigma_given;
};
struct hidden_case made(uint64_t seed, int number);
void free_case(struct hidden_case *c);

/* ---- write.c */
struct settings { const char *out, *patches; int clean; };
void write_case(const struct hidden_case *c, const struct settings *set);

/* ---- selftest.c */
int self_test(void);
#endif
