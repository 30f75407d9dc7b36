/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions that all readers in C++ use: they reject a file, decode names, write the GLB scene, and contain the main function. Thread:
 * one. */
#ifndef PREPROCESS_IMPORT_READERS_READER_HH
#define PREPROCESS_IMPORT_READERS_READER_HH
#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

extern "C" {
#include "base/mem.h"
#include "preprocess/import/encoding.h"
}
#include "preprocess/glb/glb_scene.h"

constexpr int MAX_DEPTH = 400; /* maximum levels of a model's tree; plantcast-prep reads at most 512 */

/* Stops the reader by throwing an exception with an error message; reader_main() prints it. */
[[noreturn]] inline void refuse(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
inline void refuse(const char *fmt, ...)
{
    char text[300];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    throw std::runtime_error(text);
}

/* Returns a text on one line without tabs, which separate the fields of findings (findings.h). */
inline std::string one_line(std::string text)
{
    std::replace_if(text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
    return text;
}

/* The text encoding of the names in a model file. */
struct text_encoding {
    struct charset_choice choice = { "UTF-8", "", true };

    /* Chooses the encoding from the texts of a file. asked: the encoding that the user stated, "-" for none. said: the encoding that the
     * file states, or "". */
    void choose(const std::string &texts, const char *asked, const char *said)
    {
        choice = encoding_choose(texts.data(), texts.size(), strcmp(asked, "-") != 0 ? asked : nullptr, said);
    }
    /* Returns whether texts need conversion to UTF-8. */
    bool converts() const
    {
        return !choice.ascii && strcmp(choice.name, "UTF-8") != 0;
    }
    std::string utf8(const std::string &text) const
    {
        if (!converts())
            return text;
        char *converted = charset_convert(text.data(), text.size(), choice.name, nullptr);
        std::string out = converted;
        mem_free(converted);
        return out;
    }
    void say() const
    {
        struct text line = {};
        encoding_say(&line, "names", &choice);
        fputs(line.at ? line.at : "", stdout);
        text_finish(&line);
    }
};

/* Returns the content of a file; calls refuse() if it cannot be read. */
inline std::string read_whole(const char *path)
{
    size_t count;
    char *bytes = text_read_file(path, static_cast<size_t>(4) << 30, &count);
    if (!bytes)
        refuse("%s", strerror(errno));
    std::string out(bytes, count);
    mem_free(bytes);
    return out;
}

/* Writes the scene as a GLB file, destroys the scene and sets *scene to NULL. advice: text appended to the error message about a file over
 * 4 GiB, on how to make it smaller; may be "". */
inline void write_scene(struct glb_scene **scene, const char *output, const char *advice)
{
    int status = glb_scene_write(*scene, output);
    glb_scene_destroy(scene);
    if (status == -EFBIG)
        refuse("a GLB file holds at most 4 GiB%s", advice);
    if (status != 0)
        refuse("%s", strerror(-status));
}

/* The main function of a reader. Calls `convert` with the arguments INPUT OUTPUT.glb CHORD_MM UNITS UP ENCODING. Returns the exit status;
 * on failure the last line on stderr is the reason. */
inline int reader_main(int argc, char **argv, const char *name, void (*convert)(char **arguments))
{
    if (argc != 7) {
        fprintf(stderr, "usage: %s INPUT OUTPUT.glb CHORD_MM UNITS UP ENCODING\n", name);
        return 2;
    }
    try {
        convert(argv + 1);
        return 0;
    } catch (const std::bad_alloc &) {
        fprintf(stderr, "out of memory\n");
    } catch (const std::exception &e) {
        fprintf(stderr, "%s\n", e.what());
    } catch (...) {
        fprintf(stderr, "its reader failed\n");
    }
    return 1;
}

#endif
