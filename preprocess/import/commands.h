/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of plantcast-import. Each takes the arguments after its name and returns the process's exit status. */
#ifndef PREPROCESS_IMPORT_COMMANDS_H
#define PREPROCESS_IMPORT_COMMANDS_H

int command_import(int argc, char **argv);
int command_nodes(int argc, char **argv);

#endif
