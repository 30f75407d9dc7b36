/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confines the current process, for programs that parse untrusted files in their own threads. */
#ifndef PREPROCESS_CHILD_CHILD_SELF_H
#define PREPROCESS_CHILD_CHILD_SELF_H
#include "preprocess/child/child_paths.h"

/* Returns whether this process was restarted and confined by child_self_confine(). */
bool child_self_confined(void);
/* Confines this process with the rights of CONFINE_READER (confine.h) and access to these paths. Landlock confines only the calling thread,
 * so if libraries have already started other threads, executes the program again, confined. Returns 0, or -errno. */
int child_self_confine(const struct child_paths *paths, bool notifies, char **argv);

#endif
