/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Converts mesh primitives to triangle lists that contain only the vertices in use. */
#include "preprocess/model/gltf_impl.hh"

#include <algorithm>
#include <cmath>

namespace gltf
{
namespace
{

/* Returns the vertex indices of a primitive's triangles, three per triangle. */
std::vector<uint32_t> read_indices(gltf_work *w, const tinygltf::Primitive &p, size_t vertex_count, const std::string &what)
{
    std::vector<uint32_t> out;
    if (p.indices < 0) {
        take_elements(w, vertex_count, what);
        out.resize(vertex_count);
        for (size_t i = 0; i < vertex_count; i++)
            out[i] = static_cast<uint32_t>(i);
        return out;
    }
    accessor from(*w, p.indices, 0, what + ": indices");
    int type = from.component_type();
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        refuse("invalid glTF file: %s: the accessor of `indices` has component type %d, which is not allowed for indices", what.c_str(),
               type);
    if (from.is_normalized())
        refuse("invalid glTF file: %s: the accessor of `indices` has `normalized: true`, which is not allowed for indices", what.c_str());
    if (from.width() != 1)
        refuse("invalid glTF file: %s: the accessor of `indices` has %d components, expected 1", what.c_str(), from.width());
    take_elements(w, from.count(), what + ": indices");
    out.resize(from.count());
    for (size_t i = 0; i < out.size(); i++) {
        double index;
        from.get(i, &index);
        if (!(index < static_cast<double>(vertex_count)))
            refuse("invalid glTF file: %s: index number %zu refers to vertex %.0f, but there are only %zu vertices", what.c_str(), i, index,
                   vertex_count);
        out[i] = static_cast<uint32_t>(index);
    }
    return out;
}

std::vector<uint32_t> triangle_list(std::vector<uint32_t> in, int mode, const std::string &what)
{
    std::vector<uint32_t> out;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        if (in.size() % 3 != 0)
            refuse("invalid glTF file: %s: the number of indices, %zu, is not a multiple of 3", what.c_str(), in.size());
        return in;
    }
    for (size_t i = 2; i < in.size(); i++) {
        bool odd = mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1;
        uint32_t a = mode == TINYGLTF_MODE_TRIANGLE_FAN ? in[0] : in[i - 2];
        out.push_back(odd ? in[i - 1] : a);
        out.push_back(odd ? a : in[i - 1]);
        out.push_back(in[i]);
    }
    return out;
}

/* Returns the vertices used by `indices`, in ascending order, and renumbers the indices accordingly. Dropping unused vertices
 * matters because exporters often share one large buffer among many primitives. */
std::vector<uint32_t> compact(std::vector<uint32_t> *indices)
{
    std::vector<uint32_t> used;
    if (indices->empty())
        return used;
    auto ends = std::minmax_element(indices->begin(), indices->end());
    uint32_t low = *ends.first, range = *ends.second - low + 1;
    /* few indices spread over a wide range: sorts them, because an array with an element for each number of the range would be
       large */
    if (range / 8 > indices->size()) {
        used = *indices;
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        for (uint32_t &index : *indices)
            index = static_cast<uint32_t>(std::lower_bound(used.begin(), used.end(), index) - used.begin());
        return used;
    }
    std::vector<uint32_t> number(range, 0);
    for (uint32_t index : *indices)
        number[index - low] = 1;
    for (uint32_t i = 0; i < range; i++)
        if (number[i]) {
            number[i] = static_cast<uint32_t>(used.size());
            used.push_back(low + i);
        }
    for (uint32_t &index : *indices)
        index = number[index - low];
    return used;
}

struct attribute_reader {
    const gltf_work &w;
    const tinygltf::Primitive &primitive;
    const std::vector<uint32_t> &used;
    size_t vertex_count; /* number of vertices (elements of the attribute POSITION) */
    const std::string &what;

    bool has(const std::string &name) const
    {
        return primitive.attributes.count(name) > 0;
    }

    accessor open(const std::string &name, int width) const
    {
        accessor a(w, primitive.attributes.at(name), width, what + ": " + name);
        if (a.count() != vertex_count)
            refuse("invalid glTF file: %s: attribute %s has %zu elements, but POSITION has %zu", what.c_str(), name.c_str(), a.count(),
                   vertex_count);
        return a;
    }
};

float narrow(double value, const std::string &what)
{
    float out = static_cast<float>(value);
    if (!std::isfinite(out))
        refuse("invalid glTF file: %s: the number %g is too large for a 32-bit float", what.c_str(), value);
    return out;
}

float (*read_vectors(const attribute_reader &reader, const std::string &name))[3]
{
    accessor from = reader.open(name, 3);
    float(*out)[3] = reinterpret_cast<float(*)[3]>(new_array<float>(3 * reader.used.size() + 1));
    double v[3];
    try {
        for (size_t i = 0; i < reader.used.size(); i++) {
            from.get(reader.used[i], v);
            for (int c = 0; c < 3; c++)
                out[i][c] = static_cast<float>(v[c]);
        }
    } catch (...) {
        mem_free(out);
        throw;
    }
    return out;
}

/* Reads a set of texture coordinates; *out stays NULL if the primitive has none. Returns true if coordinates lie outside 0..1
 * although the texture's mapping (uv_transform) is only valid inside. */
bool read_texcoords(const attribute_reader &reader, const uv_transform &uv, float (**out)[2])
{
    std::string name = "TEXCOORD_" + std::to_string(uv.set);
    bool beyond = false;
    if (!reader.has(name))
        return false;
    accessor from = reader.open(name, 2);
    float(*texcoords)[2] = *out = reinterpret_cast<float(*)[2]>(new_array<float>(2 * reader.used.size() + 1));
    double c = std::cos(uv.rotation), s = std::sin(uv.rotation), t[2];
    for (size_t i = 0; i < reader.used.size(); i++) {
        from.get(reader.used[i], t);
        double u = t[0] * uv.scale[0], v = t[1] * uv.scale[1];
        texcoords[i][0] = narrow(c * u + s * v + uv.offset[0], reader.what);
        texcoords[i][1] = narrow(-s * u + c * v + uv.offset[1], reader.what);
        beyond |= uv.bounded && (std::fabs(texcoords[i][0] - 0.5f) > 0.501f || std::fabs(texcoords[i][1] - 0.5f) > 0.501f);
    }
    return beyond;
}

void read_colors(const attribute_reader &reader, gltf_primitive *out)
{
    accessor from = reader.open("COLOR_0", 0);
    if (from.width() != 3 && from.width() != 4)
        refuse("invalid glTF file: %s: COLOR_0 has %d components, expected 3 or 4", reader.what.c_str(), from.width());
    out->colors = reinterpret_cast<uint8_t(*)[4]>(new_array<uint8_t>(4 * reader.used.size() + 1));
    for (size_t i = 0; i < reader.used.size(); i++) {
        double color[4] = { 1, 1, 1, 1 };
        from.get(reader.used[i], color);
        for (int c = 0; c < 4; c++)
            out->colors[i][c] = static_cast<uint8_t>(std::lround(std::fmin(std::fmax(color[c], 0), 1) * 255));
    }
}

void read_vertices(gltf_work *w, const attribute_reader &reader, gltf_primitive *out, int material)
{
    uv_lays lays = lays_of(reader.w.parsed, material);
    out->positions = read_vectors(reader, "POSITION");
    if (reader.has("NORMAL"))
        out->normals = read_vectors(reader, "NORMAL");
    if (read_texcoords(reader, lays.at[0], &out->texcoords))
        leave_out_bounded(w, material, 0);
    if (lays.count > 1 && read_texcoords(reader, lays.at[1], &out->second_texcoords))
        leave_out_bounded(w, material, 1);
    if (reader.has("COLOR_0"))
        read_colors(reader, out);
}

void check_morphing(const std::vector<double> &weights, const std::string &what)
{
    for (double weight : weights)
        if (weight != 0)
            refuse("%s: Plantcast does not support morph targets: export the model without them", what.c_str());
}

/* Reads a primitive. Returns false if it has no triangles, for example because it consists of lines or points. */
bool read_primitive(gltf_work *w, const tinygltf::Primitive &p, gltf_primitive *out, gltf_mesh *mesh, const std::string &what)
{
    int mode = p.mode;
    if (mode == TINYGLTF_MODE_POINTS || mode == TINYGLTF_MODE_LINE || mode == TINYGLTF_MODE_LINE_LOOP || mode == TINYGLTF_MODE_LINE_STRIP) {
        (mode == TINYGLTF_MODE_POINTS ? mesh->skipped_points : mesh->skipped_lines)++;
        return false;
    }
    if (mode < 0 || mode > TINYGLTF_MODE_TRIANGLE_FAN)
        refuse("invalid glTF file: %s: primitive mode %d does not exist in glTF 2.0", what.c_str(), mode);
    auto position = p.attributes.find("POSITION");
    if (position == p.attributes.end())
        refuse("invalid glTF file: %s has no attribute POSITION", what.c_str());
    size_t vertices = accessor(*w, position->second, 3, what + ": POSITION").count();
    std::vector<uint32_t> indices = triangle_list(read_indices(w, p, vertices, what), mode, what), used = compact(&indices);
    if (indices.empty())
        return false;
    take_elements(w, used.size() + indices.size(), what);
    out->material = p.material;
    out->vertex_count = static_cast<uint32_t>(used.size());
    out->index_count = static_cast<uint32_t>(indices.size());
    out->indices = new_array<uint32_t>(indices.size());
    memcpy(out->indices, indices.data(), indices.size() * sizeof(uint32_t));
    mesh->index_count += indices.size();
    read_vertices(w, { *w, p, used, vertices, what }, out, p.material);
    return true;
}

} // namespace

void read_meshes(gltf_work *w)
{
    gltf_model *model = w->model;
    size_t primitives = 0;
    for (const tinygltf::Mesh &mesh : w->parsed.meshes)
        primitives += mesh.primitives.size();
    model->meshes = new_array<gltf_mesh>(w->parsed.meshes.size() + 1);
    model->primitives = new_array<gltf_primitive>(primitives + 1);
    for (const tinygltf::Mesh &mesh : w->parsed.meshes) {
        std::string name = "mesh " + std::to_string(model->mesh_count) + (mesh.name.empty() ? "" : " '" + mesh.name.substr(0, 80) + "'");
        gltf_mesh *out = &model->meshes[model->mesh_count++];
        out->name = mem_strdup(mesh.name.c_str());
        out->first_primitive = model->primitive_count;
        check_morphing(mesh.weights, name);
        for (size_t i = 0; i < mesh.primitives.size(); i++) {
            gltf_primitive *primitive = &model->primitives[model->primitive_count];
            model->primitive_count++; /* count the primitive before reading it, so that gltf_free() also frees a partially read one */
            if (!read_primitive(w, mesh.primitives[i], primitive, out, name + ", primitive " + std::to_string(i)))
                model->primitive_count--;
        }
        out->primitive_count = model->primitive_count - out->first_primitive;
        model->skipped_lines += out->skipped_lines;
        model->skipped_points += out->skipped_points;
    }
}

} // namespace gltf
