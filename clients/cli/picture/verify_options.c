/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of `plantcast verify`. */
#include <getopt.h>
#include <stdio.h>

#include "verify.h"

static void print_usage(FILE *out)
{
    fputs("usage: plantcast verify (PICTURE.png | CLIP.mp4) --key FILE [--tour]\n"
          "                        [--plant PLANT.yaml [--prepared FOLDER] [--history FOLDER]]\n"
          "\n"
          "Checks that a server with --signing-key drew PICTURE.png or every picture of CLIP.mp4, and that\n"
          "nobody changed pixels, readings, time, view or configuration since.\n"
          "CLIP.mp4 is a film of `plantcast clip --signed`. A film with a missing picture is rejected.\n"
          "\n"
          "  --key FILE          public key of the server, made by openssl pkey -in signing.key -pubout -out\n"
          "                      FILE\n"
          "  --tour              the film is a tour: allow its view to change, and print each change\n"
          "  --plant PLANT.yaml  draw the picture again from its readings, and count the pixels that agree\n"
          "                      within 1/255\n"
          "  --prepared FOLDER   output folder of plantcast-prep (default: PLANT.prepared next to PLANT.yaml)\n"
          "  --history FOLDER    folder of recorded readings with which the readings of the picture are\n"
          "                      compared\n"
          "Exit status: 0 everything agrees, 1 something differs, 2 the check was not possible.\n",
          out);
}

int verify_parse(int argc, char **argv, struct verify_options *out)
{
    static const struct option options[] = { { "key", required_argument, NULL, 'k' },      { "plant", required_argument, NULL, 'p' },
                                             { "prepared", required_argument, NULL, 'd' }, { "history", required_argument, NULL, 'r' },
                                             { "tour", no_argument, NULL, 't' },           { "help", no_argument, NULL, 'h' },
                                             { 0 } };
    *out = (struct verify_options){ 0 };
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        switch (option) {
        case 'k': out->key = optarg; break;
        case 'p': out->redraw.plant = optarg; break;
        case 'd': out->redraw.prepared = optarg; break;
        case 'r': out->redraw.history = optarg; break;
        case 't': out->tour = true; break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    }
    if (argc - optind != 1 || !out->key || (!out->redraw.plant && (out->redraw.prepared || out->redraw.history))) {
        print_usage(stderr);
        return 2;
    }
    out->path = argv[optind];
    return -1;
}
