/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast verify`: says whether a signed picture is what the server drew, and draws it again. */
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "base/text.h"
#include "base/timestamp.h"
#include "commands.h"
#include "provenance/png_pixels.h"
#include "redraw.h"
#include "signed_film.h"

static const size_t MOST_BYTES = (size_t)256 << 20;

static void print_usage(FILE *out)
{
    fputs("usage: plantcast verify (PICTURE.png | CLIP.mp4) --key FILE [--tour]\n"
          "                        [--plant PLANT.yaml [--prepared FOLDER] [--history FOLDER]]\n"
          "\n"
          "Says whether PICTURE.png, or each picture of CLIP.mp4 (plantcast clip --signed), is what a server with --signing-key drew:\n"
          "pixels, readings, time, view and configuration; of a clip also whether one is missing between the first and the last.\n"
          "  --key FILE          the server's public key: openssl pkey -in signing.key -pubout -out FILE\n"
          "  --tour              the film is one of a tour: its view changes; each is printed, and since when\n"
          "  --plant PLANT.yaml  draw it again from the readings that it tells, and count the pixels that agree within 1/255\n"
          "  --prepared FOLDER   where plantcast-prep put its files; PLANT.prepared beside the plant file\n"
          "  --history FOLDER    compare these readings with what was recorded there\n"
          "Exit status: 0: all of it agrees; 1: something does not; 2: it could not be asked.\n",
          out);
}

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
           json_is_true(json_object_get(statement, "clock_unset")) ? "; nothing kept the server's clock right" : "");
    const char *tier = json_string_value(json_object_get(statement, "tier"));
    const char *overlay = json_string_value(json_object_get(statement, "overlay"));
    if (overlay && tier && !strcmp(overlay, "none"))
        printf("  a frame of a session: %s, without legend, markers and clock\n", tier);
    const json_t *args = json_object_get(statement, "query");
    printf("  view:");
    for (size_t i = 0; i < json_array_size(args); i++)
        printf(" %s", json_string_value(json_array_get(args, i)));
    puts(json_array_size(args) ? "" : " the plant's own");
}

/* statement: verified, so the pixels are there. */
static int redraw(const struct redraw_options *options, const json_t *statement, const char *png, size_t count)
{
    char why[PNG_WHY_BYTES];
    uint8_t *rgb = png_pixels((const uint8_t *)png, count, json_integer_value(json_object_get(statement, "width")),
                              json_integer_value(json_object_get(statement, "height")), why);
    int code = rgb ? redraw_compare(options, statement, rgb) : 2;
    mem_free(rgb);
    return code;
}

static int verify(const char *path, const char *key_path, const struct redraw_options *options, bool tour)
{
    char why[SIGNED_PICTURE_WHY_BYTES];
    size_t count;
    struct signing_key *key = signing_key_load_public(key_path, why);
    char *png = key ? text_read_file(path, MOST_BYTES, &count) : NULL;
    if (!key)
        fprintf(stderr, "plantcast: --key: %s\n", why);
    else if (!png)
        fprintf(stderr, "plantcast: %s: %m\n", path);
    if (png && film_is_one((const uint8_t *)png, count)) {
        int film = film_verify(key, path, options, tour);
        mem_free(png);
        signing_key_destroy(&key);
        return film;
    }
    json_t *statement = png ? signed_picture_verify(key, (const uint8_t *)png, count, why) : NULL;
    int code = !png ? 2 : 0;
    if (statement) {
        print_statement(path, statement);
        code = options->plant ? redraw(options, statement, png, count) : 0;
    } else if (png) {
        fprintf(stderr, "plantcast: %s: %s\n", path, why);
        code = 1;
    }
    json_decref(statement);
    mem_free(png);
    signing_key_destroy(&key);
    return code;
}

int cmd_verify(int argc, char **argv)
{
    static const struct option options[] = { { "key", required_argument, NULL, 'k' },      { "plant", required_argument, NULL, 'p' },
                                             { "prepared", required_argument, NULL, 'd' }, { "history", required_argument, NULL, 'r' },
                                             { "tour", no_argument, NULL, 't' },
                                             { "help", no_argument, NULL, 'h' },           { 0 } };
    struct redraw_options redraw = { 0 };
    const char *key = NULL;
    bool tour = false;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        switch (option) {
        case 'k': key = optarg; break;
        case 'p': redraw.plant = optarg; break;
        case 'd': redraw.prepared = optarg; break;
        case 'r': redraw.history = optarg; break;
        case 't': tour = true; break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    }
    if (argc - optind != 1 || !key || (!redraw.plant && (redraw.prepared || redraw.history))) {
        print_usage(stderr);
        return 2;
    }
    return verify(argv[optind], key, &redraw, tour);
}
