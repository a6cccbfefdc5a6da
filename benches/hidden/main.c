/* Experiments in which an effect is hidden, for tests of the gap search. This program shares no code with the emulator: C, its
 * own equations in physical units, its own integrator, other shapes of the same laws.
 *
 *     cd benches/hidden && cc -O2 *.c -o hidden -lm
 *     hidden --seed 7 --cases 1000 --out DIR --patches ../../tests/gap/systems
 *
 * Case n is DIR/000n/experiment.json with train.csv and test.csv beside it; its truth lies apart, in DIR/truth/000n.json.
 *   --only n    this case alone; it is the same as among others
 *   --clean     records without noise and offset, to compare runs with
 *   --self-test checks against closed solutions; exit 1 where one fails
 * The same seed gives the same bytes. The base patches are crates/ident/tests/systems.
 *
 * Of a hundred cases 35 hide nothing, 40 one effect of the library, 13 one that it does not have, 12 two (plan.c). What is
 * hidden is told in laws.c with its source, how it moves in motion.c: ten steps a sample, of which four times as many change a
 * record by a fiftieth of its sigma at most (rms).
 *
 * EGNR, the rms that the best refitted base leaves over sigma, is drawn first, log-uniform over 0.3 ... 30; the base is refitted
 * to the clean train record (refit.c), and sigma follows, within 1e-6 ... 3 % of the output's range. The truth tells the EGNR that
 * came of it.
 *
 * Truth: "truth" is "none", a name, "unknown:kind" or two names joined by "+". A junction is the integrator at whose input the
 * effect acts, or the drive that it stands behind. Starts are not told to the tool. Laws that depend on time run on the clock of
 * each record; forces of chance are others in every record. With two outputs EGNR is the rms over both, each over its sigma.
 * "egnr_without" of one of two effects is what the best base leaves that has the other, with its true numbers; of a friction that
 * falls, grows or yields, what the best base with Coulomb friction leaves; of a memory, what its friction leaves without it. It is
 * at least 15 % of EGNR, so that the effect is there to be found. "true_laws_leave_of_test" is the rms over sigma of the noise that
 * the test records were given.
 *
 * Names, parameters and signs are those of patches/effects; shapes are others. A friction that the base has acts in the effect: on
 * a base with Coulomb friction Stribeck's is the fall alone, growth and yielding have the base's level, and memory makes the falling
 * friction of slide-falling late.
 */
#include "hidden.h"

struct request { unsigned long long seed; int cases, only, test; struct settings set; };

static const char *value_of(int count, char **words, int *i) {
    if (*i + 1 >= count) fprintf(stderr, "%s: a value must follow\n", words[*i]), exit(2);
    return words[++*i];
}

static struct request requested(int count, char **words) {
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
    struct request r = requested(count, words);
    if (r.test) return self_test();
    if (!realpath(r.set.patches, patches)) perror(r.set.patches), exit(1);
    r.set.patches = patches;
    int first = r.only ? r.only : 1, last = r.only ? r.only : r.cases;
    for (int n = first; n <= last; n++) {
        struct hidden_case c = made(r.seed, n);
        write_case(&c, &r.set);
        free_case(&c);
    }
    return 0;
}
