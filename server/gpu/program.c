/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compiles shaders, links them to programs, and logs the compiler's and the linker's errors. */
#include "gpu/program.h"

#include <string.h>

#include "base/mem.h"
#include "base/text/embedded.h"
#include "base/text/text.h"

enum { MAX_INCLUDES = 20, LOG_BYTES = 4096 };

/* State of the expansion of `#include` lines in one source. Source numbers in compiler messages are indices into `names`. */
struct expansion {
    struct log *log;
    struct text out;
    const char *names[MAX_INCLUDES];
    int count;
};

static bool expand(struct expansion *x, const char *name, const char *text);

/* Replaces a line `#include "x.glsl"` with that file's text. On failure, logs the reason and returns false. */
static bool expand_include(struct expansion *x, const char *from, int line, const char *directive)
{
    const char *open = strchr(directive, '"');
    const char *close = open ? strchr(open + 1, '"') : NULL;
    const char *line_end = strchr(directive, '\n');
    if (!close || (line_end && close > line_end)) {
        log_err(x->log, "cannot draw: invalid shader %s:%d: #include expects a file name in double quotes", from, line);
        return false;
    }
    char *name = mem_printf("%.*s", (int)(close - open - 1), open + 1);
    for (const struct embedded_file *file = embedded_files; file->name; file++)
        if (!strcmp(file->name, name)) {
            mem_free(name);
            return expand(x, file->name, file->text);
        }
    log_err(x->log, "shader %s:%d: %s not found", from, line, name);
    mem_free(name);
    return false;
}

static bool expand(struct expansion *x, const char *name, const char *text)
{
    int source = x->count;
    if (source == MAX_INCLUDES) {
        log_err(x->log, "cannot draw: invalid shader %s: more than %d files included", name, MAX_INCLUDES);
        return false;
    }
    x->names[x->count++] = name;
    text_add(&x->out, "#line 1 %d\n", source);
    for (int line = 1; *text; line++) {
        size_t length = strcspn(text, "\n");
        if (!strncmp(text, "#include", 8)) {
            if (!expand_include(x, name, line, text))
                return false;
            text_add(&x->out, "#line %d %d\n", line + 1, source);
        } else {
            text_add_bytes(&x->out, text, length);
            text_add(&x->out, "\n");
        }
        text += length + (text[length] == '\n');
    }
    return true;
}

GLuint program_compile(struct log *log, GLenum stage, const char *name, const char *text, const char *defines)
{
    struct expansion x = { .log = log };
    GLuint shader = 0;
    GLint good = 0;
    text_add(&x.out, "#version 450 core\n%s", defines ? defines : "");
    if (expand(&x, name, text)) {
        const char *source = x.out.at;
        shader = glCreateShader(stage);
        glShaderSource(shader, 1, &source, NULL);
        glCompileShader(shader);
        glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    }
    if (shader && !good) {
        char why[LOG_BYTES] = "";
        glGetShaderInfoLog(shader, sizeof(why), NULL, why);
        log_err(log, "cannot draw: the OpenGL driver does not compile shader %s: %s", name, why);
        for (int i = 1; i < x.count; i++)
            log_err(log, "shader %s: source %d is %s", name, i, x.names[i]);
        glDeleteShader(shader);
        shader = 0;
    }
    text_finish(&x.out);
    return shader;
}

GLuint program_link(struct log *log, const char *name, const GLuint stages[2])
{
    GLuint program = glCreateProgram();
    GLint good = 0;
    for (int i = 0; i < 2; i++)
        if (stages[i])
            glAttachShader(program, stages[i]);
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &good);
    if (!good) {
        char why[LOG_BYTES] = "";
        glGetProgramInfoLog(program, sizeof(why), NULL, why);
        log_err(log, "cannot draw: the OpenGL driver does not link shader program %s: %s", name, why);
        program_destroy(&program);
    }
    for (int i = 0; i < 2; i++)
        if (stages[i])
            glDeleteShader(stages[i]);
    return program;
}

static GLuint compile_embedded(struct log *log, GLenum stage, const char *name, const char *defines)
{
    const char *text = embedded_find(name);
    if (!text) {
        log_err(log, "cannot draw: shader %s is missing in this program: install or build Plantcast again", name);
        return 0;
    }
    return program_compile(log, stage, name, text, defines);
}

GLuint program_create(struct log *log, const struct program_params *params)
{
    GLuint stages[2] = { 0, 0 };
    bool good;
    if (params->compute) {
        stages[0] = compile_embedded(log, GL_COMPUTE_SHADER, params->compute, params->defines);
        good = stages[0] != 0;
    } else {
        stages[0] = compile_embedded(log, GL_VERTEX_SHADER, params->vertex, params->defines);
        stages[1] = compile_embedded(log, GL_FRAGMENT_SHADER, params->fragment, params->defines);
        good = stages[0] && stages[1];
    }
    if (good)
        return program_link(log, params->compute ? params->compute : params->fragment, stages);
    for (int i = 0; i < 2; i++)
        if (stages[i])
            glDeleteShader(stages[i]);
    return 0;
}

void program_destroy(GLuint *program)
{
    if (*program)
        glDeleteProgram(*program);
    *program = 0;
}
