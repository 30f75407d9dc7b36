/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The commands of plantcast-import. Each takes the arguments that follow its name and returns the exit status of the process. */
#ifndef PREPROCESS_IMPORT_COMMANDS_H
#define PREPROCESS_IMPORT_COMMANDS_H

int command_import(int argc, char **argv);
int command_nodes(int argc, char **argv);

#endif
