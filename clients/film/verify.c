/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast verify` for films. */
#include <stdio.h>

#include "clients/cli/picture/verify.h"
#include "commands.h"
#include "signed_film.h"

int command_verify(int argc, char **argv)
{
    char why[SIGNED_PICTURE_WHY_BYTES];
    struct verify_options options;
    int code = verify_parse(argc, argv, &options);
    if (code >= 0)
        return code;
    struct signing_key *key = signing_key_load_public(options.key, why);
    if (!key) {
        fprintf(stderr, "plantcast: --key: %s\n", why);
        return 2;
    }
    code = film_verify(key, options.path, &options.redraw, options.tour);
    signing_key_destroy(&key);
    return code;
}
