/* SPDX-License-Identifier: GPL-3.0-or-later */
/* tinygltf behind plain C: it parses; whatever it trusts is checked here, and decoded into plain arrays. */
#include "preprocess/gltf_shim.h"

#include <cmath>
#include <cstdarg>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>
#include <tiny_gltf.h>
#include <vector>

extern "C" {
#include "base/mem.h"
#include "base/text.h"
}

namespace
{

constexpr uint32_t MAX_NODES = 4'000'000, MAX_DEPTH = 512;
constexpr uint64_t MAX_ELEMENTS = 1u << 30; /* vertices or indices of one accessor */

/* Extensions that a file may require: those that change the look only, or are done here. */
const char *const known_extensions[] = {
    "KHR_mesh_quantization",           "KHR_texture_transform", "EXT_mesh_gpu_instancing", "KHR_lights_punctual",     "KHR_materials_unlit",
    "KHR_materials_emissive_strength", "KHR_materials_ior",     "KHR_materials_specular",  "KHR_materials_clearcoat", "KHR_materials_sheen",
    "KHR_materials_transmission",      "KHR_materials_volume",  "KHR_materials_variants",  "KHR_xmp_json_ld",
};

struct refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

[[noreturn]] void refuse(const char *fmt, ...) __attribute__((format(printf, 1, 2)));
void refuse(const char *fmt, ...)
{
    char text[MODEL_WHY_BYTES];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    throw refusal(text);
}

template <typename T> T *new_array(size_t count)
{
    T *array = static_cast<T *>(mem_try_array(count, sizeof(T)));
    if (!array)
        throw std::bad_alloc();
    return array;
}

/* --- files: only from the model's folder --------------------------------------------------------------------------------- */

bool file_exists(const std::string &name, void *user)
{
    char *path = model_source_resolve(static_cast<const model_source *>(user)->folder, name.c_str());
    free(path);
    return path != nullptr;
}

std::string file_expand(const std::string &name, void *)
{
    return name;
}

bool file_read(std::vector<unsigned char> *out, std::string *error, const std::string &name, void *user)
{
    char *path = model_source_resolve(static_cast<const model_source *>(user)->folder, name.c_str());
    size_t size = 0;
    char *bytes = path ? text_read_file(path, MODEL_MAX_BYTES, &size) : nullptr;
    if (bytes)
        out->assign(bytes, bytes + size);
    else if (error)
        *error += "'" + name + "' cannot be read, or lies outside the model's folder\n";
    bool good = bytes != nullptr;
    mem_free(bytes);
    free(path);
    return good;
}

bool file_write(std::string *, const std::string &, const std::vector<unsigned char> &, void *)
{
    return false;
}

/* Images are kept as they are and decoded by OpenImageIO (image_shim.cc) when an asset needs them. */
bool image_keep(tinygltf::Image *image, const int, std::string *, std::string *, int, int, const unsigned char *bytes, int size, void *)
{
    image->image.assign(bytes, bytes + size);
    image->as_is = true;
    return true;
}

void parse(tinygltf::Model *parsed, const model_source *source)
{
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    model_source *user = const_cast<model_source *>(source);
    loader.SetImageLoader(image_keep, nullptr);
    loader.SetFsCallbacks({ file_exists, file_expand, file_read, file_write, user });
    if (source->size > std::numeric_limits<unsigned>::max())
        refuse("%zu bytes: larger than a glTF file can be", source->size);
    unsigned size = static_cast<unsigned>(source->size);
    bool good = source->binary ? loader.LoadBinaryFromMemory(parsed, &error, &warning, source->bytes, size, source->folder)
                               : loader.LoadASCIIFromString(parsed, &error, &warning, reinterpret_cast<const char *>(source->bytes), size,
                                                            source->folder);
    while (!error.empty() && error.back() == '\n')
        error.pop_back();
    if (!good)
        refuse("%s", error.empty() ? "not a glTF file" : error.c_str());
}

void check_extensions(const tinygltf::Model &parsed)
{
    for (const std::string &required : parsed.extensionsRequired) {
        bool known = false;
        for (const char *name : known_extensions)
            known = known || required == name;
        if (!known)
            refuse("requires the extension %s, which is not supported", required.c_str());
    }
}

/* --- accessors ----------------------------------------------------------------------------------------------------------- */

struct span { /* checked: element i lies at bytes + i * stride */
    const unsigned char *bytes;
    size_t stride, count;
};

/* count elements of `element` bytes at `offset` in a buffer view. */
span view_span(const tinygltf::Model &m, int view_number, uint64_t offset, uint64_t element, uint64_t count, uint64_t stride,
               const std::string &what)
{
    if (view_number < 0 || static_cast<size_t>(view_number) >= m.bufferViews.size())
        refuse("%s: there is no bufferView %d", what.c_str(), view_number);
    const tinygltf::BufferView &view = m.bufferViews[static_cast<size_t>(view_number)];
    if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= m.buffers.size())
        refuse("%s: bufferView %d: there is no buffer %d", what.c_str(), view_number, view.buffer);
    const std::vector<unsigned char> &data = m.buffers[static_cast<size_t>(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        refuse("%s: bufferView %d: bytes %zu+%zu of a buffer of %zu", what.c_str(), view_number, view.byteOffset, view.byteLength,
               data.size());
    if (count > 0 && (offset > view.byteLength || (count - 1) * stride + element > view.byteLength - offset))
        refuse("%s: %llu elements do not fit into bufferView %d of %zu bytes", what.c_str(), static_cast<unsigned long long>(count),
               view_number, view.byteLength);
    return { data.data() + view.byteOffset + offset, static_cast<size_t>(stride), static_cast<size_t>(count) };
}

size_t component_bytes(int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
    default: return 0;
    }
}

template <typename T> T load(const unsigned char *at)
{
    T value;
    memcpy(&value, at, sizeof(value));
    return value;
}

double component(const unsigned char *at, int type, bool normalized)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return normalized ? std::fmax(load<int8_t>(at) / 127.0, -1) : load<int8_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return normalized ? *at / 255.0 : *at;
    case TINYGLTF_COMPONENT_TYPE_SHORT: return normalized ? std::fmax(load<int16_t>(at) / 32767.0, -1) : load<int16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return normalized ? load<uint16_t>(at) / 65535.0 : load<uint16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return load<uint32_t>(at);
    default: return static_cast<double>(load<float>(at));
    }
}

uint32_t integer(const unsigned char *at, int type)
{
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? *at
           : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? load<uint16_t>(at)
                                                            : load<uint32_t>(at);
}

const tinygltf::Accessor &accessor_at(const tinygltf::Model &m, int number, const std::string &what)
{
    if (number < 0 || static_cast<size_t>(number) >= m.accessors.size())
        refuse("%s: there is no accessor %d", what.c_str(), number);
    const tinygltf::Accessor &a = m.accessors[static_cast<size_t>(number)];
    if (a.count > MAX_ELEMENTS)
        refuse("%s: %zu elements are more than %llu", what.c_str(), a.count, static_cast<unsigned long long>(MAX_ELEMENTS));
    if (component_bytes(a.componentType) == 0)
        refuse("%s: component type %d is not of glTF 2.0", what.c_str(), a.componentType);
    return a;
}

void read_sparse(const tinygltf::Model &m, const tinygltf::Accessor &a, int width, std::vector<double> *out, const std::string &what)
{
    int index_type = a.sparse.indices.componentType;
    if (a.sparse.count < 0 || static_cast<size_t>(a.sparse.count) > a.count || a.sparse.indices.byteOffset < 0 ||
        a.sparse.values.byteOffset < 0 || component_bytes(index_type) == 0 || index_type == TINYGLTF_COMPONENT_TYPE_FLOAT)
        refuse("%s: sparse: %d of %zu elements, or a wrong offset or type", what.c_str(), a.sparse.count, a.count);
    size_t count = static_cast<size_t>(a.sparse.count), element = component_bytes(a.componentType) * static_cast<size_t>(width),
           index_bytes = component_bytes(index_type);
    span places = view_span(m, a.sparse.indices.bufferView, static_cast<uint64_t>(a.sparse.indices.byteOffset), index_bytes, count,
                            index_bytes, what);
    span values =
        view_span(m, a.sparse.values.bufferView, static_cast<uint64_t>(a.sparse.values.byteOffset), element, count, element, what);
    for (size_t i = 0; i < count; i++) {
        size_t place = integer(places.bytes + i * index_bytes, index_type);
        if (place >= a.count)
            refuse("%s: sparse: element %zu of %zu", what.c_str(), place, a.count);
        for (int c = 0; c < width; c++)
            (*out)[place * static_cast<size_t>(width) + static_cast<size_t>(c)] =
                component(values.bytes + i * element + static_cast<size_t>(c) * component_bytes(a.componentType), a.componentType,
                          a.normalized);
    }
}

/* width numbers of each element, as doubles. */
std::vector<double> read_numbers(const tinygltf::Model &m, int number, int width, const std::string &what)
{
    const tinygltf::Accessor &a = accessor_at(m, number, what);
    int has = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(a.type));
    if (has < width)
        refuse("%s: %d components, expected %d", what.c_str(), has, width);
    size_t w = static_cast<size_t>(width), bytes = component_bytes(a.componentType), element = bytes * static_cast<size_t>(has);
    std::vector<double> out(a.count * w, 0.0);
    if (a.bufferView >= 0) {
        size_t stride =
            static_cast<size_t>(a.bufferView) < m.bufferViews.size() ? m.bufferViews[static_cast<size_t>(a.bufferView)].byteStride : 0;
        span s = view_span(m, a.bufferView, a.byteOffset, element, a.count, stride ? stride : element, what);
        for (size_t i = 0; i < a.count; i++)
            for (size_t c = 0; c < w; c++)
                out[i * w + c] = component(s.bytes + i * s.stride + c * bytes, a.componentType, a.normalized);
    }
    if (a.sparse.isSparse)
        read_sparse(m, a, width, &out, what);
    for (size_t i = 0; i < out.size(); i++)
        if (!std::isfinite(out[i]))
            refuse("%s: element %zu is not finite", what.c_str(), i / w);
    return out;
}

std::vector<uint32_t> read_indices(const tinygltf::Model &m, int number, uint32_t vertex_count, const std::string &what)
{
    const tinygltf::Accessor &a = accessor_at(m, number, what);
    if (a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
        refuse("%s: component type %d is no index", what.c_str(), a.componentType);
    std::vector<double> numbers = read_numbers(m, number, 1, what);
    std::vector<uint32_t> out(numbers.size());
    for (size_t i = 0; i < out.size(); i++) {
        if (numbers[i] >= vertex_count)
            refuse("%s: index %zu names vertex %.0f of %u", what.c_str(), i, numbers[i], vertex_count);
        out[i] = static_cast<uint32_t>(numbers[i]);
    }
    return out;
}

/* --- meshes -------------------------------------------------------------------------------------------------------------- */

std::vector<uint32_t> triangle_list(const std::vector<uint32_t> &in, int mode, const std::string &what)
{
    std::vector<uint32_t> out;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        if (in.size() % 3 != 0)
            refuse("%s: %zu indices are not whole triangles", what.c_str(), in.size());
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

struct uv_transform {
    double offset[2] = { 0, 0 }, scale[2] = { 1, 1 }, rotation = 0;
    int set = 0; /* TEXCOORD_n */
};

double number_in(const tinygltf::Value &value, const char *key, size_t index, double otherwise)
{
    if (!value.IsObject() || !value.Has(key))
        return otherwise;
    const tinygltf::Value &entry = value.Get(key);
    if (entry.IsArray())
        return index < entry.ArrayLen() && entry.Get(static_cast<int>(index)).IsNumber()
                   ? entry.Get(static_cast<int>(index)).GetNumberAsDouble()
                   : otherwise;
    return entry.IsNumber() ? entry.GetNumberAsDouble() : otherwise;
}

/* KHR_texture_transform of the base colour, which the whole material then follows. */
uv_transform uv_of(const tinygltf::Model &m, int material)
{
    uv_transform uv;
    if (material < 0)
        return uv;
    const tinygltf::TextureInfo &info = m.materials[static_cast<size_t>(material)].pbrMetallicRoughness.baseColorTexture;
    uv.set = info.index >= 0 ? info.texCoord : 0;
    auto found = info.extensions.find("KHR_texture_transform");
    if (found == info.extensions.end())
        return uv;
    for (size_t i = 0; i < 2; i++) {
        uv.offset[i] = number_in(found->second, "offset", i, 0);
        uv.scale[i] = number_in(found->second, "scale", i, 1);
    }
    uv.rotation = number_in(found->second, "rotation", 0, 0);
    uv.set = static_cast<int>(number_in(found->second, "texCoord", 0, uv.set));
    return uv;
}

float (*read_vectors(const tinygltf::Model &m, int number, uint32_t vertex_count, const std::string &what))[3]
{
    std::vector<double> numbers = read_numbers(m, number, 3, what);
    if (numbers.size() != 3u * vertex_count)
        refuse("%s: %zu elements, positions have %u", what.c_str(), numbers.size() / 3, vertex_count);
    float(*out)[3] = reinterpret_cast<float(*)[3]>(new_array<float>(numbers.size()));
    for (size_t i = 0; i < numbers.size(); i++)
        out[i / 3][i % 3] = static_cast<float>(numbers[i]);
    return out;
}

float (*read_texcoords(const tinygltf::Model &m, int number, uint32_t vertex_count, const uv_transform &uv, const std::string &what))[2]
{
    std::vector<double> numbers = read_numbers(m, number, 2, what);
    if (numbers.size() != 2u * vertex_count)
        refuse("%s: %zu elements, positions have %u", what.c_str(), numbers.size() / 2, vertex_count);
    float(*out)[2] = reinterpret_cast<float(*)[2]>(new_array<float>(numbers.size()));
    double c = std::cos(uv.rotation), s = std::sin(uv.rotation);
    for (size_t i = 0; i < vertex_count; i++) {
        double u = numbers[2 * i] * uv.scale[0], v = numbers[2 * i + 1] * uv.scale[1];
        out[i][0] = static_cast<float>(c * u + s * v + uv.offset[0]);
        out[i][1] = static_cast<float>(-s * u + c * v + uv.offset[1]);
    }
    return out;
}

uint8_t (*read_colors(const tinygltf::Model &m, int number, uint32_t vertex_count, const std::string &what))[4]
{
    const tinygltf::Accessor &a = accessor_at(m, number, what);
    int width = a.type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
    std::vector<double> numbers = read_numbers(m, number, width, what);
    if (numbers.size() != static_cast<size_t>(width) * vertex_count)
        refuse("%s: %zu elements, positions have %u", what.c_str(), numbers.size() / static_cast<size_t>(width), vertex_count);
    uint8_t(*out)[4] = reinterpret_cast<uint8_t(*)[4]>(new_array<uint8_t>(4u * vertex_count));
    for (size_t i = 0; i < vertex_count; i++)
        for (size_t c = 0; c < 4; c++) {
            double value = c < static_cast<size_t>(width) ? numbers[i * static_cast<size_t>(width) + c] : 1;
            out[i][c] = static_cast<uint8_t>(std::lround(std::fmin(std::fmax(value, 0), 1) * 255));
        }
    return out;
}

int attribute(const tinygltf::Primitive &p, const std::string &name)
{
    auto found = p.attributes.find(name);
    return found == p.attributes.end() ? -1 : found->second;
}

/* False: nothing to draw here (lines, points). */
bool read_primitive(const tinygltf::Model &m, const tinygltf::Primitive &p, gltf_primitive *out, gltf_model *model, const std::string &what)
{
    int mode = p.mode < 0 ? TINYGLTF_MODE_TRIANGLES : p.mode;
    if (mode == TINYGLTF_MODE_POINTS || mode == TINYGLTF_MODE_LINE || mode == TINYGLTF_MODE_LINE_LOOP || mode == TINYGLTF_MODE_LINE_STRIP) {
        (mode == TINYGLTF_MODE_POINTS ? model->skipped_points : model->skipped_lines)++;
        return false;
    }
    if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
        refuse("%s: mode %d is not of glTF 2.0", what.c_str(), mode);
    for (const auto &extension : p.extensions)
        if (extension.first == "KHR_draco_mesh_compression")
            refuse("%s: compressed with %s, which is not supported", what.c_str(), extension.first.c_str());
    int position = attribute(p, "POSITION");
    if (position < 0)
        refuse("%s: has no POSITION", what.c_str());
    size_t vertices = accessor_at(m, position, what + ": POSITION").count;
    out->vertex_count = static_cast<uint32_t>(vertices);
    out->material = p.material;
    if (p.material < -1 || (p.material >= 0 && static_cast<size_t>(p.material) >= m.materials.size()))
        refuse("%s: there is no material %d", what.c_str(), p.material);
    out->positions = read_vectors(m, position, out->vertex_count, what + ": POSITION");
    if (attribute(p, "NORMAL") >= 0)
        out->normals = read_vectors(m, attribute(p, "NORMAL"), out->vertex_count, what + ": NORMAL");
    uv_transform uv = uv_of(m, p.material);
    std::string set = "TEXCOORD_" + std::to_string(uv.set);
    if (attribute(p, set) >= 0)
        out->texcoords = read_texcoords(m, attribute(p, set), out->vertex_count, uv, what + ": " + set);
    if (attribute(p, "COLOR_0") >= 0)
        out->colors = read_colors(m, attribute(p, "COLOR_0"), out->vertex_count, what + ": COLOR_0");
    std::vector<uint32_t> indices;
    if (p.indices >= 0) {
        indices = read_indices(m, p.indices, out->vertex_count, what + ": indices");
    } else {
        indices.resize(vertices);
        for (size_t i = 0; i < vertices; i++)
            indices[i] = static_cast<uint32_t>(i);
    }
    indices = triangle_list(indices, mode, what);
    out->index_count = static_cast<uint32_t>(indices.size());
    out->indices = new_array<uint32_t>(indices.size());
    if (!indices.empty())
        memcpy(out->indices, indices.data(), indices.size() * sizeof(uint32_t));
    return true;
}

void read_meshes(const tinygltf::Model &m, gltf_model *model)
{
    size_t primitives = 0;
    for (const tinygltf::Mesh &mesh : m.meshes)
        primitives += mesh.primitives.size();
    model->meshes = new_array<gltf_mesh>(m.meshes.size());
    model->primitives = new_array<gltf_primitive>(primitives);
    for (const tinygltf::Mesh &mesh : m.meshes) {
        uint32_t number = model->mesh_count++; /* counted first, here and below, so that what is half read is freed */
        gltf_mesh *out = &model->meshes[number];
        out->name = mem_strdup(mesh.name.c_str());
        out->first_primitive = model->primitive_count;
        for (size_t i = 0; i < mesh.primitives.size(); i++) {
            std::string what = "mesh " + std::to_string(number) + " '" + mesh.name.substr(0, 80) + "', primitive " + std::to_string(i);
            gltf_primitive *primitive = &model->primitives[model->primitive_count++];
            if (!read_primitive(m, mesh.primitives[i], primitive, model, what))
                model->primitive_count--;
        }
        out->primitive_count = model->primitive_count - out->first_primitive;
    }
}

/* --- nodes --------------------------------------------------------------------------------------------------------------- */

void multiply(const double a[16], const double b[16], double out[16])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            double sum = 0;
            for (int k = 0; k < 4; k++)
                sum += a[4 * k + r] * b[4 * c + k];
            out[4 * c + r] = sum;
        }
}

void compose(const double t[3], const double q[4], const double s[3], double out[16])
{
    double x = q[0], y = q[1], z = q[2], w = q[3], n = x * x + y * y + z * z + w * w, k = n > 0 ? 2 / n : 0;
    const double r[9] = { 1 - k * (y * y + z * z), k * (x * y + w * z),     k * (x * z - w * y),
                          k * (x * y - w * z),     1 - k * (x * x + z * z), k * (y * z + w * x),
                          k * (x * z + w * y),     k * (y * z - w * x),     1 - k * (x * x + y * y) };
    for (int c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++)
            out[4 * c + i] = r[3 * c + i] * s[c];
    out[3] = out[7] = out[11] = 0;
    for (int i = 0; i < 3; i++)
        out[12 + i] = t[i];
    out[15] = 1;
}

void take(const std::vector<double> &from, size_t count, double *to, const std::string &what)
{
    if (from.empty())
        return;
    if (from.size() != count)
        refuse("%s: %zu numbers in its transform, expected %zu", what.c_str(), from.size(), count);
    for (size_t i = 0; i < count; i++)
        to[i] = from[i];
}

void local_of(const tinygltf::Node &node, double out[16], const std::string &what)
{
    double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
    take(node.translation, 3, t, what);
    take(node.rotation, 4, q, what);
    take(node.scale, 3, s, what);
    compose(t, q, s, out);
    take(node.matrix, 16, out, what);
    for (int i = 0; i < 16; i++)
        if (!std::isfinite(out[i]))
            refuse("%s: its transform is not finite", what.c_str());
}

struct tree { /* nodes as they are put in order */
    const tinygltf::Model *m;
    std::vector<gltf_node> out;
    std::vector<char> seen;
};

std::string node_what(const tinygltf::Model &m, int number)
{
    return "node " + std::to_string(number) + " '" + m.nodes[static_cast<size_t>(number)].name.substr(0, 80) + "'";
}

void add(tree *tree, const std::string &name, int parent, int mesh, const double world[16])
{
    if (tree->out.size() >= MAX_NODES)
        refuse("more than %u nodes", MAX_NODES);
    gltf_node node = {};
    node.name = mem_strdup(name.c_str());
    node.parent = parent;
    node.mesh = mesh;
    memcpy(node.world, world, sizeof(node.world));
    tree->out.push_back(node);
}

/* EXT_mesh_gpu_instancing: the node's mesh once for each instance, as nodes of the same name below it. */
void add_instances(tree *tree, int number, int parent, const tinygltf::Value &extension)
{
    const tinygltf::Model &m = *tree->m;
    const tinygltf::Node &node = m.nodes[static_cast<size_t>(number)];
    const tinygltf::Value none, &attributes = extension.IsObject() && extension.Has("attributes") ? extension.Get("attributes") : none;
    std::string what = node_what(m, number) + ": EXT_mesh_gpu_instancing";
    const char *const names[3] = { "TRANSLATION", "ROTATION", "SCALE" };
    const int widths[3] = { 3, 4, 3 };
    std::vector<double> values[3];
    size_t count = 0;
    for (int i = 0; i < 3; i++) {
        double accessor = number_in(attributes, names[i], 0, -1);
        if (accessor < 0)
            continue;
        values[i] = read_numbers(m, static_cast<int>(accessor), widths[i], what + ": " + names[i]);
        size_t has = values[i].size() / static_cast<size_t>(widths[i]);
        if (count && has != count)
            refuse("%s: %zu and %zu instances", what.c_str(), count, has);
        count = has;
    }
    for (size_t i = 0; i < count; i++) {
        double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 }, local[16], world[16];
        double *const parts[3] = { t, q, s };
        for (int p = 0; p < 3; p++)
            for (size_t c = 0; c < static_cast<size_t>(widths[p]) && !values[p].empty(); c++)
                parts[p][c] = values[p][i * static_cast<size_t>(widths[p]) + c];
        compose(t, q, s, local);
        multiply(tree->out[static_cast<size_t>(parent)].world, local, world);
        add(tree, node.name, parent, node.mesh, world);
        tree->out.back().end = static_cast<uint32_t>(tree->out.size());
    }
}

void walk(tree *tree, int number, int parent, const double parent_world[16], uint32_t depth)
{
    const tinygltf::Model &m = *tree->m;
    if (number < 0 || static_cast<size_t>(number) >= m.nodes.size())
        refuse("there is no node %d, which is named as a child or root", number);
    std::string what = node_what(m, number);
    if (tree->seen[static_cast<size_t>(number)])
        refuse("%s is reached twice: a cycle, or two parents", what.c_str());
    if (depth > MAX_DEPTH)
        refuse("%s: nodes are nested deeper than %u levels", what.c_str(), MAX_DEPTH);
    tree->seen[static_cast<size_t>(number)] = 1;
    const tinygltf::Node &node = m.nodes[static_cast<size_t>(number)];
    if (node.mesh < -1 || (node.mesh >= 0 && static_cast<size_t>(node.mesh) >= m.meshes.size()))
        refuse("%s: there is no mesh %d", what.c_str(), node.mesh);
    double local[16], world[16];
    local_of(node, local, what);
    multiply(parent_world, local, world);
    int self = static_cast<int>(tree->out.size());
    auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
    bool instanced = instancing != node.extensions.end();
    add(tree, node.name, parent, instanced ? -1 : node.mesh, world);
    if (instanced)
        add_instances(tree, number, self, instancing->second);
    for (int child : node.children)
        walk(tree, child, self, world, depth + 1);
    tree->out[static_cast<size_t>(self)].end = static_cast<uint32_t>(tree->out.size());
}

std::vector<int> roots_of(const tinygltf::Model &m)
{
    if (!m.scenes.empty()) {
        size_t scene = m.defaultScene >= 0 ? static_cast<size_t>(m.defaultScene) : 0;
        if (scene >= m.scenes.size())
            refuse("there is no scene %d", m.defaultScene);
        return m.scenes[scene].nodes;
    }
    std::vector<char> child(m.nodes.size(), 0);
    for (const tinygltf::Node &node : m.nodes)
        for (int c : node.children)
            if (c >= 0 && static_cast<size_t>(c) < child.size())
                child[static_cast<size_t>(c)] = 1;
    std::vector<int> roots;
    for (size_t i = 0; i < m.nodes.size(); i++)
        if (!child[i])
            roots.push_back(static_cast<int>(i));
    if (roots.empty() && !m.nodes.empty())
        refuse("every node is a child of another: a cycle");
    return roots;
}

void read_nodes(const tinygltf::Model &m, gltf_model *model)
{
    static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    tree tree = { &m, {}, std::vector<char>(m.nodes.size(), 0) };
    try {
        for (int root : roots_of(m))
            walk(&tree, root, -1, identity, 0);
        model->nodes = new_array<gltf_node>(tree.out.size());
    } catch (...) {
        for (gltf_node &node : tree.out)
            mem_free(node.name);
        throw;
    }
    model->node_count = static_cast<uint32_t>(tree.out.size());
    if (!tree.out.empty())
        memcpy(model->nodes, tree.out.data(), tree.out.size() * sizeof(gltf_node));
}

/* --- materials ----------------------------------------------------------------------------------------------------------- */

uint32_t texture_of(const tinygltf::Model &m, gltf_model *model, int texture, bool srgb, const std::string &what)
{
    if (texture < 0)
        return ASSET_NO_TEXTURE;
    if (static_cast<size_t>(texture) >= m.textures.size())
        refuse("%s: there is no texture %d", what.c_str(), texture);
    const tinygltf::Texture &t = m.textures[static_cast<size_t>(texture)];
    if (t.source < 0 || static_cast<size_t>(t.source) >= m.images.size())
        refuse("%s: texture %d: there is no image %d", what.c_str(), texture, t.source);
    bool repeat = true;
    if (t.sampler >= 0 && static_cast<size_t>(t.sampler) < m.samplers.size())
        repeat = m.samplers[static_cast<size_t>(t.sampler)].wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    gltf_texture wanted = { static_cast<uint32_t>(t.source), srgb, repeat };
    for (uint32_t i = 0; i < model->texture_count; i++)
        if (model->textures[i].image == wanted.image && model->textures[i].srgb == srgb && model->textures[i].wrap_repeat == repeat)
            return i;
    model->textures[model->texture_count] = wanted;
    return model->texture_count++;
}

float unit(double value)
{
    return static_cast<float>(std::fmin(std::fmax(value, 0), 1)); /* also NaN: fmax gives 0 */
}

float finite(double value, double otherwise)
{
    return static_cast<float>(std::isfinite(value) ? value : otherwise);
}

void read_material(const tinygltf::Model &m, const tinygltf::Material &from, asset_material *to, gltf_model *model, const std::string &what)
{
    const tinygltf::PbrMetallicRoughness &pbr = from.pbrMetallicRoughness;
    for (size_t i = 0; i < 4; i++)
        to->base_color[i] = pbr.baseColorFactor.size() == 4 ? unit(pbr.baseColorFactor[i]) : 1;
    for (size_t i = 0; i < 3; i++)
        to->emissive[i] = from.emissiveFactor.size() == 3 ? unit(from.emissiveFactor[i]) : 0;
    to->metallic = unit(pbr.metallicFactor);
    to->roughness = unit(pbr.roughnessFactor);
    to->normal_scale = finite(from.normalTexture.scale, 1);
    to->occlusion_strength = unit(from.occlusionTexture.strength);
    to->alpha_cutoff = finite(from.alphaCutoff, 0.5);
    to->alpha = from.alphaMode == "MASK" ? ASSET_ALPHA_MASK : from.alphaMode == "BLEND" ? ASSET_ALPHA_BLEND : ASSET_ALPHA_OPAQUE;
    to->double_sided = from.doubleSided;
    to->base_color_texture = texture_of(m, model, pbr.baseColorTexture.index, true, what);
    to->metallic_roughness_texture = texture_of(m, model, pbr.metallicRoughnessTexture.index, false, what);
    to->normal_texture = texture_of(m, model, from.normalTexture.index, false, what);
    to->occlusion_texture = texture_of(m, model, from.occlusionTexture.index, false, what);
    to->emissive_texture = texture_of(m, model, from.emissiveTexture.index, true, what);
}

void read_materials(const tinygltf::Model &m, gltf_model *model)
{
    model->images = new_array<gltf_image>(m.images.size());
    for (const tinygltf::Image &image : m.images) {
        gltf_image *out = &model->images[model->image_count++];
        out->name = mem_strdup(image.uri.empty() ? image.name.c_str() : image.uri.c_str());
        out->size = image.image.size();
        out->bytes = new_array<unsigned char>(out->size);
        if (out->size)
            memcpy(out->bytes, image.image.data(), out->size);
    }
    model->materials = new_array<asset_material>(m.materials.size());
    model->material_names = new_array<char *>(m.materials.size());
    model->textures = new_array<gltf_texture>(5 * m.materials.size());
    for (const tinygltf::Material &material : m.materials) {
        std::string what = "material " + std::to_string(model->material_count) + " '" + material.name.substr(0, 80) + "'";
        model->material_names[model->material_count] = mem_strdup(material.name.c_str());
        read_material(m, material, &model->materials[model->material_count++], model, what);
    }
}

} // namespace

extern "C" bool gltf_load(struct gltf_model *model, const struct model_source *source, char why[MODEL_WHY_BYTES])
{
    *model = {};
    try {
        tinygltf::Model parsed;
        parse(&parsed, source);
        check_extensions(parsed);
        read_materials(parsed, model);
        read_nodes(parsed, model);
        read_meshes(parsed, model);
        return true;
    } catch (const std::bad_alloc &) {
        snprintf(why, MODEL_WHY_BYTES, "out of memory");
    } catch (const std::exception &e) {
        snprintf(why, MODEL_WHY_BYTES, "%s", e.what());
    } catch (...) {
        snprintf(why, MODEL_WHY_BYTES, "the glTF library failed");
    }
    gltf_free(model);
    return false;
}

extern "C" void gltf_free(struct gltf_model *model)
{
    for (uint32_t i = 0; i < model->primitive_count; i++) {
        mem_free(model->primitives[i].positions);
        mem_free(model->primitives[i].normals);
        mem_free(model->primitives[i].texcoords);
        mem_free(model->primitives[i].colors);
        mem_free(model->primitives[i].indices);
    }
    for (uint32_t i = 0; i < model->mesh_count; i++)
        mem_free(model->meshes[i].name);
    for (uint32_t i = 0; i < model->node_count; i++)
        mem_free(model->nodes[i].name);
    for (uint32_t i = 0; i < model->material_count; i++)
        mem_free(model->material_names[i]);
    for (uint32_t i = 0; i < model->image_count; i++) {
        mem_free(model->images[i].name);
        mem_free(model->images[i].bytes);
    }
    mem_free(model->primitives);
    mem_free(model->meshes);
    mem_free(model->nodes);
    mem_free(model->materials);
    mem_free(model->material_names);
    mem_free(model->textures);
    mem_free(model->images);
    *model = {};
}
