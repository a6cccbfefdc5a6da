/* The base systems: the equations of the patches of the same names in crates/ident/tests/systems. */
#include "hidden.h"

#define SLIDE_PARAMS {"M", "kg", 400, 100, 1600, 1}, {"K", "N/m", 18e6, 4e6, 80e6, 1}, {"f", "N s/m", 10e3, 0, 60e3, 1}
#define AXIS_MASS {"M", "kg", 20, 5, 80, 1}
#define SPRING_PARAMS {"M", "kg", 3, 1, 9, 1}, {"k", "N/m", 500, 150, 2000, 1}
#define SLIDE_REST .drive = "v_i", .drive_unit = "m/s", .first_junction = "IV", .second_junction = "IX", .family = SLIDE, \
    .outputs = {{"x_error", E}, {"v", V}}, .dt = 1e-3, .period = 40, .full_drive = 0.1, .full_force = 4000, .full = {200e-6, 0.1, 0.1}, \
    .free = {E, V}, .states = 2, .wanders = 1
#define AXIS_REST .drive = "F", .drive_unit = "N", .first_junction = "IV", .second_junction = "IX", .family = AXIS, \
    .outputs = {{"x", X}, {"v", V}}, .dt = 2e-3, .period = 100, .full_drive = 400, .full_force = 400, .full = {0, 0.8, 4}, \
    .free = {X, V}, .states = 2, .wanders = 1
#define SPRING_REST .drive = "F", .drive_unit = "N", .first_junction = "IV", .second_junction = "IX", .family = OSCILLATOR, \
    .outputs = {{"x", X}, {"v", V}}, .dt = 5e-3, .period = 100, .full_drive = 200, .full_force = 200, .full = {0, 0.4, 6}, \
    .free = {X, V}, .states = 2
#define HEATER_REST .drive = "P", .drive_unit = "W", .first_junction = "IT", .second_junction = "IT", .family = HEATER, \
    .outputs = {{"T", TEMPERATURE}}, .dt = 2, .period = 120, .full_drive = 500, .full_force = 500, .full = {200}, \
    .free = {TEMPERATURE}, .states = 1

const struct system SYSTEMS[] = {
    {"slide", .params = {SLIDE_PARAMS}, SLIDE_REST},
    {"slide-coulomb", .params = {SLIDE_PARAMS, {"Fc", "N", 120, 0, 1000, 1}}, SLIDE_REST},
    {"slide-falling", .params = {SLIDE_PARAMS, {"Fs", "N", 160, 0, 1000, 1}, {"VcL", "m/s", 12e-3, 3e-3, 60e-3, 1}}, SLIDE_REST},
    {"axis", .params = {AXIS_MASS, {"f", "N s/m", 40, 0, 200, 1}}, AXIS_REST},
    {"axis-coulomb", .params = {AXIS_MASS, {"f", "N s/m", 40, 0, 200, 1}, {"Fc", "N", 8, 0, 60, 1}}, AXIS_REST},
    {"axis-ideal", .params = {AXIS_MASS}, AXIS_REST},
    {"oscillator", .params = {SPRING_PARAMS, {"c", "N s/m", 5, 0, 40, 1}}, SPRING_REST},
    {"oscillator-undamped", .params = {SPRING_PARAMS}, SPRING_REST},
    {"tanks", .drive = "u", .drive_unit = "V", .first_junction = "I1", .second_junction = "I2", .family = TANKS,
     .params = {{"ku", "m3/s/V", 20e-6, 5e-6, 80e-6, 1}, {"R1", "s/m2", 1500, 400, 6000, 1}, {"R2", "s/m2", 1500, 400, 6000, 1}},
     .outputs = {{"h1", H1}, {"h2", H2}}, .dt = 1, .period = 100, .full_drive = 20, .full_force = 500e-6, .full = {0.8, 0.8},
     .free = {H1, H2}, .states = 2, .positive = 1, .second_output_alone = 1},
    {"tank", .drive = "u", .drive_unit = "V", .first_junction = "I1", .second_junction = "I1", .family = TANK,
     .params = {{"ku", "m3/s/V", 20e-6, 5e-6, 80e-6, 1}},
     .outputs = {{"h1", H1}}, .dt = 1, .period = 100, .full_drive = 20, .full_force = 500e-6, .full = {0.8},
     .free = {H1}, .states = 1, .wanders = 1},
    {"heater", .params = {{"C", "J/K", 500, 125, 2000, 1}, {"G", "W/K", 2.5, 0.5, 10, 1}}, HEATER_REST, .positive = 1},
    {"heater-ideal", .params = {{"C", "J/K", 500, 125, 2000, 1}}, HEATER_REST, .wanders = 1},
};
const int SYSTEM_COUNT = sizeof SYSTEMS / sizeof *SYSTEMS;

const struct system *system_named(const char *name) {
    for (int i = 0; i < SYSTEM_COUNT; i++)
        if (!strcmp(SYSTEMS[i].name, name)) return &SYSTEMS[i];
    fprintf(stderr, "%s: no such system\n", name);
    exit(2);
}

int params_of(const struct system *s) {
    int n = 0;
    while (n < MAX_PARAMS && s->params[n].name) n++;
    return n;
}

void set_base(struct plant *p, const double *params) {
    struct { const char *name; double *place; } names[] = {
        {"M", &p->M}, {"K", &p->K}, {"k", &p->k}, {"f", &p->f}, {"c", &p->f}, {"Fc", &p->Fc}, {"Fs", &p->Fs}, {"VcL", &p->VcL},
        {"ku", &p->ku}, {"R1", &p->R1}, {"R2", &p->R2}, {"C", &p->capacity}, {"G", &p->G}};
    for (int i = 0; i < params_of(p->system); i++)
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            if (!strcmp(p->system->params[i].name, names[k].name)) *names[k].place = params[i];
}

/* The plant of a base. The damping of the slide's drive and the areas of the tanks are known numbers in the patches. */
struct plant base_plant(const struct system *s, const double *params) {
    struct plant p = {.system = s, .mass_factor = 1, .A1 = 0.02, .A2 = 0.03};
    if (s->family == SLIDE) p.C = 12e3;
    set_base(&p, params);
    return p;
}

/* Whether solid friction can hold a mass at rest. A bristle yields, so it cannot. */
int has_brake(const struct plant *p) {
    return !p->bristle && (p->Fc > 0 || p->Fs > 0 || p->coulomb > 0 || p->falling || p->load > 0);
}
