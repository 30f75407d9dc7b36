/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads modules (the program's own shared libraries) from the program's folder, or from the installation's ../lib/plantcast. */
#include "base/system/module.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

#define PATH_BYTES 4096

/* Returns the path of a module's file; the caller frees it. Returns NULL with the reason if the file is missing. Each module
   comes in a Debian package of the same name. */
static char *path_of(const char *name, char *why, size_t why_bytes)
{
    static const char *const places[] = { "", "../lib/plantcast/" };
    char program[PATH_BYTES] = "";
    ssize_t length = readlink("/proc/self/exe", program, sizeof(program) - 1);
    char *end = length > 0 ? strrchr(program, '/') : NULL;
    for (size_t i = 0; end && i < sizeof(places) / sizeof(*places); i++) {
        char *path = mem_printf("%.*s%s%s", (int)(end + 1 - program), program, places[i], name);
        if (access(path, F_OK) == 0)
            return path;
        mem_free(path);
    }
    snprintf(why, why_bytes, "%s is missing: install the package %.*s (searched next to %s and in ../lib/plantcast)", name,
             (int)strcspn(name, "."), name, end ? program : "the program");
    return NULL;
}

static void *load(const char *name, char *why, size_t why_bytes)
{
    char *path = path_of(name, why, why_bytes);
    void *library = path ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
    if (path && !library) {
        /* this text begins with the name of the file that failed to load, which may be a dependency of the module */
        const char *reason = dlerror();
        snprintf(why, why_bytes, "%s cannot be loaded: %s", path, reason ? reason : "no reason given");
    }
    mem_free(path);
    return library;
}

bool module_find(struct module *module, const char *name, void *function, char *why, size_t why_bytes)
{
    pthread_mutex_lock(&module->lock);
    if (!module->library)
        module->library = load(module->name, why, why_bytes);
    void *library = module->library, *symbol = library ? dlsym(library, name) : NULL;
    pthread_mutex_unlock(&module->lock);
    if (library && !symbol)
        snprintf(why, why_bytes,
                 "%s has another version than this program: the function %s is missing; install the same version of all packages",
                 module->name, name);
    memcpy(function, &symbol, sizeof(symbol));
    return symbol != NULL;
}
