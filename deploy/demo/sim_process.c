/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Upsets as a table of who feels them; each tag a first-order lag behind its loop. */
#include "sim_process.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "base/mem.h"

enum { MAX_EFFECTS = 12, UPSETS = 3, CYCLE_S = 690 };
static const double MAX_STEP_S = 1.0, TAU = 6.283185307179586;

struct effect {
    const char *word;  /* in the name of the loop */
    enum process_kind kind;
    double share;      /* of the tag's span, at the height of the upset */
    double dead_s;     /* before it is felt */
};

struct upset {
    const char *name;
    double start_s, rise_s, hold_s, fall_s; /* within the cycle */
    struct effect effects[MAX_EFFECTS];
};

static const struct upset upsets[UPSETS] = {
    { "cooling water lost", 60, 60, 40, 80, {
        { "cooling", PROCESS_TEMPERATURE, 0.30, 0 },    { "condenser", PROCESS_TEMPERATURE, 0.28, 4 },
        { "overhead", PROCESS_TEMPERATURE, 0.25, 10 },  { "reflux", PROCESS_TEMPERATURE, 0.22, 15 },
        { "drum", PROCESS_TEMPERATURE, 0.20, 20 },      { "column", PROCESS_TEMPERATURE, 0.10, 30 },
        { "condenser", PROCESS_PRESSURE, 0.24, 4 },     { "overhead", PROCESS_PRESSURE, 0.24, 6 },
        { "drum", PROCESS_PRESSURE, 0.22, 8 },          { "column", PROCESS_PRESSURE, 0.18, 8 },
        { "reboiler", PROCESS_TEMPERATURE, 0.04, 50 },
    } },
    { "exchanger fouled", 280, 110, 40, 40, {
        { "preheat", PROCESS_TEMPERATURE, -0.22, 0 },   { "exchanger", PROCESS_TEMPERATURE, -0.22, 0 },
        { "feed", PROCESS_TEMPERATURE, -0.16, 6 },      { "column", PROCESS_TEMPERATURE, -0.06, 30 },
        { "bottoms", PROCESS_TEMPERATURE, 0.12, 12 },   { "product", PROCESS_TEMPERATURE, 0.10, 20 },
        { "feed", PROCESS_PRESSURE, 0.18, 0 },          { "preheat", PROCESS_PRESSURE, 0.18, 0 },
        { "exchanger", PROCESS_PRESSURE, 0.18, 0 },     { "reboiler", PROCESS_TEMPERATURE, 0.05, 40 },
    } },
    { "pump bearing worn", 510, 90, 45, 15, {
        { "pump", PROCESS_VIBRATION, 0.40, 0 },         { "pump", PROCESS_TEMPERATURE, 0.12, 20 },
        { "motor", PROCESS_VIBRATION, 0.25, 4 },        { "motor", PROCESS_TEMPERATURE, 0.08, 30 },
    } },
};

struct state {
    enum process_kind kind;
    double normal, span;
    double shares[UPSETS], dead_s[UPSETS];
    uint32_t loop;             /* hash of its name: phase of its drift */
    double dead_own_s, lag_s;
    double lagged, drift, noise, value;
    uint64_t random;
};

struct process {
    double now_s;
    size_t count;
    struct state *states;
};

static uint32_t hash_of(const char *text)
{
    uint32_t hash = 2166136261u; /* FNV-1a */
    for (; *text; text++)
        hash = (hash ^ (uint8_t)*text) * 16777619u;
    return hash ^ hash >> 15;
}

static double uniform(uint64_t *random)
{
    *random += 0x9E3779B97F4A7C15u; /* splitmix64 */
    uint64_t z = *random;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static double normal_deviate(uint64_t *random)
{
    double u = uniform(random);
    return sqrt(-2 * log(u > 0 ? u : 0x1p-53)) * cos(TAU * uniform(random));
}

static double smooth(double part)
{
    part = part < 0 ? 0 : part > 1 ? 1 : part;
    return part * part * (3 - 2 * part);
}

static double level(const struct upset *upset, double time_s)
{
    double t = fmod(time_s, CYCLE_S) - upset->start_s;
    if (time_s < 0 || t < 0)
        return 0;
    if (t < upset->rise_s + upset->hold_s)
        return smooth(t / upset->rise_s);
    return 1 - smooth((t - upset->rise_s - upset->hold_s) / upset->fall_s);
}

/* The strongest effect of each upset on this loop. */
static void find_effects(struct state *state, const char *loop)
{
    for (int u = 0; u < UPSETS; u++)
        for (int e = 0; e < MAX_EFFECTS && upsets[u].effects[e].word; e++) {
            const struct effect *effect = &upsets[u].effects[e];
            if (effect->kind != state->kind || !strcasestr(loop, effect->word) || fabs(effect->share) <= fabs(state->shares[u]))
                continue;
            state->shares[u] = effect->share;
            state->dead_s[u] = effect->dead_s;
        }
}

static double drift_of_loop(uint32_t loop, double time_s)
{
    double slow_s = 170 + loop % 97, fast_s = 61 + loop % 41;
    return 0.012 * sin(TAU * (time_s / slow_s + loop % 1000 / 1000.0)) + 0.005 * sin(TAU * (time_s / fast_s + loop % 777 / 777.0));
}

static double target(const struct state *state, double time_s)
{
    double share = drift_of_loop(state->loop, time_s - state->dead_own_s) + state->drift;
    for (int u = 0; u < UPSETS; u++)
        if (state->shares[u] != 0)
            share += state->shares[u] * level(&upsets[u], time_s - state->dead_s[u] - state->dead_own_s);
    return state->normal + share * state->span;
}

static void show(struct state *state)
{
    state->value = state->lagged + state->noise * state->span;
    if (state->value < 0 && state->normal >= 0 && state->kind != PROCESS_TEMPERATURE)
        state->value = 0;
}

struct process *process_create(const struct process_tag *tags, size_t count, uint64_t seed)
{
    static const double lags_s[] = { [PROCESS_TEMPERATURE] = 10, [PROCESS_PRESSURE] = 3, [PROCESS_VIBRATION] = 1.5, [PROCESS_OTHER] = 5 };
    struct process *process = mem_new(sizeof(*process));
    process->count = count;
    process->states = mem_array(count, sizeof(*process->states));
    for (size_t i = 0; i < count; i++) {
        struct state *state = &process->states[i];
        *state = (struct state){ .kind = tags[i].kind, .normal = tags[i].normal, .span = fabs(tags[i].span), .loop = hash_of(tags[i].loop) };
        state->random = seed ^ (uint64_t)hash_of(tags[i].name) << 20;
        find_effects(state, tags[i].loop);
        double own = 0.75 + 0.5 * uniform(&state->random); /* no two feel it alike */
        for (int u = 0; u < UPSETS; u++)
            state->shares[u] *= own;
        state->dead_own_s = 6 * uniform(&state->random);
        state->lag_s = lags_s[tags[i].kind] * (0.6 + 0.8 * uniform(&state->random));
        state->lagged = target(state, 0);
        show(state);
    }
    return process;
}

void process_destroy(struct process **process)
{
    if (!*process)
        return;
    mem_free((*process)->states);
    mem_free(*process);
    *process = NULL;
}

/* Ornstein-Uhlenbeck, exact for any step. */
static double wander(double x, double sigma, double time_constant_s, double dt_s, uint64_t *random)
{
    double keep = exp(-dt_s / time_constant_s);
    return x * keep + sigma * sqrt(1 - keep * keep) * normal_deviate(random);
}

static void step_tag(struct state *state, double time_s, double dt_s)
{
    static const double noises[] = {
        [PROCESS_TEMPERATURE] = 0.0012, [PROCESS_PRESSURE] = 0.003, [PROCESS_VIBRATION] = 0.008, [PROCESS_OTHER] = 0.003
    };
    state->drift = wander(state->drift, 0.006, 150, dt_s, &state->random);
    state->noise = wander(state->noise, noises[state->kind], 0.8, dt_s, &state->random);
    state->lagged += (target(state, time_s) - state->lagged) * (1 - exp(-dt_s / state->lag_s));
    show(state);
}

void process_step(struct process *process, double dt_s)
{
    while (dt_s > 0) {
        double step_s = dt_s < MAX_STEP_S ? dt_s : MAX_STEP_S;
        process->now_s += step_s;
        for (size_t i = 0; i < process->count; i++)
            step_tag(&process->states[i], process->now_s, step_s);
        dt_s -= step_s;
    }
}

double process_value(const struct process *process, size_t tag)
{
    return process->states[tag].value;
}

double process_upset(const struct process *process, const char **name)
{
    *name = "";
    for (int u = 0; u < UPSETS; u++) {
        double reached = level(&upsets[u], process->now_s);
        if (reached > 0) {
            *name = upsets[u].name;
            return reached;
        }
    }
    return 0;
}

const char *process_upset_help(void)
{
    return "  cooling water lost   loops named *cooling*, *condenser*, *overhead*, *reflux*, *drum*, *column*, *reboiler*\n"
           "  exchanger fouled     loops named *preheat*, *exchanger*, *feed*, *column*, *bottoms*, *product*, *reboiler*\n"
           "  pump bearing worn    loops named *pump*, *motor*\n";
}
