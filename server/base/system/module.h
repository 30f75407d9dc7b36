/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parts of programs in files of their own, loaded when they are first needed: what libraries with hundreds of others behind them do is not
   paid for at each start. Thread: any. */
#ifndef BASE_SYSTEM_MODULE_H
#define BASE_SYSTEM_MODULE_H
#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>

struct module {
    const char *name; /* of the file: beside the program, or ../lib/plantcast from there */
    pthread_mutex_t lock;
    void *library; /* under lock; NULL: not loaded yet, or it cannot be. It stays loaded */
};
#define MODULE(file) { .name = (file), .lock = PTHREAD_MUTEX_INITIALIZER }

/* Sets the function pointer at `function` to what the module has of that name. Returns false, with the file and the reason in why, if it
   cannot be loaded or is of another version. */
bool module_find(struct module *module, const char *name, void *function, char *why, size_t why_bytes);

#endif
