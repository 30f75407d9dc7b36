/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads glTF materials and the images of their textures. */
#include "preprocess/model/gltf_impl.hh"

#include <array>
#include <cmath>
#include <cstring>

namespace gltf
{
namespace
{

struct use { /* a texture's role in a material, such as the base colour */
    int texture, set;
    const tinygltf::ExtensionMap *extensions;
};

template <typename Info> use use_of(const Info &info)
{
    return { info.index, info.texCoord, &info.extensions };
}

std::vector<use> uses_of(const tinygltf::Material &m)
{
    return { use_of(m.pbrMetallicRoughness.baseColorTexture), use_of(m.pbrMetallicRoughness.metallicRoughnessTexture),
             use_of(m.normalTexture), use_of(m.occlusionTexture), use_of(m.emissiveTexture) };
}

bool wraps_alike(const tinygltf::Model &m, int texture)
{
    int number = m.textures.at(static_cast<size_t>(texture)).sampler;
    if (number < 0)
        return true;
    const tinygltf::Sampler &sampler = m.samplers.at(static_cast<size_t>(number));
    return sampler.wrapS == sampler.wrapT && sampler.wrapS != TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT;
}

uv_transform transform_of(const tinygltf::Model &m, const use &use)
{
    uv_transform uv;
    uv.set = use.set;
    uv.bounded = !wraps_alike(m, use.texture);
    auto found = use.extensions->find("KHR_texture_transform");
    if (found == use.extensions->end())
        return uv;
    for (size_t i = 0; i < 2; i++) {
        uv.offset[i] = number_in(found->second, "offset", i, 0);
        uv.scale[i] = number_in(found->second, "scale", i, 1);
    }
    uv.rotation = number_in(found->second, "rotation", 0, 0);
    uv.set = static_cast<int>(number_in(found->second, "texCoord", 0, uv.set));
    return uv;
}

bool lie_alike(const uv_transform &a, const uv_transform &b)
{
    bool same = a.set == b.set && a.rotation == b.rotation;
    for (int i = 0; i < 2; i++)
        same = same && a.offset[i] == b.offset[i] && a.scale[i] == b.scale[i];
    return same;
}

int image_of(const tinygltf::Texture &texture)
{
    auto webp = texture.extensions.find("EXT_texture_webp");
    if (texture.source >= 0 || webp == texture.extensions.end())
        return texture.source;
    return static_cast<int>(number_in(webp->second, "source", 0, -1));
}

bool is_readable(const document_bytes &image)
{
    const unsigned char *b = image.at;
    return b && image.size > 12 && (memcmp(b, "\x89PNG", 4) == 0 || memcmp(b, "\xff\xd8\xff", 3) == 0 || memcmp(b + 8, "WEBP", 4) == 0);
}

/* Returns the index of the texture, or ASSET_NO_TEXTURE with the reason in *why if its image cannot be read. */
uint32_t texture_of(gltf_work *w, int texture, bool srgb, std::string *why)
{
    gltf_model *model = w->model;
    const tinygltf::Texture &t = w->parsed.textures.at(static_cast<size_t>(texture));
    int image = image_of(t);
    const document_image *from = image < 0 ? nullptr : &w->document->images[image];
    if (from && from->missing)
        *why = std::string("the texture's image is missing, so the texture is not shown: ") + from->missing;
    else if (!from || !is_readable(from->bytes))
        *why = "the texture's image is not PNG, JPEG or WebP, so the texture is not shown";
    if (!why->empty())
        return ASSET_NO_TEXTURE;
    bool repeat = t.sampler < 0 || w->parsed.samplers.at(static_cast<size_t>(t.sampler)).wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    gltf_texture wanted = { static_cast<uint32_t>(image), srgb, repeat };
    for (uint32_t i = 0; i < model->texture_count; i++)
        if (model->textures[i].image == wanted.image && model->textures[i].srgb == srgb && model->textures[i].wrap_repeat == repeat)
            return i;
    model->textures[model->texture_count] = wanted;
    return model->texture_count++;
}

float unit(double value)
{
    return static_cast<float>(std::fmin(std::fmax(value, 0), 1));
}

float finite(double value, double otherwise)
{
    float out = static_cast<float>(value);
    return std::isfinite(out) ? out : static_cast<float>(otherwise);
}

std::string material_what(const gltf_work &w, int number)
{
    return "material " + std::to_string(number) + " '" + w.parsed.materials.at(static_cast<size_t>(number)).name.substr(0, 80) + "'";
}

const char *const use_names[USE_COUNT] = { "base colour", "metallic-roughness", "normal", "occlusion", "emissive" };

/* Returns, by texture role, a pointer to the material's member with the texture's index. */
std::array<uint32_t *, USE_COUNT> places_of(asset_material *m)
{
    return { &m->base_color_texture, &m->metallic_roughness_texture, &m->normal_texture, &m->occlusion_texture, &m->emissive_texture };
}

void read_textures(gltf_work *w, const tinygltf::Material &from, asset_material *to, int number, const std::string &what)
{
    std::array<uint32_t *, USE_COUNT> places = places_of(to);
    std::vector<use> uses = uses_of(from);
    uv_lays lays = lays_of(w->parsed, number);
    for (size_t i = 0; i < USE_COUNT; i++) {
        std::string why;
        *places[i] = ASSET_NO_TEXTURE;
        if (uses[i].texture < 0)
            continue;
        if (lays.of[i] == 2)
            why = "(TEXCOORD_" + std::to_string(transform_of(w->parsed, uses[i]).set) +
                  ") is not shown: Plantcast supports only two texture mappings for a material";
        else
            *places[i] = texture_of(w, uses[i].texture, i == BASE_COLOR || i == EMISSIVE, &why);
        if (!why.empty())
            leave_out(w, what + ": the " + use_names[i] + " texture" + (why[0] == '(' ? " " : ": ") + why);
        else
            to->second |= static_cast<uint32_t>(lays.of[i]) << i;
    }
}

void read_material(gltf_work *w, const tinygltf::Material &from, asset_material *to, int number, const std::string &what)
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
    if (from.alphaMode != "OPAQUE" && from.alphaMode != "MASK" && from.alphaMode != "BLEND")
        refuse("invalid glTF file: %s: alphaMode '%.20s' does not exist in glTF 2.0", what.c_str(), from.alphaMode.c_str());
    to->alpha = from.alphaMode == "MASK" ? ASSET_ALPHA_MASK : from.alphaMode == "BLEND" ? ASSET_ALPHA_BLEND : ASSET_ALPHA_OPAQUE;
    to->double_sided = from.doubleSided;
    read_textures(w, from, to, number, what);
}

} // namespace

void leave_out(gltf_work *w, const std::string &text)
{
    char *copy = mem_strdup(text.c_str());
    utf8_drop_invalid(copy); /* a shortened name may end inside a character, which JSON does not allow */
    w->model->left_out[w->model->left_out_textures++] = copy;
}

uv_lays lays_of(const tinygltf::Model &m, int material)
{
    uv_lays lays;
    if (material < 0)
        return lays;
    std::vector<use> uses = uses_of(m.materials.at(static_cast<size_t>(material)));
    for (size_t i = 0; i < USE_COUNT; i++) {
        if (uses[i].texture < 0)
            continue;
        uv_transform own = transform_of(m, uses[i]);
        size_t &lay = lays.of[i];
        while (lay < lays.count && !lie_alike(lays.at[lay], own))
            lay++;
        if (lay == 2)
            continue;
        if (lay == lays.count)
            lays.at[lays.count++] = own;
        lays.at[lay].bounded = lays.at[lay].bounded || own.bounded;
    }
    return lays;
}

void leave_out_bounded(gltf_work *w, int material, size_t lay)
{
    std::vector<use> uses = uses_of(w->parsed.materials.at(static_cast<size_t>(material)));
    uv_lays lays = lays_of(w->parsed, material);
    std::array<uint32_t *, USE_COUNT> places = places_of(&w->model->materials[material]);
    for (size_t i = 0; i < USE_COUNT; i++)
        if (*places[i] != ASSET_NO_TEXTURE && lays.of[i] == lay && transform_of(w->parsed, uses[i]).bounded) {
            *places[i] = ASSET_NO_TEXTURE;
            leave_out(w,
                      material_what(*w, material) + ": the " + use_names[i] +
                          " texture is not shown: Plantcast does not support mirroring, or different wrapping along u and v, outside 0..1");
        }
}

void read_materials(gltf_work *w)
{
    gltf_model *model = w->model;
    const model_document *d = w->document;
    model->images = new_array<gltf_image>(d->image_count + 1);
    for (size_t i = 0; i < d->image_count; i++) {
        gltf_image *out = &model->images[model->image_count++];
        out->name = mem_strdup(d->images[i].name);
        out->size = d->images[i].bytes.size;
        out->bytes = new_array<unsigned char>(out->size + 1);
        if (out->size)
            memcpy(out->bytes, d->images[i].bytes.at, out->size);
    }
    model->materials = new_array<asset_material>(w->parsed.materials.size() + 1);
    model->material_names = new_array<char *>(w->parsed.materials.size() + 1);
    model->textures = new_array<gltf_texture>(USE_COUNT * w->parsed.materials.size() + 1);
    /* one text for each texture role of a material, one for each ignored extension, and one about nodes outside the scene */
    model->left_out = new_array<char *>(USE_COUNT * w->parsed.materials.size() + d->look_count + 2);
    for (size_t i = 0; i < d->look_count; i++)
        leave_out(w, d->looks[i]);
    for (const tinygltf::Material &material : w->parsed.materials) {
        int number = static_cast<int>(model->material_count);
        std::string what = material_what(*w, number);
        model->material_names[model->material_count++] = mem_strdup(material.name.c_str());
        read_material(w, material, &model->materials[number], number, what);
    }
}

} // namespace gltf
