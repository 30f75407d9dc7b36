/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Feeds RVM files and attribute files to their readers; the first byte selects which. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>

#include "preprocess/import/cad_attributes.h"
#include "preprocess/import/rvm.h"
#include "tests/fuzz/promise.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static void check_model(const struct cad_model *model)
{
    for (size_t n = 0; n < model->node_count; n++) {
        const struct cad_node *node = &model->nodes[n];
        require(node->parent < (int)n, "parents come before children");
        for (size_t v = 0; v < node->vertex_count; v++)
            for (int k = 0; k < 3; k++)
                require(isfinite(node->vertices[v].position_m[k]) && isfinite(node->vertices[v].normal[k]), "corners are finite");
        for (size_t t = 0; t < node->triangle_count; t++)
            for (int k = 0; k < 3; k++)
                require(node->triangles[t][k] < node->vertex_count, "triangles have corners that are there");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count)
{
    struct rvm_counts counts;
    struct attribute_counts attributes;
    char why[256] = "";
    const struct rvm_params params = { .chord_m = 0.01 };
    const struct attribute_params attribute_params = { .model_encoding = "" };
    if (count < 1)
        return 0;
    struct cad_model *model = cad_model_create();
    if (bytes[0] % 2) {
        cad_model_add_node(model, -1, "/A");
        cad_model_add_node(model, 0, "/A/B");
        if (!cad_attributes_read(model, (const char *)bytes + 1, count - 1, &attribute_params, &attributes, why, sizeof(why)))
            require(why[0], "what is refused says why");
    } else if (!rvm_read(model, bytes + 1, count - 1, &params, &counts, why, sizeof(why))) {
        require(why[0], "what is refused says why");
    }
    check_model(model);
    cad_model_destroy(&model);
    return 0;
}
