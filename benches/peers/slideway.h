/* The slideway of Fig 8.16, and the command line of the hand-written C programs that integrate it.
 *
 *     e' = v_i - v              w = K e              F = Fs max(u, 0)^2
 *     d  = w - F (w > F),  w + F (w < -F),  0 otherwise
 *     M v' = d - f v            Tc u' = (1 - min(|v| / VcL, 1)) - u
 *
 * Initial values: e = 0, v = 0, u = 1; v_i rises from 0 at v_rate. The programs use a = w / M instead of e, so that the divisions
 * by M and Tc are done once: a' = stiff (v_i - v), v' = d / M - damp v. All values are in SI units.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

struct setting { double VcL, Tc, v_rate; };

static const double M = 433, K = 45e6, VISCOUS = 10.7e3, FS = 771;

struct state { double a, v, u; };

static const struct state AT_REST = {0, 0, 1};

/* The signals of a row: command, position error, velocity, acceleration, spring force, friction level, memory. */
enum { SIGNALS = 7, V_O = 2 };
static const double EVERY = 1e-3;

/* Integrates `steps` steps and records a row before every `per_row` of them. Returns the number of located kinks. Each program
 * defines it. */
static long integrate(const struct setting *set, double step, long steps, long per_row, double (*row)[SIGNALS]);

static void record(double *row, double v_i, struct state s, double v_rate_of_change) {
    double solid = s.u > 0 ? FS * s.u * s.u : 0;
    double values[SIGNALS] = {v_i, s.a * M / K, s.v, v_rate_of_change, s.a * M, solid, s.u};
    memcpy(row, values, sizeof values);
}

static double seconds_now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

struct request { double step, length, VcL, Tc; const char *rows, *sweep; };

static struct request parse_request(int count, char **words) {
    struct request r = {20e-6, 8.4667, 2.54e-3, 0.0065, NULL, NULL};
    struct { const char *name; double *value; } numbers[] = {
        {"step=", &r.step}, {"for=", &r.length}, {"VcL=", &r.VcL}, {"Tc=", &r.Tc}};
    for (int i = 1; i < count; i++) {
        const char *word = words[i];
        int is_known = 0;
        for (int n = 0; n < 4; n++)
            if (!strncmp(word, numbers[n].name, strlen(numbers[n].name)))
                *numbers[n].value = atof(strchr(word, '=') + 1), is_known = 1;
        if (!strncmp(word, "rows=", 5)) r.rows = word + 5, is_known = 1;
        if (!strncmp(word, "sweep=", 6)) r.sweep = word + 6, is_known = 1;
        if (!is_known) {
            fprintf(stderr, "%s: one of step= for= VcL= Tc= rows= sweep=\n", word);
            exit(2);
        }
    }
    return r;
}

static FILE *open_file(const char *path) {
    FILE *file = fopen(path, "wb");
    if (!file) perror(path), exit(1);
    return file;
}

/* 1000 settings: 40 of VcL by 25 of Tc. */
enum { VCLS = 40, TCS = 25 };

/* Runs all settings and writes v_o of every row of every run to a file. Returns the duration of integrating in s. */
static double run_sweep(const struct request *r, long steps, long per_row, long rows, double (*row)[SIGNALS]) {
    FILE *file = open_file(r->sweep);
    double seconds = 0;
    for (int i = 0; i < VCLS * TCS; i++) {
        struct setting set = {1.27e-3 + (25.4e-3 - 1.27e-3) * (i / TCS) / (VCLS - 1),
                              6e-3 + (25e-3 - 6e-3) * (i % TCS) / (TCS - 1), 1.2e-3};
        double start = seconds_now();
        integrate(&set, EVERY / per_row, steps, per_row, row);
        seconds += seconds_now() - start;
        for (long k = 0; k < rows; k++) fwrite(&row[k][V_O], sizeof(double), 1, file);
    }
    fclose(file);
    return seconds;
}

int main(int count, char **words) {
    /* Without this, denormal numbers double the time. */
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    struct request r = parse_request(count, words);
    long per_row = lround(EVERY / r.step), steps = lround(r.length / EVERY * per_row);
    long rows = (steps - 1) / per_row + 1, kinks = 0;
    double (*row)[SIGNALS] = calloc(rows + 1, sizeof *row), seconds = 0;
    if (r.sweep) {
        seconds = run_sweep(&r, steps, per_row, rows, row), steps *= VCLS * TCS;
    } else for (int run = 0; run < 2; run++) { /* The first run warms up. */
        struct setting set = {r.VcL, r.Tc, 1.2e-3};
        double start = seconds_now();
        kinks = integrate(&set, EVERY / per_row, steps, per_row, row);
        seconds = seconds_now() - start;
    }
    printf("{\"seconds\": %.9f, \"steps\": %ld, \"ns_per_step\": %.3f, \"kinks\": %ld}\n", seconds, steps, 1e9 * seconds / steps,
           kinks);
    if (r.rows) {
        FILE *file = open_file(r.rows);
        fwrite(row, sizeof *row, rows, file);
        fclose(file);
    }
    return 0;
}
