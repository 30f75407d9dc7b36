/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tests GL contexts, shader programs and framebuffers, which every render pass uses: how a GPU is selected, which errors are
   reported, and that pixels are read back correctly. */
#include "tests/support/test.h"
#include <sys/wait.h>
#include <unistd.h>

#include <glad/gl.h>

#include "gpu/program.h"
#include "gpu/readback.h"
#include "tests/support/rig.h"

static struct rig rig;

TEST(test_names_of_contexts)
{
    enum gl_kind kind = GL_OSMESA;
    assert_true(gl_kind_parse("auto", &kind) && kind == GL_AUTO);
    for (enum gl_kind k = GL_AUTO; k <= GL_OSMESA; k++)
        assert_true(gl_kind_parse(gl_kind_name(k), &kind) && kind == k);
    assert_false(gl_kind_parse("glx", &kind));
}

TEST(test_addresses_of_devices)
{
    struct gl_device device;
    assert_true(gl_device_parse("0000:65:00.0", &device) && device.index < 0);
    assert_true(device.domain == 0 && device.bus == 0x65 && device.slot == 0 && device.function == 0);
    assert_true(gl_device_parse("10:af:1f.7", &device) && device.domain == 0x10 && device.bus == 0xaf);
    assert_true(gl_device_parse("af:1f.7", &device) && device.bus == 0xaf && device.slot == 0x1f && device.function == 7);
    assert_true(gl_device_parse("12", &device) && device.index == 12);
    static const char *const wrong[] = { "", "-1", "1 ", "1x", "0x1", "65:00", "65:00.", "65:00.0x", "gpu0", "0000:65:00.0.1" };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
        assert_false(gl_device_parse(wrong[i], &device));
}

TEST(test_context_tells_what_it_is)
{
    GLint major = 0, minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    assert_true(major * 10 + minor >= 45);
    assert_true(strlen(rig.gl->renderer) > 1);
    assert_true(rig.gl->max_texture_px >= 8192 && rig.gl->max_samples >= 4);
    assert_int_equal(rig.gl->software, strstr(rig.gl->renderer, "llvmpipe") != NULL);
}

/* The addresses of GL functions are loaded once for all contexts. Therefore creating a context of another back end in the same
   process must fail. */
TEST(test_contexts_beside_each_other_are_of_one_kind)
{
    for (enum gl_kind kind = GL_EGL_DEVICE; kind <= GL_OSMESA; kind++)
        if (kind != rig.gl->kind)
            assert_null(gl_create(rig.log, kind, NULL));
    assert_false(gl_lost(rig.gl));
}

TEST(test_pass_tells_its_errors)
{
    gl_pass_enter("good");
    assert_true(gl_pass_leave(rig.gl, "good"));
    gl_pass_enter("bad on purpose");
    glEnable(GL_TEXTURE_2D_ARRAY);
    assert_false(gl_pass_leave(rig.gl, "bad on purpose"));
    gl_pass_enter("good again");
    assert_true(gl_pass_leave(rig.gl, "good again"));
}

TEST(test_program_that_does_not_compile)
{
    assert_int_equal(program_compile(rig.log, GL_FRAGMENT_SHADER, "broken", "void main() { nonsense }\n", NULL), 0);
    assert_int_equal(program_compile(rig.log, GL_FRAGMENT_SHADER, "lost", "#include \"nowhere.glsl\"\nvoid main() {}\n", NULL), 0);
    assert_int_equal(program_compile(rig.log, GL_FRAGMENT_SHADER, "unquoted", "#include light.glsl\nvoid main() {}\n", NULL), 0);
    assert_int_equal(program_create(rig.log, program_params(.vertex = "nowhere.vert", .fragment = "depth.frag")), 0);
}

TEST(test_program_that_does_not_link)
{
    GLuint stages[2] = {
        program_compile(rig.log, GL_VERTEX_SHADER, "one", "out vec4 a;\nvoid main() { a = vec4(1); gl_Position = a; }\n", NULL),
        program_compile(rig.log, GL_FRAGMENT_SHADER, "two", "in vec2 a;\nout vec4 c;\nvoid main() { c = a.xyxy; }\n", NULL),
    };
    assert_int_not_equal(stages[0], 0);
    assert_int_not_equal(stages[1], 0);
    assert_int_equal(program_link(rig.log, "mismatch", stages), 0);
}

TEST(test_defines_and_includes_reach_the_compiler)
{
    GLuint shader = program_compile(rig.log, GL_FRAGMENT_SHADER, "good",
                                    "#include \"light.glsl\"\nout vec4 c;\nvoid main() { c = vec4(light_scalar(VALUE, 0.5)); }\n",
                                    "#define VALUE 0.25\n");
    assert_int_not_equal(shader, 0);
    glDeleteShader(shader);
}

/* Draws a picture with blue above red and one green pixel in the corner. It shows whether rows begin at the top and bytes are
   in the order blue, green, red. */
static void draw_flag(const struct target *target)
{
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target->framebuffer);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, target->width_px, 2);
    glClearColor(0, 0, 1, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glScissor(0, 2, target->width_px, target->height_px - 2);
    glClearColor(1, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glScissor(0, 0, 1, 1);
    glClearColor(0, 1, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
    target_resolve(target, 0, 0, target->width_px, target->height_px);
}

static void check_flag(int samples)
{
    enum { WIDTH = 5, HEIGHT = 4, STRIDE = 32 };
    struct target target;
    struct readback readback = { 0 };
    uint8_t out[HEIGHT * STRIDE];
    memset(out, 77, sizeof(out));
    assert_true(target_init(&target, rig.log, WIDTH, HEIGHT, samples));
    draw_flag(&target);
    assert_true(readback_start(&readback, rig.log, &target) && readback_wait(&readback, rig.log));
    readback_get(&readback, rig.workers, out, STRIDE);
    assert_memory_equal(out, "\0\377\0", 3);
    assert_memory_equal(out + 4, "\377\0\0", 3);
    assert_memory_equal(out + 3 * STRIDE, "\0\0\377", 3);
    assert_int_equal(out[WIDTH * 4], 77);
    readback_finish(&readback);
    target_finish(&target);
}

TEST(test_readback_from_the_top)
{
    check_flag(1);
    check_flag(4);
}

TEST(test_target_too_large_is_refused)
{
    struct target target;
    assert_false(target_init(&target, rig.log, rig.gl->max_texture_px * 2, 16, 1));
}

/* Without drivers (Debian package libgl1-mesa-dri not installed), Mesa's EGL must create no context and must not crash. Runs in
   a child process, because this process has already loaded drivers. */
static pid_t try_without_drivers(void)
{
    pid_t child = fork();
    if (child != 0)
        return child;
    struct log *log = log_create(LOG_INFO);
    setenv("LIBGL_DRIVERS_PATH", "/nowhere", 1);
    struct gl *gl = gl_create(log, GL_EGL_SURFACELESS, NULL);
    /* exit code 1: a software context was created, which must not happen; a GPU's own drivers do not come from Mesa and are
       allowed */
    _exit(gl && gl->software);
}

static pid_t without_drivers;

TEST(test_no_drivers)
{
    int status = -1;
    assert_int_equal(waitpid(without_drivers, &status, 0), without_drivers);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* --- selecting a GPU by index and by PCI address, also in a child process ------------------------------------------------------- */

enum { NO_DEVICES = 77 };

static int count_of(const char *text, const char *words)
{
    int count = 0;
    for (const char *at = strstr(text, words); at; at = strstr(at + 1, words))
        count++;
    return count;
}

static bool draws_with(struct log *log, const char *name, const char *renderer)
{
    struct gl_device device;
    struct gl *gl = gl_device_parse(name, &device) ? gl_create(log, GL_AUTO, &device) : NULL;
    bool good = gl && gl->kind == GL_EGL_DEVICE && strcmp(gl->renderer, renderer) == 0;
    gl_destroy(&gl);
    return good;
}

/* Returns whether every device of the list that is not listed as unusable can be opened by its index and by its PCI address. */
static bool right_devices_draw(struct log *log, char *list)
{
    for (char *line = strtok(list, "\n"); line; line = strtok(NULL, "\n")) {
        char index[12], address[20];
        int at = 0;
        if (sscanf(line, "%11s  %14c  %n", index, address, &at) != 2 || strncmp(line + at, "cannot be used", 14) == 0)
            continue;
        address[strspn(address, "0123456789abcdef:.")] = 0;
        if (!draws_with(log, index, line + at) || (address[0] && !draws_with(log, address, line + at)))
            return false;
    }
    return true;
}

/* Returns whether opening this device fails without falling back to software rendering, and the reason is logged exactly once.
   */
static bool is_refused(struct log *log, FILE *said, const char *name, const char *reason)
{
    char text[4096] = "";
    struct gl_device device;
    rewind(said);
    if (ftruncate(fileno(said), 0) != 0 || !gl_device_parse(name, &device) || gl_create(log, GL_AUTO, &device))
        return false;
    rewind(said);
    text[fread(text, 1, sizeof(text) - 1, said)] = 0;
    return count_of(text, reason) == 1 && count_of(text, "egl-device:") == 1;
}

static int ask_for_devices(void)
{
    char *list = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&list, &size), *said = tmpfile();
    int count = gl_list_devices(out);
    fclose(out);
    if (count == 0)
        return NO_DEVICES;
    if (dup2(fileno(said), STDERR_FILENO) < 0)
        return 1;
    struct log *log = log_create(LOG_INFO);
    if (!is_refused(log, said, "999", "device 999 was requested, but there are only"))
        return 2;
    if (!is_refused(log, said, "ffff:ff:1f.7", "devices is at PCI address ffff:ff:1f.7"))
        return 3;
    return right_devices_draw(log, list) ? 0 : 4;
}

static pid_t asks_for_devices;

static pid_t try_devices(void)
{
    pid_t child = fork();
    if (child == 0)
        _exit(ask_for_devices());
    return child;
}

TEST(test_devices_that_are_asked_for)
{
    int status = -1;
    assert_int_equal(waitpid(asks_for_devices, &status, 0), asks_for_devices);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == NO_DEVICES)
        skip();
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main(void)
{
    without_drivers = try_without_drivers();
    asks_for_devices = try_devices();
    return rig_run(&rig);
}
