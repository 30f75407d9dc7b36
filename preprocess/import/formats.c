/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of model file formats that can be imported. */
#include "preprocess/import/formats.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/mem.h"
#include "preprocess/import/file_name.h"

#define BY_OCCT "plantcast-import-occt", NULL, "this Plantcast was built without OCCT: install libocct-data-exchange-dev and build again"
#define BY_ASSIMP "plantcast-import-assimp", NULL, "this Plantcast was built without Assimp: install libassimp-dev and build again"
#define BY_WEB_IFC "plantcast-import-ifc/ifc.mjs", "node", "this Plantcast was built without web-ifc: install npm and build again"

/* endings of buffer and image files that a glTF model may refer to */
#define OF_GLTF ".bin .buffer .dat .png .jpg .jpeg .webp .ktx .ktx2 .basis .dds .gif .bmp .tga .tif .tiff .exr .hdr"

static const struct import_format formats[] = {
    { "glTF", ".glb .gltf", FORMAT_GLTF, NULL, NULL, NULL, OF_GLTF, false, true, true },
    { "RVM", ".rvm", FORMAT_RVM, NULL, NULL, NULL, NULL, false, false, false },
    { "STEP", ".step .stp .p21 .stpz", FORMAT_PROGRAM, BY_OCCT, ".step .stp .p21", true, false, true },
    { "IGES", ".iges .igs", FORMAT_PROGRAM, BY_OCCT, NULL, false, false, true },
    { "IFC", ".ifc .ifczip", FORMAT_PROGRAM, BY_WEB_IFC, NULL, false, false, false },
    { "OBJ", ".obj", FORMAT_PROGRAM, BY_ASSIMP, ".mtl", false, true, true },
    { "STL", ".stl", FORMAT_PROGRAM, BY_ASSIMP, NULL, false, true, true },
    { "PLY", ".ply", FORMAT_PROGRAM, BY_ASSIMP, NULL, false, true, true },
    { "FBX", ".fbx", FORMAT_PROGRAM, BY_ASSIMP, NULL, false, false, false },
    { "COLLADA", ".dae .zae", FORMAT_PROGRAM, BY_ASSIMP, NULL, false, false, false },
    { "3DS", ".3ds", FORMAT_PROGRAM, BY_ASSIMP, NULL, false, true, false },
};
enum { FORMATS = sizeof(formats) / sizeof(formats[0]) };

static bool has_ending(const char *endings, const char *ending)
{
    size_t length = strlen(ending);
    for (const char *at = endings; at; at = strchr(at, ' ')) {
        at += *at == ' ';
        if (!strncasecmp(at, ending, length) && (at[length] == ' ' || !at[length]))
            return true;
    }
    return false;
}

const struct import_format *import_format_of(const char *path)
{
    const struct import_format *found = NULL;
    char *plain = file_name_without_gz(path);
    const char *dot = strrchr(plain, '.');
    for (int i = 0; dot && dot[1] && !strchr(dot, '/') && i < FORMATS && !found; i++)
        if (has_ending(formats[i].endings, dot))
            found = &formats[i];
    if (found && found->reader == FORMAT_GLTF && strcmp(plain, path) != 0)
        found = NULL; /* refuse a compressed glTF file: it would be unpacked in another folder, away from its buffers */
    mem_free(plain);
    return found;
}

char *import_format_runtime(const struct import_format *format)
{
    const char *at = format->runtime ? getenv("PATH") : NULL;
    char *found = NULL;
    while (at && *at && !found) {
        size_t length = strcspn(at, ":");
        found = mem_printf("%.*s/%s", (int)length, at, format->runtime);
        if (access(found, X_OK) != 0) {
            mem_free(found);
            found = NULL;
        }
        at += length + (at[length] == ':');
    }
    return found;
}

char *import_format_program(const struct import_format *format)
{
    static const char *const places[] = { "", "../libexec/plantcast/" };
    char own[PATH_MAX] = "", *runtime = import_format_runtime(format);
    bool runs = !format->runtime || runtime;
    mem_free(runtime);
    if (readlink("/proc/self/exe", own, sizeof(own) - 1) <= 0 || !runs)
        return NULL;
    for (size_t i = 0; i < sizeof(places) / sizeof(places[0]); i++) {
        char *path = mem_printf("%.*s%s%s", (int)(strrchr(own, '/') + 1 - own), own, places[i], format->program);
        if (access(path, format->runtime ? R_OK : X_OK) == 0)
            return path;
        mem_free(path);
    }
    return NULL;
}

const char *import_format_missing(const struct import_format *format)
{
    char *runtime = import_format_runtime(format);
    bool runs = !format->runtime || runtime;
    mem_free(runtime);
    return runs ? format->missing : "its reader needs Node.js: install the package nodejs";
}

void import_formats_print(FILE *out)
{
    for (int i = 0; i < FORMATS; i++) {
        char *program = formats[i].reader == FORMAT_PROGRAM ? import_format_program(&formats[i]) : NULL;
        bool there = formats[i].reader != FORMAT_PROGRAM || program;
        fprintf(out, "%-8s %-16s %s%s\n", formats[i].name, formats[i].endings, there ? "yes" : "no: ",
                there ? "" : import_format_missing(&formats[i]));
        mem_free(program);
    }
    fputs("All formats but glTF may be compressed with gzip, such as .stp.gz.\n", out);
}
