/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compresses meshes with Draco. */
#include "tests/support/draco_encode.h"

#include <cstdlib>
#include <cstring>
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>

extern "C" {
#include "base/mem.h"
}

namespace
{

void add(draco::Mesh *mesh, draco::GeometryAttribute::Type type, draco::DataType data, int8_t width, size_t bytes, bool normalized,
         const void *values, uint32_t count)
{
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, width, data, normalized, static_cast<int64_t>(bytes), 0);
    int number = mesh->AddAttribute(attribute, true, count);
    for (uint32_t i = 0; i < count; i++)
        mesh->attribute(number)->SetAttributeValue(draco::AttributeValueIndex(i), static_cast<const char *>(values) + i * bytes);
}

} // namespace

extern "C" unsigned char *draco_encode(const struct draco_input *in, size_t *size, uint32_t *vertex_count)
{
    draco::Mesh mesh;
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    mesh.set_num_points(in->vertex_count);
    add(&mesh, draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, 12, false, in->positions, in->vertex_count);
    if (in->normals)
        add(&mesh, draco::GeometryAttribute::NORMAL, draco::DT_FLOAT32, 3, 12, false, in->normals, in->vertex_count);
    if (in->colors)
        add(&mesh, draco::GeometryAttribute::COLOR, draco::DT_UINT8, 4, 4, true, in->colors, in->vertex_count);
    for (uint32_t i = 0; i < in->index_count; i += 3)
        mesh.AddFace({ draco::PointIndex(in->indices[i]), draco::PointIndex(in->indices[i + 1]), draco::PointIndex(in->indices[i + 2]) });
    encoder.SetEncodingMethod(in->sequential ? draco::MESH_SEQUENTIAL_ENCODING : draco::MESH_EDGEBREAKER_ENCODING);
    if (in->bits) {
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, in->bits);
        encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, in->bits);
    }
    encoder.SetTrackEncodedProperties(true);
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok())
        abort();
    *vertex_count = static_cast<uint32_t>(encoder.num_encoded_points());
    *size = buffer.size();
    unsigned char *out = static_cast<unsigned char *>(mem_array(*size, 1));
    memcpy(out, buffer.data(), *size);
    return out;
}
