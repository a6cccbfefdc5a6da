/* The plan of the cases: which effects each hides in which system. Of each hundred, 35 hide nothing, 40 one effect of the library,
 * 13 one that the library does not have, and 12 two. */
#include "hidden.h"

struct choice { const char *first, *second, *hosts; };

static const struct choice SINGLES[] = {
    {"coulomb-friction", NULL, "slide axis axis-ideal oscillator"},
    {"viscous-friction", NULL, "axis-ideal oscillator-undamped"},
    {"stribeck-friction", NULL, "slide axis slide-coulomb oscillator"},
    {"friction-memory", NULL, "slide-falling slide"},
    {"static-friction-growth", NULL, "slide-coulomb axis-coulomb slide axis"},
    {"asymmetric-viscous-friction", NULL, "slide axis oscillator"},
    {"quadratic-drag", NULL, "slide axis oscillator"},
    {"presliding-stiffness", NULL, "slide-coulomb axis-coulomb slide axis"},
    {"backlash", NULL, "slide tanks slide heater"},
    {"cubic-stiffness", NULL, "slide oscillator"},
    {"hard-stop", NULL, "axis oscillator"},
    {"saturation", NULL, "axis oscillator tanks heater slide"},
    {"drive-dead-zone", NULL, "axis oscillator tanks heater slide"},
    {"time-delay", NULL, "slide axis oscillator tanks heater"},
    {"actuator-lag", NULL, "slide axis oscillator tanks heater"},
    {"constant-bias", NULL, "slide axis oscillator tanks heater"},
    {"drift", NULL, "slide axis oscillator tanks heater"},
    {"periodic-disturbance", NULL, "slide axis oscillator tanks heater"},
    {"mass-change", NULL, "slide axis oscillator axis! oscillator!"},
    {"load-dependent-friction", NULL, "slide axis oscillator"},
    {"leak", NULL, "tank heater-ideal tanks"},
    {"overflow", NULL, "tanks"},
};

static const struct choice UNKNOWNS[] = {
    {"unknown:bumps", NULL, "slide axis oscillator"},
    {"unknown:random-walk", NULL, "slide axis oscillator tanks heater"},
    {"unknown:relay-hysteresis", NULL, "slide axis oscillator heater-ideal tank"},
    {"unknown:slow-thaw", NULL, "slide axis oscillator tanks heater"},
    {"unknown:shocks", NULL, "slide axis oscillator"},
};

static const struct choice PAIRS[] = {
    {"coulomb-friction", "cubic-stiffness", "oscillator slide"},
    {"stribeck-friction", "asymmetric-viscous-friction", "slide axis"},
    {"coulomb-friction", "viscous-friction", "axis-ideal oscillator-undamped"},
    {"coulomb-friction", "time-delay", "slide axis"},
    {"presliding-stiffness", "constant-bias", "axis slide"},
    {"stribeck-friction", "time-delay", "slide axis"},
    {"quadratic-drag", "constant-bias", "axis oscillator"},
    {"overflow", "time-delay", "tanks"},
    {"hard-stop", "quadratic-drag", "oscillator axis"},
    {"backlash", "coulomb-friction", "slide"},
    {"asymmetric-viscous-friction", "drive-dead-zone", "axis oscillator"},
    {"coulomb-friction", "periodic-disturbance", "axis slide oscillator"},
    {"actuator-lag", "drift", "heater tanks"},
    {"leak", "saturation", "tank heater-ideal"},
    {"mass-change", "coulomb-friction", "axis oscillator"},
};

static const char *const NOTHING_HIDDEN = "slide axis oscillator tanks heater slide-coulomb axis-coulomb slide-falling axis-ideal "
                                          "oscillator-undamped tank heater-ideal axis! oscillator!";

/* The system of the n-th word, cyclically. A "!" after a name means that the mass is known. */
static void host(struct plan *p, const char *words, int n) {
    char name[32];
    int count = 1, length;
    for (const char *c = words; *c; c++) count += *c == ' ';
    for (n %= count; n > 0; n--) words = strchr(words, ' ') + 1;
    length = (int)strcspn(words, " !");
    snprintf(name, sizeof name, "%.*s", length, words);
    p->mass_known = words[length] == '!';
    p->system = system_named(name);
}

static void chosen(struct plan *p, const struct choice *choices, int count, int rank, int turn) {
    const struct choice *c = &choices[rank % count];
    p->effects[0] = c->first, p->effects[1] = c->second;
    p->count = c->second ? 2 : 1;
    host(p, c->hosts, rank / count + turn);
}
#define CHOSEN(p, choices, rank, turn) chosen(p, choices, sizeof choices / sizeof *choices, rank, turn)

/* Each hundred is shuffled separately, so that a case does not depend on the number of cases. */
struct plan plan_case(uint64_t seed, int number) {
    enum { NONE_SHARE = 35, SINGLE_SHARE = 40, UNKNOWN_SHARE = 13, PAIR_SHARE = 12 };
    int block = (number - 1) / 100, order[100], turn = (int)(seed % 60);
    struct rng c = rng_of(seed, 1u << 30 | (uint64_t)block);
    for (int i = 0; i < 100; i++) order[i] = i;
    for (int i = 99; i > 0; i--) {
        int other = random_below(&c, i + 1), kept = order[i];
        order[i] = order[other], order[other] = kept;
    }
    int slot = order[(number - 1) % 100];
    struct plan p = {0};
    if (slot < NONE_SHARE) return host(&p, NOTHING_HIDDEN, block * NONE_SHARE + slot), p;
    if ((slot -= NONE_SHARE) < SINGLE_SHARE) return CHOSEN(&p, SINGLES, block * SINGLE_SHARE + slot, turn), p;
    if ((slot -= SINGLE_SHARE) < UNKNOWN_SHARE) return CHOSEN(&p, UNKNOWNS, block * UNKNOWN_SHARE + slot, turn), p;
    return CHOSEN(&p, PAIRS, block * PAIR_SHARE + slot - UNKNOWN_SHARE, turn), p;
}
