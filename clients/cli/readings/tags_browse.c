/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast tags --browse`: prints the variables of an OPC UA server as a draft tag list. It never writes to the server. */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/commands.h"

#ifdef PLANTCAST_OPCUA
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text/text.h"
#include "plant/plant.h"
#include "value/opcua/opcua_browse.h"

static const int64_t CONNECT_NS = 15 * NS_PER_S, BROWSE_NS = 1800 * NS_PER_S;

static void print_usage(FILE *out)
{
    fputs("usage: plantcast tags --browse opc.tcp://HOST[:PORT][/PATH] [--login FILE]\n"
          "                      [--certificate FILE --key FILE --trusted FOLDER [--server-name NAME]]\n"
          "\n"
          "Prints the numeric variables of an OPC UA server as a tag list (CSV); each array element is a row.\n"
          "The options correspond to the keys of an `opcua` source in the plant file (SOURCES.md).\n"
          "Without --certificate the connection is not encrypted. Nothing is written to the server.\n",
          out);
}

static void add_row(struct text *row, const char *name, const char *address, const struct opcua_variable *variable)
{
    text_add_cell(row, name, ",\"\r\n");
    text_add(row, ",");
    text_add_cell(row, address, ",\"\r\n");
    text_add(row, ",%s,", variable->is_bit ? "bool" : "");
    text_add_cell(row, variable->description, ",\"\r\n");
    puts(row->at);
    row->length = 0;
}

static void print_variable(void *arg, const struct opcua_variable *variable)
{
    struct text *row = arg, name = { 0 }, address = { 0 };
    for (size_t i = 0; i < variable->elements || (i == 0 && variable->elements == 0); i++) {
        name.length = address.length = 0;
        text_add(&name, "%s", variable->path);
        if (variable->elements > 0) {
            text_add(&name, "[%zu]", i);
            text_add(&address, "[%zu]", i);
        }
        text_add(&address, "%s", variable->address);
        add_row(row, name.at, address.at, variable);
    }
    text_finish(&name);
    text_finish(&address);
}

/* Parses opc.tcp://HOST:PORT/PATH. host: receives the host name. Returns false for other text. */
static bool read_url(const char *url, struct plant_source *source, char host[256])
{
    static const char SCHEME[] = "opc.tcp://";
    if (strncmp(url, SCHEME, strlen(SCHEME)) != 0)
        return false;
    const char *at = url + strlen(SCHEME), *slash = strchr(at, '/'), *end = slash ? slash : at + strlen(at);
    const char *bracket = *at == '[' ? strchr(at, ']') : NULL, *rest = bracket && bracket < end ? bracket : at;
    const char *colon = memchr(rest, ':', (size_t)(end - rest));
    const char *from = bracket ? at + 1 : at, *to = bracket ? bracket : colon ? colon : end;
    snprintf(host, 256, "%.*s", (int)(to - from), from);
    source->hosts[0] = host;
    source->host_count = 1;
    source->port = colon ? atoi(colon + 1) : 4840;
    source->opcua.path = slash ? (char *)(uintptr_t)slash : NULL;
    return *host && source->port >= 1 && source->port <= 65535;
}

static bool read_options(int argc, char **argv, struct plant_source *source, char host[256], int *code)
{
    static const struct option options[] = { { "certificate", required_argument, NULL, 'c' },
                                             { "key", required_argument, NULL, 'k' },
                                             { "trusted", required_argument, NULL, 't' },
                                             { "server-name", required_argument, NULL, 's' },
                                             { "login", required_argument, NULL, 'l' },
                                             { "help", no_argument, NULL, 'h' },
                                             { NULL, 0, NULL, 0 } };
    bool good = true;
    for (int option; good && (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        char **const to = option == 'c'   ? &source->opcua.certificate
                          : option == 'k' ? &source->opcua.key
                          : option == 't' ? &source->opcua.trusted
                          : option == 's' ? &source->opcua.server_name
                          : option == 'l' ? &source->login
                                          : NULL;
        good = to != NULL;
        if (to)
            *to = optarg;
        *code = option == 'h' ? 0 : 2;
    }
    const struct plant_opcua *opcua = &source->opcua;
    bool is_secure = opcua->certificate && opcua->key && opcua->trusted;
    bool is_open = !opcua->certificate && !opcua->key && !opcua->trusted && !source->login;
    good = good && optind + 1 == argc && (is_secure || is_open) && read_url(argv[optind], source, host);
    source->opcua.policy = is_secure ? OPCUA_BEST : OPCUA_NONE;
    if (!good)
        print_usage(*code == 0 ? stdout : stderr);
    return good;
}

int tags_browse(int argc, char **argv)
{
    struct plant_source source = { .poll_ms = 1000 };
    const struct opcua_nodes nodes = { 0 };
    const struct opcua_events events = { 0 };
    struct text row = { 0 };
    char host[256], why[200] = "";
    int code = 2;
    if (!read_options(argc, argv, &source, host, &code))
        return code;
    /* the OPC UA client stops when this descriptor becomes readable; nothing writes to it, so browsing always runs to its end */
    int stop_fd = eventfd(0, EFD_CLOEXEC);
    struct opcua_client *client = opcua_client_create(&source, 0, &nodes, &events, why);
    int status = client ? opcua_client_connect(client, stop_fd, clock_mono_ns() + CONNECT_NS, why) : -1;
    if (status == 0) {
        puts("Tag Name,Address,Data Type,Description");
        status = opcua_browse(client, print_variable, &row, stop_fd, clock_mono_ns() + BROWSE_NS, why);
    }
    if (status)
        fprintf(stderr, "plantcast: %s:%d: %s\n", host, source.port, why);
    opcua_client_destroy(&client);
    text_finish(&row);
    close(stop_fd);
    return status ? 1 : 0;
}
#else
int tags_browse(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    fputs("plantcast: this program was built without OPC UA\n", stderr);
    return 1;
}
#endif
