/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A growing string (struct text), to which callers append text, quoted if needed, and reading of whole files into memory. */
#include "base/text/text.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/mem.h"

void text_add_bytes(struct text *text, const void *bytes, size_t count)
{
    mem_grow(&text->at, &text->capacity, text->length + count + 1, 1);
    memcpy(text->at + text->length, bytes, count);
    text->length += count;
    text->at[text->length] = 0;
}

void text_add_v(struct text *text, const char *fmt, va_list ap)
{
    va_list again;
    va_copy(again, ap);
    int count = vsnprintf(NULL, 0, fmt, again);
    va_end(again);
    if (count < 0)
        return;
    mem_grow(&text->at, &text->capacity, text->length + (size_t)count + 1, 1);
    vsnprintf(text->at + text->length, (size_t)count + 1, fmt, ap);
    text->length += (size_t)count;
}

void text_add(struct text *text, const char *fmt, ...)
{
    va_list ap;
    va_start(ap, fmt);
    text_add_v(text, fmt, ap);
    va_end(ap);
}

void text_add_escaped(struct text *text, const char *part)
{
    for (; *part; part++) {
        bool plain = (*part >= 'a' && *part <= 'z') || (*part >= 'A' && *part <= 'Z') || (*part >= '0' && *part <= '9') ||
                     strchr("-._~", *part);
        text_add(text, plain ? "%c" : "%%%02X", (unsigned char)*part);
    }
}

void text_add_quoted(struct text *text, const char *cell)
{
    text_add(text, "\"");
    for (; *cell; cell++)
        text_add(text, *cell == '"' ? "\"\"" : "%c", *cell);
    text_add(text, "\"");
}

/* Returns true if a spreadsheet would interpret the cell as a formula. A lone sign such as "-" does not count, because it may
   be the unit of a dimensionless quantity. */
bool text_is_formula(const char *cell)
{
    return *cell && strchr("=+-@\t\r", *cell) && cell[1];
}

void text_add_cell(struct text *text, const char *cell, const char *special)
{
    char *safe = text_is_formula(cell) ? mem_printf("'%s", cell) : NULL;
    if (strpbrk(cell, special))
        text_add_quoted(text, safe ? safe : cell);
    else
        text_add(text, "%s", safe ? safe : cell);
    mem_free(safe);
}

const char *text_cell_read(const char *cell)
{
    return *cell == '\'' && text_is_formula(cell + 1) ? cell + 1 : cell;
}

void text_finish(struct text *text)
{
    mem_free(text->at);
    *text = (struct text){ 0 };
}

const char *text_base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

bool text_equal_but_numbers(const char *a, const char *b)
{
    static const char digits[] = "0123456789";
    for (;;) {
        size_t in_a = strspn(a, digits), in_b = strspn(b, digits);
        if (*(a += in_a) != *(b += in_b) || !in_a != !in_b)
            return false;
        if (!*a)
            return true;
        a++, b++;
    }
}

char *text_read_file(const char *path, size_t max_bytes, size_t *out_bytes)
{
    struct stat st;
    char *bytes = NULL;
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    if (fstat(fileno(file), &st) != 0)
        goto error;
    if (!S_ISREG(st.st_mode)) {
        errno = S_ISDIR(st.st_mode) ? EISDIR : EINVAL;
        goto error;
    }
    if ((size_t)st.st_size > max_bytes) {
        errno = EFBIG;
        goto error;
    }
    size_t size = (size_t)st.st_size;
    bytes = mem_try_array(size + 1, 1);
    if (!bytes) {
        errno = ENOMEM;
        goto error;
    }
    size_t got = fread(bytes, 1, size, file);
    if (got < size && ferror(file)) {
        errno = EIO;
        goto error;
    }
    bytes[got] = 0;
    *out_bytes = got;
    fclose(file);
    return bytes;
error:;
    int cause = errno;
    fclose(file);
    mem_free(bytes);
    errno = cause;
    return NULL;
}
