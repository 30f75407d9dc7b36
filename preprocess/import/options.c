/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the options that several commands share: numbers within ranges, words of fixed lists. */
#include "preprocess/import/options.h"

#include <stdlib.h>
#include <string.h>

#include "base/text/charset.h"

const struct conversion_params options_default = { .chord_m = 0.001, .timeout_s = 120, .memory_bytes = (size_t)2 << 30 };

void options_print(FILE *out)
{
    fputs("  --chord MM        greatest distance in mm from a triangle to the true surface, where a model has one (default: 1)\n"
          "  --units UNIT      unit of models that name none: m, mm, cm, in or ft\n"
          "  --mesh-units UNIT unit of OBJ, STL, PLY and 3DS models alone\n"
          "  --up AXIS         up axis of models that name none: y or z\n"
          "  --encoding NAME   encoding of names, such as GB18030, Shift-JIS, EUC-KR, Windows-1251 (default: the encoding that the\n"
          "                    model names, else the most likely one, which is printed)\n"
          "  --keep-covered    RVM: keep faces that are covered by a neighbouring face\n"
          "  --timeout S       time limit in seconds for reading one model (default: 120)\n"
          "  --memory MB       memory limit for reading one model (default: 2048)\n"
          "  --formats         print the formats that this build reads\n",
          out);
}

static const char *one_of(const char *words, const char *value)
{
    size_t length = strlen(value);
    for (const char *at = words; *at; at += strcspn(at, " "), at += *at == ' ')
        if (strcspn(at, " ") == length && !strncmp(at, value, length))
            return value;
    return NULL;
}

static bool number(const char *value, double least, double most, double *out)
{
    char *end;
    *out = strtod(value, &end);
    return end != value && !*end && *out >= least && *out <= most;
}

bool options_take(struct conversion_params *params, const char *command, int option, const char *value)
{
    static char encoding[CHARSET_NAME_BYTES];
    const char *wanted = NULL, *name = NULL;
    double taken;
    switch (option) {
    case 'c':
        name = "chord", wanted = number(value, 0.01, 1000, &taken) ? NULL : "0.01 to 1000 (mm)";
        params->chord_m = taken / 1000;
        break;
    case 't':
        name = "timeout", wanted = number(value, 1, 86400, &taken) ? NULL : "1 to 86400 (s)";
        params->timeout_s = wanted ? 1 : (int)taken;
        break;
    case 'm':
        name = "memory", wanted = number(value, 64, 1e6, &taken) ? NULL : "64 to 1000000 (MB)";
        params->memory_bytes = wanted ? 0 : (size_t)taken << 20;
        break;
    case 'u': name = "units", wanted = (params->units = one_of("m mm cm in ft", value)) ? NULL : "m, mm, cm, in or ft"; break;
    case 'M': name = "mesh-units", wanted = (params->mesh_units = one_of("m mm cm in ft", value)) ? NULL : "m, mm, cm, in or ft"; break;
    case 'e':
        name = "encoding", wanted = charset_resolve(value, encoding) ? NULL : "unknown; iconv --list shows the names that are known";
        params->encoding = encoding;
        break;
    case 'U': name = "up", wanted = (params->up = one_of("y z", value)) ? NULL : "y or z"; break;
    case 'k': params->keep_covered = true; return true;
    default: return false;
    }
    if (wanted)
        fprintf(stderr, "plantcast %s: --%s %s: %s\n", command, name, value, wanted);
    return !wanted;
}
