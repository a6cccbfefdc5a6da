/* Types and functions of the simulator of hidden effects. main.c describes the program. All values are in SI units. */
#ifndef HIDDEN_H
#define HIDDEN_H
#define _XOPEN_SOURCE 700 /* M_PI, realpath */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- noise.c: random numbers */
struct rng { uint64_t s[4]; int spare_set; double spare; };
struct rng rng_of(uint64_t seed, uint64_t stream);
double uniform(struct rng *c, double low, double high);     /* uniform */
double log_uniform(struct rng *c, double low, double high);   /* log-uniform */
double gaussian(struct rng *c);
int random_below(struct rng *c, int n);                         /* uniform over 0 ... n - 1 */
int bernoulli(struct rng *c, double share);                   /* 1 with this probability */
double random_sign(struct rng *c);
void add_noise(struct rng *c, const double *clean, int n, double sigma, double quantum, double offset, double *out);

/* ---- systems.c: the base systems */
enum family { SLIDE, AXIS, OSCILLATOR, TANKS, TANK, HEATER };
enum { MAX_PARAMS = 6, MAX_OUTPUTS = 2, MAX_RATES = 16 };
/* States of a plant. Mechanical plants: position error (in motion.c without the distance of the drive), position, velocity, inner
 * state of friction. Tanks: two levels. Heater: temperature. */
enum state { E, X, V, Z, STATES, H1 = 0, H2 = 1, TEMPERATURE = 0 };

struct parameter { const char *name, *unit; double value, low, high; int fitted; };
struct output { const char *signal; enum state state; };
struct system {
    const char *name, *drive, *drive_unit, *first_junction, *second_junction;
    enum family family;
    struct parameter params[MAX_PARAMS];
    struct output outputs[MAX_OUTPUTS];
    double dt, period;               /* sampling interval in s; period of the slowest fast mode of the system, in samples */
    double full_drive, full_force, full[STATES];    /* values at 100 V; 0: the patch has no such signal */
    enum state free[2];              /* states of the base whose initial values are fitted */
    int states;
    int wanders, positive;           /* the drive must return to 0, because the system integrates it; the drive is never negative */
    int second_output_alone;         /* which output is measured if only one is: 1 the second, 0 the first */
};
extern const struct system SYSTEMS[];
extern const int SYSTEM_COUNT;
const struct system *system_named(const char *name);
int params_of(const struct system *s);

/* ---- plant: the base and all effects that can be hidden in it; 0 or NONE if an effect is absent */
enum shape { NONE, EXPONENTIAL, GAUSSIAN, LORENTZIAN, THESIS, LEVEL, DISTANCE, DAHL, LUGRE, ELASTOPLASTIC, LOGARITHMIC,
             HARD, SOFT, SPRING, REBOUND, LINEAR, CURVED, ROOT, LIMIT, WEIR };
enum { BUMPS = 5 };
struct plant {
    const struct system *system;
    /* base */
    double M, K, C, k, f, Fc, Fs, VcL;             /* mechanical; Fc: Coulomb friction of the base; Fs, VcL: its falling friction */
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
    /* effects that are not in the library */
    double thaw, thaw_time, bump[BUMPS], bump_at[BUMPS], bump_width;
    double walk, shock;                            /* rms of a random-walk force; height of shock forces */
};
struct plant base_plant(const struct system *s, const double *params);
void set_base(struct plant *p, const double *params);
int has_brake(const struct plant *p);

/* ---- drive.c */
enum { FINE = 40 };                                /* points per sample of the output of the drive's chain */
enum { TRUE_RUN_STEPS = 10 };                         /* steps per sample of a run that makes data */
struct record {
    int n;
    double *u;                                     /* the drive, one value per sample, linear between samples */
    double *chain_output;                          /* the drive after its chain (dead zone, lag ...), FINE values per sample */
    double *distance;                              /* slide: the integral of the chain's output, FINE values per sample */
    unsigned char *sharp_steps;                    /* 1 for the steps of a true run with a sharp corner of the drive */
    double *force;                                 /* random-walk and shock force, one value per sample */
    double start[STATES];
    double *out[MAX_OUTPUTS];                      /* every output of the system */
    double *noisy[MAX_OUTPUTS];                    /* the measured outputs, with noise */
};
struct record new_record(int n);
void free_record(struct record *r);
void draw_drive(struct rng *c, const struct system *s, const double *params, double gain, int rests, struct record *r);
void draw_force(struct rng *c, const struct plant *p, struct record *r);
void apply_drive_chain(const struct plant *p, struct record *r);

/* ---- motion.c */
/* Summary of a run: the largest share of full scale of any signal; rms of the drive's force, of velocity and of the drive; the
 * drive's peak; initial states and the ranges of states. */
struct survey { double share, force, velocity, drive, drive_peak, first[STATES], top[STATES], low[STATES]; };
struct survey simulate(const struct plant *p, struct record *r, int fine);

/* ---- laws.c */
enum { MAX_QUANTITIES = 18, MAX_EFFECTS = 2 };
struct quantity { char name[16]; const char *unit; double value; };
struct effect { const char *name, *shape, *junction; struct quantity q[MAX_QUANTITIES]; int n; };
struct draw_context {                              /* the inputs and outputs of drawing a law's parameters */
    struct rng *c;
    const struct system *system;
    const struct survey *at;
    double size, inner, length;                    /* size: factor of the whole effect; inner: factor of the details of a friction law; length of the train record in s */
    int mass_known;
    struct plant *plant;
    struct effect *effect;
};
struct law { const char *name; void (*draw)(struct draw_context *d); };
extern const struct law LAWS[];
extern const int LAW_COUNT;
const struct law *law_named(const char *name);

/* ---- refit.c */
struct fit { int params[MAX_PARAMS], count, offset, first_output, outputs; };
struct job {                                       /* a fit: the model and the data */
    const struct system *system;
    const double *params;                          /* start values of fitted parameters, and values of known ones */
    const struct fit *fit;
    const struct record *data;
    const double *full;                            /* full scale of every measured output */
    const struct plant *with;                      /* effects that act in addition to the base; NULL: none */
    int coulomb;                                   /* 1: a Coulomb friction is fitted too, beginning with the one in `with` */
    int rounds;
};
struct fit_result { double misfit, rms[MAX_OUTPUTS], params[MAX_PARAMS]; };
struct fit_result refit_base(const struct job *job);
void linear_base(const struct system *s, const double *params, const double *start, const double *u, int n, const struct fit *fit,
                 double *const *out);

/* ---- plan.c */
struct plan { const struct system *system; const char *effects[MAX_EFFECTS]; int count, mass_known; };
struct plan plan_case(uint64_t seed, int number);

/* ---- cases.c */
struct hidden_case {
    int number;
    uint64_t seed;
    struct plan plan;
    double params[MAX_PARAMS];
    struct fit fit;
    struct plant plant;
    struct effect effects[MAX_EFFECTS];
    struct plant only[MAX_EFFECTS];                /* the plant with only one of two effects */
    struct record train, test;
    double sigma[MAX_OUTPUTS], quantum[MAX_OUTPUTS], offset[MAX_OUTPUTS], target, egnr;
    double rival[MAX_EFFECTS];                     /* EGNR of the best model without this effect; 0: not examined */
    struct fit_result best;
    int sigma_given;
};
struct hidden_case make_case(uint64_t seed, int number);
void free_case(struct hidden_case *c);

/* ---- write.c */
struct settings { const char *out, *patches; int clean; };
void write_case(const struct hidden_case *c, const struct settings *set);

/* ---- selftest.c */
int self_test(void);
#endif
