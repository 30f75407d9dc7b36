/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-import`: converts CAD exports to GLB, one file each, with names, hierarchy and attributes. `plantcast import` and
 * `plantcast nodes` run this program; the name it is run under (argv[0]) selects the command. */
#include <string.h>

#include "base/system/standard_output.h"
#include "preprocess/import/commands.h"

int main(int argc, char **argv)
{
    return standard_output_end("plantcast", !strcmp(argv[0], "nodes") ? command_nodes(argc, argv) : command_import(argc, argv));
}
