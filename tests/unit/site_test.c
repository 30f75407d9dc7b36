/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Serving the files of the web client: every valid path within the folder gives its file, and no other path gives anything. */
#include "net/http/site.h"

#include "tests/support/test.h"
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/files/atomic_file.h"

struct site_fixture {
    char *root, *web;
};

static void begin(struct site_fixture *f)
{
    f->root = temp_folder();
    f->web = temp_path(f->root, "web");
    char *core = temp_path(f->web, "core"), *link = temp_path(f->web, "escape.js");
    assert_int_equal(mkdir(f->web, 0700) | mkdir(core, 0700), 0);
    temp_write_text(f->root, "secret.js", "secret");
    temp_write_text(f->web, "index.html", "<p>");
    temp_write_text(f->web, ".hidden.js", "hidden");
    temp_write_text(f->web, "notes", "no ending");
    temp_write_text(f->web, "x.exe", "unknown ending");
    temp_write_text(core, "wire.js", "export {};");
    assert_int_equal(symlink("../secret.js", link), 0);
}

TEST_FIXTURE(struct site_fixture, begin, NULL)

#define CASE(name) TEST_ON(struct site_fixture *f, name, set_up, tear_down)

static void expect(const struct site_fixture *f, const char *path, const char *content, const char *type)
{
    struct web_site *site = site_create(NULL, f->web);
    const struct site_file *file = site_find(site, path);
    if (!file)
        fail_msg("%s is not served", path);
    assert_int_equal(file->plain.count, strlen(content));
    assert_memory_equal(file->plain.bytes, content, file->plain.count);
    assert_string_equal(file->type, type);
    assert_true(file->plain.etag[0] == '"' && strlen(file->plain.etag) > 4);
    site_destroy(&site);
}

CASE(honest_paths_are_served)
{
    expect(f, "/", "<p>", "text/html; charset=utf-8");
    expect(f, "/index.html", "<p>", "text/html; charset=utf-8");
    expect(f, "/core/wire.js", "export {};", "text/javascript; charset=utf-8");
}

/* Scripts are served without comment lines and indentation, and each remaining line keeps its number. Template literals, text
   that only looks like a comment, and scripts of other projects (vendor) must stay unchanged. */
CASE(scripts_come_without_comments_and_indentation)
{
    static const char source[] = "// licence\n// what it is\nconst a = 1; // why\n    // a `tick\n\n    const b = 'x//y';\n"
                                 "  f(`a \\` ${b\n  // text\n   } c`, `d`);\n  // gone\n  g(/  x/);\n// end";
    static const char served[] = "// licence\n\nconst a = 1; // why\n\n\nconst b = 'x//y';\n"
                                 "f(`a \\` ${b\n  // text\n   } c`, `d`);\n\ng(/  x/);\n";
    char *vendor = test_printf("%s/vendor", f->web);
    assert_int_equal(mkdir(vendor, 0700), 0);
    temp_write_text(f->web, "a.js", source);
    temp_write_text(f->web, "a.css", source);
    temp_write_text(vendor, "a.js", source);
    expect(f, "/a.js", served, "text/javascript; charset=utf-8");
    expect(f, "/a.css", source, "text/css; charset=utf-8");
    expect(f, "/vendor/a.js", source, "text/javascript; charset=utf-8");
}

CASE(nothing_else_is)
{
    static const char *const bad[] = { "",
                                       "index.html",
                                       "/none.html",
                                       "/core",
                                       "/core/",
                                       "/notes",
                                       "/x.exe",
                                       "/.hidden.js",
                                       "/../secret.js",
                                       "/core/../../secret.js",
                                       "/core/..",
                                       "//index.html",
                                       "/./index.html",
                                       "/escape.js",
                                       "/index.html/",
                                       "/core\\wire.js",
                                       "/index.html\n",
                                       "/in dex.html",
                                       "/%2e%2e/secret.js",
                                       "/\xc3\xa9.js" };
    struct web_site *site = site_create(NULL, f->web), *none = site_create(NULL, NULL), *nowhere = site_create(NULL, "/nonexistent");
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
        if (site_find(site, bad[i]))
            fail_msg("'%s' is served", bad[i]);
    assert_null(site_find(none, "/"));
    assert_null(site_find(nowhere, "/"));
    site_destroy(&site);
    site_destroy(&none);
    site_destroy(&nowhere);
}

/* If an upgrade replaces the files while the daemon runs, the daemon must continue to serve the files that it read at its
   start. */
CASE(files_stay_as_they_were_at_the_start)
{
    struct web_site *before = site_create(NULL, f->web);
    temp_write_text(f->web, "index.html", "<p>more");
    temp_write_text(f->web, "new.js", "1;");
    struct web_site *after = site_create(NULL, f->web);
    assert_memory_equal(site_find(before, "/")->plain.bytes, "<p>", 3);
    assert_int_equal(site_find(before, "/")->plain.count, 3);
    assert_null(site_find(before, "/new.js"));
    assert_int_equal(site_find(after, "/")->plain.count, 7);
    assert_non_null(site_find(after, "/new.js"));
    assert_string_not_equal(site_find(before, "/")->plain.etag, site_find(after, "/")->plain.etag);
    site_destroy(&before);
    site_destroy(&after);
}

static void expect_gzip(const struct site_file *file, const char *text)
{
    char bytes[8192];
    z_stream stream = { .next_in = (Bytef *)file->gzip.bytes, .avail_in = (uInt)file->gzip.count, .next_out = (Bytef *)bytes };
    stream.avail_out = sizeof(bytes);
    assert_int_equal(inflateInit2(&stream, MAX_WBITS + 16), Z_OK);
    assert_int_equal(inflate(&stream, Z_FINISH), Z_STREAM_END);
    assert_int_equal(stream.total_out, strlen(text));
    assert_memory_equal(bytes, text, stream.total_out);
    assert_string_not_equal(file->gzip.etag, file->plain.etag);
    inflateEnd(&stream);
}

/* A file is sent compressed if the browser accepts gzip and the compressed file is smaller. */
CASE(text_is_compressed_if_the_browser_accepts_gzip)
{
    static const struct {
        const char *accept;
        bool gzip;
    } cases[] = { { "", false },          { "gzip", true },        { "gzip, deflate, br, zstd", true }, { "br,GZIP;q=0.5", true },
                  { "br", false },        { "gzip;q=0", false },   { "gzip; q=0.0, br", false },        { "gzipped, x-gzip", false },
                  { "deflate,gzip", true }, { ",,", false },       { "*", false } };
    char long_text[6001], noise[33] = "8f3kQz0PvLw7YtRb2XnJcMh5GsDa9Ue4";
    for (size_t i = 0; i + 1 < sizeof(long_text); i++)
        long_text[i] = "plant\n"[i % 6];
    long_text[sizeof(long_text) - 1] = 0;
    temp_write_text(f->web, "long.css", long_text);
    temp_write_text(f->web, "noise.txt", noise);
    struct web_site *site = site_create(NULL, f->web);
    struct site_file *file = site_find(site, "/long.css");
    assert_ptr_equal(site_form_for(file, "gzip"), &file->gzip);
    expect_gzip(file, long_text);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
        if ((site_form_for(file, cases[i].accept) == &file->gzip) != cases[i].gzip)
            fail_msg("Accept-Encoding: %s", cases[i].accept);
    assert_ptr_equal(site_form_for(site_find(site, "/noise.txt"), "gzip"), &site_find(site, "/noise.txt")->plain);
    site_destroy(&site);
}
