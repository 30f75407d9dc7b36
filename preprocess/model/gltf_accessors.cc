/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads glTF accessors: all component types, normalised, strided and sparse. */
#include "preprocess/model/gltf_impl.hh"

#include <algorithm>
#include <cmath>

namespace gltf
{
namespace
{

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

/* Returns the memory of `count` elements of `element` bytes each, at byte `offset` of a buffer view, with the view's stride or
 * tightly packed. model_document.h guarantees that buffer views lie within their buffers. */
byte_span view_span(const gltf_work &w, int number, uint64_t offset, uint64_t element, uint64_t count, bool strided,
                    const std::string &what)
{
    if (number < 0 || static_cast<size_t>(number) >= w.parsed.bufferViews.size())
        refuse("invalid glTF file: %s refers to bufferView %d, which does not exist", what.c_str(), number);
    const tinygltf::BufferView &view = w.parsed.bufferViews[static_cast<size_t>(number)];
    const document_bytes &buffer = w.document->buffers[view.buffer];
    uint64_t stride = strided && view.byteStride ? view.byteStride : element;
    if (stride < element)
        refuse("invalid glTF file: %s: byteStride %llu of bufferView %d is less than an element's %llu bytes", what.c_str(),
               static_cast<unsigned long long>(stride), number, static_cast<unsigned long long>(element));
    if (count > view.byteLength)
        refuse("invalid glTF file: %s: %llu elements do not fit into the %zu bytes of bufferView %d", what.c_str(),
               static_cast<unsigned long long>(count), view.byteLength, number);
    if (count > 0 && (offset > view.byteLength || (count - 1) * stride + element > view.byteLength - offset))
        refuse("invalid glTF file: %s: %llu elements do not fit into bufferView %d of %zu bytes", what.c_str(),
               static_cast<unsigned long long>(count), number, view.byteLength);
    return { buffer.at + view.byteOffset + offset, static_cast<size_t>(stride), static_cast<size_t>(count) };
}

} // namespace

accessor::accessor(const gltf_work &w, int number, int width, const std::string &about) : what(about), values{ nullptr, 0, 0 }
{
    const tinygltf::Accessor &a = w.parsed.accessors.at(static_cast<size_t>(number));
    int has = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(a.type));
    type = a.componentType;
    normalized = a.normalized;
    wanted = width ? width : has;
    size_t element = component_bytes(type) * static_cast<size_t>(has);
    if (component_bytes(type) == 0)
        refuse("invalid glTF file: %s has component type %d, which does not exist in glTF 2.0", what.c_str(), type);
    if (has != wanted)
        refuse("invalid glTF file: %s has %d components, expected %d", what.c_str(), has, wanted);
    base = view_span(w, a.bufferView, a.byteOffset, element, a.count, true, what);
    if (!a.sparse.isSparse)
        return;
    int index_type = a.sparse.indices.componentType;
    size_t count = static_cast<size_t>(a.sparse.count), index_bytes = component_bytes(index_type);
    if (count > a.count || index_bytes == 0 || index_type == TINYGLTF_COMPONENT_TYPE_FLOAT || index_type == TINYGLTF_COMPONENT_TYPE_BYTE ||
        index_type == TINYGLTF_COMPONENT_TYPE_SHORT)
        refuse("invalid glTF file: %s: sparse accessor with %zu of %zu elements and indices of component type %d", what.c_str(), count,
               a.count, index_type);
    byte_span places =
        view_span(w, a.sparse.indices.bufferView, static_cast<uint64_t>(a.sparse.indices.byteOffset), index_bytes, count, false, what);
    values = view_span(w, a.sparse.values.bufferView, static_cast<uint64_t>(a.sparse.values.byteOffset), element, count, false, what);
    for (size_t i = 0; i < count; i++) {
        size_t place = integer(places.bytes + i * index_bytes, index_type);
        if (place >= a.count || (i > 0 && place <= replaced.back().first))
            refuse("invalid glTF file: %s: sparse accessor: the index of element %zu of %zu is out of range or out of order", what.c_str(),
                   place, a.count);
        replaced.emplace_back(place, i);
    }
}

void accessor::get(size_t element, double *out) const
{
    const unsigned char *from = base.bytes + element * base.stride;
    auto found = std::lower_bound(replaced.begin(), replaced.end(), std::make_pair(element, static_cast<size_t>(0)));
    if (found != replaced.end() && found->first == element)
        from = values.bytes + found->second * values.stride;
    for (int c = 0; c < wanted; c++) {
        out[c] = component(from + static_cast<size_t>(c) * component_bytes(type), type, normalized);
        if (!std::isfinite(out[c]))
            refuse("invalid glTF file: %s: element %zu is infinite or not a number", what.c_str(), element);
    }
}

void take_elements(gltf_work *w, uint64_t count, const std::string &what)
{
    if (count > w->elements_left)
        refuse("invalid glTF file: %s: %llu elements cannot be in a file of %zu bytes", what.c_str(),
               static_cast<unsigned long long>(count), w->document->total_bytes);
    w->elements_left -= count;
}

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

} // namespace gltf
