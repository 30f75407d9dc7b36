/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the identification letters of ANSI/ISA-5.1-2009, table 4.1. */
#include "preprocess/match/isa.h"

#include <string.h>

static const struct {
    char variable;
    const char *name;
} quantities[] = {
    { 'T', "Temperature" },  { 'P', "Pressure" },  { 'd', "Differential pressure" },
    { 'F', "Flow" },         { 'L', "Level" },     { 'A', "Analysis" },
    { 'S', "Speed" },        { 'V', "Vibration" }, { 'Z', "Position" },
    { 'W', "Weight" },       { 'E', "Voltage" },   { 'I', "Current" },
    { 'J', "Power" },        { 'D', "Density" },   { 'M', "Moisture" },
    { 'C', "Conductivity" }, { 'R', "Radiation" }, { 'Q', "Quantity" },
    { 'H', NULL },           { 'X', NULL },        { 'U', NULL },
    { 'B', NULL },           { 'Y', NULL },        { 'K', NULL },
    { 'N', NULL },           { 'O', NULL },        { 'G', NULL },
};
enum { QUANTITIES = sizeof(quantities) / sizeof(*quantities) };

const char *isa_quantity(char variable)
{
    for (int i = 0; i < QUANTITIES; i++)
        if (quantities[i].variable == variable)
            return quantities[i].name;
    return NULL;
}

/* The letters before a loop number are valid if they are a measured variable, optionally a modifier (D, F, J, K, M, Q, S, X, Y,
 * Z), then functions. H, L and O are valid only after a function. */
bool isa_are_letters(const char *letters)
{
    static const char functions[] = "ACEGIKQRSTUVWYZ";
    size_t length = strlen(letters);
    if (length < 2 || length > 5 || !strchr("ABCDEFHIJKLMNOPQRSTUVWXYZ", letters[0]))
        return false;
    bool modified = length > 2 && strchr("DFJKMQSXYZ", letters[1]) && strchr(functions, letters[2]);
    size_t at = modified ? 2 : 1;
    return strchr(functions, letters[at]) && letters[at] && strspn(letters + at, "ACEGIKQRSTUVWYZHLOM") == length - at;
}

/* attribute words that control systems append to tag names, such as PV, and the role of such tags */
static const struct {
    const char *word;
    enum isa_role role;
} attributes[] = {
    { "PV", ISA_MEASURED },     { "VALUE", ISA_MEASURED }, { "VAL", ISA_MEASURED },   { "CV", ISA_MEASURED },   { "DACA", ISA_MEASURED },
    { "PVCALC", ISA_MEASURED }, { "IN", ISA_MEASURED },    { "AI", ISA_MEASURED },    { "RAW", ISA_MEASURED },  { "ACT", ISA_MEASURED },
    { "MEAS", ISA_MEASURED },   { "INPUT", ISA_MEASURED }, { "SP", ISA_SETTING },     { "SPT", ISA_SETTING },   { "OP", ISA_SETTING },
    { "MV", ISA_SETTING },      { "OUT", ISA_SETTING },    { "OUTPUT", ISA_SETTING }, { "CO", ISA_SETTING },    { "RSP", ISA_SETTING },
    { "KP", ISA_SETTING },      { "TI", ISA_SETTING },     { "TD", ISA_SETTING },     { "GAIN", ISA_SETTING },  { "MODE", ISA_STATE },
    { "ALM", ISA_STATE },       { "ALARM", ISA_STATE },    { "RUN", ISA_STATE },      { "RUNNING", ISA_STATE }, { "FAULT", ISA_STATE },
    { "STATUS", ISA_STATE },    { "STS", ISA_STATE },      { "CMD", ISA_STATE },      { "HI", ISA_STATE },      { "LO", ISA_STATE },
    { "HIHI", ISA_STATE },      { "LOLO", ISA_STATE },     { "ACK", ISA_STATE },
};

/* Removes trailing attribute words, such as PV, that follow a separator in the tag name. The last word determines the role
 * (measurement, state or setting). */
static void drop_attributes(struct isa_name *name)
{
    bool first = true;
    while (name->tokens.count > 1) {
        const struct name_token *last = &name->tokens.at[name->tokens.count - 1];
        size_t i = 0, count = sizeof(attributes) / sizeof(*attributes);
        while (i < count && (!last->apart || strcmp(attributes[i].word, last->text) != 0))
            i++;
        if (i == count)
            return;
        if (first || attributes[i].role != ISA_MEASURED) {
            name->role = attributes[i].role;
            name->attribute = attributes[i].word;
        }
        first = false;
        name->tokens.count--;
    }
}

static enum isa_role role_of(const char *letters)
{
    size_t length = strlen(letters);
    const char *functions = letters + 1;
    if (strchr(functions, 'A') && !strchr("A", letters[0]))
        return ISA_STATE;
    if (letters[0] == 'H' || letters[0] == 'X' || letters[0] == 'Y')
        return ISA_STATE;
    if (strpbrk(functions, "HLO"))
        return ISA_STATE;
    if (letters[length - 1] == 'S' && length > 1)
        return ISA_STATE;
    if (letters[length - 1] == 'V' || letters[length - 1] == 'Y')
        return ISA_SETTING;
    return ISA_MEASURED;
}

void isa_read(struct isa_name *name, const char *text)
{
    *name = (struct isa_name){ .letters = -1, .number = -1, .suffix = "", .role = ISA_MEASURED, .attribute = "" };
    name_tokens_read(&name->tokens, text);
    drop_attributes(name);
    bool measured = name->role == ISA_MEASURED;
    for (int i = name->tokens.count - 2; i >= 0 && name->letters < 0; i--) {
        const struct name_token *at = &name->tokens.at[i], *next = at + 1;
        if (at->digits || !next->digits || next->raw_length < 2 || !isa_are_letters(at->text))
            continue;
        name->letters = i;
        name->number = i + 1;
        if (i + 2 < name->tokens.count && !next[1].digits && strlen(next[1].text) == 1)
            name->suffix = next[1].text;
    }
    if (name->letters < 0)
        return;
    const char *letters = name->tokens.at[name->letters].text;
    name->variable = letters[0] == 'P' && letters[1] == 'D' ? 'd' : letters[0];
    if (measured)
        name->role = role_of(letters);
}
