/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast tags URL`: prints a table of tags with value, quality and age; --probe is in tags_probe.c, --browse in tags_browse.c. */
#include <getopt.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>

#include "clients/cli/commands.h"
#include "clients/link/daemon.h"

static void print_usage(FILE *out)
{
    fputs("usage: plantcast tags URL [--json]\n"
          "       plantcast tags --browse opc.tcp://HOST[:PORT][/PATH] [OPTION ...]\n"
          "       plantcast tags --probe DEVICE [--address-base 0|1] ADDRESS\n"
          "\n"
          "Prints the tags that the daemon at URL serves, with value, quality and age.\n"
          "URL is http://HOST:PORT/, or https://HOST:PORT/ with --token-file FILE.\n"
          "\n"
          "  --browse   print the numeric variables of an OPC UA server as a tag list\n"
          "             (see plantcast tags --browse --help)\n"
          "  --probe    read one address of a Modbus device, and print the value in every type and byte order\n"
          "             DEVICE is HOST, HOST:PORT or a serial line /dev/LINE (19200 baud, even parity).\n"
          "             ADDRESS is an address such as hr:0, or 2!400001 for unit 2. Nothing is written to the device\n",
          out);
}

static const char *text_of(const json_t *o, const char *name)
{
    const char *text = json_string_value(json_object_get(o, name));
    return text ? text : "-";
}

static int chars_of(const char *utf8)
{
    int count = 0;
    for (; *utf8; utf8++)
        count += ((unsigned char)*utf8 & 0xc0) != 0x80;
    return count;
}

static void print_cell(const char *text, int width)
{
    printf("%s%*s", text, width > chars_of(text) ? width - chars_of(text) : 0, "");
}

static int widest(const json_t *tags, const char *field)
{
    int width = (int)strlen(field);
    for (size_t i = 0; i < json_array_size(tags); i++) {
        int n = chars_of(text_of(json_array_get(tags, i), field));
        width = n > width ? n : width;
    }
    return width + 2;
}

static void print_tag(const json_t *tag, const int widths[5])
{
    const json_t *value = json_object_get(tag, "value"), *age = json_object_get(tag, "age_ms");
    print_cell(text_of(tag, "name"), widths[0]);
    if (json_is_number(value))
        printf("%14.6g ", json_number_value(value));
    else
        printf("%14s ", "-");
    print_cell(text_of(tag, "unit"), widths[1]);
    print_cell(text_of(tag, "quality_name"), widths[2]);
    if (json_is_integer(age))
        printf("%10.1f s  ", (double)json_integer_value(age) / 1000);
    else
        printf("%10s    ", "never");
    print_cell(text_of(tag, "group"), widths[3]);
    print_cell(text_of(tag, "asset"), widths[4]);
    putchar('\n');
}

static void print_table(const json_t *tags)
{
    static const char *const fields[] = { "name", "unit", "quality_name", "group", "asset" };
    int widths[5];
    for (int i = 0; i < 5; i++)
        widths[i] = widest(tags, fields[i]);
    print_cell("tag", widths[0]);
    printf("%14s ", "value");
    print_cell("unit", widths[1]);
    print_cell("quality", widths[2]);
    printf("%10s    ", "age");
    print_cell("group", widths[3]);
    puts("asset");
    for (size_t i = 0; i < json_array_size(tags); i++)
        print_tag(json_array_get(tags, i), widths);
}

/* Fetches one page of the daemon's tag list, starting with the tag of index `first`. Returns NULL with the reason printed. */
static json_t *fetch_page(const struct daemon_url *url, const char *name, size_t first)
{
    struct text body = { 0 };
    char path[60];
    snprintf(path, sizeof(path), "/api/v1/tags?first=%zu&count=5000", first);
    int status = daemon_get(url, path, &body);
    json_t *page = status == 200 && body.at ? json_loads(body.at, 0, NULL) : NULL;
    if (status && !json_is_array(json_object_get(page, "tags"))) {
        fprintf(stderr, "plantcast: %s: the daemon answered with HTTP status %d: %s\n", name, status, body.at ? body.at : "");
        json_decref(page);
        page = NULL;
    }
    text_finish(&body);
    return page;
}

/* Fetches all pages of the daemon's tag list and joins them. Returns NULL with the reason printed. */
static json_t *fetch_all(const struct daemon_url *url, const char *name)
{
    json_t *all = fetch_page(url, name, 0);
    json_t *tags = json_object_get(all, "tags");
    size_t total = (size_t)json_integer_value(json_object_get(all, "total")), before = 0;
    while (all && json_array_size(tags) < total && json_array_size(tags) > before) {
        before = json_array_size(tags);
        json_t *page = fetch_page(url, name, before);
        if (page)
            json_array_extend(tags, json_object_get(page, "tags"));
        else
            json_decref(all);
        all = page ? all : NULL;
        json_decref(page);
    }
    return all;
}

int cmd_tags(const struct daemon_access *access, int argc, char **argv)
{
    static const struct option options[] = { { "json", no_argument, NULL, 'j' },
                                             { "help", no_argument, NULL, 'h' },
                                             { "probe", required_argument, NULL, 'p' },
                                             { "address-base", required_argument, NULL, 'b' },
                                             { NULL, 0, NULL, 0 } };
    if (argc > 1 && !strcmp(argv[1], "--browse"))
        return tags_browse(argc - 1, argv + 1);
    const char *device = NULL;
    int address_base = -1;
    struct daemon_url url;
    bool as_json = false;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        if (option == 'p')
            device = optarg;
        else if (option == 'b' && (!strcmp(optarg, "0") || !strcmp(optarg, "1")))
            address_base = *optarg - '0';
        else if (option != 'j') {
            print_usage(option == 'h' ? stdout : stderr);
            return option == 'h' ? 0 : 2;
        }
        as_json |= option == 'j';
    }
    if (optind + 1 != argc) {
        print_usage(stderr);
        return 2;
    }
    if (device)
        return tags_probe(device, argv[optind], address_base);
    if (!daemon_url_parse(argv[optind], access, &url))
        return 2;
    json_t *all = fetch_all(&url, argv[optind]);
    if (all && as_json)
        json_dumpf(all, stdout, JSON_COMPACT | JSON_REAL_PRECISION(15));
    else if (all)
        print_table(json_object_get(all, "tags"));
    bool good = all != NULL;
    json_decref(all);
    return good ? 0 : 1;
}
