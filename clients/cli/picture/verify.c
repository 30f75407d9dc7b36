/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast verify`: checks with the server's public key that a signed picture is as the server drew it, and can redraw it. */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/timestamp.h"
#include "clients/cli/commands.h"
#include "provenance/png_pixels.h"
#include "verify.h"

static const size_t MAX_BYTES = (size_t)256 << 20;

static void print_statement(const char *path, const json_t *statement)
{
    char taken[TIMESTAMP_BYTES], at[TIMESTAMP_BYTES];
    int64_t at_us = json_integer_value(json_object_get(statement, "at_us"));
    timestamp_print(json_integer_value(json_object_get(statement, "taken_ns")) / 1000, taken);
    timestamp_print(at_us, at);
    printf("%s: the signature is good\n", path);
    printf("  plant %s, configuration %s, plantcastd %s\n", json_string_value(json_object_get(statement, "plant")),
           json_string_value(json_object_get(statement, "configuration")), json_string_value(json_object_get(statement, "server")));
    printf("  readings of %s%s%s\n", at_us ? at : taken, at_us ? " (history)" : "",
           json_is_true(json_object_get(statement, "clock_unset")) ? "; the server's clock was not synchronised, so this time may be wrong"
                                                                   : "");
    const char *tier = json_string_value(json_object_get(statement, "tier"));
    const char *overlay = json_string_value(json_object_get(statement, "overlay"));
    if (overlay && tier && !strcmp(overlay, "none"))
        printf("  frame of a live session, quality %s, without legend, markers and clock\n", tier);
    const json_t *args = json_object_get(statement, "query");
    printf("  view:");
    for (size_t i = 0; i < json_array_size(args); i++)
        printf(" %s", json_string_value(json_array_get(args, i)));
    puts(json_array_size(args) ? "" : " the plant's own");
}

/* Redraws a picture from its signed statement and compares the two. The signature was already verified, so the picture's size
   and pixels can be trusted. Returns the exit code. */
static int redraw(const struct redraw_options *options, const json_t *statement, const char *png, size_t count)
{
    char why[PNG_WHY_BYTES];
    uint8_t *rgb = png_pixels((const uint8_t *)png, count, json_integer_value(json_object_get(statement, "width")),
                              json_integer_value(json_object_get(statement, "height")), why);
    int code = rgb ? redraw_compare(options, statement, rgb) : 2;
    mem_free(rgb);
    return code;
}

static int verify(const struct verify_options *options)
{
    char why[SIGNED_PICTURE_WHY_BYTES];
    size_t count;
    struct signing_key *key = signing_key_load_public(options->key, why);
    char *png = key ? text_read_file(options->path, MAX_BYTES, &count) : NULL;
    if (!key)
        fprintf(stderr, "plantcast: --key: %s\n", why);
    else if (!png)
        fprintf(stderr, "plantcast: %s: %m\n", options->path);
    json_t *statement = png ? signed_picture_verify(key, (const uint8_t *)png, count, why) : NULL;
    int code = !png ? 2 : 0;
    if (statement) {
        print_statement(options->path, statement);
        code = options->redraw.plant ? redraw(&options->redraw, statement, png, count) : 0;
    } else if (png) {
        fprintf(stderr, "plantcast: %s: %s\n", options->path, why);
        code = 1;
    }
    json_decref(statement);
    mem_free(png);
    signing_key_destroy(&key);
    return code;
}

/* Returns true if the file's first bytes are those of a film. */
static bool is_film(const char *path)
{
    char head[8] = "";
    FILE *file = fopen(path, "rb");
    bool film = file && fread(head, sizeof(head), 1, file) == 1 && !memcmp(head + 4, "ftyp", 4);
    if (file)
        fclose(file);
    return film;
}

int cmd_verify(int argc, char **argv)
{
    struct verify_options options;
    int code = verify_parse(argc, argv, &options);
    if (code >= 0)
        return code;
    if (!is_film(options.path))
        return verify(&options);
    run_film(NULL, argc, argv);
    return 2;
}
