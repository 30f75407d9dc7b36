/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compression of cache files: contents come back unchanged, arrays become small, and damaged bytes or false sizes are refused without a
   large allocation. Also cache files of compressed contents: files of another version are passed over, damaged ones are logged. */
#include "base/files/compress.h"

#include "tests/support/test.h"
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/files/cache_file.h"
#include "base/text/text.h"

#define MAGIC "TESTPCK2"
#define OLD_MAGIC "TESTPCK1"
#define COUNT 200000 /* number of 32-bit words in the test's array, enough for several chunks */

static void fill(uint32_t *words, size_t count)
{
    uint32_t state = 7;
    for (size_t i = 0; i < count; i++) {
        state = state * 1664525 + 1013904223;
        words[i] = (uint32_t)(3 * i) + (state >> 28); /* indices, nearly in order */
    }
}

static int add_to_text(void *arg, const void *bytes, size_t count)
{
    text_add_bytes(arg, bytes, count);
    return 0;
}

static int refuse(void *arg, const void *bytes, size_t count)
{
    (void)bytes;
    *(size_t *)arg += count;
    return *(size_t *)arg > 8 ? -ENOSPC : 0;
}

static void *compress_all(const struct atomic_file_part *parts, size_t part_count, size_t *compressed_bytes)
{
    struct text text = { 0 };
    assert_int_equal(compress_parts(parts, part_count, add_to_text, &text), 0);
    *compressed_bytes = text.length;
    return text.at;
}

static void *compress_one(const void *bytes, size_t count, size_t *compressed_bytes)
{
    return compress_all(&(struct atomic_file_part){ bytes, count }, 1, compressed_bytes);
}

/* Decompresses in pieces of 1, 2, 4, ... bytes, so that some pieces begin and end within a chunk and others span several. */
static void read_in_pieces(const void *compressed, size_t bytes, char *to, size_t count)
{
    struct decompressor *d = decompressor_create(compressed, bytes);
    assert_non_null(d);
    for (size_t at = 0, piece = 1; at < count; at += piece, piece *= 2) {
        piece = piece < count - at ? piece : count - at;
        assert_int_equal(decompressor_left(d), count - at);
        assert_true(decompressor_read(d, to + at, piece));
    }
    assert_int_equal(decompressor_left(d), 0);
    assert_true(decompressor_read(d, to, 0));
    assert_false(decompressor_read(d, to, 1));
    decompressor_destroy(&d);
}

TEST(contents_come_back_unchanged)
{
    uint32_t *words = test_memory(mem_array(COUNT, sizeof(*words)));
    fill(words, COUNT);
    static const size_t lengths[] = { 0, 1, 3, 4, 5, 4095, 1 << 18, (1 << 18) + 1, 3 << 18, 4 * COUNT - 1, 4 * COUNT };
    for (size_t i = 0; i < sizeof(lengths) / sizeof(*lengths); i++) {
        const size_t first = lengths[i] / 3;
        const struct atomic_file_part parts[] = { { words, first }, { NULL, 0 }, { (char *)words + first, lengths[i] - first } };
        size_t bytes, count;
        void *compressed = compress_all(parts, 3, &bytes), *back;
        assert_int_equal(decompressed_size(compressed, bytes), lengths[i]);
        back = decompress(compressed, bytes, &count);
        assert_non_null(back);
        assert_int_equal(count, lengths[i]);
        assert_memory_equal(back, words, count);
        memset(back, 0, count);
        read_in_pieces(compressed, bytes, back, count);
        assert_memory_equal(back, words, count);
        mem_free(back);
        mem_free(compressed);
    }
}

TEST(a_failed_write_ends_the_compression)
{
    size_t put = 0;
    char content[1000] = "content";
    assert_int_equal(compress_parts(&(struct atomic_file_part){ content, sizeof(content) }, 1, refuse, &put), -ENOSPC);
}

/* Compression chooses the layout of each chunk by its contents: differences for indices, byte planes for floats, nothing for
   text. Each kind must become as small as expected. */
TEST(each_kind_of_array_becomes_small)
{
    uint32_t *words = test_memory(mem_array(COUNT, sizeof(*words)));
    float *floats = test_memory(mem_array(COUNT, sizeof(*floats)));
    char *text = test_memory(mem_array(COUNT, 4));
    for (size_t i = 0; i < COUNT; i++) {
        floats[i] = 1 + (float)((i * 7919) % 1000) / 256;
        memcpy(text + 4 * i, i % 3 ? "pipe" : "flan", 4);
    }
    fill(words, COUNT);
    const void *const arrays[] = { words, floats, text };
    static const double most[] = { 0.2, 0.5, 0.01 }; /* largest allowed compressed size of each array, as a share of its original size */
    for (size_t i = 0; i < 3; i++) {
        size_t bytes;
        void *compressed = compress_one(arrays[i], 4 * COUNT, &bytes);
        print_message("# array %zu: %.3f of its size\n", i, (double)bytes / (4 * COUNT));
        assert_true((double)bytes < most[i] * 4 * COUNT);
        mem_free(compressed);
    }
}

/* --- damage ----------------------------------------------------------------------------------------------------------------------- */

/* Flips bits at many places: decompressing must fail (NULL) or give as many bytes as before. Sanitizers detect accesses out of
   bounds. */
TEST(damaged_bytes_are_refused_or_harmless)
{
    uint32_t *words = test_memory(mem_array(COUNT, sizeof(*words)));
    size_t bytes, count, refused = 0, tried = 0;
    fill(words, COUNT);
    uint8_t *compressed = test_memory(compress_one(words, 4 * COUNT, &bytes));
    for (size_t i = 0; i < bytes; i += i < 64 ? 1 : bytes / 97) {
        compressed[i] ^= 0x15;
        void *back = decompress(compressed, bytes, &count);
        assert_true(!back || count == 4 * COUNT);
        refused += !back;
        tried++;
        mem_free(back);
        compressed[i] ^= 0x15;
    }
    print_message("# %zu of %zu damaged copies were refused\n", refused, tried);
    assert_true(refused > 0);
    for (size_t cut = 1; cut < bytes; cut += bytes / 53) {
        uint8_t *shorter = mem_array(bytes - cut, 1); /* an allocation of its own, so that reads beyond its end are found */
        memcpy(shorter, compressed, bytes - cut);
        assert_null(decompress(shorter, bytes - cut, &count));
        mem_free(shorter);
    }
}

/* A header with a size that does not match the number of chunks is refused before any memory is allocated for it. */
TEST(false_sizes_are_refused)
{
    static const uint64_t sizes[] = { 0, 1, 999, 1001, 1 << 18, (1 << 18) + 1000, (uint64_t)1 << 40, UINT64_MAX, UINT64_MAX - 7 };
    char content[1000] = "content";
    size_t bytes, count;
    uint8_t *compressed = test_memory(compress_one(content, sizeof(content), &bytes));
    for (size_t i = 0; i < sizeof(sizes) / sizeof(*sizes); i++) {
        memcpy(compressed, &sizes[i], sizeof(sizes[i]));
        assert_int_equal(decompressed_size(compressed, bytes), SIZE_MAX);
        assert_null(decompress(compressed, bytes, &count));
        assert_null(decompressor_create(compressed, bytes));
    }
    const uint64_t right = sizeof(content);
    memcpy(compressed, &right, sizeof(right));
    for (uint32_t frame = 0; frame < 3; frame++) { /* false sizes of the only compressed frame: 0, beyond the end, and huge */
        const uint32_t size = frame == 0 ? 0 : frame == 1 ? (uint32_t)bytes : UINT32_MAX;
        memcpy(compressed + sizeof(right), &size, sizeof(size));
        assert_null(decompress(compressed, bytes, &count));
    }
}

/* --- files ------------------------------------------------------------------------------------------------------------------------ */

struct compress_fixture {
    char *folder, *path;
};

static void begin(struct compress_fixture *f)
{
    f->folder = temp_folder();
    f->path = temp_path(f->folder, "file");
}

TEST_FIXTURE(struct compress_fixture, begin, NULL)

#define CASE(name) TEST_ON(struct compress_fixture *f, name, set_up, tear_down)

/* Opens the file, and asserts that the log has a line with the file's path and `reason` (NULL: that the log stays empty). Returns whether
   the file is usable. */
static bool opens(const struct compress_fixture *f, struct cache_file *file, const char *reason)
{
    char *said = temp_path(f->folder, "said");
    size_t count;
    fflush(stderr);
    const int kept = dup(STDERR_FILENO), to = open(said, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(to, STDERR_FILENO);
    close(to);
    struct log *log = log_create(LOG_INFO);
    const bool good = cache_file_open_compressed(file, log, f->path, MAGIC, 5);
    log_destroy(&log);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    char *text = test_memory(text_read_file(said, 4096, &count));
    assert_non_null(text);
    if (!reason)
        assert_string_equal(text, "");
    else if (!strstr(text, f->path) || !strstr(text, reason))
        fail_msg("the log does not name %s and \"%s\": %s", f->path, reason, text);
    return good;
}

static void write_words(const struct compress_fixture *f)
{
    uint32_t *words = mem_array(COUNT, sizeof(*words));
    fill(words, COUNT);
    assert_int_equal(cache_file_write_compressed(f->path, MAGIC, 5, &(struct atomic_file_part){ words, 4 * COUNT }, 1), 0);
    mem_free(words);
}

CASE(a_file_comes_back_and_is_smaller)
{
    struct cache_file file;
    struct stat st;
    uint32_t *words = test_memory(mem_array(COUNT, sizeof(*words)));
    fill(words, COUNT);
    write_words(f);
    assert_int_equal(stat(f->path, &st), 0);
    assert_true((size_t)st.st_size < COUNT);
    assert_true(opens(f, &file, NULL));
    assert_int_equal(file.count, 4 * COUNT);
    assert_int_equal((uintptr_t)file.bytes % 8, 0);
    assert_memory_equal(file.bytes, words, file.count);
    cache_file_close(&file);
}

/* A missing cache file, or one of the previous version, is no error and not logged: the caller makes the file again. */
CASE(a_file_of_the_previous_version_is_passed_over)
{
    struct cache_file file;
    assert_false(opens(f, &file, NULL));
    assert_int_equal(cache_file_write_parts(f->path, OLD_MAGIC, 5, &(struct atomic_file_part){ "content", 7 }, 1), 0);
    assert_false(opens(f, &file, NULL));
    write_words(f);
    assert_true(opens(f, &file, NULL));
    cache_file_close(&file);
}

CASE(a_damaged_or_cut_file_is_refused_with_a_reason)
{
    static const struct {
        size_t flip, cut;
        const char *reason;
    } cases[] = { { 100, 0, "damaged: its checksum" }, { 0, 1, "truncated: " }, { 0, 1000, "truncated: " } };
    for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
        struct cache_file file;
        size_t size;
        write_words(f);
        char *bytes = test_memory(text_read_file(f->path, 1 << 20, &size));
        assert_non_null(bytes);
        if (cases[i].flip)
            bytes[cases[i].flip] ^= 4;
        assert_int_equal(atomic_file_put(f->path, bytes, size - cases[i].cut), 0);
        assert_false(opens(f, &file, cases[i].reason));
    }
}

/* Cache files with valid checksums whose compressed contents are wrong: false sizes, cut off, and damaged. */
CASE(contents_that_lie_are_refused_with_a_reason)
{
    size_t bytes;
    uint32_t *words = test_memory(mem_array(COUNT, sizeof(*words)));
    fill(words, COUNT);
    uint8_t *compressed = test_memory(compress_one(words, 4 * COUNT, &bytes));
    for (int i = 0; i < 3; i++) {
        struct cache_file file;
        uint8_t *lie = mem_array(bytes, 1);
        memcpy(lie, compressed, bytes);
        if (i == 0)
            memset(lie + 3, 0x7f, 4); /* claims hundreds of petabytes */
        else if (i == 2)
            /* i == 2: sets the type of the compressed frame's first block to an invalid one. Its byte comes after the size (8
               bytes), the chunk's header (8) and the frame's header (9). */
            lie[25] |= 6;
        assert_int_equal(cache_file_write_parts(f->path, MAGIC, 5, &(struct atomic_file_part){ lie, i == 1 ? bytes / 2 : bytes }, 1), 0);
        assert_false(opens(f, &file, i == 2 ? "compressed bytes are damaged" : "do not have the sizes that they state"));
        mem_free(lie);
    }
}
