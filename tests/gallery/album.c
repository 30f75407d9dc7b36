/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws many pictures of one plant but computes its lighting only once. usage: album PLANT.yaml <LIST
   Each line of LIST: a file to write, then the arguments of `plantcast snapshot`, separated by tabs. */
#include <getopt.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/picture/offline_renderer.h"

enum { WORDS = 64, LINE_BYTES = 4096 };

static int split(char *line, char **words)
{
    int count = 0;
    line[strcspn(line, "\n")] = 0;
    for (char *word = strtok(line, "\t"); word && count < WORDS; word = strtok(NULL, "\t"))
        words[count++] = word;
    return count;
}

static bool draw(struct offline_renderer *offline, char *plant, char *line)
{
    char *words[WORDS + 4] = { "album", plant, "-o" };
    struct snapshot_options options;
    struct view view;
    int count = 3 + split(line, words + 3);
    optind = 0; /* makes getopt_long(), which has parsed the previous line, begin again with the first word */
    bool first = !offline->gl, good = snapshot_parse(count, words, false, &options) < 0;
    good = good && (first ? offline_renderer_open(offline, &options, &view) : offline_renderer_reopen(offline, &options, &view)) == 0;
    good = good && (!first || offline_renderer_open_gl(offline, &options));
    struct frame *frame = good ? offline_renderer_draw(offline, &options, &view) : NULL;
    good = frame && offline_renderer_save(offline, frame, options.out);
    printf("gallery: %s%s\n", options.out ? options.out : "?", good ? "" : ": failed");
    fflush(stdout);
    frame_unref(&frame);
    snapshot_options_finish(&options);
    return good;
}

int main(int argc, char **argv)
{
    struct offline_renderer offline = { 0 };
    char line[LINE_BYTES];
    bool good = argc == 2;
    while (good && fgets(line, sizeof(line), stdin))
        good = draw(&offline, argv[1], line);
    offline_renderer_close(&offline);
    return !good;
}
