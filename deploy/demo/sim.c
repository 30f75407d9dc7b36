/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plantcast-sim: simulates the devices of a plant as Modbus TCP servers, and MQTT publishers, fed by a simulated process or by recorded
   series. */
#include "sim.h"

#include <arpa/inet.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/mem.h"
#include "base/text/timestamp.h"
#include "sim_process.h"

enum { TICK_MS = 100, EXIT_USAGE = 2, MAX_SPEED = 10000 };

static const char usage_text[] =
    "usage: plantcast-sim PLANT.yaml [OPTION ...]\n"
    "\n"
    "Simulates the field devices of a plant: serves all registers of its Modbus sources, read-only.\n"
    "\n"
    "  --port N         TCP port of the first simulated device; further devices get the next ports\n"
    "                   (default: the port of the first source in the plant file)\n"
    "  --bind ADDRESS   IPv4 address of this machine to listen on (default: 127.0.0.1)\n"
    "  --values FILE    CSV file of recorded tag values to replay; may be repeated. FILE has one of three formats:\n"
    "                   wide: a header line, a time column and one column for each series. The time column's name ends\n"
    "                   in _ms, _s, _min or _h, or its times look like 2026-11-20T10:00:00Z (without a zone:\n"
    "                   in the time zone of the plant).\n"
    "                   tag table: a header line Tag,Time,Value, then one value per line.\n"
    "                   entity table: no header line, one value per line: TIME,TYPE,ENTITY,PROPERTY,VALUE, with TIME in ms\n"
    "  --map TAG=SERIES[*SCALE[+OFFSET]]\n"
    "                   let TAG replay SERIES: the name of a column, or ENTITY/PROPERTY in an entity table;\n"
    "                   may be repeated\n"
    "  --speed X        run the simulation X times as fast as real time (default: 1)\n"
    "  --loop           repeat each recorded series from its start (default: keep the last value of the series)\n"
    "  --mqtt HOST:PORT publish the tags of MQTT sources to this broker, as numbers or JSON\n"
    "                   Use a separate broker: subscribers cannot tell simulated values from measured values\n"
    "  --control PORT   accept the commands below on this TCP port of 127.0.0.1\n"
    "  --help           print this text\n"
    "\n"
    "A tag without a recorded series varies around the value in column `Sim Value` of the tag list\n"
    "(default: 40 % of the tag's range). Column `Sim Loop` names the part of the process where the tag is,\n"
    "and so decides which faults change the tag.\n"
    "PLANT.map next to PLANT.yaml may contain options, one per line: TAG=SERIES (as for --map),\n"
    "`values FILE`, `speed X`, `loop`; # begins a comment.\n"
    "Simulated faults (upsets) occur one after another. Each fault changes these tags:\n";

struct sim_options {
    const char *plant, *bind, *broker;
    int port, control;
    double speed;
    bool loop;
    struct sim_map map;
};

/* --- arguments -------------------------------------------------------------------------------------------------------------- */

static void print_help(void)
{
    printf("%s%s\nCommands on the control port:\n%s", usage_text, process_upset_help(), sim_control_help);
}

static bool read_port(const char *name, const char *text, int *out)
{
    char *end;
    long port = strtol(text, &end, 10);
    *out = (int)port;
    if (end != text && !*end && port >= 1 && port <= 65535)
        return true;
    fprintf(stderr, "plantcast-sim: --%s %s: expected a port number, 1 to 65535\n", name, text);
    return false;
}

static bool read_speed(const char *text, double *out)
{
    char *end;
    *out = strtod(text, &end);
    if (end != text && !*end && isfinite(*out) && *out > 0 && *out <= MAX_SPEED)
        return true;
    fprintf(stderr, "plantcast-sim: --speed %s: expected a number above 0, at most %d\n", text, MAX_SPEED);
    return false;
}

static bool take_option(struct sim_options *options, int option, const char *text, struct diag *diag)
{
    struct in_addr address;
    switch (option) {
    case 'p': return read_port("port", text, &options->port);
    case 'c': return read_port("control", text, &options->control);
    case 's': return read_speed(text, &options->speed);
    case 'b':
        options->bind = text;
        if (inet_pton(AF_INET, text, &address) == 1)
            return true;
        fprintf(stderr, "plantcast-sim: --bind %s: expected an IPv4 address\n", text);
        return false;
    case 'v': sim_map_add_file(&options->map, text); return true;
    case 'm': sim_map_add(&options->map, text, "--map", 0, diag); return true;
    case 'l': options->loop = true; return true;
    case 'q': options->broker = text; return true;
    default: return false;
    }
}

/* Reads the command line. Returns EXIT_SUCCESS to continue; EXIT_USAGE after an error message; -1 if only help was wanted. */
static int read_options(struct sim_options *options, int argc, char **argv)
{
    static const struct option known[] = {
        { "port", required_argument, NULL, 'p' },     { "bind", required_argument, NULL, 'b' },
        { "values", required_argument, NULL, 'v' },   { "map", required_argument, NULL, 'm' },
        { "speed", required_argument, NULL, 's' },    { "loop", no_argument, NULL, 'l' },
        { "control", required_argument, NULL, 'c' },  { "mqtt", required_argument, NULL, 'q' },
        { "help", no_argument, NULL, 'h' },           { 0 },
    };
    struct diag diag = { 0 };
    int option, status = EXIT_SUCCESS;
    while (status == EXIT_SUCCESS && (option = getopt_long(argc, argv, "", known, NULL)) >= 0)
        if (option == 'h')
            status = -1;
        else if (!take_option(options, option, optarg, &diag))
            status = EXIT_USAGE;
    if (status == EXIT_SUCCESS && (optind != argc - 1 || diag.errors)) {
        if (!diag.errors)
            fprintf(stderr, "plantcast-sim: expected one plant file\n");
        status = EXIT_USAGE;
    }
    diag_print(&diag, stderr);
    diag_finish(&diag);
    if (status == EXIT_USAGE)
        fprintf(stderr, "see plantcast-sim --help\n");
    options->plant = optind < argc ? argv[optind] : NULL;
    return status;
}

/* Reads the map file PLANT.map (which recorded series belongs to which tag) next to PLANT.yaml, if there is one. */
static void read_map_file(struct sim_options *options, struct diag *diag)
{
    const char *dot = strrchr(options->plant, '.'), *slash = strrchr(options->plant, '/');
    int stem = dot && (!slash || dot > slash) ? (int)(dot - options->plant) : (int)strlen(options->plant);
    char *path = mem_printf("%.*s.map", stem, options->plant);
    if (access(path, R_OK) == 0)
        sim_map_read(&options->map, path, diag);
    mem_free(path);
}

/* --- running ---------------------------------------------------------------------------------------------------------------- */

static bool open_port(struct sim_port *port, const char *address, int number, sim_take *take, void *arg)
{
    int status = sim_port_open(port, address, number, take, arg);
    if (status)
        fprintf(stderr, "plantcast-sim: cannot listen on %s:%d: %s%s\n", address, number, strerror(-status),
                status == -EADDRINUSE ? "; stop any other plantcast-sim, or give the source another port" : "");
    return status == 0;
}

static int stop_fd = -1; /* eventfd; readable when the program must end; global, because a signal handler gets no argument */

static void on_signal(int number)
{
    int cause = errno;
    (void)number;
    (void)!write(stop_fd, &(uint64_t){ 1 }, sizeof(uint64_t));
    errno = cause;
}

/* Installs a signal handler. A blocked signal mask with a signalfd would not suffice, because threads that libraries start before main() do
   not have our mask. */
static bool await_signals(void)
{
    struct sigaction action = { .sa_handler = on_signal, .sa_flags = SA_RESTART };
    stop_fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    sigemptyset(&action.sa_mask);
    return stop_fd >= 0 && sigaction(SIGINT, &action, NULL) == 0 && sigaction(SIGTERM, &action, NULL) == 0;
}

static void serve(struct sim *sim, struct sim_port *ports, size_t count, double speed)
{
    int64_t last_ns = clock_mono_ns();
    while (!sim->quit && !sim_ports_serve(ports, count, stop_fd, TICK_MS)) {
        int64_t now_ns = clock_mono_ns();
        sim_values_step(sim->values, (double)(now_ns - last_ns) / 1e9 * speed);
        sim_update(sim);
        if (sim->mqtt && !sim->mqtt_paused)
            sim_mqtt_step(sim->mqtt, sim->values, now_ns, clock_utc_ns());
        last_ns = now_ns;
    }
}

static bool listen_and_serve(struct sim *sim, const struct sim_options *options)
{
    size_t count = sim->device_count + (options->control > 0), open = 0;
    struct sim_port *ports = mem_array(count, sizeof(*ports));
    double speed = options->speed > 0 ? options->speed : options->map.speed > 0 ? fmin(options->map.speed, MAX_SPEED) : 1;
    bool good = await_signals();
    for (; good && open < sim->device_count; open += good)
        good = open_port(&ports[open], options->bind, sim->devices[open].listen_port, sim_modbus_take, &sim->devices[open].modbus);
    if (good && options->control > 0) {
        good = open_port(&ports[open], "127.0.0.1", options->control, sim_control_take, sim);
        open += good;
    }
    for (size_t i = 0; good && i < sim->device_count; i++)
        printf("plantcast-sim: listening on %s:%d, %zu tags\n", options->bind, sim->devices[i].listen_port, sim->devices[i].tag_count);
    if (good && sim->mqtt)
        printf("plantcast-sim: publishing %zu tags to %s\n", sim_mqtt_tag_count(sim->mqtt), options->broker);
    fflush(stdout);
    if (good)
        serve(sim, ports, count, speed);
    while (open)
        sim_port_close(&ports[--open]);
    mem_free(ports);
    return good;
}

static int run_sim(struct sim_options *options)
{
    struct diag diag = { 0 };
    struct sim sim = { 0 };
    struct sim_values *values = NULL;
    bool good = false;
    struct plant *plant = plant_load(options->plant, &diag);
    if (plant) {
        timestamp_use_zone(plant->time_zone); /* recorded series have times in the plant's time zone */
        read_map_file(options, &diag);
        values = sim_values_create(plant, &options->map, options->loop || options->map.loop, &diag);
    }
    if (diag.errors)
        diag_print(&diag, stderr);
    if (values && sim_init(&sim, plant, values, options->port, options->broker))
        good = listen_and_serve(&sim, options);
    sim_finish(&sim);
    sim_values_destroy(&values);
    plant_destroy(&plant);
    diag_finish(&diag);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    struct sim_options options = { .bind = "127.0.0.1" };
    int status = read_options(&options, argc, argv);
    if (status == -1)
        print_help();
    else if (status == EXIT_SUCCESS)
        status = run_sim(&options);
    sim_map_finish(&options.map);
    return status > 0 ? status : EXIT_SUCCESS;
}
