/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Command-line options shared by the commands `import` and `nodes`. */
#ifndef PREPROCESS_IMPORT_OPTIONS_H
#define PREPROCESS_IMPORT_OPTIONS_H
#include <getopt.h>
#include <stdio.h>

#include "preprocess/import/conversion.h"

/* entries of the shared options, for the option array of getopt_long() */
#define OPTIONS_OF_CONVERSION                                                                                                              \
    { "chord", required_argument, NULL, 'c' }, { "units", required_argument, NULL, 'u' }, { "up", required_argument, NULL, 'U' },          \
        { "encoding", required_argument, NULL, 'e' }, { "mesh-units", required_argument, NULL, 'M' },                                      \
        { "keep-covered", no_argument, NULL, 'k' }, { "timeout", required_argument, NULL, 't' },                                           \
        { "memory", required_argument, NULL, 'm' }, { "formats", no_argument, NULL, 'F' },                                                 \
    {                                                                                                                                      \
        "help", no_argument, NULL, 'h'                                                                                                     \
    }

extern const struct conversion_params options_default;
/* Prints the help text of the shared options. */
void options_print(FILE *out);
/* Applies a shared option to params. Returns false if the option is not a shared one, or if its value is invalid; an error has
 * then been printed. */
bool options_take(struct conversion_params *params, const char *command, int option, const char *value);

#endif
