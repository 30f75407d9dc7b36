/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files of the web client: served for every valid path below the folder, and for no other path. */
#include "net/http/site.h"

#include "tests/support/test.h"
#include <sys/stat.h>
#include <unistd.h>


#include "base/files/atomic_file.h"
#include "base/mem.h"

struct site_fixture {
    char root[64], web[80];
};

static void write_file(const char *folder, const char *name, const char *content)
{
    char *path = mem_printf("%s/%s", folder, name);
    assert_int_equal(atomic_file_put(path, content, strlen(content)), 0);
    mem_free(path);
}

static int set_up(void **state)
{
    struct site_fixture *f = mem_new(sizeof(*f));
    char *core = NULL, *link = NULL;
    strcpy(f->root, "/tmp/plantcast-site-XXXXXX");
    assert_non_null(mkdtemp(f->root));
    snprintf(f->web, sizeof(f->web), "%s/web", f->root);
    core = mem_printf("%s/core", f->web);
    link = mem_printf("%s/escape.js", f->web);
    assert_int_equal(mkdir(f->web, 0700) | mkdir(core, 0700), 0);
    write_file(f->root, "secret.js", "secret");
    write_file(f->web, "index.html", "<p>");
    write_file(f->web, ".hidden.js", "hidden");
    write_file(f->web, "notes", "no ending");
    write_file(f->web, "x.exe", "unknown ending");
    write_file(core, "wire.js", "export {};");
    assert_int_equal(symlink("../secret.js", link), 0);
    mem_free(link);
    mem_free(core);
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    struct site_fixture *f = *state;
    char *command = mem_printf("rm -rf '%s'", f->root);
    assert_int_equal(system(command), 0);
    mem_free(command);
    mem_free(f);
    return 0;
}

#define CASE(name) TEST_ON(struct site_fixture *f, name, set_up, tear_down)

static void expect(const struct site_fixture *f, const char *path, const char *content, const char *type)
{
    struct web_site *site = site_create(NULL, f->web);
    const struct site_file *file = site_find(site, path);
    if (!file)
        fail_msg("%s is not served", path);
    assert_int_equal(file->count, strlen(content));
    assert_memory_equal(file->bytes, content, file->count);
    assert_string_equal(file->type, type);
    assert_true(file->etag[0] == '"' && strlen(file->etag) > 4);
    site_destroy(&site);
}

CASE(honest_paths_are_served)
{
    expect(f, "/", "<p>", "text/html; charset=utf-8");
    expect(f, "/index.html", "<p>", "text/html; charset=utf-8");
    expect(f, "/core/wire.js", "export {};", "text/javascript; charset=utf-8");
}

/* Whole-line comments and indentation are stripped; lines keep their numbers. Template literals, text that only looks like a comment, and
   vendored scripts stay unchanged. */
CASE(scripts_come_without_comments_and_indentation)
{
    static const char source[] = "// licence\n// what it is\nconst a = 1; // why\n    // a `tick\n\n    const b = 'x//y';\n"
                                 "  f(`a \\` ${b\n  // text\n   } c`, `d`);\n  // gone\n  g(/  x/);\n// end";
    static const char served[] = "// licence\n\nconst a = 1; // why\n\n\nconst b = 'x//y';\n"
                                 "f(`a \\` ${b\n  // text\n   } c`, `d`);\n\ng(/  x/);\n";
    char *vendor = mem_printf("%s/vendor", f->web);
    assert_int_equal(mkdir(vendor, 0700), 0);
    write_file(f->web, "a.js", source);
    write_file(f->web, "a.css", source);
    write_file(vendor, "a.js", source);
    expect(f, "/a.js", served, "text/javascript; charset=utf-8");
    expect(f, "/a.css", source, "text/css; charset=utf-8");
    expect(f, "/vendor/a.js", source, "text/javascript; charset=utf-8");
    mem_free(vendor);
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

/* An upgrade replaces the files under a running daemon: it keeps serving the files from its start. */
CASE(files_stay_as_they_were_at_the_start)
{
    struct web_site *before = site_create(NULL, f->web);
    write_file(f->web, "index.html", "<p>more");
    write_file(f->web, "new.js", "1;");
    struct web_site *after = site_create(NULL, f->web);
    assert_memory_equal(site_find(before, "/")->bytes, "<p>", 3);
    assert_int_equal(site_find(before, "/")->count, 3);
    assert_null(site_find(before, "/new.js"));
    assert_int_equal(site_find(after, "/")->count, 7);
    assert_non_null(site_find(after, "/new.js"));
    assert_string_not_equal(site_find(before, "/")->etag, site_find(after, "/")->etag);
    site_destroy(&before);
    site_destroy(&after);
}
