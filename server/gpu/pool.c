/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Manages pages (buffers) of GPU memory and the free gaps in them. */
#include "gpu/pool.h"

#include "base/mem.h"
#include "gpu/mesh.h"

struct pool {
    struct log *log;
    const char *name;
    GLenum format;
    size_t texel_bytes, max_texels; /* max_texels: capacity of a page */
    GLbitfield flags;
    /* expected: number of texels announced for the next page (pool_expect()); texels: total size of all pages */
    size_t expected, texels;
    struct pool_page **pages;
    size_t page_count, page_capacity;
};

struct pool *pool_create(struct log *log, const char *name, GLenum format, size_t texel_bytes, GLbitfield flags)
{
    GLint most = 0;
    struct pool *pool = mem_new(sizeof(*pool));
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    *pool = (struct pool){ .log = log, .name = name, .format = format, .texel_bytes = texel_bytes, .flags = flags };
    pool->max_texels = (size_t)most;
    return pool;
}

static void page_destroy(struct pool *pool, size_t index)
{
    struct pool_page *page = pool->pages[index];
    pool->texels -= page->texels;
    pool->pages[index] = pool->pages[--pool->page_count];
    glDeleteTextures(1, &page->texture);
    glDeleteBuffers(1, &page->buffer);
    mem_free(page);
}

void pool_destroy(struct pool **pool_ptr)
{
    struct pool *pool = *pool_ptr;
    if (!pool)
        return;
    while (pool->page_count)
        page_destroy(pool, pool->page_count - 1);
    mem_free(pool->pages);
    mem_free(pool);
    *pool_ptr = NULL;
}

static size_t whole_blocks(size_t texels)
{
    return (texels + POOL_BLOCK - 1) / POOL_BLOCK * POOL_BLOCK;
}

/* Finds a free gap of at least `count` texels in the page. *first receives its offset; *before receives the slice in front of
   the gap, or NULL if the gap is at the beginning. Returns false if there is none. */
static bool find_gap(const struct pool_page *page, size_t count, struct pool_slice **before, size_t *first)
{
    *before = NULL;
    *first = 0;
    for (struct pool_slice *next = page->first;; next = next->next) {
        size_t end = next ? next->block * POOL_BLOCK : page->texels;
        if (*first + count <= end)
            return true;
        if (!next)
            return false;
        *before = next;
        *first = next->block * POOL_BLOCK + whole_blocks(next->count);
    }
}

static struct pool_slice *take_from(struct pool_page *page, size_t count)
{
    struct pool_slice *before, *slice;
    size_t first;
    if (!find_gap(page, count, &before, &first))
        return NULL;
    slice = mem_new(sizeof(*slice));
    *slice = (struct pool_slice){ .page = page, .block = first / POOL_BLOCK, .count = count, .holds = 1 };
    slice->next = before ? before->next : page->first;
    *(before ? &before->next : &page->first) = slice;
    return slice;
}

static struct pool_page *page_create(struct pool *pool, size_t texels)
{
    GLuint buffer = mesh_buffer(pool->log, pool->name, texels * pool->texel_bytes, NULL, pool->flags);
    if (!buffer)
        return NULL;
    struct pool_page *page = mem_new(sizeof(*page));
    *page = (struct pool_page){ .pool = pool, .buffer = buffer, .texels = texels };
    glCreateTextures(GL_TEXTURE_BUFFER, 1, &page->texture);
    glTextureBuffer(page->texture, pool->format, buffer);
    mem_grow(&pool->pages, &pool->page_capacity, pool->page_count + 1, sizeof(*pool->pages));
    pool->pages[pool->page_count++] = page;
    pool->texels += texels;
    return page;
}

void pool_expect(struct pool *pool, size_t texels, size_t slices)
{
    pool->expected = texels + slices * (POOL_BLOCK - 1);
}

/* Returns the number of texels for a new page: at least half the total of all pages, which keeps pages few. */
static size_t page_texels(const struct pool *pool, size_t least)
{
    size_t texels = pool->expected > pool->texels / 2 ? pool->expected : pool->texels / 2;
    texels = whole_blocks(texels < pool->max_texels ? texels : pool->max_texels);
    return texels > least ? texels : least;
}

struct pool_slice *pool_take(struct pool *pool, size_t count)
{
    struct pool_slice *slice = NULL;
    for (size_t i = 0; i < pool->page_count && !slice; i++)
        slice = take_from(pool->pages[i], count);
    if (slice)
        return slice;
    size_t least = count > 0 ? whole_blocks(count) : POOL_BLOCK, most = page_texels(pool, least);
    struct pool_page *page = count > pool->max_texels ? NULL : page_create(pool, most);
    if (!page && most > least && count <= pool->max_texels)
        page = page_create(pool, least);
    pool->expected = 0;
    if (count > pool->max_texels)
        log_err(pool->log, "%s: the asset has %zu vertices, more than this GPU can hold (buffer textures of at most %zu): split the asset",
                pool->name, count, pool->max_texels);
    return page ? take_from(page, count) : NULL;
}

struct pool_slice *pool_ref(struct pool_slice *slice)
{
    if (slice)
        slice->holds++;
    return slice;
}

void pool_unref(struct pool_slice **slice_ptr)
{
    struct pool_slice *slice = *slice_ptr;
    *slice_ptr = NULL;
    if (!slice || --slice->holds > 0)
        return;
    struct pool_page *page = slice->page;
    struct pool_slice **at = &page->first;
    while (*at != slice)
        at = &(*at)->next;
    *at = slice->next;
    mem_free(slice);
    for (size_t i = 0; !page->first && i < page->pool->page_count; i++)
        if (page->pool->pages[i] == page) {
            page_destroy(page->pool, i);
            return;
        }
}

size_t pool_offset(const struct pool_slice *slice)
{
    return slice->block * POOL_BLOCK * slice->page->pool->texel_bytes;
}

size_t pool_bytes(const struct pool_slice *slice)
{
    return slice->count * slice->page->pool->texel_bytes;
}

size_t pool_bytes_taken(const struct pool *pool)
{
    return pool->texels * pool->texel_bytes;
}
