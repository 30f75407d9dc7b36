/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compiles expressions by recursive descent into steps of a stack machine, and evaluates them. */
#include "plant/tags/expression.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "plant/parse/number.h"

enum { MAX_STEPS = 256, MAX_DEPTH = 32, MAX_ARGUMENTS = 64 };
static_assert(MAX_STEPS == 256 && MAX_DEPTH == 32 && EXPRESSION_INPUTS == 64, "the error texts below name these limits");

enum operation { OP_NUMBER, OP_INPUT, OP_ADD, OP_SUBTRACT, OP_MULTIPLY, OP_DIVIDE, OP_POWER, OP_NEGATE, OP_FUNCTION };

struct expression_step {
    enum operation operation;
    double number;
    /* index: meaning depends on `operation`: index of an input in expression_inputs(), or of a function. arguments: number of
       the function's arguments */
    int index, arguments;
};

struct expression {
    struct expression_step steps[MAX_STEPS];
    size_t count;
    int inputs[EXPRESSION_INPUTS];
    size_t input_count;
};

/* --- functions -------------------------------------------------------------------------------------------------------------- */

static double sum_of(const double *v, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += v[i];
    return sum;
}

static double mean_of(const double *v, int count)
{
    return sum_of(v, count) / count;
}

static double least_of(const double *v, int count)
{
    double least = v[0];
    for (int i = 1; i < count; i++)
        least = v[i] < least ? v[i] : least;
    return least;
}

static double most_of(const double *v, int count)
{
    double most = v[0];
    for (int i = 1; i < count; i++)
        most = v[i] > most ? v[i] : most;
    return most;
}

static double magnitude_of(const double *v, int count)
{
    (void)count;
    return fabs(v[0]);
}

static double root_of(const double *v, int count)
{
    (void)count;
    return sqrt(v[0]);
}

static double difference_of(const double *v, int count)
{
    (void)count;
    return v[0] - v[1];
}

/* Returns the approach temperature of a counterflow heat exchanger: the smaller of the temperature differences at its two ends.
   Inputs: hot in, hot out, cold in, cold out. */
static double approach_of(const double *v, int count)
{
    (void)count;
    return fmin(v[0] - v[3], v[1] - v[2]);
}

/* Returns the logarithmic mean temperature difference of a counterflow heat exchanger. Inputs: hot in, hot out, cold in, cold out. */
static double lmtd_of(const double *v, int count)
{
    double a = v[0] - v[3], b = v[1] - v[2];
    (void)count;
    if (!(a > 0) || !(b > 0))
        return NAN;
    return fabs(a - b) < 1e-9 * a ? a : (a - b) / log(a / b);
}

static const struct {
    const char *name;
    int least, most;
    double (*of)(const double *values, int count);
} functions[] = {
    { "mean", 1, MAX_ARGUMENTS, mean_of }, { "sum", 1, MAX_ARGUMENTS, sum_of }, { "min", 1, MAX_ARGUMENTS, least_of },
    { "max", 1, MAX_ARGUMENTS, most_of },  { "abs", 1, 1, magnitude_of },       { "sqrt", 1, 1, root_of },
    { "difference", 2, 2, difference_of }, { "approach", 4, 4, approach_of },   { "lmtd", 4, 4, lmtd_of },
};
enum { FUNCTIONS = sizeof(functions) / sizeof(*functions) };

/* --- parsing ---------------------------------------------------------------------------------------------------------------- */

struct expression_parser {
    const char *text, *p;
    struct expression *out;
    int (*find)(const void *arg, const char *name);
    const void *arg;
    char *why;
    int depth;
};

static bool fail(struct expression_parser *parser, const char *why, const char *what)
{
    snprintf(parser->why, 200, why, what);
    return false;
}

static char peek(struct expression_parser *parser)
{
    while (*parser->p == ' ' || *parser->p == '\t')
        parser->p++;
    return *parser->p;
}

static bool add_step(struct expression_parser *parser, struct expression_step step)
{
    if (parser->out->count == MAX_STEPS)
        return fail(parser, "the expression has more than 256 numbers, tags and operations, the maximum%s", "");
    parser->out->steps[parser->out->count++] = step;
    return true;
}

static bool parse_sum(struct expression_parser *parser);

static bool parse_number(struct expression_parser *parser)
{
    size_t length = strspn(parser->p, "0123456789.");
    if ((parser->p[length] | 32) == 'e') {
        size_t sign = parser->p[length + 1] == '-' || parser->p[length + 1] == '+';
        length += 1 + sign + strspn(parser->p + length + 1 + sign, "0123456789");
    }
    char *text = mem_printf("%.*s", (int)length, parser->p);
    double number;
    bool good = number_parse(text, &number) == NUMBER_GOOD;
    mem_free(text);
    if (!good)
        return fail(parser, "the expression needs a number such as 1.5 here%s", "");
    parser->p += length;
    return add_step(parser, (struct expression_step){ .operation = OP_NUMBER, .number = number });
}

static bool add_input(struct expression_parser *parser, int found)
{
    struct expression *out = parser->out;
    size_t i = 0;
    while (i < out->input_count && out->inputs[i] != found)
        i++;
    if (i == EXPRESSION_INPUTS)
        return fail(parser, "the expression has more than 64 different tags, the maximum%s", "");
    if (i == out->input_count)
        out->inputs[out->input_count++] = found;
    return add_step(parser, (struct expression_step){ .operation = OP_INPUT, .index = (int)i });
}

static bool parse_name(struct expression_parser *parser)
{
    const char *end = strchr(parser->p, ']');
    if (!end)
        return fail(parser, "the expression needs ] after the name of a tag%s", "");
    char *name = mem_printf("%.*s", (int)(end - parser->p - 1), parser->p + 1);
    int found = parser->find(parser->arg, name);
    if (found < 0)
        fail(parser, "unknown tag '%.60s'", name);
    mem_free(name);
    if (found < 0 || !add_input(parser, found))
        return false;
    parser->p = end + 1;
    return true;
}

static bool parse_arguments(struct expression_parser *parser, int function)
{
    int count = 0;
    char next;
    do {
        parser->p++;
        if (!parse_sum(parser))
            return false;
        count++;
        next = peek(parser);
    } while ((next == ',' || next == ';') && count < MAX_ARGUMENTS);
    if (next != ')')
        return fail(parser, "the expression needs ) after the arguments of %s", functions[function].name);
    if (count < functions[function].least || count > functions[function].most) {
        char what[80];
        snprintf(what, sizeof(what), "%d argument%s for %s, found %d", functions[function].least, functions[function].least == 1 ? "" : "s",
                 functions[function].name, count);
        return fail(parser, "expected %s", what);
    }
    parser->p++;
    return add_step(parser, (struct expression_step){ .operation = OP_FUNCTION, .index = function, .arguments = count });
}

static bool parse_call(struct expression_parser *parser)
{
    size_t length = 0;
    while (isalnum((unsigned char)parser->p[length]) || parser->p[length] == '_')
        length++;
    int i = 0;
    while (i < FUNCTIONS && (strlen(functions[i].name) != length || memcmp(functions[i].name, parser->p, length) != 0))
        i++;
    if (i == FUNCTIONS)
        return fail(parser,
                    "the expression needs [TAG], a number, or one of mean, sum, min, max, abs, sqrt, difference, approach, lmtd here%s",
                    "");
    parser->p += length;
    return peek(parser) == '(' ? parse_arguments(parser, i) : fail(parser, "expected ( after %s", functions[i].name);
}

static bool parse_primary(struct expression_parser *parser)
{
    char next = peek(parser);
    if (next == '[')
        return parse_name(parser);
    if (isdigit((unsigned char)next) || next == '.')
        return parse_number(parser);
    if (next != '(')
        return parse_call(parser);
    parser->p++;
    if (!parse_sum(parser))
        return false;
    if (peek(parser) != ')')
        return fail(parser, "expected )%s", "");
    parser->p++;
    return true;
}

static bool parse_signed(struct expression_parser *parser);

static bool parse_power(struct expression_parser *parser)
{
    if (!parse_primary(parser))
        return false;
    if (peek(parser) != '^')
        return true;
    parser->p++;
    return parse_signed(parser) && add_step(parser, (struct expression_step){ .operation = OP_POWER });
}

static bool parse_signed(struct expression_parser *parser)
{
    if (++parser->depth > MAX_DEPTH)
        return fail(parser, "the expression's brackets and signs are nested more than 32 deep, the maximum%s", "");
    bool negative = peek(parser) == '-', good;
    if (negative)
        parser->p++;
    good = negative ? parse_signed(parser) && add_step(parser, (struct expression_step){ .operation = OP_NEGATE }) : parse_power(parser);
    parser->depth--;
    return good;
}

static bool parse_product(struct expression_parser *parser)
{
    bool good = parse_signed(parser);
    for (char next; good && ((next = peek(parser)) == '*' || next == '/');) {
        parser->p++;
        good = parse_signed(parser) && add_step(parser, (struct expression_step){ .operation = next == '*' ? OP_MULTIPLY : OP_DIVIDE });
    }
    return good;
}

static bool parse_sum(struct expression_parser *parser)
{
    bool good = parse_product(parser);
    for (char next; good && ((next = peek(parser)) == '+' || next == '-');) {
        parser->p++;
        good = parse_product(parser) && add_step(parser, (struct expression_step){ .operation = next == '+' ? OP_ADD : OP_SUBTRACT });
    }
    return good;
}

struct expression *expression_parse(const char *text, int (*find)(const void *arg, const char *name), const void *arg, char why[200],
                                    size_t *at)
{
    struct expression_parser parser = {
        .text = text, .p = text, .out = mem_new(sizeof(*parser.out)), .find = find, .arg = arg, .why = why
    };
    bool good = parse_sum(&parser);
    if (good && peek(&parser))
        good = fail(&parser, "the expression needs + - * / ^ or the end here, found '%.20s'", parser.p);
    *at = (size_t)(parser.p - text);
    if (!good)
        expression_destroy(&parser.out);
    return parser.out;
}

void expression_destroy(struct expression **expression)
{
    mem_free(*expression);
    *expression = NULL;
}

size_t expression_inputs(const struct expression *expression, const int **inputs)
{
    *inputs = expression->inputs;
    return expression->input_count;
}

/* --- computing -------------------------------------------------------------------------------------------------------------- */

static double join(enum operation operation, double a, double b)
{
    switch (operation) {
    case OP_ADD: return a + b;
    case OP_SUBTRACT: return a - b;
    case OP_MULTIPLY: return a * b;
    case OP_DIVIDE: return a / b;
    default: return pow(a, b);
    }
}

double expression_value(const struct expression *expression, const double *values)
{
    double stack[MAX_STEPS];
    size_t top = 0;
    for (size_t i = 0; i < expression->count; i++) {
        const struct expression_step *step = &expression->steps[i];
        if (step->operation == OP_NUMBER) {
            stack[top++] = step->number;
        } else if (step->operation == OP_INPUT) {
            stack[top++] = values[step->index];
        } else if (step->operation == OP_NEGATE) {
            stack[top - 1] = -stack[top - 1];
        } else if (step->operation == OP_FUNCTION) {
            top -= (size_t)step->arguments - 1;
            stack[top - 1] = functions[step->index].of(&stack[top - 1], step->arguments);
        } else {
            top--;
            stack[top - 1] = join(step->operation, stack[top - 1], stack[top]);
        }
        /* returns an undefined result as soon as an intermediate result is undefined: min(), or a division by infinity, would
           otherwise hide it */
        if (!isfinite(stack[top - 1]))
            return NAN;
    }
    assert(top == 1);
    return stack[0];
}
