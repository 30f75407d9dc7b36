/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wraps the library Draco, which decodes compressed meshes, in plain C. Checks the counts in the file's header against the size
 * of the data before the library allocates memory for them. */
#include "preprocess/model/draco_shim.h"

#include <draco/compression/decode.h>
#include <draco/metadata/metadata_decoder.h>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>

struct draco_mesh {
    std::unique_ptr<draco::Mesh> mesh;
};

namespace
{

/* Limit on the triangle count. A regular grid compresses to well under one bit per triangle, but data with more triangles than
 * FREE_TRIANGLES plus TRIANGLES_PER_BYTE per byte is rejected as implausible. */
constexpr uint64_t FREE_TRIANGLES = 1 << 16, TRIANGLES_PER_BYTE = 1024;

bool read_varint(draco::DecoderBuffer *buffer, uint64_t *out)
{
    uint8_t byte = 0;
    *out = 0;
    for (int shift = 0; shift < 63; shift += 7) {
        if (!buffer->Decode(&byte))
            return false;
        *out |= static_cast<uint64_t>(byte & 127) << shift;
        if (!(byte & 128))
            return true;
    }
    return false;
}

/* Checks the counts in a Draco header against limits, for bitstream version 2.2, which every glTF exporter writes. Returns
 * false with the reason in why. */
bool claims_good(const char *bytes, size_t size, char *why)
{
    draco::DecoderBuffer buffer;
    struct {
        char magic[5];
        uint8_t major, minor, type, method, flags[2];
    } header;
    static_assert(sizeof(header) == 11, "the header must have no padding, as in Draco data");
    buffer.Init(bytes, size);
    if (!buffer.Decode(&header, sizeof(header)) || memcmp(header.magic, "DRACO", 5) != 0)
        return wrong(why, "the %zu bytes of compressed data do not begin with DRACO, so they are damaged", size);
    if (header.major != 2 || header.minor != 2 || header.type != draco::TRIANGULAR_MESH || header.method > draco::MESH_EDGEBREAKER_ENCODING)
        return wrong(why, "Plantcast supports only Draco meshes of version 2.2; this one has version %u.%u, type %u, method %u",
                     header.major, header.minor, header.type, header.method);
    draco::GeometryMetadata metadata;
    if ((header.flags[1] & 128) && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
        return wrong(why, "the metadata of the Draco-compressed mesh is truncated");
    uint64_t first = 0, second = 0;
    bool edgebreaker = header.method == draco::MESH_EDGEBREAKER_ENCODING;
    if (edgebreaker)
        buffer.Advance(1); /* skip the traversal type */
    if (!read_varint(&buffer, &first) || !read_varint(&buffer, &second))
        return wrong(why, "the Draco-compressed mesh is truncated at %zu bytes", size);
    uint64_t triangles = edgebreaker ? second : first, vertices = edgebreaker ? first : second,
             most = FREE_TRIANGLES + TRIANGLES_PER_BYTE * size;
    if (triangles > most || vertices > 3 * most)
        return wrong(why, "%zu bytes of Draco data cannot hold %llu vertices and %llu triangles, the numbers in the header", size,
                     static_cast<unsigned long long>(vertices), static_cast<unsigned long long>(triangles));
    return true;
}

bool decode(draco_mesh *out, const char *bytes, size_t size, char *why)
{
    draco::DecoderBuffer buffer;
    draco::Decoder decoder;
    if (!claims_good(bytes, size, why))
        return false;
    buffer.Init(bytes, size);
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok())
        return wrong(why, "%s", result.status().error_msg());
    out->mesh = std::move(result).value();
    for (uint32_t f = 0; f < out->mesh->num_faces(); f++)
        for (draco::PointIndex v : out->mesh->face(draco::FaceIndex(f)))
            if (v.value() >= out->mesh->num_points())
                return wrong(why, "triangle %u of the Draco-compressed mesh refers to vertex %u, but there are only %u vertices", f,
                             v.value(), out->mesh->num_points());
    return true;
}

template <typename S, typename T> bool convert(const char *from, T *to)
{
    S value;
    memcpy(&value, from, sizeof(value));
    double number = static_cast<double>(value);
    if (std::numeric_limits<T>::is_integer &&
        !(number >= static_cast<double>(std::numeric_limits<T>::min()) && number <= static_cast<double>(std::numeric_limits<T>::max()) &&
          number == std::floor(number)))
        return false;
    *to = static_cast<T>(value);
    return true;
}

template <typename T> bool convert(draco::DataType type, const char *from, T *to)
{
    switch (type) {
    case draco::DT_INT8: return convert<int8_t>(from, to);
    case draco::DT_UINT8: return convert<uint8_t>(from, to);
    case draco::DT_INT16: return convert<int16_t>(from, to);
    case draco::DT_UINT16: return convert<uint16_t>(from, to);
    case draco::DT_INT32: return convert<int32_t>(from, to);
    case draco::DT_UINT32: return convert<uint32_t>(from, to);
    case draco::DT_FLOAT32: return convert<float>(from, to);
    default: return false;
    }
}

/* Copies a mesh attribute's values without Draco's own conversion, which trusts a flag in the file. */
template <typename T> bool copy(const draco::Mesh &mesh, const draco::PointAttribute &attribute, int width, void *out)
{
    T *to = static_cast<T *>(out);
    uint64_t bytes = static_cast<uint64_t>(draco::DataTypeLength(attribute.data_type())), has = attribute.buffer()->data_size();
    if (!attribute.is_mapping_identity() && attribute.indices_map_size() < mesh.num_points())
        return false;
    for (uint32_t v = 0; v < mesh.num_points(); v++, to += width) {
        uint64_t place = attribute.mapped_index(draco::PointIndex(v)).value();
        uint64_t at = static_cast<uint64_t>(attribute.byte_offset()) + place * static_cast<uint64_t>(attribute.byte_stride());
        if (at + static_cast<uint64_t>(width) * bytes > has)
            return false;
        for (int c = 0; c < width; c++)
            if (!convert<T>(attribute.data_type(),
                            reinterpret_cast<const char *>(attribute.buffer()->data()) + at + static_cast<uint64_t>(c) * bytes, to + c))
                return false;
    }
    return true;
}

} // namespace

extern "C" struct draco_mesh *draco_mesh_decode(const void *bytes, size_t size, char why[MODEL_WHY_BYTES])
{
    try {
        auto mesh = std::make_unique<draco_mesh>();
        if (decode(mesh.get(), static_cast<const char *>(bytes), size, why))
            return mesh.release();
    } catch (const std::exception &e) {
        wrong(why, "%s", e.what());
    } catch (...) {
        wrong(why, "the Draco library could not decompress the mesh, and gave no reason: export the model again");
    }
    return nullptr;
}

extern "C" void draco_mesh_destroy(struct draco_mesh **mesh)
{
    delete *mesh;
    *mesh = nullptr;
}

extern "C" uint32_t draco_mesh_vertex_count(const struct draco_mesh *mesh)
{
    return mesh->mesh->num_points();
}

extern "C" uint32_t draco_mesh_triangle_count(const struct draco_mesh *mesh)
{
    return mesh->mesh->num_faces();
}

extern "C" void draco_mesh_indices(const struct draco_mesh *mesh, uint32_t *out)
{
    for (uint32_t f = 0; f < mesh->mesh->num_faces(); f++)
        for (draco::PointIndex v : mesh->mesh->face(draco::FaceIndex(f)))
            *out++ = v.value();
}

extern "C" bool draco_mesh_attribute(const struct draco_mesh *mesh, uint32_t unique_id, int component_type, int width, void *out)
{
    const draco::PointAttribute *attribute = mesh->mesh->GetAttributeByUniqueId(unique_id);
    if (!attribute || attribute->num_components() < width)
        return false;
    switch (component_type) {
    case 5120: return copy<int8_t>(*mesh->mesh, *attribute, width, out);
    case 5121: return copy<uint8_t>(*mesh->mesh, *attribute, width, out);
    case 5122: return copy<int16_t>(*mesh->mesh, *attribute, width, out);
    case 5123: return copy<uint16_t>(*mesh->mesh, *attribute, width, out);
    case 5125: return copy<uint32_t>(*mesh->mesh, *attribute, width, out);
    case 5126: return copy<float>(*mesh->mesh, *attribute, width, out);
    default: return false;
    }
}
