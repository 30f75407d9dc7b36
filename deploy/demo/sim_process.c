/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The simulated process. A table lists upsets (disturbances) and their effects on loops; each tag follows its loop with a first-order lag.
   The effects fit the limits of the demo plant: an upset drives few tags beyond their limits and moves many within them. */
#include "sim_process.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"

enum { MAX_EFFECTS = 20, UPSETS = 3, CYCLE_S = 690 };
static const double MAX_STEP_S = 1.0, TAU = 6.283185307179586;
#define T PROCESS_TEMPERATURE
#define P PROCESS_PRESSURE
#define V PROCESS_VIBRATION
#define MACHINE "machine" /* pseudo loop name: the effect applies to machines, to a different one in each cycle */

struct effect {
    const char *word; /* the effect applies to loops whose names contain this word; or MACHINE */
    enum process_kind kind;
    double share;  /* size of the effect at the peak of the upset, as a fraction of the tag's span */
    double dead_s; /* seconds before the effect begins */
};

struct upset {
    const char *name;
    double start_s, rise_s, hold_s, fall_s; /* times of an upset in seconds: start within the cycle, then durations */
    struct effect effects[MAX_EFFECTS];
};

static const struct upset upsets[UPSETS] = {
    { "cooling water lost", 60, 60, 40, 80, {
        { "condenser", T, 0.16, 4 },  { "overhead", T, 0.15, 8 },  { "reflux", T, 0.05, 15 },     { "drum", T, 0.05, 18 },
        { "offgas", T, 0.05, 20 },    { "distillate", T, 0.05, 25 }, { "cooling", T, 0.05, 0 },   { "column", T, 0.05, 30 },
        { "water", T, 0.025, 0 },     { "reboiler", T, 0.02, 50 }, { "water", P, -0.12, 0 },      { "condenser", P, 0.08, 4 },
        { "overhead", P, 0.08, 6 },   { "drum", P, 0.05, 8 },      { "column", P, 0.05, 8 },      { "offgas", P, 0.05, 10 },
        { "reboiler", P, 0.03, 12 },
    } },
    { "exchanger fouled", 280, 110, 40, 40, {
        { "feed", T, -0.12, 0 },      { "preheat", T, -0.12, 0 },  { "exchanger", T, -0.12, 0 }, { "bottoms", T, 0.07, 10 },
        { "product", T, 0.04, 20 },   { "column", T, -0.03, 30 },  { "feed", P, 0.06, 0 },       { "preheat", P, 0.06, 0 },
        { "exchanger", P, 0.06, 0 },
    } },
    { "bearing worn", 510, 90, 45, 15, {
        { MACHINE, V, 0.40, 0 },      { MACHINE, T, 0.10, 20 },
    } },
};

static const struct {
    const char *word;
    double lag; /* factor by which control loops whose names contain the word are slower than others */
} slow_loops[] = { { "storage", 60 }, { "weather", 60 }, { "steam", 20 } };

struct process_state {
    enum process_kind kind;
    double normal, span;
    double shares[UPSETS], dead_s[UPSETS];
    uint32_t loop; /* hash of the name of the tag's loop; sets the phase of the drift */
    int machine;   /* number of the tag's machine; -1: none */
    double dead_own_s, lag_s;
    double lagged, drift, noise, value;
    uint64_t random;
};

struct process {
    double now_s;
    size_t count;
    struct process_state *states;
    int machine_count;
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

/* Returns whether a loop's name is that of a machine: a pump or motor, or the tag of a pump, compressor or air cooler (P-101, K-101,
   EA-101). */
static bool is_machine(const char *loop)
{
    static const char *const starts[] = { "P-", "K-", "C-", "EA-" };
    for (size_t i = 0; i < sizeof(starts) / sizeof(starts[0]); i++)
        if (!strncmp(loop, starts[i], strlen(starts[i])))
            return true;
    return strcasestr(loop, "pump") || strcasestr(loop, "motor");
}

static bool has_number(const char *loop)
{
    return strpbrk(loop, "0123456789") != NULL;
}

/* Returns the number of a tag's machine, numbered in order of appearance. All tags of one loop are on one machine, and so are all loops
   without a number. */
static int machine_of(struct process *process, const struct process_tag *tags, size_t tag)
{
    if (!is_machine(tags[tag].loop))
        return -1;
    for (size_t i = 0; i < tag; i++)
        if (process->states[i].machine >= 0 &&
            (!strcmp(tags[i].loop, tags[tag].loop) || (!has_number(tags[i].loop) && !has_number(tags[tag].loop))))
            return process->states[i].machine;
    return process->machine_count++;
}

static bool feels(const struct process_state *state, const struct effect *effect, const char *loop)
{
    bool there = !strcmp(effect->word, MACHINE) ? state->machine >= 0 : strcasestr(loop, effect->word) != NULL;
    return there && effect->kind == state->kind;
}

/* Finds the strongest effect of each upset on a loop. */
static void find_effects(struct process_state *state, const char *loop)
{
    for (int u = 0; u < UPSETS; u++)
        for (int e = 0; e < MAX_EFFECTS && upsets[u].effects[e].word; e++) {
            const struct effect *effect = &upsets[u].effects[e];
            if (!feels(state, effect, loop) || fabs(effect->share) <= fabs(state->shares[u]))
                continue;
            state->shares[u] = effect->share;
            state->dead_s[u] = effect->dead_s;
        }
}

static double slowness(const char *loop)
{
    for (size_t i = 0; i < sizeof(slow_loops) / sizeof(slow_loops[0]); i++)
        if (strcasestr(loop, slow_loops[i].word))
            return slow_loops[i].lag;
    return 1;
}

static double drift_of_loop(uint32_t loop, double time_s)
{
    double slow_s = 170 + loop % 97, fast_s = 61 + loop % 41;
    return 0.006 * sin(TAU * (time_s / slow_s + loop % 1000 / 1000.0)) + 0.003 * sin(TAU * (time_s / fast_s + loop % 777 / 777.0));
}

static bool spared(const struct process_state *state, int machine_count, double time_s)
{
    return state->machine >= 0 && time_s >= 0 && (int)fmod(time_s / CYCLE_S, machine_count) != state->machine;
}

static double target(const struct process_state *state, int machine_count, double time_s)
{
    double share = drift_of_loop(state->loop, time_s - state->dead_own_s) + state->drift;
    for (int u = 0; u < UPSETS; u++) {
        double felt_s = time_s - state->dead_s[u] - state->dead_own_s;
        if (state->shares[u] != 0 && !spared(state, machine_count, felt_s))
            share += state->shares[u] * level(&upsets[u], felt_s);
    }
    return state->normal + share * state->span;
}

static void show(struct process_state *state)
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
        struct process_state *state = &process->states[i];
        *state = (struct process_state){
            .kind = tags[i].kind, .normal = tags[i].normal, .span = fabs(tags[i].span), .loop = hash_of(tags[i].loop)
        };
        state->random = seed ^ (uint64_t)hash_of(tags[i].name) << 20;
        state->machine = machine_of(process, tags, i);
        find_effects(state, tags[i].loop);
        double own = 0.75 + 0.5 * uniform(&state->random); /* random factor: tags of one loop react to an upset with different strength */
        for (int u = 0; u < UPSETS; u++)
            state->shares[u] *= own;
        state->dead_own_s = 6 * uniform(&state->random);
        state->lag_s = lags_s[tags[i].kind] * (0.6 + 0.8 * uniform(&state->random)) * slowness(tags[i].loop);
        state->lagged = target(state, 1, 0);
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

/* Steps an Ornstein-Uhlenbeck process, exact for any step size. */
static double wander(double x, double sigma, double time_constant_s, double dt_s, uint64_t *random)
{
    double keep = exp(-dt_s / time_constant_s);
    return x * keep + sigma * sqrt(1 - keep * keep) * normal_deviate(random);
}

static void step_tag(struct process_state *state, int machine_count, double time_s, double dt_s)
{
    static const double noises[] = {
        [PROCESS_TEMPERATURE] = 0.0012, [PROCESS_PRESSURE] = 0.003, [PROCESS_VIBRATION] = 0.008, [PROCESS_OTHER] = 0.003
    };
    state->drift = wander(state->drift, 0.003, 150, dt_s, &state->random);
    state->noise = wander(state->noise, noises[state->kind], 0.8, dt_s, &state->random);
    state->lagged += (target(state, machine_count, time_s) - state->lagged) * (1 - exp(-dt_s / state->lag_s));
    show(state);
}

void process_step(struct process *process, double dt_s)
{
    while (dt_s > 0) {
        double step_s = dt_s < MAX_STEP_S ? dt_s : MAX_STEP_S;
        process->now_s += step_s;
        for (size_t i = 0; i < process->count; i++)
            step_tag(&process->states[i], process->machine_count, process->now_s, step_s);
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
    return "  cooling water lost   tags whose column Sim Loop contains water, cooling, condenser, overhead, reflux, drum,\n"
           "                       offgas, distillate, column or reboiler\n"
           "  exchanger fouled     tags whose column Sim Loop contains feed, preheat, exchanger, bottoms, product or column\n"
           "  bearing worn         tags whose column Sim Loop contains pump or motor, or begins with P-, K-, C- or EA-;\n"
           "                       one machine at a time\n"
           "Tags whose column Sim Loop contains storage, weather or steam change slowly.\n";
}
