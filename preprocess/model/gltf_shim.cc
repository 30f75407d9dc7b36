/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Wraps tinygltf in plain C: tinygltf parses a normalised document (model_document.h), and this file decodes the result into plain
 * arrays. */
#include "preprocess/model/gltf_shim.h"

#include <exception>
#include <limits>

#include "preprocess/model/gltf_impl.hh"

namespace
{

using gltf::refuse;

constexpr uint64_t FREE_ELEMENTS = 1 << 22, ELEMENTS_PER_BYTE = 16;

/* tinygltf's file callback: never finds or opens a file, because a normalised document does not refer to any. */
bool file_absent(const std::string &, void *)
{
    return false;
}

std::string file_expand(const std::string &name, void *)
{
    return name;
}

bool file_unread(std::vector<unsigned char> *, std::string *, const std::string &, void *)
{
    return false;
}

bool file_unwritten(std::string *, const std::string &, const std::vector<unsigned char> &, void *)
{
    return false;
}

[[maybe_unused]] bool file_unmeasured(size_t *, std::string *, const std::string &, void *)
{
    return false;
}

/* Sets a callback that exists only in tinygltf 2.9 and later. */
template <typename Callbacks> auto set_measure(Callbacks *files, int) -> decltype(files->GetFileSizeInBytes = file_unmeasured, void())
{
    files->GetFileSizeInBytes = file_unmeasured;
}

template <typename Callbacks> void set_measure(Callbacks *, long)
{
}

tinygltf::FsCallbacks no_files()
{
    tinygltf::FsCallbacks files = {};
    files.FileExists = file_absent;
    files.ExpandFilePath = file_expand;
    files.ReadWholeFile = file_unread;
    files.WriteWholeFile = file_unwritten;
    set_measure(&files, 0);
    return files;
}

void parse(gltf::gltf_work *w)
{
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    loader.SetFsCallbacks(no_files());
    if (w->document->json_bytes > std::numeric_limits<unsigned>::max())
        refuse("the JSON part of the glTF model has %zu bytes; Plantcast supports at most %u: split the model", w->document->json_bytes,
               std::numeric_limits<unsigned>::max());
    bool good =
        loader.LoadASCIIFromString(&w->parsed, &error, &warning, w->document->json, static_cast<unsigned>(w->document->json_bytes), "");
    while (!error.empty() && error.back() == '\n')
        error.pop_back();
    /* rejects the model if there is an error text, even if tinygltf returned true: the text may describe content that it could
       not read */
    if (!good || !error.empty())
        refuse("%s", error.empty() ? "not a glTF file" : error.c_str());
}

} // namespace

extern "C" bool gltf_load(struct gltf_model *model, const struct model_source *source, char why[MODEL_WHY_BYTES])
{
    struct model_document document;
    bool good = false;
    *model = {};
    if (!model_document_open(&document, source, why))
        return false;
    try {
        gltf::gltf_work w = { &document, {}, model, FREE_ELEMENTS + ELEMENTS_PER_BYTE * document.total_bytes };
        parse(&w);
        gltf::read_materials(&w);
        gltf::read_nodes(&w);
        gltf::read_meshes(&w);
        good = true;
    } catch (const std::bad_alloc &) {
        snprintf(why, MODEL_WHY_BYTES, "out of memory");
    } catch (const std::exception &e) {
        snprintf(why, MODEL_WHY_BYTES, "%s", e.what());
    } catch (...) {
        snprintf(why, MODEL_WHY_BYTES, "the glTF library could not read the model, and gave no reason: export the model again");
    }
    if (!good)
        gltf_free(model);
    model_document_finish(&document);
    return good;
}

extern "C" void gltf_free(struct gltf_model *model)
{
    for (uint32_t i = 0; i < model->primitive_count; i++) {
        mem_free(model->primitives[i].positions);
        mem_free(model->primitives[i].normals);
        mem_free(model->primitives[i].texcoords);
        mem_free(model->primitives[i].second_texcoords);
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
    for (uint32_t i = 0; i < model->left_out_textures; i++)
        mem_free(model->left_out[i]);
    mem_free(model->left_out);
    mem_free(model->primitives);
    mem_free(model->meshes);
    mem_free(model->nodes);
    mem_free(model->materials);
    mem_free(model->material_names);
    mem_free(model->textures);
    mem_free(model->images);
    *model = {};
}
