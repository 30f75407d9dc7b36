/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was found out about models that were read before, so that one that has not changed need not be read again: what each asset takes
   from it, and where the nodes are that sensors stand on. In the file FOLDER/cuts; safe to delete. Thread: one. */
#ifndef PREPROCESS_CUTS_H
#define PREPROCESS_CUTS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cut {
    uint64_t recipe;   /* build_recipe */
    uint64_t geometry; /* geometry_hash */
};
struct cut_node {
    uint64_t recipe, node_hash;
    double place_m[3]; /* asset frame */
};
struct cuts {
    struct cut *at;
    struct cut_node *nodes;
    size_t count, node_count, capacity, node_capacity;
};

void cuts_read(struct cuts *cuts, const char *folder); /* none is fine */
int cuts_write(const struct cuts *cuts, const char *folder); /* 0 or -errno */
void cuts_finish(struct cuts *cuts);

bool cuts_same(const struct cuts *a, const struct cuts *b); /* order counts */
bool cuts_find(const struct cuts *cuts, uint64_t recipe, uint64_t *geometry);
bool cuts_find_node(const struct cuts *cuts, uint64_t recipe, uint64_t node_hash, double place_m[3]);
/* Unless it is there. */
void cuts_add(struct cuts *cuts, uint64_t recipe, uint64_t geometry);
void cuts_add_node(struct cuts *cuts, uint64_t recipe, uint64_t node_hash, const double place_m[3]);

#endif
