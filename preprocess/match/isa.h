/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses tag names according to ANSI/ISA-5.1: prefix, letters for the measured variable and the function, loop number, suffix,
 * and the attribute appended by control systems (.PV, .SP). Call from any thread. */
#ifndef PREPROCESS_MATCH_ISA_H
#define PREPROCESS_MATCH_ISA_H
#include "preprocess/match/name_tokens.h"

enum isa_role { /* role of the tag's value */
                ISA_MEASURED,
                ISA_STATE,   /* the value is the state of a switch, alarm, valve end position or command */
                ISA_SETTING, /* the value is a set point, output, limit or tuning parameter */
};

struct isa_name {
    struct name_tokens tokens; /* tokens of the name, without a trailing attribute such as PV */
    /* indices in `tokens` of the identification letters and of the loop number; -1: none */
    int letters, number;
    const char *suffix; /* suffix: a single letter after the loop number; "": none */
    char variable;      /* letter of the measured variable; 'd': differential pressure; 0: unknown */
    enum isa_role role;
    const char *attribute; /* trailing attribute word from which the role follows, such as SP; "": none */
};

/* Parses a tag's name. name->suffix points into name->tokens. */
void isa_read(struct isa_name *name, const char *text);
/* Returns whether these letters (upper case) can precede a loop number according to ISA-5.1. */
bool isa_are_letters(const char *letters);
/* Returns the name of the measured variable for a letter, such as "Temperature", or NULL if ISA-5.1 leaves the letter's meaning
 * to the user. */
const char *isa_quantity(char variable);

#endif
