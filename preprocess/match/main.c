/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-match`: matches tags of a control system to equipment of a model. `plantcast match` runs this program. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"
#include "base/system/standard_output.h"
#include "base/text/charset.h"
#include "plant/sources/address.h"
#include "preprocess/match/matching.h"

static void print_usage(FILE *out)
{
    fputs("usage: plantcast match PLANT TAGS [OPTION ...]\n"
          "\n"
          "Finds the equipment to which each tag of a control system's tag list belongs, in an imported plant.\n"
          "Writes tags.csv, matches.csv (each match with its reason) and the sensor groups of plant.yaml.\n"
          "Entries in these files that were edited by hand are kept.\n"
          "A file match_rules.csv (Tag,Equipment) in the plant's folder contains patterns, applied in their order.\n"
          "A file aliases.csv (Alias,Equipment) in the plant's folder lists other names of equipment.\n"
          "\n"
          "  PLANT                 folder of the plant, or its plant.yaml\n"
          "  TAGS                  tag list: CSV, .xlsx, or an export of Kepware, Ignition, AVEVA, Emerson, Honeywell\n"
          "  --equipment NODES     model nodes to use as assets; may be repeated. NODES is level=N (all nodes at\n"
          "                        level N of the hierarchy), a pattern for node names, or @FILE (a file with\n"
          "                        one node name per line)\n"
          "  --encoding NAME       character encoding of TAGS, such as GB18030 or Windows-1251 (default: detected)\n"
          "  --decide FILE         CSV file (Tag,Status,Asset) of decisions, which have the effect of edits in matches.csv\n"
          "  --source ID           source in plant.yaml (connection to field devices) that provides these tags\n"
          "  --modbus HOST[:PORT]  create source ID as a Modbus device at HOST, or change that source's address\n"
          "  --unit N              Modbus unit identifier for the source, 0 to 255\n"
          "  --byte-order ORDER    byte order of values that span several registers: ABCD, CDAB, BADC or DCBA\n"
          "  --address-base N      address that TAGS uses for the source's first register, 0 or 1 (default: 1)\n"
          "  --timeout S           maximum time in seconds for matching (default: 120)\n"
          "  --memory MB           maximum memory in MB for matching (default: 2048)\n"
          "  --dry-run             print the changes, and write nothing\n"
          "Exit status: 0 success, 1 input cannot be read or the result would be invalid (nothing is written), 2 wrong usage.\n",
          out);
}

enum { EQUIPMENT_MOST = 100 };

/* Parses the numeric argument of a command-line option. Returns false after printing an error if it is not a number between least and
 * most. */
static bool take_number(const char *option, const char *range, long least, long most, long *number)
{
    char *end;
    *number = strtol(optarg, &end, 10);
    bool good = end != optarg && !*end && *number >= least && *number <= most;
    if (!good)
        fprintf(stderr, "plantcast match: --%s %s: %s\n", option, optarg, range);
    return good;
}

int main(int argc, char **argv)
{
    enum { ENCODING = 1, SOURCE, MODBUS, UNIT, ORDER, BASE, EQUIPMENT, DECIDE, LENT, TIMEOUT, MEMORY, DRY, HELP };
    static const struct option options[] = { { "encoding", required_argument, NULL, ENCODING },
                                             { "source", required_argument, NULL, SOURCE },
                                             { "modbus", required_argument, NULL, MODBUS },
                                             { "unit", required_argument, NULL, UNIT },
                                             { "byte-order", required_argument, NULL, ORDER },
                                             { "address-base", required_argument, NULL, BASE },
                                             { "equipment", required_argument, NULL, EQUIPMENT },
                                             { "decide", required_argument, NULL, DECIDE },
                                             { "folder-lent", required_argument, NULL, LENT },
                                             { "timeout", required_argument, NULL, TIMEOUT },
                                             { "memory", required_argument, NULL, MEMORY },
                                             { "dry-run", no_argument, NULL, DRY },
                                             { "help", no_argument, NULL, HELP },
                                             { 0 } };
    const char *equipment[EQUIPMENT_MOST];
    struct matching_params params = {
        .unit = -1, .address_base = 1, .equipment = equipment, .timeout_s = 120, .memory_bytes = (size_t)2048 << 20
    };
    enum byte_order order;
    long number;
    char encoding[CHARSET_NAME_BYTES];
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;)
        switch (option) {
        case ENCODING:
            params.encoding = encoding;
            if (!charset_resolve(optarg, encoding)) {
                fprintf(stderr, "plantcast match: --encoding %s: unknown encoding: iconv --list prints the known names\n", optarg);
                return 2;
            }
            break;
        case SOURCE: params.source = optarg; break;
        case MODBUS: params.modbus = optarg; break;
        case UNIT:
            if (!take_number("unit", "0 to 255", 0, 255, &number))
                return 2;
            params.unit = (int)number;
            break;
        case ORDER:
            params.byte_order = optarg;
            if (!byte_order_parse(optarg, &order)) {
                fprintf(stderr, "plantcast match: --byte-order %s: expected ABCD, CDAB, BADC or DCBA\n", optarg);
                return 2;
            }
            break;
        case BASE:
            params.address_base = !strcmp(optarg, "1");
            if (!params.address_base && strcmp(optarg, "0") != 0) {
                fprintf(stderr, "plantcast match: --address-base %s: expected 0 or 1\n", optarg);
                return 2;
            }
            break;
        case EQUIPMENT:
            if (params.equipment_count == EQUIPMENT_MOST) {
                fprintf(stderr, "plantcast match: --equipment: given more than %d times: put the names into a file and use --equipment "
                                "@FILE\n",
                        EQUIPMENT_MOST);
                return 2;
            }
            equipment[params.equipment_count++] = optarg;
            break;
        case DECIDE: params.decisions = optarg; break;
        case LENT: params.lent = atoi(optarg); break;
        case TIMEOUT:
            if (!take_number("timeout", "1 to 86400 (s)", 1, 86400, &number))
                return 2;
            params.timeout_s = (int)number;
            break;
        case MEMORY:
            if (!take_number("memory", "64 to 1000000 (MB)", 64, 1000000, &number))
                return 2;
            params.memory_bytes = (size_t)number << 20;
            break;
        case DRY: params.dry_run = true; break;
        case HELP: print_usage(stdout); return standard_output_end("plantcast match", 0);
        default: print_usage(stderr); return 2;
        }
    if (argc - optind != 2) {
        print_usage(stderr);
        return 2;
    }
    struct stat st;
    bool folder = stat(argv[optind], &st) == 0 && S_ISDIR(st.st_mode);
    char *plant = folder ? mem_printf("%s/plant.yaml", argv[optind]) : mem_strdup(argv[optind]);
    params.plant = plant;
    params.tags = argv[optind + 1];
    int status = matching_run(&params);
    mem_free(plant);
    return standard_output_end("plantcast match", status);
}
