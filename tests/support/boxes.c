/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes models of boxes as glTF. */
#include "tests/support/boxes.h"

int boxes_add(struct model_maker *maker, const char *node, const double low[3], const double high[3])
{
    static const uint16_t corners[36] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                          2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    float places[8][3];
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++)
            places[i][axis] = (float)(i >> axis & 1 ? high[axis] : low[axis]);
    int positions = maker_numbers(maker, places, sizeof(places), FLOAT, 8, "VEC3");
    int indices = maker_numbers(maker, corners, sizeof(corners), USHORT, 36, "SCALAR");
    int mesh = maker_mesh(maker, json_pack("{s:{s:i},s:i}", "attributes", "POSITION", positions, "indices", indices));
    maker_node(maker, node, mesh, NULL);
    return mesh;
}

void boxes_add_primitive(struct model_maker *maker, int mesh, int mode, const float (*corners)[3], size_t count)
{
    int positions = maker_numbers(maker, corners, count * sizeof(*corners), FLOAT, count, "VEC3");
    json_array_append_new(json_object_get(maker_get(maker, "meshes", mesh), "primitives"),
                          json_pack("{s:{s:i},s:i}", "attributes", "POSITION", positions, "mode", mode));
}
