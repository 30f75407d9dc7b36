/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modbus interoperability: our source reads from pymodbus, and mbpoll reads from our simulator. Also checks that our programs
   contain no Modbus function that writes. */
#include "tests/support/test.h"
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/text/text.h"
#include "tests/support/modbus_case.h"
#include "tests/support/plant_by_hand.h"
#include "tests/support/ports.h"
#include "tests/support/sleep.h"
#include "value/quality.h"

static char *program(const char *name)
{
    const char *folder = getenv("PLANTCAST_BIN");
    char *path = test_printf("%s/%s", folder ? folder : "build", name);
    if (access(path, X_OK) == 0)
        return path;
    print_message("# %s is not there\n", path);
    skip();
    return NULL;
}

static pid_t spawn(const char *path, char *const arguments[])
{
    pid_t pid = fork();
    if (pid == 0) {
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
            _exit(126);
        execv(path, arguments);
        _exit(127);
    }
    return pid;
}

static void end(pid_t pid)
{
    kill(pid, SIGTERM);
    waitpid(pid, NULL, 0);
}

/* Returns the output of a command; the caller frees it (mem_free). */
static char *output_of(const char *command, int *status)
{
    struct text text = { 0 };
    char bytes[4096];
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    for (size_t n; (n = fread(bytes, 1, sizeof(bytes), pipe)) > 0;)
        text_add_bytes(&text, bytes, n);
    *status = pclose(pipe);
    text_add(&text, "%s", "");
    return text.at;
}

static bool has_python_modbus(void)
{
    int status;
    mem_free(output_of("/usr/bin/python3 -c 'import pymodbus.server' 2>&1", &status));
    if (status)
        print_message("# python3-pymodbus is not installed\n");
    return status == 0;
}

static void read_pymodbus(struct modbus_case *s, const char *framer)
{
    char port[16];
    if (!has_python_modbus())
        skip();
    modbus_case_add_registers(s, 200);
    plant_by_hand_tag(s->plant, "input", TABLE_INPUT, 7, DATA_UINT16);
    plant_by_hand_tag(s->plant, "coil", TABLE_COIL, 3, DATA_BIT);
    plant_by_hand_tag(s->plant, "contact", TABLE_DISCRETE, 4, DATA_BIT);
    plant_by_hand_tag(s->plant, "wide", TABLE_HOLDING, 300, DATA_UINT32);
    plant_by_hand_tag(s->plant, "beyond its end", TABLE_HOLDING, 1000, DATA_UINT16);
    s->plant->sources[0].transport = !strcmp(framer, "rtu") ? TRANSPORT_RTU_TCP : TRANSPORT_TCP;
    snprintf(port, sizeof(port), "%d", s->device.port);
    pid_t pid = spawn("/usr/bin/python3", (char *[]){ "python3", "tests/support/pymodbus_server.py", port, (char *)framer, NULL });
    modbus_case_start(s);
    const double wanted[] = { 0, 199, 10007, 1, 1, 300 * 65536.0 + 301 };
    for (int i = 0; i < 6; i++) {
        int tag = i == 0 ? 0 : 198 + i;
        modbus_case_expect(s, tag, QUALITY_GOOD, 60); /* Python starts slowly on a busy machine */
        assert_true(modbus_case_look(s, tag)->value == wanted[i]);
    }
    modbus_case_expect(s, 204, QUALITY_BAD_CONFIGURATION, 5);
    end(pid);
    modbus_case_expect(s, 199, QUALITY_UNCERTAIN_NO_COMMUNICATION_LAST_USABLE, 5);
}

TEST_WITH(pymodbus_is_read, modbus_case_set_up, modbus_case_tear_down)
{
    read_pymodbus(*state, "tcp");
}

TEST_WITH(pymodbus_is_read_in_rtu_over_tcp, modbus_case_set_up, modbus_case_tear_down)
{
    read_pymodbus(*state, "rtu");
}

/* Starts plantcast-sim with constant values for another program to read. Returns its process id. */
static pid_t simulate(const char *folder, int port)
{
    static const char yaml[] = "plant: { name: P }\n"
                               "assets: [ { id: A, model: m.glb } ]\n"
                               "groups: [ { id: g, unit: K, min: 0, max: 1 } ]\n"
                               "sources: [ { id: plc, type: modbus, host: h, address_base: 1, byte_order: CDAB } ]\n"
                               "tags: tags.csv\n";
    char number[16], *paths[] = {
        temp_write_text(folder, "m.glb", "glTF"),
        temp_write_text(folder, "tags.csv",
                        "Tag Name,Address,Data Type\nw,400001,Word\nf,400003,Float\ni,300001,Short\nc,000001,Boolean\n"),
        temp_write_text(folder, "still.csv", "t_s,w,f,i,c\n0,1234,-118.625,-2,1\n"),
        temp_write_text(folder, "p.map", "values still.csv\nw=w\nf=f\ni=i\nc=c\n"),
        temp_write_text(folder, "p.yaml", yaml),
    };
    char *path = program("plantcast-sim");
    snprintf(number, sizeof(number), "%d", port);
    pid_t pid = spawn(path, (char *[]){ path, paths[4], "--port", number, NULL });
    return pid;
}

/* Repeats the command until the server has started. Returns its output; free with mem_free. */
static char *ask_until_answered(const char *command)
{
    int status = 1;
    char *out = NULL;
    for (int64_t end_ns = clock_mono_ns() + 20 * NS_PER_S; status && clock_mono_ns() < end_ns; sleep_ns(50 * NS_PER_MS)) {
        mem_free(out);
        out = output_of(command, &status);
    }
    if (status)
        print_message("# %s\n%s\n", command, out);
    assert_int_equal(status, 0);
    return out;
}

static void assert_prints(const char *words, const char *fmt, int port)
{
    char *command = test_printf(fmt, port), *out = test_memory(ask_until_answered(command));
    if (!strstr(out, words))
        print_message("# %s\n%s\n", command, out);
    assert_non_null(strstr(out, words));
}

TEST(mbpoll_reads_the_simulator)
{
    int port = free_port();
    if (access("/usr/bin/mbpoll", X_OK) != 0) {
        print_message("# mbpoll is not installed\n");
        skip();
    }
    char *folder = temp_folder();
    pid_t pid = simulate(folder, port);
    assert_prints("[1]: \t1234", "mbpoll -m tcp -t 4 -r 1 -c 1 -1 -p %d 127.0.0.1 2>&1", port);
    assert_prints("[3]: \t-118.625", "mbpoll -m tcp -t 4:float -r 3 -c 1 -1 -p %d 127.0.0.1 2>&1", port);
    assert_prints("[1]: \t65534 (-2)", "mbpoll -m tcp -t 3 -r 1 -c 1 -1 -p %d 127.0.0.1 2>&1", port);
    assert_prints("[1]: \t1", "mbpoll -m tcp -t 0 -r 1 -c 1 -1 -p %d 127.0.0.1 2>&1", port);
    end(pid);
}

TEST(a_probe_shows_every_type_and_order)
{
    int port = free_port();
    char *folder = temp_folder(), *path = program("plantcast");
    pid_t pid = simulate(folder, port);
    char *command = test_printf("%s tags --probe 127.0.0.1:%d hr:2 2>&1", path, port), *out = test_memory(ask_until_answered(command));
    /* two registers are left from this address to the device's last one: the command shows both, but no 64-bit value */
    assert_non_null(strstr(out, "registers 4000 C2ED\nbits 15-0 0100 0000 0000 0000"));
    assert_non_null(strstr(out, "               -118.625 "));
    assert_null(strstr(out, "float64"));
    const char *const wrong[] = { "400001", "hr:9999", "pr:1", "--address-base 2 400001", "hr:0 hr:1" };
    const int statuses[] = { 2, 1, 2, 2, 2 };
    for (int i = 0; i < 5; i++) {
        int status;
        command = test_printf("%s tags --probe 127.0.0.1:%d %s 2>&1", path, port, wrong[i]);
        mem_free(output_of(command, &status));
        assert_int_equal(WEXITSTATUS(status), statuses[i]);
    }
    end(pid);
}

/* All functions of libmodbus that write or that send raw data. A program that does not import them cannot call them. */
TEST(programs_import_nothing_that_writes)
{
    static const char *const programs[] = { "plantcastd", "plantcast", "plantcast-prep" };
    static const char *const writers[] = { "modbus_write", "modbus_mask_write", "modbus_send_raw", "modbus_report_slave_id" };
    for (size_t i = 0; i < sizeof(programs) / sizeof(*programs); i++) {
        int status;
        char *path = program(programs[i]), *command = test_printf("nm -D --undefined-only %s", path), *out = output_of(command, &status);
        assert_int_equal(status, 0);
        assert_true(i == 2 || strstr(out, "modbus_read_registers"));
        for (size_t k = 0; k < sizeof(writers) / sizeof(*writers); k++)
            assert_null(strstr(out, writers[k]));
        mem_free(out);
    }
}
