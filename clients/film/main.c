/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-film`: makes and verifies films with libavformat. `plantcast clip` and, for films, `plantcast verify` start it; argv[0] is the
   command. */
#include <string.h>

#include "base/system/standard_output.h"
#include "clients/link/daemon.h"
#include "commands.h"

int main(int argc, char **argv)
{
    struct daemon_access access;
    if (!daemon_take_options(&argc, argv, &access))
        return 2;
    return standard_output_end("plantcast", !strcmp(argv[0], "verify") ? command_verify(argc, argv) : command_clip(&access, argc, argv));
}
