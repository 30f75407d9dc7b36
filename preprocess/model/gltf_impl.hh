/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the glTF shim (gltf_*.cc). */
#pragma once
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <tiny_gltf.h>
#include <vector>

#include "preprocess/model/gltf_shim.h"
#include "preprocess/model/model_document.h"

extern "C" {
#include "base/mem.h"
}

namespace gltf
{

struct gltf_refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

[[noreturn]] void refuse(const char *fmt, ...) __attribute__((format(printf, 1, 2)));

template <typename T> T *new_array(size_t count)
{
    T *array = static_cast<T *>(mem_try_array(count, sizeof(T)));
    if (!array)
        throw std::bad_alloc();
    return array;
}

struct gltf_work { /* a model in the making */
    const model_document *document;
    tinygltf::Model parsed;
    gltf_model *model;
    uint64_t elements_left; /* so that a small file cannot claim a great model by naming the same numbers again and again */
};

/* Where numbers lie that were checked to be there. */
struct byte_span {
    const unsigned char *bytes;
    size_t stride, count;
};

/* An accessor's numbers, one element at a time. */
class accessor
{
  public:
    accessor(const gltf_work &w, int number, int width, const std::string &what); /* width 0: all that it has */
    size_t count() const
    {
        return base.count;
    }
    int width() const
    {
        return wanted;
    }
    int component_type() const
    {
        return type;
    }
    bool is_normalized() const
    {
        return normalized;
    }
    void get(size_t element, double *out) const; /* finite, or refused */

  private:
    std::string what;
    int type, wanted;
    bool normalized;
    byte_span base, values;
    std::vector<std::pair<size_t, size_t>> replaced; /* element, where in values; sorted */
};

void take_elements(gltf_work *w, uint64_t count, const std::string &what);
double number_in(const tinygltf::Value &value, const char *key, size_t index, double otherwise);

/* How a material's textures lie on the surface (KHR_texture_transform). */
struct uv_transform {
    double offset[2] = { 0, 0 }, scale[2] = { 1, 1 }, rotation = 0;
    int set = 0;          /* TEXCOORD_n */
    bool bounded = false; /* right only inside 0..1: how it goes on beyond cannot be drawn */
};
enum { BASE_COLOR, METALLIC_ROUGHNESS, NORMAL, OCCLUSION, EMISSIVE, USE_COUNT }; /* of textures, by a material */

/* The ways in which a material's textures lie on the surface: a vertex keeps two places on them. */
struct uv_lays {
    uv_transform at[2];
    size_t count = 0;
    size_t of[USE_COUNT] = {}; /* for each use which of them; 2: left out. Of textures that are not there: 0 */
};
uv_lays lays_of(const tinygltf::Model &m, int material);

/* Notes what is not shown. read_materials() makes room. */
void leave_out(gltf_work *w, const std::string &text);
void read_materials(gltf_work *w);
/* Takes those textures out of a material that lie in this way and cannot be drawn beyond 0..1, and says so. */
void leave_out_bounded(gltf_work *w, int material, size_t lay);
void read_nodes(gltf_work *w);
void read_meshes(gltf_work *w);

} // namespace gltf
