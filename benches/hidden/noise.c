/* Random numbers: xoshiro256** (Blackman, Vigna, 2018), seeded by splitmix64. Normal numbers by the polar Box-Muller method. */
#include "hidden.h"

static uint64_t splitmix(uint64_t *state) {
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

struct rng rng_of(uint64_t seed, uint64_t stream) {
    struct rng c = {0};
    uint64_t state = seed * 0xd1342543de82ef95u + stream;
    for (int i = 0; i < 4; i++) c.s[i] = splitmix(&state);
    return c;
}

static uint64_t rotate_left(uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

static uint64_t next(struct rng *c) {
    uint64_t *s = c->s, result = rotate_left(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0], s[3] ^= s[1], s[1] ^= s[2], s[0] ^= s[3], s[2] ^= t;
    s[3] = rotate_left(s[3], 45);
    return result;
}

double uniform(struct rng *c, double low, double high) { return low + (high - low) * ((next(c) >> 11) * 0x1p-53); }
double log_uniform(struct rng *c, double low, double high) { return low * pow(high / low, uniform(c, 0, 1)); }
int random_below(struct rng *c, int n) { return (int)(next(c) % (uint64_t)n); }
int bernoulli(struct rng *c, double share) { return uniform(c, 0, 1) < share; }
double random_sign(struct rng *c) { return bernoulli(c, 0.5) ? 1 : -1; }

double gaussian(struct rng *c) {
    if (c->spare_set) return c->spare_set = 0, c->spare;
    double a, b, q;
    do a = uniform(c, -1, 1), b = uniform(c, -1, 1), q = a * a + b * b;
    while (q >= 1 || q == 0);
    q = sqrt(-2 * log(q) / q);
    c->spare = b * q, c->spare_set = 1;
    return a * q;
}

/* The reading of a sensor: the signal with an offset and white noise, rounded to multiples of the quantum if it is not 0. */
void add_noise(struct rng *c, const double *clean, int n, double sigma, double quantum, double offset, double *out) {
    for (int i = 0; i < n; i++) {
        double y = clean[i] + offset + sigma * gaussian(c);
        out[i] = quantum > 0 ? quantum * round(y / quantum) : y;
    }
}
