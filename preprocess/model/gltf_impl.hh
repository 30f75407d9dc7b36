/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declarations shared by the files of the glTF shim (gltf_*.cc). */
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
#include "base/text/utf8.h"
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

struct gltf_work { /* state while a model is read */
    const model_document *document;
    tinygltf::Model parsed;
    gltf_model *model;
    /* number of accessor elements that may still be read; limits small files that refer to the same data over and over */
    uint64_t elements_left;
};

/* a strided range of accessor elements in memory, already checked to be within its buffer */
struct byte_span {
    const unsigned char *bytes;
    size_t stride, count;
};

/* Reads the numbers of a glTF accessor, one element at a time. */
class accessor
{
  public:
    /* width: number of components to read per element; 0: all that the accessor has */
    accessor(const gltf_work &w, int number, int width, const std::string &what);
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
    void get(size_t element, double *out) const; /* reads the components of one element; throws gltf_refusal if a number is not finite */

  private:
    std::string what;
    int type, wanted;
    bool normalized;
    byte_span base, values;
    /* replacements of a sparse accessor, sorted: index of the element, and index of its new value in `values` */
    std::vector<std::pair<size_t, size_t>> replaced;
};

void take_elements(gltf_work *w, uint64_t count, const std::string &what);
double number_in(const tinygltf::Value &value, const char *key, size_t index, double otherwise);

/* How a material's textures are mapped to texture coordinates (KHR_texture_transform). */
struct uv_transform {
    double offset[2] = { 0, 0 }, scale[2] = { 1, 1 }, rotation = 0;
    int set = 0;          /* number n of the attribute TEXCOORD_n that holds the coordinates */
    /* true: the mapping is valid only for coordinates in 0..1, because the texture's wrapping outside that range cannot be drawn */
    bool bounded = false;
};
enum { BASE_COLOR, METALLIC_ROUGHNESS, NORMAL, OCCLUSION, EMISSIVE, USE_COUNT }; /* purposes for which a material can use a texture */

/* The distinct mappings (texture transforms) of a material's textures: at most two, because a vertex stores two texture coordinates. */
struct uv_lays {
    uv_transform at[2];
    size_t count = 0;
    /* by use of a texture: index of its mapping in at[]; 2: the texture is ignored; 0 if the material has no such texture */
    size_t of[USE_COUNT] = {};
};
uv_lays lays_of(const tinygltf::Model &m, int material);

/* Appends a text about content of the model that is not drawn to the model's left_out. read_materials() must have allocated the list. */
void leave_out(gltf_work *w, const std::string &text);
void read_materials(gltf_work *w);
/* Removes from a material the textures with mapping `lay` (uv_lays) that cannot be drawn outside 0..1, and appends a text about each to the
 * model's left_out. */
void leave_out_bounded(gltf_work *w, int material, size_t lay);
void read_nodes(gltf_work *w);
void read_meshes(gltf_work *w);

} // namespace gltf
