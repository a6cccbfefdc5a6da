/* Writes the files of a case: the experiment with its two records, and the truth in another folder. */
#include "hidden.h"
#include <errno.h>
#include <sys/stat.h>

static void make_folder(const char *path) {
    if (mkdir(path, 0777) && errno != EEXIST) perror(path), exit(1);
}

static FILE *open_file(const char *path) {
    FILE *file = fopen(path, "w");
    if (!file) perror(path), exit(1);
    return file;
}

static void close_file(FILE *file, const char *path) {
    if (ferror(file) | fclose(file)) fprintf(stderr, "%s: not written\n", path), exit(1);
}

static const char *output_name(const struct hidden_case *c, int k) { return c->plan.system->outputs[c->fit.first_output + k].signal; }

static void write_record(const struct hidden_case *c, const struct record *r, const char *path, int clean) {
    FILE *file = open_file(path);
    fprintf(file, "t,%s", c->plan.system->drive);
    for (int k = 0; k < c->fit.outputs; k++) fprintf(file, ",%s", output_name(c, k));
    fprintf(file, "\n");
    for (int i = 0; i < r->n; i++) {
        fprintf(file, "%.10g,%.7g", i * c->plan.system->dt, r->u[i]);
        for (int k = 0; k < c->fit.outputs; k++) {
            int output = c->fit.first_output + k;
            fprintf(file, ",%.10g", clean ? r->out[output][i] : r->noisy[k][i]);
        }
        fprintf(file, "\n");
    }
    close_file(file, path);
}

static void write_experiment(const struct hidden_case *c, const char *path, const char *patches) {
    const struct system *s = c->plan.system;
    FILE *file = open_file(path);
    fprintf(file, "{\n  \"patch\": \"%s/%s.json\",\n  \"data\": \"train.csv\",\n  \"time\": \"t\",\n", patches, s->name);
    fprintf(file, "  \"drives\": {\"%s\": \"%s\"},\n  \"outputs\": {", s->drive, s->drive);
    for (int k = 0; k < c->fit.outputs; k++) {
        fprintf(file, "%s\"%s\": {\"column\": \"%s\"", k ? ", " : "", output_name(c, k), output_name(c, k));
        if (c->sigma_given) fprintf(file, ", \"sigma\": %.6g", c->sigma[k]);
        if (c->fit.offset) fprintf(file, ", \"offset\": true");
        fprintf(file, "}");
    }
    fprintf(file, "},\n  \"fit\": [");
    for (int i = 0; i < c->fit.count; i++) fprintf(file, "%s\"%s\"", i ? ", " : "", s->params[c->fit.params[i]].name);
    fprintf(file, "],\n  \"train\": [0, %.10g],\n", (c->train.n - 1) * s->dt);
    fprintf(file, "  \"test\": {\"data\": \"test.csv\", \"range\": [0, %.10g]}\n}\n", (c->test.n - 1) * s->dt);
    close_file(file, path);
}

static void write_effect(FILE *file, const struct effect *e, double rival, int more) {
    fprintf(file, "    {\"name\": \"%s\", \"junction\": \"%s\", \"shape\": \"%s\", ", e->name, e->junction, e->shape);
    if (rival > 0) fprintf(file, "\"egnr_without\": %.6g, ", rival);
    fprintf(file, "\"parameters\": {");
    for (int i = 0; i < e->n; i++)
        fprintf(file, "%s\"%s\": {\"value\": %.10g, \"unit\": \"%s\"}", i ? ", " : "", e->q[i].name, e->q[i].value, e->q[i].unit);
    fprintf(file, "}}%s\n", more ? "," : "");
}

static void write_names(FILE *file, const struct hidden_case *c) {
    fprintf(file, "  \"truth\": \"");
    for (int i = 0; i < c->plan.count; i++) fprintf(file, "%s%s", i ? "+" : "", c->effects[i].name);
    fprintf(file, "%s\",\n  \"effects\": [%s", c->plan.count ? "" : "none", c->plan.count ? "\n" : "");
    for (int i = 0; i < c->plan.count; i++) write_effect(file, &c->effects[i], c->rival[i], i + 1 < c->plan.count);
    fprintf(file, "%s],\n", c->plan.count ? "  " : "");
}

static void write_base(FILE *file, const struct hidden_case *c) {
    const struct system *s = c->plan.system;
    fprintf(file, "  \"base\": {");
    for (int i = 0; i < params_of(s); i++) {
        int fitted = 0;
        for (int k = 0; k < c->fit.count; k++) fitted |= c->fit.params[k] == i;
        fprintf(file, "%s\n    \"%s\": {\"value\": %.10g, \"unit\": \"%s\", \"fitted\": %s, \"best_base\": %.10g}", i ? "," : "", s->params[i].name,
                c->params[i], s->params[i].unit, fitted ? "true" : "false", c->plan.count ? c->best.params[i] : c->params[i]);
    }
    fprintf(file, "\n  },\n");
}

static void write_start(FILE *file, const struct hidden_case *c, const char *name, const struct record *r) {
    static const char *const MASS[] = {"error", "position", "velocity"}, *const TANK_LEVELS[] = {"level_1", "level_2"}, *const HEAT[] = {"temperature"};
    enum family family = c->plan.system->family;
    const char *const *names = family <= OSCILLATOR ? MASS : family == HEATER ? HEAT : TANK_LEVELS;
    int first = family == AXIS || family == OSCILLATOR, count = family <= OSCILLATOR ? 3 : family == TANKS ? 2 : 1;
    fprintf(file, "  \"start_%s\": {", name);
    for (int i = first; i < count; i++) fprintf(file, "%s\"%s\": %.10g", i > first ? ", " : "", names[i], r->start[i]);
    fprintf(file, "},\n");
}

/* The residual of the true laws in a record: rms over its outputs, each over its sigma. */
static double true_residual(const struct hidden_case *c, const struct record *r) {
    double sum = 0;
    for (int k = 0; k < c->fit.outputs; k++)
        for (int i = 0; i < r->n; i++) {
            double residual = (r->noisy[k][i] - c->offset[k] - r->out[c->fit.first_output + k][i]) / c->sigma[k];
            sum += residual * residual;
        }
    return sqrt(sum / (r->n * c->fit.outputs));
}

static void write_truth(const struct hidden_case *c, const char *path) {
    FILE *file = open_file(path);
    fprintf(file, "{\n  \"case\": %d,\n  \"seed\": %llu,\n  \"system\": \"%s\",\n", c->number, (unsigned long long)c->seed, c->plan.system->name);
    write_names(file, c);
    write_base(file, c);
    write_start(file, c, "train", &c->train);
    write_start(file, c, "test", &c->test);
    fprintf(file, "  \"outputs\": {");
    for (int k = 0; k < c->fit.outputs; k++)
        fprintf(file, "%s\n    \"%s\": {\"sigma\": %.10g, \"quantum\": %.10g, \"offset\": %.10g, \"base_leaves\": %.10g}", k ? "," : "", output_name(c, k),
                c->sigma[k], c->quantum[k], c->offset[k], c->best.rms[k]);
    fprintf(file, "\n  },\n  \"egnr_asked\": %.6g,\n  \"egnr\": %.6g,\n", c->plan.count ? c->target : 0, c->egnr);
    fprintf(file, "  \"true_laws_leave_of_test\": %.6g\n}\n", true_residual(c, &c->test));
    close_file(file, path);
}

void write_case(const struct hidden_case *c, const struct settings *set) {
    char at[4096], path[4200];
    snprintf(path, sizeof path, "%s", set->out), make_folder(path);
    snprintf(path, sizeof path, "%s/truth", set->out), make_folder(path);
    snprintf(at, sizeof at, "%s/%04d", set->out, c->number), make_folder(at);
    snprintf(path, sizeof path, "%s/train.csv", at), write_record(c, &c->train, path, set->clean);
    snprintf(path, sizeof path, "%s/test.csv", at), write_record(c, &c->test, path, set->clean);
    snprintf(path, sizeof path, "%s/experiment.json", at), write_experiment(c, path, set->patches);
    snprintf(path, sizeof path, "%s/truth/%04d.json", set->out, c->number), write_truth(c, path);
}
