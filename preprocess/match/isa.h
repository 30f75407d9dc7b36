/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tag names as ANSI/ISA-5.1 builds them: what comes before, letters for the measured variable and the function, loop number, suffix; and
 * what control systems put behind (.PV, .SP). Thread: any. */
#ifndef PREPROCESS_MATCH_ISA_H
#define PREPROCESS_MATCH_ISA_H
#include "preprocess/match/name_tokens.h"

enum isa_role { /* of the value behind the name */
                ISA_MEASURED,
                ISA_STATE,   /* of a switch, an alarm, a valve's end position, a command */
                ISA_SETTING, /* set point, output, limit, tuning */
};

struct isa_name {
    struct name_tokens tokens; /* without the last, where that is an attribute such as PV */
    int letters, number;       /* tokens; -1: there are none */
    const char *suffix;        /* a single letter behind the number, or "" */
    char variable;             /* the first letter, 'd' for a difference of pressures; 0: none */
    enum isa_role role;
    const char *attribute; /* the word behind the name that says the role, such as SP; "": none */
};

/* Takes a tag's name apart. The suffix points into name->tokens. */
void isa_read(struct isa_name *name, const char *text);
/* Returns whether these letters (upper case) may stand before a loop number. */
bool isa_are_letters(const char *letters);
/* Returns what the variable is called, such as "Temperature"; NULL where ISA-5.1 leaves it to the user. */
const char *isa_quantity(char variable);

#endif
