/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses the options that several commands share: numbers within ranges, words of fixed lists. */
#include "preprocess/import/options.h"

#include <stdlib.h>
#include <string.h>

#include "base/text/charset.h"

const struct conversion_params options_default = { .chord_m = 0.001, .timeout_s = 120, .memory_bytes = (size_t)2 << 30 };

void options_print(FILE *out)
{
    fputs("  --chord MM        largest distance in mm between the triangles and the curved surfaces of a model\n"
          "                    that they replace (default: 1)\n"
          "  --units UNIT      unit of length of models whose file states none: m, mm, cm, in or ft\n"
          "  --mesh-units UNIT unit of length of OBJ, STL, PLY and 3DS models only\n"
          "  --up AXIS         axis that points up in models whose file states none: y or z\n"
          "  --encoding NAME   character encoding of the names in the model, such as GB18030, Shift-JIS,\n"
          "                    EUC-KR, Windows-1251 (default: the one that the model states, else the most\n"
          "                    likely one, which is printed)\n"
          "  --keep-covered    keep faces of RVM models that a neighbouring face covers; nobody can see them\n"
          "  --timeout S       longest time in seconds that reading one model may take (default: 120)\n"
          "  --memory MB       most memory that reading one model may take (default: 2048)\n"
          "  --formats         print the CAD formats that this program can read\n",
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
