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
          "Checks the signature that a server with --signing-key wrote into PICTURE.png or CLIP.mp4.\n"
          "A good signature proves that pixels, readings, time, view and configuration are unchanged since signing.\n"
          "CLIP.mp4 is a clip made by `plantcast clip --signed`. A clip with a missing frame is rejected.\n"
          "\n"
          "  --key FILE          public key of the server (openssl pkey -in signing.key -pubout -out FILE)\n"
          "  --tour              accept a clip of a tour, in which the view changes, and print each change\n"
          "  --plant PLANT.yaml  redraw the picture from its readings, and count the pixels that agree within 1/255\n"
          "  --prepared FOLDER   output folder of plantcast-prep (default: PLANT.prepared next to PLANT.yaml;\n"
          "                      for the service plantcastd@NAME: /var/lib/plantcast/NAME/prepared)\n"
          "  --history FOLDER    compare the picture's readings with the recorded readings in FOLDER\n"
          "Exit status: 0 all checks passed, 1 a check failed, 2 a check was not possible.\n",
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
