/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modules: parts of a program in shared libraries that are loaded on first use, so that the program starts without loading
   libraries with hundreds of dependencies. Call from any thread. */
#ifndef BASE_SYSTEM_MODULE_H
#define BASE_SYSTEM_MODULE_H
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

struct module {
    const char *name; /* file name; looked up in the program's folder and in ../lib/plantcast */
    pthread_mutex_t lock;
    void *library; /* library handle, protected by `lock`; NULL: not loaded yet, or not loadable. A library is never unloaded */
};
#define MODULE(file) { .name = (file), .lock = PTHREAD_MUTEX_INITIALIZER }

/* Sets the function pointer at `function` to the module's function of that name; first loads the module if needed. Returns
   false, with the file and the reason in `why`, if the module cannot be loaded or has a different version. */
bool module_find(struct module *module, const char *name, void *function, char *why, size_t why_bytes);

#endif
