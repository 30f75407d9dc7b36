/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads images by a module that is loaded when there is one to read: to start with OpenImageIO and the 260 libraries behind it takes a
   fifth of a second, more than all else that many a program does. */
#include "base/image.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"

#define MODULE "plantcast-images.so" /* server/base/image_shim.cc */
#define PATH_BYTES 4096

static struct module {
    bool (*decode)(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
    bool (*load)(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
    bool (*load_float)(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES]);
    bool good;
    char why[IMAGE_WHY_BYTES];
} module;

static void find(void *library, const char *name, void *function)
{
    void *symbol = dlsym(library, name);
    module.good &= symbol != NULL;
    memcpy(function, &symbol, sizeof(symbol));
}

/* Beside the program, or where it is installed. It stays loaded. */
static void open_module(void)
{
    static const char *const places[] = { "", "../lib/plantcast/" };
    char program[PATH_BYTES] = "";
    void *library = NULL;
    ssize_t length = readlink("/proc/self/exe", program, sizeof(program) - 1);
    char *name = length > 0 ? strrchr(program, '/') : NULL;
    for (size_t i = 0; name && !library && i < sizeof(places) / sizeof(*places); i++) {
        char *path = mem_printf("%.*s%s" MODULE, (int)(name + 1 - program), program, places[i]);
        library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        mem_free(path);
        if (!library && i == 0)
            snprintf(module.why, sizeof(module.why), "%s", dlerror());
    }
    if (!library)
        return;
    module.good = true;
    find(library, "image_decode", &module.decode);
    find(library, "image_load", &module.load);
    find(library, "image_load_float", &module.load_float);
    if (!module.good)
        snprintf(module.why, sizeof(module.why), MODULE " is of another version");
}

static bool is_there(char why[IMAGE_WHY_BYTES])
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, open_module);
    if (!module.good)
        memcpy(why, module.why, sizeof(module.why));
    return module.good;
}

bool image_decode(struct image *image, const void *bytes, size_t size, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    *image = (struct image){ 0 };
    return is_there(why) && module.decode(image, bytes, size, max_px, why);
}

bool image_load(struct image *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    *image = (struct image){ 0 };
    return is_there(why) && module.load(image, path, max_px, why);
}

bool image_load_float(struct image_float *image, const char *path, uint32_t max_px, char why[IMAGE_WHY_BYTES])
{
    *image = (struct image_float){ 0 };
    return is_there(why) && module.load_float(image, path, max_px, why);
}
