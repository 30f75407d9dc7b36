/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confines this program itself, for programs that parse strangers' files in their own threads. */
#ifndef PREPROCESS_CHILD_CHILD_SELF_H
#define PREPROCESS_CHILD_CHILD_SELF_H
#include "preprocess/child/child_paths.h"

/* Returns whether child_self_confine() has started this program again, confined. */
bool child_self_confined(void);
/* Confines this process as a reader with these paths. Libraries may have started threads already, which Landlock would miss: then the
 * program starts again from its first line, confined. Returns 0, or -errno. */
int child_self_confine(const struct child_paths *paths, bool notifies, char **argv);

#endif
