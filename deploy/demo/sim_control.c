/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The control port: one command a line, answered by one line. For tests and demonstrations. */
#include "sim.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

const char sim_control_help[] =
    "  set TAG VALUE   hold the tag at VALUE, in the tag's Eng Units; nan and inf: floating-point types only\n"
    "  get TAG         print the present value of the tag\n"
    "  fail TAG        answer requests for the tag's registers with Modbus exception 2 (illegal address)\n"
    "  release TAG     end `set` and `fail` for the tag\n"
    "  pause           stop answering requests and publishing values; connections stay open\n"
    "  resume          end `pause`\n"
    "  stats           print the number of reads, the number of refused requests and the present simulated fault\n"
    "  quit            exit plantcast-sim\n"
    "  The answer to each command is one line: `ok`, `ok ...` or `error: ...`.\n";

struct sim_command {
    const char *name, *tag, *value; /* the three parts of the command; "": the part is missing */
};

static void set_tag(struct sim *sim, size_t tag, const char *text, char *reply, size_t bytes)
{
    const struct plant_tag *config = &sim->plant->tags[tag];
    char *end;
    double value = strtod(text, &end);
    int unit;
    struct sim_device *device = sim_device_of(sim, config, &unit);
    if (end == text || *end)
        snprintf(reply, bytes, "error: %s is not a number", text);
    else if (!sim_image_set(&device->modbus.image, unit, config, value))
        snprintf(reply, bytes, "error: tag %s: its data type cannot hold %s", config->name, text);
    else
        sim_values_force(sim->values, tag, value);
}

/* Executes commands for tags published over MQTT, which have no device. */
static void do_with_published(struct sim *sim, const struct sim_command *command, size_t tag, char *reply, size_t bytes)
{
    char *end;
    double value = strtod(command->value, &end);
    if (!strcmp(command->name, "get"))
        snprintf(reply, bytes, "ok %.9g", sim_values_at(sim->values, tag));
    else if (!strcmp(command->name, "release"))
        sim_values_release(sim->values, tag);
    else if (!strcmp(command->name, "fail"))
        snprintf(reply, bytes, "error: tag %s has no Modbus register", command->tag);
    else if (end == command->value || *end)
        snprintf(reply, bytes, "error: %s is not a number", command->value);
    else
        sim_values_force(sim->values, tag, value);
}

static void fail_tag(struct sim *sim, size_t tag, bool failing)
{
    int unit;
    struct sim_device *device = sim_device_of(sim, &sim->plant->tags[tag], &unit);
    sim_image_fail(&device->modbus.image, unit, &sim->plant->tags[tag], failing);
}

static void do_with_tag(struct sim *sim, const struct sim_command *command, char *reply, size_t bytes)
{
    int tag = plant_find_tag(sim->plant, command->tag), unit;
    if (tag >= 0 && sim->mqtt && sim_mqtt_has(sim->plant, (size_t)tag)) {
        do_with_published(sim, command, (size_t)tag, reply, bytes);
    } else if (tag < 0 || !sim_device_of(sim, &sim->plant->tags[tag], &unit)) {
        snprintf(reply, bytes, "error: unknown tag %s", command->tag);
    } else if (!strcmp(command->name, "set")) {
        set_tag(sim, (size_t)tag, command->value, reply, bytes);
    } else if (!strcmp(command->name, "get")) {
        snprintf(reply, bytes, "ok %.9g", sim_values_at(sim->values, (size_t)tag));
    } else if (!strcmp(command->name, "fail")) {
        fail_tag(sim, (size_t)tag, true);
    } else {
        fail_tag(sim, (size_t)tag, false);
        sim_values_release(sim->values, (size_t)tag);
        sim_update(sim);
    }
}

static void pause_all(struct sim *sim, bool paused)
{
    for (size_t i = 0; i < sim->device_count; i++)
        sim->devices[i].modbus.paused = paused;
    sim->mqtt_paused = paused;
}

static void say_stats(const struct sim *sim, char *reply, size_t bytes)
{
    long reads = 0, refusals = 0, writes = 0;
    const char *upset;
    double reached = sim_values_upset(sim->values, &upset);
    for (size_t i = 0; i < sim->device_count; i++) {
        reads += sim->devices[i].modbus.reads;
        refusals += sim->devices[i].modbus.refusals;
        writes += sim->devices[i].modbus.writes_refused;
    }
    snprintf(reply, bytes, "ok reads=%ld refusals=%ld writes_refused=%ld upset=\"%s\" %.2f", reads, refusals, writes, upset, reached);
}

static bool takes_tag(const char *name)
{
    return !strcmp(name, "set") || !strcmp(name, "get") || !strcmp(name, "fail") || !strcmp(name, "release");
}

static void execute(struct sim *sim, const struct sim_command *command, char *reply, size_t bytes)
{
    snprintf(reply, bytes, "ok");
    if (takes_tag(command->name))
        do_with_tag(sim, command, reply, bytes);
    else if (!strcmp(command->name, "pause") || !strcmp(command->name, "resume"))
        pause_all(sim, command->name[0] == 'p');
    else if (!strcmp(command->name, "stats"))
        say_stats(sim, reply, bytes);
    else if (!strcmp(command->name, "quit"))
        sim->quit = true;
    else
        snprintf(reply, bytes, "error: unknown command %s", command->name);
}

/* Splits a line into command, tag and value. The value is the last word, so that a tag's name may contain spaces. */
static struct sim_command parse(char *line)
{
    struct sim_command command = { "", "", "" };
    size_t length = strlen(line);
    while (length && isspace((unsigned char)line[length - 1]))
        line[--length] = 0;
    command.name = strsep(&line, " ");
    if (!line)
        return command;
    command.tag = line;
    char *blank = strrchr(line, ' ');
    if (!strcmp(command.name, "set") && blank) {
        *blank = 0;
        command.value = blank + 1;
    }
    return command;
}

ssize_t sim_control_take(void *arg, int fd, const uint8_t *bytes, size_t count)
{
    char line[SIM_PORT_BYTES], reply[SIM_PORT_BYTES + 100];
    const uint8_t *end = memchr(bytes, '\n', count);
    if (!end)
        return 0;
    size_t length = (size_t)(end - bytes);
    memcpy(line, bytes, length);
    line[length] = 0;
    struct sim_command command = parse(line);
    execute(arg, &command, reply, sizeof(reply) - 1);
    strcat(reply, "\n");
    if (send(fd, reply, strlen(reply), MSG_NOSIGNAL) < 0)
        return -1;
    return (ssize_t)length + 1;
}
