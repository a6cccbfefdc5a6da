/* Makes experiments with hidden effects, for tests of the gap search. The program shares no code with patchcord. It is written in
 * C, and it has independent equations in physical units, an independent integrator and other shapes of the same laws.
 *
 *     cd benches/hidden && cc -O2 *.c -o hidden -lm
 *     hidden --seed 7 --cases 1000 --out DIR --patches ../../crates/ident/tests/systems
 *
 * Case n is DIR/000n/experiment.json, with train.csv and test.csv in the same folder. Its truth is in DIR/truth/000n.json.
 *   --only n    makes only this case; it does not depend on the other cases
 *   --clean     writes records without noise and offset
 *   --self-test compares with closed solutions; the exit status is 1 if a comparison fails
 * The same seed gives the same bytes. The patches of the base systems are in crates/ident/tests/systems.
 *
 * Of a hundred cases, 35 hide nothing, 40 one effect of the library, 13 one that the library does not have, and 12 two (plan.c).
 * laws.c has the laws with their sources, motion.c the equations of motion. A run has ten steps per sample. Four times as many
 * change a record by at most a fiftieth of its sigma (rms).
 *
 * EGNR is the effect-to-noise ratio: the rms residual of the best refitted base over sigma. It is drawn first, log-uniform over
 * 0.3 ... 30. The base is refitted to the clean train record (refit.c), and sigma follows, within 1e-6 ... 3 % of the output's
 * range. The truth contains the resulting EGNR.
 *
 * Keys of the truth: "truth" is "none", a name, "unknown:kind" or two names joined by "+". A junction is the integrator at whose
 * input the effect acts, or the drive that it changes. The search does not get the initial states. Laws that depend on time use
 * the time of each record. Random forces differ from record to record. With two outputs EGNR is the rms over both, each over its
 * sigma. "egnr_without" is the EGNR without one effect or detail: for one of two effects, that of the best base with the other
 * one at its true values; for a friction that falls, grows or yields, that of the best base with Coulomb friction; for a memory,
 * that of its friction without lag. It is at least 15 % of EGNR, so that the effect is detectable. "true_laws_leave_of_test" is
 * the rms over sigma of the noise in the test record.
 *
 * Names, parameters and signs are those of patches/effects; the shapes may differ. If the base has friction, the effect changes
 * it: on a base with Coulomb friction, Stribeck friction is only the fall, growth and presliding use the base's level, and memory
 * delays the falling friction of slide-falling.
 */
#include "hidden.h"

struct request { unsigned long long seed; int cases, only, test; struct settings set; };

static const char *value_of(int count, char **words, int *i) {
    if (*i + 1 >= count) fprintf(stderr, "%s: a value must follow\n", words[*i]), exit(2);
    return words[++*i];
}

static struct request parse_request(int count, char **words) {
    struct request r = {.seed = 7, .cases = 1000};
    for (int i = 1; i < count; i++) {
        const char *word = words[i];
        if (!strcmp(word, "--seed")) r.seed = strtoull(value_of(count, words, &i), NULL, 10);
        else if (!strcmp(word, "--cases")) r.cases = atoi(value_of(count, words, &i));
        else if (!strcmp(word, "--only")) r.only = atoi(value_of(count, words, &i));
        else if (!strcmp(word, "--out")) r.set.out = value_of(count, words, &i);
        else if (!strcmp(word, "--patches")) r.set.patches = value_of(count, words, &i);
        else if (!strcmp(word, "--clean")) r.set.clean = 1;
        else if (!strcmp(word, "--self-test")) r.test = 1;
        else fprintf(stderr, "%s: one of --seed --cases --only --out --patches --clean --self-test\n", word), exit(2);
    }
    if (!r.test && (!r.set.out || !r.set.patches)) fprintf(stderr, "--out and --patches must be given\n"), exit(2);
    return r;
}

int main(int count, char **words) {
    static char patches[4096];
    struct request r = parse_request(count, words);
    if (r.test) return self_test();
    if (!realpath(r.set.patches, patches)) perror(r.set.patches), exit(1);
    r.set.patches = patches;
    int first = r.only ? r.only : 1, last = r.only ? r.only : r.cases;
    for (int n = first; n <= last; n++) {
        struct hidden_case c = make_case(r.seed, n);
        write_case(&c, &r.set);
        free_case(&c);
    }
    return 0;
}
