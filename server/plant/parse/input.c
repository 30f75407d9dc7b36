/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads text files and checks their size and encoding. */
#include "plant/parse/input.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>

#include "base/mem.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "plant/parse/file_kind.h"

enum {
    REPORTED_LINES = 10,
    TEXT_AT_LEAST = 10 /* TEXT_AT_LEAST: minimum number of valid characters per invalid byte in a file that counts as text */
};

/* Reports bytes that are not valid UTF-8. If the bytes are not text at all, returns false and reports nothing. */
static bool check_characters(char *text, size_t bytes, const char *path, struct diag *diag)
{
    size_t wrong = 0;
    for (size_t i = 0, count; i < bytes; i += count ? count : 1) {
        count = utf8_length(text + i, bytes - i);
        wrong += count == 0;
    }
    if (wrong > REPORTED_LINES && wrong > bytes / TEXT_AT_LEAST)
        return false;
    int line = 1, column = 1, reported_line = 0, reported = 0;
    for (size_t i = 0; i < bytes && wrong > 0;) {
        size_t count = utf8_length(text + i, bytes - i);
        if (count == 0) {
            if (reported_line != line && ++reported <= REPORTED_LINES)
                diag_error(diag, path, line, column, "byte 0x%02X is not UTF-8 text; save the file as UTF-8", (unsigned char)text[i]);
            reported_line = line;
            text[i] = '_';
            count = 1;
        }
        column++;
        if (text[i] == '\n') {
            line++;
            column = 1;
        }
        i += count;
    }
    if (reported > REPORTED_LINES)
        diag_error(diag, path, reported_line, 0, "%d lines contain bytes that are not UTF-8 text; this is the last of them", reported);
    return true;
}

static bool starts_with(const char *text, size_t bytes, const char *mark, size_t mark_bytes)
{
    return bytes >= mark_bytes && !memcmp(text, mark, mark_bytes);
}

static bool is_blank(const char *text, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        if (!memchr(" \t\r\n", text[i], 4))
            return false;
    return true;
}

/* Reads a text file into memory. Returns NULL after an error (reported). */
static char *read_bytes(const char *path, const char *wanted, struct diag *diag, size_t *bytes)
{
    const char *kind = file_kind_of(path);
    if (kind) {
        diag_error(diag, path, 0, 0, "is %s; expected %s", kind, wanted);
        return NULL;
    }
    char *text = text_read_file(path, INPUT_MAX_BYTES, bytes);
    if (!text && errno == EFBIG)
        diag_error(diag, path, 0, 0, "larger than the limit of %u MiB", INPUT_MAX_BYTES / (1024 * 1024));
    else if (!text)
        diag_error(diag, path, 0, 0, "cannot be read: %s", strerror(errno));
    return text;
}

/* Takes ownership of a file's content, and checks that it is valid UTF-8. Returns NULL after an error (reported). */
static char *check_text(char *text, size_t bytes, const char *path, const char *wanted, struct diag *diag)
{
    if (is_blank(text, bytes))
        diag_error(diag, path, 1, 1, "is empty");
    else if (check_characters(text, bytes, path, diag))
        return text;
    else
        diag_error(diag, path, 0, 0, "is not a text file; expected %s", wanted);
    mem_free(text);
    return NULL;
}

char *input_read(const char *path, const char *wanted, struct diag *diag, size_t *bytes)
{
    char *text = read_bytes(path, wanted, diag, bytes);
    if (!text)
        return NULL;
    if (starts_with(text, *bytes, "\xFF\xFE", 2) || starts_with(text, *bytes, "\xFE\xFF", 2)) {
        diag_error(diag, path, 1, 1, "is UTF-16; save the file as UTF-8");
        mem_free(text);
        return NULL;
    }
    if (starts_with(text, *bytes, "\xEF\xBB\xBF", 3)) {
        *bytes -= 3;
        memmove(text, text + 3, *bytes + 1);
    }
    return check_text(text, *bytes, path, wanted, diag);
}

char *input_read_foreign(const char *path, const char *wanted, const char *encoding, struct diag *diag, size_t *bytes,
                         struct charset_choice *choice)
{
    struct charset_text decoded;
    char *text = read_bytes(path, wanted, diag, bytes);
    if (!text)
        return NULL;
    charset_decode(text, *bytes, encoding, &decoded);
    mem_free(text);
    *bytes = decoded.length;
    *choice = decoded.encoding;
    if (decoded.damaged)
        diag_warning(diag, path, 0, 0, "%zu characters are invalid in %s; choose another encoding with --encoding", decoded.damaged,
                     choice->name);
    return check_text(decoded.utf8, *bytes, path, wanted, diag);
}
