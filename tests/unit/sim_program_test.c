/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program plantcast-sim, a simulated device, read by the daemon's Modbus source over a real connection: every data type. */
#include "tests/support/test.h"
#include <arpa/inet.h>
#include <errno.h>
#include <modbus.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/files/atomic_file.h"
#include "tests/support/modbus_device.h"
#include "tests/support/ports.h"
#include "tests/support/sleep.h"
#include "value/quality.h"
#include "value/source.h"

static const char plant_text[] = "plant: { name: Test }\n"
                                 "assets: [ { id: V-1, model: none.glb } ]\n"
                                 "groups: [ { id: temperature, unit: °C, min: 0, max: 200 } ]\n"
                                 "sources: [ { id: plc, type: modbus, host: 127.0.0.1, port: %d, poll_ms: 50,\n"
                                 "             timeout_ms: 300, byte_order: CDAB, address_base: 1 } ]\n"
                                 "tags: sim-test.csv\n";
/* Tag list of the test. uint16 has a `Stale s` of one minute, so that its reading stays Uncertain while the device pauses and
   does not become Bad. */
static const char tags_text[] =
    "Tag Name,Address,Data Type,Byte Order,Scaling,Raw Low,Raw High,Scaled Low,Scaled High,Negate Value,Sim Value,Sim Loop,Stale s\n"
    "int16,40001,Short,,,,,,,,-1234,,\n"
    "uint16,40002,Word,BADC,,,,,,,54321,,60\n"
    "int32,40003,Long,ABCD,,,,,,,-123456,,\n"
    "uint32,40005,DWord,CDAB,,,,,,,123456,,\n"
    "float32,40007,Float,,,,,,,,80.25,,\n"
    "int64,40009,LLong,BADC,,,,,,,-5000000000,,\n"
    "uint64,40013,QWord,DCBA,,,,,,,5000000000,,\n"
    "float64,40017,Double,DCBA,,,,,,1,33.125,,\n"
    "bcd,40021,BCD,,,,,,,,1234,,\n"
    "lbcd,40022,LBCD,CDAB,,,,,,,12345678,,\n"
    "linear,30001,Short,,Linear,0,27648,0,200,,63.5,,\n"
    "root,30002,Word,,Square Root,0,65535,0,50,,20,,\n"
    "bit 3,40024.3,Boolean,,,,,,,,1,,\n"
    "bit 4,40024.4,Boolean,,,,,,,,0,,\n"
    "coil,000001,Boolean,,,,,,,1,1,,\n"
    "contact,100001,Boolean,,,,,,,,1,,\n"
    "unit 9,9!40001,Word,,,,,,,,77,,\n";

struct sim_program_setup {
    char *folder, *plant_path;
    int port, control_port, control_fd;
    pid_t pid;
    FILE *out;
    struct plant *plant;
};

static pid_t spawn(char *const arguments[], FILE **out)
{
    int pipes[2];
    const char *folder = getenv("PLANTCAST_BIN");
    char *program = test_printf("%s/plantcast-sim", folder ? folder : "build");
    if (access(program, X_OK) != 0) {
        print_message("# %s is not there\n", program);
        skip();
    }
    assert_int_equal(pipe(pipes), 0);
    pid_t pid = fork();
    if (pid == 0) {
        dup2(pipes[1], STDOUT_FILENO);
        dup2(pipes[1], STDERR_FILENO);
        close(pipes[0]);
        close(pipes[1]);
        execv(program, arguments);
        _exit(127);
    }
    close(pipes[1]);
    *out = fdopen(pipes[0], "r");
    return pid;
}

static int exit_status(struct sim_program_setup *s)
{
    int status = 0;
    assert_int_equal(waitpid(s->pid, &status, 0), s->pid);
    s->pid = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

static void begin(struct sim_program_setup *s)
{
    s->folder = temp_folder();
    s->control_fd = -1;
    s->port = free_port();
    s->control_port = free_port();
    s->plant_path = temp_write_text(s->folder, "sim-test.yaml", test_printf(plant_text, s->port));
    temp_write_text(s->folder, "sim-test.csv", tags_text);
    temp_write_text(s->folder, "none.glb", "glTF"); /* the content does not matter, because the simulator does not open the model */
    struct diag diag = { 0 };
    s->plant = plant_load(s->plant_path, &diag);
    if (!s->plant)
        diag_print(&diag, stderr);
    diag_finish(&diag);
    assert_non_null(s->plant);
}

static void end(struct sim_program_setup *s)
{
    if (s->control_fd >= 0)
        close(s->control_fd);
    if (s->pid > 0) {
        kill(s->pid, SIGKILL);
        waitpid(s->pid, NULL, 0);
    }
    if (s->out)
        fclose(s->out);
    plant_destroy(&s->plant);
}

TEST_FIXTURE(struct sim_program_setup, begin, end)

#define CASE(name) TEST_ON(struct sim_program_setup *s, name, set_up, tear_down)

static void start(struct sim_program_setup *s)
{
    char control[12], line[200], wanted[200];
    snprintf(control, sizeof(control), "%d", s->control_port);
    char *const arguments[] = { "plantcast-sim", s->plant_path, "--control", control, NULL };
    s->pid = spawn(arguments, &s->out);
    snprintf(wanted, sizeof(wanted), "plantcast-sim: listening on 127.0.0.1:%d, 17 tags\n", s->port);
    assert_non_null(fgets(line, sizeof(line), s->out));
    assert_string_equal(line, wanted);
}

static int connect_to(int port)
{
    struct sockaddr_in at = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_int_equal(connect(fd, (struct sockaddr *)&at, sizeof(at)), 0);
    return fd;
}

/* One command, one line back. */
static const char *control(struct sim_program_setup *s, const char *command)
{
    static char reply[300];
    size_t count = 0;
    if (s->control_fd < 0)
        s->control_fd = connect_to(s->control_port);
    struct pollfd readable = { .fd = s->control_fd, .events = POLLIN };
    assert_int_equal(dprintf(s->control_fd, "%s\n", command), (int)strlen(command) + 1);
    while (count == 0 || reply[count - 1] != '\n') {
        assert_int_equal(poll(&readable, 1, 3000), 1);
        ssize_t got = recv(s->control_fd, reply + count, sizeof(reply) - 1 - count, 0);
        assert_true(got > 0);
        count += (size_t)got;
    }
    reply[count - 1] = 0;
    return reply;
}

/* --- the daemon's side ------------------------------------------------------------------------------------------------------ */

struct sim_reader {
    struct store *store;
    struct snapshot *snapshot;
    struct source *source;
};

static void reader_start(struct sim_reader *reader, const struct plant *plant)
{
    reader->store = test_store(plant);
    reader->snapshot = test_snapshot(plant->tag_count);
    reader->source = source_start(test_log(), plant, 0, reader->store, test_counters());
    assert_non_null(reader->source);
}

static void reader_stop(struct sim_reader *reader)
{
    source_stop(&reader->source);
}

static const struct reading *look(struct sim_reader *reader, int tag)
{
    store_snapshot(reader->store, clock_mono_ns(), clock_utc_ns(), reader->snapshot);
    return &reader->snapshot->readings[tag];
}

/* Waits up to 8 s until the tag has this quality and, unless `value` is NAN, this value with a relative error of at most 1e-4.
   */
static void expect(struct sim_reader *reader, const struct plant *plant, const char *name, uint32_t quality, double value)
{
    int64_t end_ns = clock_mono_ns() + 8 * NS_PER_S;
    int tag = plant_find_tag(plant, name);
    assert_true(tag >= 0);
    const struct reading *r = look(reader, tag);
    while ((r->quality != quality || fabs(r->value - value) > 1e-4 * fmax(1, fabs(value))) && clock_mono_ns() < end_ns) {
        sleep_ns(10 * NS_PER_MS);
        r = look(reader, tag);
        if (isnan(value) && r->quality == quality)
            return;
    }
    if (r->quality != quality || (!isnan(value) && fabs(r->value - value) > 1e-4 * fmax(1, fabs(value))))
        fail_msg("%s: %s %.9g, not %s %.9g", name, quality_name(r->quality), r->value, quality_name(quality), value);
}

CASE(every_type_over_the_wire)
{
    struct sim_reader reader;
    start(s);
    reader_start(&reader, s->plant);
    const struct {
        const char *name;
        double value;
    } sets[] = {
        { "int16", -32000 }, { "uint16", 60001 },       { "int32", -2000000001 }, { "uint32", 4000000001.0 }, { "float32", -0.125 },
        { "int64", -1e15 },  { "uint64", 1e15 },        { "float64", 0 },         { "bcd", 9071 },            { "lbcd", 90210345 },
        { "linear", 156.25 }, { "root", 50 },          { "bit 3", 0 },           { "bit 4", 1 },             { "coil", 0 },
        { "contact", 0 },    { "unit 9", 4711 },        { "coil", 1 },            { "contact", 1 },           { "bit 3", 1 },
        { "root", 0 },       { "linear", 0 },           { "float64", 1e-3 },      { "int32", 0 },             { "float32", 1e6 },
    };
    for (size_t i = 0; i < sizeof(sets) / sizeof(sets[0]); i++) {
        assert_string_equal(control(s, test_printf("set %s %.17g", sets[i].name, sets[i].value)), "ok");
        expect(&reader, s->plant, sets[i].name, QUALITY_GOOD, sets[i].value);
    }
    /* other bits of the same register were set meanwhile, which must not change bit 4 */
    expect(&reader, s->plant, "bit 4", QUALITY_GOOD, 1);
    reader_stop(&reader);
}

CASE(process_values_come_near_their_operating_point)
{
    struct sim_reader reader;
    start(s);
    reader_start(&reader, s->plant);
    expect(&reader, s->plant, "float32", QUALITY_GOOD, NAN);
    expect(&reader, s->plant, "linear", QUALITY_GOOD, NAN);
    assert_true(fabs(look(&reader, plant_find_tag(s->plant, "float32"))->value - 80.25) < 8);
    assert_true(fabs(look(&reader, plant_find_tag(s->plant, "linear"))->value - 63.5) < 12);
    reader_stop(&reader);
}

CASE(tests_can_fail_and_pause_it)
{
    struct sim_reader reader;
    start(s);
    reader_start(&reader, s->plant);
    assert_string_equal(control(s, "set float32 42"), "ok");
    expect(&reader, s->plant, "float32", QUALITY_GOOD, 42);
    assert_string_equal(control(s, "set float32 nan"), "ok");
    expect(&reader, s->plant, "float32", QUALITY_BAD_SENSOR_FAILURE, NAN);
    assert_string_equal(control(s, "set linear 260"), "ok");
    expect(&reader, s->plant, "linear", QUALITY_UNCERTAIN_UNITS_EXCEEDED, NAN);
    assert_string_equal(control(s, "fail int32"), "ok");
    expect(&reader, s->plant, "int32", QUALITY_BAD_CONFIGURATION, NAN);
    expect(&reader, s->plant, "uint16", QUALITY_GOOD, NAN); /* same block */
    assert_string_equal(control(s, "set uint16 7"), "ok");
    expect(&reader, s->plant, "uint16", QUALITY_GOOD, 7);
    assert_string_equal(control(s, "pause"), "ok");
    expect(&reader, s->plant, "uint16", QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 7);
    assert_string_equal(control(s, "set uint16 8"), "ok");
    assert_string_equal(control(s, "resume"), "ok");
    expect(&reader, s->plant, "uint16", QUALITY_GOOD, 8);
    reader_stop(&reader);
}

CASE(control_says_what_is_wrong)
{
    start(s);
    assert_string_equal(control(s, "set nobody 1"), "error: unknown tag nobody");
    assert_string_equal(control(s, "set int16 much"), "error: much is not a number");
    assert_string_equal(control(s, "set int16 nan"), "error: tag int16: its data type cannot hold nan");
    assert_string_equal(control(s, "dance"), "error: unknown command dance");
    assert_string_equal(control(s, "set bit 3 0"), "ok"); /* a blank in the name */
    assert_string_equal(control(s, "get bit 3"), "ok 0");
    assert_string_equal(control(s, "release bit 3"), "ok");
    assert_string_equal(control(s, "get bit 3"), "ok 1");
    assert_string_equal(control(s, "quit"), "ok");
    assert_int_equal(exit_status(s), 0);
}

/* --- the device's side ------------------------------------------------------------------------------------------------------ */

CASE(writes_are_refused_and_counted)
{
    const uint16_t words[2] = { 1, 2 };
    const uint8_t bits[2] = { 1, 0 };
    start(s);
    assert_string_equal(control(s, "set int16 5"), "ok");
    modbus_t *modbus = modbus_new_tcp("127.0.0.1", s->port);
    modbus_set_slave(modbus, 1);
    assert_int_equal(modbus_connect(modbus), 0);
    assert_int_equal(modbus_write_register(modbus, 0, 9), -1);
    assert_int_equal(errno, EMBXILFUN);
    assert_int_equal(modbus_write_registers(modbus, 0, 2, words), -1);
    assert_int_equal(errno, EMBXILFUN);
    assert_int_equal(modbus_write_bit(modbus, 0, 1), -1);
    assert_int_equal(errno, EMBXILFUN);
    assert_int_equal(modbus_write_bits(modbus, 0, 2, bits), -1);
    assert_int_equal(errno, EMBXILFUN);
    uint16_t read = 0;
    assert_int_equal(modbus_read_registers(modbus, 0, 1, &read), 1);
    assert_int_equal(read, 5);
    assert_non_null(strstr(control(s, "stats"), "writes_refused=4"));
    modbus_close(modbus);
    modbus_free(modbus);
}

CASE(many_clients_at_once_and_one_talks_nonsense)
{
    enum { CLIENTS = 20 };
    modbus_t *clients[CLIENTS];
    char byte;
    start(s);
    assert_string_equal(control(s, "set int16 5"), "ok");
    int silent = connect_to(s->port), nonsense = connect_to(s->port);
    assert_int_equal(send(silent, "\0\1\0", 3, 0), 3); /* half a request, for ever */
    assert_int_equal(send(nonsense, "GET / HTTP/1.1\r\n\r\n", 18, 0), 18);
    for (int i = 0; i < CLIENTS; i++) {
        clients[i] = modbus_new_tcp("127.0.0.1", s->port);
        modbus_set_slave(clients[i], 1);
        assert_int_equal(modbus_connect(clients[i]), 0);
    }
    for (int round = 0; round < 3; round++)
        for (int i = 0; i < CLIENTS; i++) {
            uint16_t read = 0;
            assert_int_equal(modbus_read_registers(clients[i], 0, 1, &read), 1);
            assert_int_equal(read, 5);
        }
    assert_true(recv(nonsense, &byte, 1, 0) <= 0);
    for (int i = 0; i < CLIENTS; i++) {
        modbus_close(clients[i]);
        modbus_free(clients[i]);
    }
    close(silent);
    close(nonsense);
}

CASE(ends_cleanly_on_signals)
{
    const int signals[] = { SIGTERM, SIGINT };
    for (int i = 0; i < 2; i++) {
        start(s);
        kill(s->pid, signals[i]);
        assert_int_equal(exit_status(s), 0);
        fclose(s->out);
        s->out = NULL;
    }
}

static int run(struct sim_program_setup *s, char *const arguments[], char said[300])
{
    s->pid = spawn(arguments, &s->out);
    size_t count = fread(said, 1, 299, s->out);
    said[count] = 0;
    fclose(s->out);
    s->out = NULL;
    return exit_status(s);
}

CASE(says_what_stops_it)
{
    char said[300], wanted[100];
    assert_int_equal(run(s, (char *[]){ "plantcast-sim", NULL }, said), 2);
    assert_int_equal(run(s, (char *[]){ "plantcast-sim", s->plant_path, "--port", "70000", NULL }, said), 2);
    assert_non_null(strstr(said, "--port 70000: expected a port number"));
    assert_int_equal(run(s, (char *[]){ "plantcast-sim", "/nowhere/plant.yaml", NULL }, said), 1);
    assert_non_null(strstr(said, "/nowhere/plant.yaml"));
    assert_int_equal(run(s, (char *[]){ "plantcast-sim", s->plant_path, "--map", "nobody=a", NULL }, said), 1);
    assert_non_null(strstr(said, "the plant has no tag nobody"));
    start(s);
    pid_t first = s->pid;
    FILE *first_out = s->out;
    assert_int_equal(run(s, (char *[]){ "plantcast-sim", s->plant_path, NULL }, said), 1);
    snprintf(wanted, sizeof(wanted), "cannot listen on 127.0.0.1:%d: Address already in use", s->port);
    assert_non_null(strstr(said, wanted));
    s->pid = first;
    s->out = first_out;
}

/* Simulates plants with real models and recorded series. Skipped if these data files are missing. */
CASE(real_plants_are_served)
{
    const char *const plants[] = { "tests/plants/plant_room.yaml", "tests/plants/cookie_line.yaml" };
    if (access("../shared/data/sensors/tep", R_OK) != 0) {
        print_message("# ../shared/data is not there\n");
        skip();
    }
    for (int i = 0; i < 2; i++) {
        struct diag diag = { 0 };
        struct sim_reader reader;
        char port[12];
        struct plant *plant = plant_load(plants[i], &diag);
        assert_non_null(plant);
        assert_int_equal(diag.errors + diag.warnings, 0);
        plant->sources[0].port = s->port;
        snprintf(port, sizeof(port), "%d", s->port);
        s->pid = spawn((char *[]){ "plantcast-sim", (char *)plants[i], "--port", port, NULL }, &s->out);
        reader_start(&reader, plant);
        for (size_t t = 0; t < plant->tag_count; t++) {
            expect(&reader, plant, plant->tags[t].name, QUALITY_GOOD, NAN);
            int group = plant->tags[t].group;
            double value = look(&reader, (int)t)->value;
            if (group >= 0 && (value < plant->groups[group].min || value > plant->groups[group].max))
                fail_msg("%s: %g is outside of its group", plant->tags[t].name, value);
        }
        reader_stop(&reader);
        kill(s->pid, SIGTERM);
        assert_int_equal(exit_status(s), 0);
        fclose(s->out);
        s->out = NULL;
        plant_destroy(&plant);
        diag_finish(&diag);
    }
}
